//! Walls that the laser does not see as others: of glass, or lower than the rest.
//!
//! | key of a world file | walls in the rectangle | a beam |
//! | --- | --- | --- |
//! | `glass: [[x0, y0, x1, y1], …]` | of glass | goes through, to what is behind |
//! | `low: [[x0, y0, x1, y1, height], …]` | as high as said | goes over, if it is higher |
//!
//! A wall cell belongs to a rectangle if its centre lies in it. The robot touches such a wall as
//! any other, and it bounds the floor as any other. Only rays know the material.
//!
//! Metres.

use super::occupancy::{Class, GridCell, Occupancy};
use super::yaml::{BadKey, Node, Table};

/// A rectangle of walls, and how high they are for a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Patch {
    /// Least x and y, greatest x and y.
    corners_m: [f64; 4],
    /// Metres above the ground; below the ground for glass.
    height_m: f64,
}

/// Height of glass: no beam is below it.
const GLASS_M: f64 = f64::NEG_INFINITY;

/// The patches of a world file, in the order in which they count: a later one replaces an earlier
/// one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Materials(Vec<(String, Patch)>);

/// Heights of the wall cells, for rays.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WallHeights {
    /// Metres above the ground, row by row; NaN for the world's own height.
    heights_m: Vec<f64>,
}

impl Materials {
    /// Reads `glass` and `low`.
    pub(super) fn read(keys: &Table<'_>) -> Result<Self, BadKey> {
        let mut patches = Vec::new();
        for (key, count, form) in [
            ("low", 5, "[x0, y0, x1, y1, height]"),
            ("glass", 4, "[x0, y0, x1, y1]"),
        ] {
            let list = match keys.node(key) {
                None => continue,
                Some(Node::List(list)) => list,
                Some(other) => {
                    let reason = format!("{other} is not a list of {form}; give metres");
                    return Err(keys.bad(key, &reason));
                }
            };
            for (index, node) in list.iter().enumerate() {
                let name = format!("{key}[{index}]");
                let patch = patch(node, count);
                let patch = patch.ok_or_else(|| {
                    let reason = format!(
                        "{node} is not {form} in metres with x0 < x1, y0 < y1 and a height above 0"
                    );
                    keys.bad(&name, &reason)
                })?;
                patches.push((name, patch));
            }
        }
        Ok(Self(patches))
    }

    /// Returns the heights of the walls of a plan; `None` without patches.
    pub(super) fn heights(
        &self,
        plan: &Occupancy,
        keys: &Table<'_>,
    ) -> Result<Option<WallHeights>, BadKey> {
        if self.0.is_empty() {
            return Ok(None);
        }
        let mut heights_m = vec![f64::NAN; plan.width() * plan.height()];
        for (
            name,
            Patch {
                corners_m,
                height_m,
            },
        ) in &self.0
        {
            let mut is_used = false;
            let [x0, y0, x1, y1] = *corners_m;
            for (index, _) in (0..)
                .zip(plan.classes())
                .filter(|(_, it)| **it == Class::Wall)
            {
                let (i, j) = (index % plan.width(), index / plan.width());
                let [x, y] = plan.centre(GridCell {
                    i: i as i64,
                    j: j as i64,
                });
                if (x0..=x1).contains(&x) && (y0..=y1).contains(&y) {
                    heights_m[index] = *height_m;
                    is_used = true;
                }
            }
            if !is_used {
                let reason = "no wall cell has its centre there; draw the wall in the image";
                return Err(keys.bad(name, reason));
            }
        }
        Ok(Some(WallHeights { heights_m }))
    }
}

impl WallHeights {
    /// Height of the wall on a cell above the ground; `None` for the world's own height.
    pub(super) fn of(&self, index: usize) -> Option<f64> {
        let height_m = self.heights_m.get(index).copied();
        height_m.filter(|height_m| !height_m.is_nan())
    }
}

/// Reads a patch of so many numbers.
fn patch(node: &Node, count: usize) -> Option<Patch> {
    let numbers = node.numbers(count..=count)?;
    let [x0, y0, x1, y1] = [numbers[0], numbers[1], numbers[2], numbers[3]];
    let height_m = numbers.get(4).copied();
    let is_patch = x0 < x1 && y0 < y1 && height_m.is_none_or(|height_m| height_m > 0.0);
    is_patch.then_some(Patch {
        corners_m: [x0, y0, x1, y1],
        height_m: height_m.unwrap_or(GLASS_M),
    })
}
