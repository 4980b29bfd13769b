//! The true class of every map cell, for a robot that starts at a given pose.
//!
//! | class | map cells |
//! | --- | --- |
//! | traversable | ground that the robot covers within its limits ([`Footing`]) |
//! | obstacle | walls; steep ground or edges that rise from covered ground within `BESIDE_M` |
//! | negative | holes; steep ground or edges that fall from covered ground within `BESIDE_M` |
//! | either | steep ground or edge with covered ground above and below it |
//! | unjudged | anything else: ground that the robot cannot reach |

use fieldline_planner::geometry::Cell;

use super::cell_area::CellArea;
use super::coverage::{MAP_CELL_M, Truth, centre_m, truth};
use super::footing::Footing;
use super::gentle::is_gentle;
use crate::robot::Limits;
use crate::world::World;

/// Greatest distance from a steep cell to the covered ground that decides its class, metres.
const BESIDE_M: f64 = 0.5;

/// True class of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrueClass {
    /// The robot may be there.
    Traversable,
    /// The ground rises.
    Obstacle,
    /// The ground falls.
    Negative,
    /// An obstacle from one side, negative from the other.
    Either,
    /// Out of reach.
    Unjudged,
}

/// The true class of every cell.
#[derive(Clone, Debug)]
pub struct GroundTruth {
    pub(super) area: CellArea,
    pub(super) classes: Vec<TrueClass>,
}

impl GroundTruth {
    /// Classifies the cells of a world for a robot with this footing.
    #[must_use]
    pub fn new(world: &World, footing: &Footing, limits: &Limits) -> Self {
        let area = *footing.area();
        let heights_m: Vec<Option<f64>> = (0..area.len())
            .map(|index| {
                let [x, y] = centre_m(area.cell(index));
                world.ground_m(x, y)
            })
            .collect();
        let classes = (0..area.len())
            .map(|index| {
                let cell = area.cell(index);
                match heights_m[index] {
                    _ if truth(world, cell) != Truth::Free => TrueClass::Obstacle,
                    None => TrueClass::Negative,
                    _ if footing.covers(cell) => TrueClass::Traversable,
                    _ if is_gentle(world, cell, limits) => TrueClass::Unjudged,
                    Some(_) => steep(footing, &heights_m, cell),
                }
            })
            .collect();
        Self { area, classes }
    }

    /// The map cells of the world.
    #[must_use]
    pub fn area(&self) -> &CellArea {
        &self.area
    }

    /// True class of a cell; unjudged outside.
    #[must_use]
    pub fn class(&self, cell: Cell) -> TrueClass {
        self.area
            .index(cell)
            .map_or(TrueClass::Unjudged, |index| self.classes[index])
    }
}

/// Class of a steep cell, from the covered ground around it. From ground nearer to the height of
/// the cell's lower side it rises, from other ground it falls.
fn steep(footing: &Footing, heights_m: &[Option<f64>], cell: Cell) -> TrueClass {
    let cells = (BESIDE_M / MAP_CELL_M).round() as i32;
    let area = footing.area();
    let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
    for height_m in area.around(cell, 1).map(|index| heights_m[index]) {
        // A hole counts as infinitely deep.
        low_m = low_m.min(height_m.unwrap_or(f64::NEG_INFINITY));
        high_m = high_m.max(height_m.unwrap_or(f64::NEG_INFINITY));
    }
    let (mut above, mut below) = (false, false);
    for index in area.around(cell, cells) {
        let beside = area.cell(index);
        let (dx, dy) = (beside.x - cell.x, beside.y - cell.y);
        if dx * dx + dy * dy > cells * cells || !footing.covers(beside) {
            continue;
        }
        let lower = heights_m[index].map(|height_m| height_m < 0.5 * (low_m + high_m));
        above |= lower == Some(false);
        below |= lower == Some(true);
    }
    match (above, below) {
        (true, true) => TrueClass::Either,
        (true, false) => TrueClass::Negative,
        (false, true) => TrueClass::Obstacle,
        (false, false) => TrueClass::Unjudged,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::world::{Class, Elevation, GridCell, Occupancy, Start};

    /// The true classes of a strip of 8 × 3 m, sampled every 5 cm, with a start at `x_m`.
    pub(in crate::metrics) fn truths(
        x_m: f64,
        walls: &[i64],
        height_m: impl Fn(f64) -> f64,
    ) -> GroundTruth {
        let size = [160, 60];
        let elevation = Elevation::from_fn(size, 0.05, [0.0, 0.0], |x, _| height_m(x));
        let mut grid = Occupancy::filled(size[0], size[1], 0.05, [0.0, 0.0], Class::Free);
        for i in walls {
            for j in 0..60 {
                grid.set(GridCell { i: *i, j }, Class::Wall);
            }
        }
        let start = Start {
            x_m,
            y_m: 1.5,
            yaw_rad: 0.0,
        };
        let world = World::uneven("strip", grid, elevation, vec![start]);
        let footing = Footing::new(&world, start, 0.3, &Limits::WORKING);
        GroundTruth::new(&world, &footing, &Limits::WORKING)
    }

    /// The middle row as characters.
    fn row(truths: &GroundTruth) -> String {
        (0..80)
            .map(|x| match truths.class(Cell { x, y: 15 }) {
                TrueClass::Traversable => '.',
                TrueClass::Obstacle => '#',
                TrueClass::Negative => 'v',
                TrueClass::Either => 'x',
                TrueClass::Unjudged => '?',
            })
            .collect()
    }

    pub(in crate::metrics) fn cliff(x: f64) -> f64 {
        if x > 4.0 { 1.0 } else { 0.0 }
    }

    #[test]
    fn a_cliff_is_an_obstacle_from_below_and_negative_from_above() {
        let (below, above) = (row(&truths(1.0, &[], cliff)), row(&truths(7.0, &[], cliff)));
        assert_eq!(below, format!("{}##{}", ".".repeat(39), "?".repeat(39)));
        assert_eq!(above, format!("{}vv{}", "?".repeat(39), ".".repeat(39)));
    }

    #[test]
    fn ground_beyond_a_wall_or_a_hole_is_unjudged() {
        let ground = |x: f64| if (x - 6.0).abs() < 0.3 { f64::NAN } else { 0.0 };
        let seen = row(&truths(1.0, &[80, 81, 82, 83], ground));
        assert_eq!(&seen[..42], format!("{}##", ".".repeat(40)));
        // A patch with a corner in the hole has no ground. The far rim and the ground before it are
        // out of reach.
        assert_eq!(seen[57..63], *"vvvvvv");
        assert!(seen[43..56].chars().all(|c| c == '?'), "{seen}");
    }

    #[test]
    fn the_rim_of_a_hole_without_a_floor_is_negative() {
        // The ground tilts away from the hole, is level, or tilts towards it.
        for tilt in [-0.02, 0.0, 0.02] {
            let ground = |x: f64| if x > 5.0 { f64::NAN } else { tilt * x };
            let seen = row(&truths(1.0, &[], ground));
            assert_eq!(seen, format!("{}{}", ".".repeat(49), "v".repeat(31)));
        }
    }
}
