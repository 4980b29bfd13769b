//! How much of what could be known is known.
//!
//! The denominator is honest: the map cells of 10 cm that a disc of the robot's radius, driven wherever it can get from the
//! start ([`CellSet::reach`]), could have seen. A cell counts if its centre is free and
//! - lies in a reached cell, or
//! - one of [`DIRECTIONS`] level rays from it meets a reached cell within the laser's range before anything solid.
//!
//! On uneven ground the denominator is what the robot covers from wherever it can get within its limits
//! ([`Footing`]).
//!
//! The numerator counts only cells of the denominator, so that a map smeared beyond the walls earns nothing. Once
//! known, a cell stays counted until [`Coverage::recount`].
//!
//! [`CellSet::reach`]: super::CellSet::reach

use fieldline_planner::geometry::Cell;

use super::footing::Footing;
use super::frame::Frame;
use super::reach::CellSet;
use crate::world::{GridCell, Start, Walk, World};

/// Side of a map cell, metres; `fieldline_planner::geometry::CELL_M` in double precision.
pub const MAP_CELL_M: f64 = 0.1;
/// Rays cast from a cell before it is called invisible.
pub const DIRECTIONS: u32 = 360;
/// Coprime to [`DIRECTIONS`] and near its golden section: consecutive rays go far apart.
const STRIDE: u32 = 223;

/// What the true world has in a map cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// Nothing solid anywhere in it.
    Free,
    /// Solid in part: an edge of something.
    Edge,
    /// Solid throughout, or outside of the world.
    Solid,
}

/// The measure of an exploration.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// Cells that can be seen, those already known first.
    cells: Vec<Cell>,
    known: usize,
    seen_at_s: [Option<f64>; 2],
}

/// Fractions whose times are kept: T90 and T99.
const MILESTONES: [f64; 2] = [0.90, 0.99];

impl Coverage {
    /// Finds everything that a disc of `radius_m`, driven from `start`, could have seen within `range_m`.
    #[must_use]
    pub fn new(world: &World, start: Start, radius_m: f64, range_m: f64) -> Self {
        let reach = CellSet::reach(world, start, radius_m);
        let free = CellSet::free(world, start);
        let grid = world.occupancy();
        let cells = map_cells(world)
            .filter(|cell| {
                let [x, y] = centre_m(*cell);
                let place = grid.cell_at(x, y);
                // A line of sight is free all along, so it cannot leave the free cells around the start.
                reach.contains(place)
                    || (free.contains(place) && visible(world, &reach, [x, y], range_m))
            })
            .collect();
        Self {
            cells,
            known: 0,
            seen_at_s: [None; 2],
        }
    }

    /// What a robot on uneven ground covers from wherever it can get.
    #[must_use]
    pub fn on(footing: &Footing) -> Self {
        let frame = *footing.frame();
        let cells = (0..frame.len())
            .map(|index| frame.cell(index))
            .filter(|cell| footing.covers(*cell));
        Self {
            cells: cells.collect(),
            known: 0,
            seen_at_s: [None; 2],
        }
    }

    /// Asks about the cells not known so far, at a simulated time in seconds, and returns the fraction.
    pub fn update(&mut self, time_s: f64, is_known: impl Fn(Cell) -> bool) -> f64 {
        for index in self.known..self.cells.len() {
            if is_known(self.cells[index]) {
                self.cells.swap(index, self.known);
                self.known += 1;
            }
        }
        let fraction = self.fraction();
        for (seen, milestone) in self.seen_at_s.iter_mut().zip(MILESTONES) {
            if fraction >= milestone {
                seen.get_or_insert(time_s);
            }
        }
        fraction
    }

    /// Asks about every cell anew, the known ones too, and returns the fraction.
    pub fn recount(&mut self, time_s: f64, is_known: impl Fn(Cell) -> bool) -> f64 {
        self.known = 0;
        self.update(time_s, is_known)
    }

    /// Known cells over cells that can be seen; 1 where there are none.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        if self.cells.is_empty() {
            1.0
        } else {
            self.known as f64 / self.cells.len() as f64
        }
    }

    /// Area known of what can be seen, m².
    #[must_use]
    pub fn known_m2(&self) -> f64 {
        self.known as f64 * MAP_CELL_M * MAP_CELL_M
    }

    /// Area that can be seen, m².
    #[must_use]
    pub fn reachable_m2(&self) -> f64 {
        self.cells.len() as f64 * MAP_CELL_M * MAP_CELL_M
    }

    /// When 90 % were known, simulated seconds.
    #[must_use]
    pub fn t90_s(&self) -> Option<f64> {
        self.seen_at_s[0]
    }

    /// When 99 % were known, simulated seconds.
    #[must_use]
    pub fn t99_s(&self) -> Option<f64> {
        self.seen_at_s[1]
    }

    /// Cells that can be seen but are not known.
    #[must_use]
    pub fn missing(&self) -> &[Cell] {
        &self.cells[self.known..]
    }

    /// All cells that can be seen, in no particular order.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }
}

/// The map cells that lie at least partly in the world, row by row.
pub fn map_cells(world: &World) -> impl Iterator<Item = Cell> + use<> {
    let frame = Frame::of(world);
    (0..frame.len()).map(move |index| frame.cell(index))
}

/// What the true world has in a map cell.
#[must_use]
pub fn truth(world: &World, cell: Cell) -> Truth {
    // A border that is shared with the next cell, give or take rounding, does not count.
    let slack_m = 1e-6;
    let [x, y] = centre_m(cell);
    let half = 0.5 * MAP_CELL_M - slack_m;
    let grid = world.occupancy();
    let (low, high) = (
        grid.cell_at(x - half, y - half),
        grid.cell_at(x + half, y + half),
    );
    let (mut solid, mut free) = (false, false);
    for j in low.j..=high.j {
        for i in low.i..=high.i {
            let here = grid.is_solid(GridCell { i, j });
            solid |= here;
            free |= !here;
        }
    }
    match (solid, free) {
        (false, _) => Truth::Free,
        (true, true) => Truth::Edge,
        (true, false) => Truth::Solid,
    }
}

/// The centre of a map cell, metres.
pub(super) fn centre_m(cell: Cell) -> [f64; 2] {
    [cell.x, cell.y].map(|k| (f64::from(k) + 0.5) * MAP_CELL_M)
}

/// Does some ray from a point meet a reached cell before anything solid?
fn visible(world: &World, reach: &CellSet, from_m: [f64; 2], range_m: f64) -> bool {
    let step = core::f64::consts::TAU / f64::from(DIRECTIONS);
    (0..DIRECTIONS).any(|k| {
        let bearing = f64::from(k * STRIDE % DIRECTIONS) * step;
        let direction = [libm::cos(bearing), libm::sin(bearing)];
        meets(world, reach, (from_m, direction), range_m)
    })
}

/// Does this ray?
fn meets(
    world: &World,
    reach: &CellSet,
    (from_m, direction): ([f64; 2], [f64; 2]),
    range_m: f64,
) -> bool {
    let grid = world.occupancy();
    let origin_m = grid.origin_m();
    let start = [0, 1].map(|k| (from_m[k] - origin_m[k]) / grid.resolution_m());
    let mut walk = Walk::new(start, direction.map(|d| d / grid.resolution_m()));
    while walk.entered_m <= range_m {
        let [i, j] = walk.cell;
        let cell = GridCell { i, j };
        if grid.is_solid(cell) {
            return false;
        }
        if reach.contains(cell) {
            return true;
        }
        walk.advance();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Class, Occupancy, Ray};
    use std::collections::BTreeSet;

    const RANGE_M: f64 = 12.0;

    /// Map cells seen, of a world whose corner lies at the origin, with a margin of one cell.
    struct Seen {
        columns: i32,
        cells: Vec<bool>,
    }

    impl Seen {
        /// What perfect beams see from every eighth cell of reach in both directions.
        fn from_everywhere(world: &World, start: Start) -> Self {
            let [columns, rows] = world.size_m().map(|m| (m / MAP_CELL_M) as i32 + 3);
            let mut seen = Self {
                columns,
                cells: vec![false; (columns * rows) as usize],
            };
            let reach = CellSet::reach(world, start, 0.3);
            let grid = world.occupancy();
            for j in (0..grid.height() as i64).step_by(8) {
                for i in (0..grid.width() as i64).step_by(8) {
                    let cell = GridCell { i, j };
                    if reach.contains(cell) {
                        seen.look_around(world, grid.centre(cell));
                    }
                }
            }
            seen
        }

        fn look_around(&mut self, world: &World, [x, y]: [f64; 2]) {
            for k in 0..360 {
                let bearing = f64::from(k).to_radians();
                let direction = [libm::cos(bearing), libm::sin(bearing), 0.0];
                let ray = Ray {
                    origin_m: [x, y, 0.4],
                    direction,
                };
                let end_m = world.cast(&ray, RANGE_M).map_or(RANGE_M, |hit| hit.range_m);
                let steps = (end_m / 0.03) as u32;
                let ways = (0..=steps).map(|k| f64::from(k) * 0.03);
                for at_m in ways.chain([end_m + 1e-6]) {
                    let map = |k: usize| {
                        ((ray.origin_m[k] + at_m * direction[k]) / MAP_CELL_M).floor() as i32
                    };
                    let index = self.index(Cell {
                        x: map(0),
                        y: map(1),
                    });
                    self.cells[index] = true;
                }
            }
        }

        fn index(&self, cell: Cell) -> usize {
            ((cell.y + 1) * self.columns + cell.x + 1) as usize
        }

        fn contains(&self, cell: Cell) -> bool {
            self.cells[self.index(cell)]
        }
    }

    #[test]
    fn the_denominator_can_be_reached_and_not_exceeded() {
        for name in ["cave", "narrow-doors", "unreachable-room", "boxed-in"] {
            let world = World::builtin(name).expect("built in");
            let start = world.starts()[0];
            let seen = Seen::from_everywhere(&world, start);
            let mut coverage = Coverage::new(&world, start, 0.3, RANGE_M);
            let fraction = coverage.update(1.0, |cell| seen.contains(cell));
            assert!(fraction > 0.995, "{name}: {fraction}");
            // What is seen and free is in the denominator, but for cells whose centre hides behind an edge.
            let cells: BTreeSet<_> = coverage.cells().iter().map(|c| (c.x, c.y)).collect();
            let beyond = map_cells(&world)
                .filter(|cell| seen.contains(*cell) && truth(&world, *cell) == Truth::Free)
                .filter(|cell| !cells.contains(&(cell.x, cell.y)))
                .count();
            assert!(beyond * 100 <= cells.len(), "{name}: {beyond} cells beyond");
        }
    }

    #[test]
    fn a_room_seen_through_a_gap_counts_as_far_as_it_is_seen() {
        let world = World::builtin("unreachable-room").expect("built in");
        let coverage = Coverage::new(&world, world.starts()[0], 0.3, RANGE_M);
        let counts = |x0: i32, x1: i32| {
            let inside = |c: &&Cell| (x0..x1).contains(&c.x) && (54..102).contains(&c.y);
            coverage.cells().iter().filter(inside).count()
        };
        // 42 × 48 cells each: nothing of the sealed room, most of the one behind the gap, all of the open one.
        assert_eq!(counts(2, 44), 0);
        assert!((1500..2016).contains(&counts(46, 88)), "{}", counts(46, 88));
        assert_eq!(counts(90, 132), 2016);
    }

    #[test]
    fn milestones_are_kept_and_a_recount_forgets() {
        let row = ".".repeat(20);
        let world = World::picture("room", 0.1, &[row.as_str(); 20]);
        let start = Start {
            x_m: 1.0,
            y_m: 1.0,
            yaw_rad: 0.0,
        };
        let mut coverage = Coverage::new(&world, start, 0.3, RANGE_M);
        assert!((coverage.reachable_m2() - 4.0).abs() < 1e-9);
        assert_eq!(coverage.update(1.0, |cell| cell.y < 10), 0.5);
        assert_eq!((coverage.t90_s(), coverage.t99_s()), (None, None));
        assert_eq!(coverage.update(2.0, |cell| cell.y < 18), 0.9);
        assert_eq!(coverage.update(3.0, |_| true), 1.0);
        assert_eq!((coverage.t90_s(), coverage.t99_s()), (Some(2.0), Some(3.0)));
        assert!(coverage.missing().is_empty());
        assert_eq!(coverage.recount(4.0, |cell| cell.x < 10), 0.5);
        assert!((coverage.known_m2() - 2.0).abs() < 1e-9);
        assert_eq!(coverage.missing().len(), 200);
    }

    #[test]
    fn truth_of_cells_that_do_not_match_the_worlds_grid() {
        let mut grid = Occupancy::filled(4, 1, 0.075, [0.0, 0.0], Class::Free);
        grid.set(GridCell { i: 3, j: 0 }, Class::Wall);
        let world = World::flat("strip", grid, Vec::new());
        // Columns end at 0.075, 0.15, 0.225 (wall from there) and 0.3; above 0.075 everything is outside.
        let truths = [0, 1, 2, 3].map(|x| truth(&world, Cell { x, y: 0 }));
        assert_eq!(
            truths,
            [Truth::Edge, Truth::Edge, Truth::Edge, Truth::Solid]
        );
        let row = World::picture("row", 0.05, &["....##", "....##"]);
        let truths = [0, 1, 2].map(|x| truth(&row, Cell { x, y: 0 }));
        assert_eq!(truths, [Truth::Free, Truth::Free, Truth::Solid]);
        assert_eq!(map_cells(&row).count(), 3);
    }
}
