//! The drawing of a built-in world: shapes that are filled one after another.
//!
//! | shape | fills |
//! | --- | --- |
//! | `floor`, `block` | rectangles [x0, y0, x1, y1] with floor, or with wall |
//! | `disc` | discs [x, y, radius] with wall |
//! | `loops` | corridors 2 m wide around blocks [x, y, width, height], and then the blocks |
//! | `rough-floor`, `rough-block` | discs, lines [x0, y0, x1, y1, half width] with a rough edge |
//! | `scatter` | wall: boxes and posts at random places with gaps between |
//! | `border` | a wall of this thickness all around |
//! | `funnel` | floor: an entrance at [x, y] that widens to the north |
//!
//! Metres. With `wall`, an outer wall of this thickness lies around `size`, and coordinates count
//! from its inside.

use serde::Deserialize;

use super::super::canvas::{Canvas, hash, roughness};
use super::super::occupancy::{Class, Occupancy};
use super::ground::Ground;

/// Width of the corridors of loops, metres.
pub(super) const CORRIDOR_M: f64 = 2.0;
/// How far the noise moves a rough edge in and out, metres.
const ROUGH_M: f64 = 0.45;

/// A world's file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) description: String,
    /// Width and height.
    size: [f64; 2],
    /// Thickness of an outer wall around the size.
    #[serde(default)]
    wall: f64,
    /// What the plan is filled with at first.
    #[serde(default)]
    filled: Filled,
    #[serde(default)]
    pub(super) draw: Vec<Shape>,
    pub(super) ground: Option<Ground>,
    #[serde(default)]
    pub(super) places: Vec<NamedPlace>,
    /// Starts: x, y and yaw.
    pub(super) robots: Vec<[f64; 3]>,
}

/// A place; its point is the centre of its extent if none is given.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NamedPlace {
    pub(super) name: String,
    pub(super) extent: [f64; 4],
    pub(super) point: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Filled {
    #[default]
    Wall,
    Free,
}

/// What is filled.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Shape {
    Floor(Vec<[f64; 4]>),
    Block(Vec<[f64; 4]>),
    Disc(Vec<[f64; 3]>),
    Loops(Vec<[f64; 4]>),
    RoughFloor(Vec<Line>),
    RoughBlock(Vec<Line>),
    Scatter(Scatter),
    Border(f64),
    Funnel([f64; 2]),
}

/// A thick line, or a disc.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Line {
    Disc([f64; 3]),
    Line([f64; 5]),
}

/// Obstacles at random places.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Scatter {
    seed: u32,
    /// Number of places that are tried; most have no room.
    trials: u32,
    /// Least gap between two obstacles, and between an obstacle and a wall.
    gap: f64,
    /// Least radius, and the span of radii above it.
    radius: [f64; 2],
    /// True if two of three obstacles are boxes; the others are discs.
    #[serde(default)]
    boxes: bool,
    /// Discs that stay clear.
    #[serde(default)]
    clearings: Vec<[f64; 3]>,
}

impl File {
    /// Draws the plan.
    pub(super) fn drawn(&self) -> Occupancy {
        let [width, height] = self.size.map(|side| side + 2.0 * self.wall);
        let class = match self.filled {
            Filled::Wall => Class::Wall,
            Filled::Free => Class::Free,
        };
        let mut canvas = Canvas::new(width, height, class);
        for shape in &self.draw {
            self.fill(&mut canvas, shape);
        }
        canvas.finish()
    }

    fn fill(&self, canvas: &mut Canvas, shape: &Shape) {
        let inside = |corners: &[f64; 4]| corners.map(|m| m + self.wall);
        match shape {
            Shape::Floor(list) => list.iter().for_each(|it| canvas.floor(inside(it))),
            Shape::Block(list) => list.iter().for_each(|it| canvas.block(inside(it))),
            Shape::Disc(list) => list.iter().for_each(|[x, y, radius]| {
                canvas.disc(Class::Wall, [*x, *y], *radius);
            }),
            Shape::Loops(blocks) => {
                let c = CORRIDOR_M;
                for [x, y, w, h] in blocks {
                    canvas.floor(inside(&[x - c, y - c, x + w + c, y + h + c]));
                }
                for [x, y, w, h] in blocks {
                    canvas.block(inside(&[*x, *y, x + w, y + h]));
                }
            }
            Shape::RoughFloor(lines) => lines.iter().for_each(|it| it.fill(canvas, Class::Free)),
            Shape::RoughBlock(lines) => lines.iter().for_each(|it| it.fill(canvas, Class::Wall)),
            Shape::Scatter(scatter) => scatter.fill(canvas, self.wall),
            Shape::Border(thickness) => canvas.border(*thickness),
            // A gap of 1.6 m in a wall. Behind it the room widens at 45° to 5.4 m, 5.6 m deep.
            Shape::Funnel([at_x, at_y]) => canvas.fill(Class::Free, |x, y| {
                let (aside, inwards) = ((x - at_x).abs(), y - at_y);
                (-0.1..5.6).contains(&inwards) && aside < (0.8 + inwards.max(0.0)).min(2.7)
            }),
        }
    }
}

impl Line {
    fn fill(self, canvas: &mut Canvas, class: Class) {
        let [x0, y0, x1, y1, reach] = match self {
            Self::Disc([x, y, radius]) => [x, y, x, y, radius],
            Self::Line(line) => line,
        };
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length2 = (dx * dx + dy * dy).max(1e-9);
        canvas.fill(class, |px, py| {
            let along = (((px - x0) * dx + (py - y0) * dy) / length2).clamp(0.0, 1.0);
            let (ex, ey) = (px - x0 - along * dx, py - y0 - along * dy);
            let reach = reach + ROUGH_M * roughness(px, py);
            ex * ex + ey * ey < reach * reach
        });
    }
}

impl Scatter {
    fn fill(&self, canvas: &mut Canvas, wall_m: f64) {
        let [side, _] = canvas.size_m();
        // Centre and radius of the circle around each obstacle.
        let mut placed = self.clearings.clone();
        for trial in self.seed..self.seed + self.trials {
            let random = |what: u32| f64::from(hash(trial, what) >> 8) / f64::from(1_u32 << 24);
            let radius = self.radius[0] + self.radius[1] * random(2);
            let margin = wall_m + self.gap + radius;
            let [x, y] = [0, 1].map(|axis| margin + random(axis) * (side - 2.0 * margin));
            let clear = placed.iter().all(|[other_x, other_y, other]| {
                let apart = self.gap + radius + other;
                (x - other_x) * (x - other_x) + (y - other_y) * (y - other_y) > apart * apart
            });
            if !clear {
                continue;
            }
            placed.push([x, y, radius]);
            if !self.boxes || hash(trial, 3).is_multiple_of(3) {
                canvas.disc(Class::Wall, [x, y], radius);
                continue;
            }
            // A box whose corner lies on the circle.
            let is_wide = hash(trial, 4).is_multiple_of(2);
            let [a, b] = if is_wide { [0.8, 0.6] } else { [0.6, 0.8] }.map(|part| part * radius);
            canvas.block([x - a, y - b, x + a, y + b]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::find;
    use super::*;

    /// The blocks of a world's loops.
    fn loops(world: &str) -> Vec<[f64; 4]> {
        let shapes = find(world).expect("listed").file.draw.iter();
        let blocks = shapes.filter_map(|shape| match shape {
            Shape::Loops(blocks) => Some(blocks.clone()),
            _ => None,
        });
        blocks.flatten().collect()
    }

    #[test]
    fn the_loops_have_their_published_lengths() {
        for (world, lengths) in [
            ("ouroboros-a", &[44, 46, 58, 78][..]),
            ("ouroboros-b", &[72; 3]),
            ("tdbvp-adjacent", &[72; 3]),
            ("tdbvp-nested", &[88, 48]),
            ("tdbvp-floor", &[90, 60]),
        ] {
            let length =
                |[_, _, w, h]: &[f64; 4]| (2.0 * (w + h) + 4.0 * CORRIDOR_M).round() as u32;
            let found: Vec<u32> = loops(world).iter().map(length).collect();
            assert_eq!(found, lengths, "{world}");
        }
    }

    /// A corridor between blocks is as wide as one along the outer wall, so two loops side by side
    /// share it.
    #[test]
    fn blocks_are_one_corridor_apart() {
        for world in [
            "ouroboros-a",
            "ouroboros-b",
            "tdbvp-adjacent",
            "tdbvp-floor",
        ] {
            let blocks = loops(world);
            for (k, one) in blocks.iter().enumerate() {
                for other in &blocks[k + 1..] {
                    let gap = |low: usize| {
                        let first = if one[low] < other[low] { one } else { other };
                        one[low].max(other[low]) - first[low] - first[low + 2]
                    };
                    let apart = gap(0).max(gap(1));
                    assert!(apart >= CORRIDOR_M - 1e-9, "{one:?} {other:?}: {apart}");
                }
            }
        }
    }
}
