//! Coverage: the share of the visible map cells that the map knows.
//!
//! The denominator is the map cells of 10 cm that a robot could see from everywhere that its disc
//! can reach from the start ([`CellSet::reach`]). A cell counts if its centre is free and
//! - lies in a reached cell, or
//! - one of [`DIRECTIONS`] level rays from it hits a reached cell within the laser's range, before
//!   anything solid.
//!
//! On uneven ground the denominator is the ground that the robot covers within its limits
//! ([`Footing`]).
//!
//! The numerator counts only cells of the denominator, so a map smeared beyond the walls gains
//! nothing. A cell that was known once stays counted.
//!
//! [`CellSet::reach`]: super::CellSet::reach

use fieldline_planner::geometry::Cell;

use super::cell_area::CellArea;
use super::footing::Footing;
use super::reach::CellSet;
use crate::world::{GridCell, GridTraversal, Start, World};

/// Side of a map cell, metres; `fieldline_planner::geometry::CELL_M` in double precision.
pub const MAP_CELL_M: f64 = 0.1;
/// Number of rays from a cell before it counts as invisible.
pub const DIRECTIONS: u32 = 360;
/// Step between consecutive rays. It is coprime to [`DIRECTIONS`] and near its golden section, so
/// consecutive rays point far apart.
const STRIDE: u32 = 223;

/// Content of a map cell in the true world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// Nothing solid anywhere in it.
    Free,
    /// Partly solid: an edge of something.
    Edge,
    /// Wholly solid, or outside of the world.
    Solid,
}

/// Coverage of an exploration.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// Visible cells; the known ones come first.
    cells: Vec<Cell>,
    known: usize,
    seen_at_s: [Option<f64>; MILESTONES.len()],
}

/// Fractions whose times are recorded: T90 and T99.
const MILESTONES: [f64; 3] = [0.90, 0.95, 0.99];

impl Coverage {
    /// Finds the cells that a disc of `radius_m` from `start` can see within `range_m`.
    #[must_use]
    pub fn new(world: &World, start: Start, radius_m: f64, range_m: f64) -> Self {
        let key = [start.x_m, start.y_m, start.yaw_rad, radius_m, range_m].map(f64::to_bits);
        let cells = || visible_cells(world, start, radius_m, range_m);
        Self {
            cells: world.seen().get(key, cells),
            known: 0,
            seen_at_s: [None; MILESTONES.len()],
        }
    }

    /// The cells that a robot on uneven ground covers.
    #[must_use]
    pub fn on(footing: &Footing) -> Self {
        let area = *footing.area();
        let cells = (0..area.len())
            .map(|index| area.cell(index))
            .filter(|cell| footing.covers(*cell));
        Self {
            cells: cells.collect(),
            known: 0,
            seen_at_s: [None; MILESTONES.len()],
        }
    }

    /// Tests the cells that are not known so far, at a simulated time in seconds, and returns the
    /// fraction.
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

    /// Known cells over visible cells; 1 if there are none.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        if self.cells.is_empty() {
            1.0
        } else {
            self.known as f64 / self.cells.len() as f64
        }
    }

    /// Known area, m².
    #[must_use]
    pub fn known_m2(&self) -> f64 {
        self.known as f64 * MAP_CELL_M * MAP_CELL_M
    }

    /// Visible area, m².
    #[must_use]
    pub fn reachable_m2(&self) -> f64 {
        self.cells.len() as f64 * MAP_CELL_M * MAP_CELL_M
    }

    /// Simulated time at which 90 % were known, seconds.
    #[must_use]
    pub fn t90_s(&self) -> Option<f64> {
        self.seen_at_s[0]
    }

    /// Simulated time at which 95 % were known, seconds.
    #[must_use]
    pub fn t95_s(&self) -> Option<f64> {
        self.seen_at_s[1]
    }

    /// Simulated time at which 99 % were known, seconds.
    #[must_use]
    pub fn t99_s(&self) -> Option<f64> {
        self.seen_at_s[2]
    }

    /// Visible cells that are known.
    #[must_use]
    pub fn known(&self) -> &[Cell] {
        &self.cells[..self.known]
    }

    /// Visible cells that are not known.
    #[must_use]
    pub fn missing(&self) -> &[Cell] {
        &self.cells[self.known..]
    }

    /// All visible cells, in no particular order.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }
}

/// The map cells that lie at least partly in the world, row by row.
pub fn map_cells(world: &World) -> impl Iterator<Item = Cell> + use<> {
    let area = CellArea::of(world);
    (0..area.len()).map(move |index| area.cell(index))
}

/// Content of a map cell in the true world.
#[must_use]
pub fn truth(world: &World, cell: Cell) -> Truth {
    // The border that a cell shares with the next one does not count; rounding must not add it.
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

/// Returns the cells that a disc of `radius_m` from `start` can see within `range_m`.
fn visible_cells(world: &World, start: Start, radius_m: f64, range_m: f64) -> Vec<Cell> {
    let reach = CellSet::reach(world, start, radius_m);
    let free = CellSet::free(world, start);
    let grid = world.occupancy();
    map_cells(world)
        .filter(|cell| {
            let [x, y] = centre_m(*cell);
            let place = grid.cell_at(x, y);
            // A line of sight is free, so it stays in the free cells around the start.
            reach.contains(place)
                || (free.contains(place) && visible(world, &reach, [x, y], range_m))
        })
        .collect()
}

/// Returns true if some ray from a point hits a reached cell before anything solid.
fn visible(world: &World, reach: &CellSet, from_m: [f64; 2], range_m: f64) -> bool {
    let step = core::f64::consts::TAU / f64::from(DIRECTIONS);
    (0..DIRECTIONS).any(|k| {
        let bearing = f64::from(k * STRIDE % DIRECTIONS) * step;
        let direction = [libm::cos(bearing), libm::sin(bearing)];
        sees(world, reach, (from_m, direction), range_m)
    })
}

/// Returns true if this ray hits a reached cell before anything solid.
fn sees(
    world: &World,
    reach: &CellSet,
    (from_m, direction): ([f64; 2], [f64; 2]),
    range_m: f64,
) -> bool {
    let grid = world.occupancy();
    let origin_m = grid.origin_m();
    let start = [0, 1].map(|k| (from_m[k] - origin_m[k]) / grid.resolution_m());
    let mut traversal = GridTraversal::new(start, direction.map(|d| d / grid.resolution_m()));
    while traversal.entered_m <= range_m {
        let [i, j] = traversal.cell;
        let cell = GridCell { i, j };
        if grid.is_solid(cell) {
            return false;
        }
        if reach.contains(cell) {
            return true;
        }
        traversal.advance();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Class, Occupancy, Ray, place};
    use std::collections::BTreeSet;

    const RANGE_M: f64 = 12.0;

    /// Seen map cells of a world whose corner is the origin, with a margin of one cell.
    struct Seen {
        columns: i32,
        cells: Vec<bool>,
    }

    impl Seen {
        /// Casts perfect beams from every eighth reached cell along both axes.
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
            // Seen free cells are in the denominator, except for those whose centre is behind an
            // edge.
            let cells: BTreeSet<_> = coverage.cells().iter().map(|c| (c.x, c.y)).collect();
            let beyond = map_cells(&world)
                .filter(|cell| seen.contains(*cell) && truth(&world, *cell) == Truth::Free)
                .filter(|cell| !cells.contains(&(cell.x, cell.y)))
                .count();
            assert!(beyond * 100 <= cells.len(), "{name}: {beyond} cells beyond");
        }
    }

    #[test]
    fn a_room_behind_a_gap_counts_as_far_as_it_is_visible() {
        let world = World::builtin("unreachable-room").expect("built in");
        let coverage = Coverage::new(&world, world.starts()[0], 0.3, RANGE_M);
        let count = |room: &str| {
            let room = place("unreachable-room", room).expect("a room");
            let [x0, y0, x1, y1] = room.extent_m.map(|m| (m / MAP_CELL_M).round() as i32);
            let inside = |c: &&Cell| (x0..x1).contains(&c.x) && (y0..y1).contains(&c.y);
            coverage.cells().iter().filter(inside).count()
        };
        // Of 42 × 48 cells each: none of the sealed room, most of the room behind the gap, all of
        // the open room.
        assert_eq!(count("sealed room"), 0);
        let behind = count("room behind the gap");
        assert!((1500..2016).contains(&behind), "{behind}");
        assert_eq!(count("room with a door"), 2016);
    }

    #[test]
    fn milestones_are_kept_and_areas_add_up() {
        let row = ".".repeat(20);
        let world = World::picture("room", 0.1, &[row.as_str(); 20]);
        let start = Start {
            x_m: 1.0,
            y_m: 1.0,
            yaw_rad: 0.0,
        };
        let unseen = Coverage::new(&world, start, 0.3, RANGE_M);
        let mut coverage = unseen.clone();
        assert!((coverage.reachable_m2() - 4.0).abs() < 1e-9);
        assert_eq!(coverage.update(1.0, |cell| cell.y < 10), 0.5);
        let times = |it: &Coverage| [it.t90_s(), it.t95_s(), it.t99_s()];
        assert_eq!(times(&coverage), [None; 3]);
        assert_eq!(coverage.update(2.0, |cell| cell.y < 18), 0.9);
        assert_eq!(coverage.update(3.0, |cell| cell.y < 19), 0.95);
        assert_eq!(coverage.update(4.0, |_| true), 1.0);
        assert_eq!(times(&coverage), [2.0, 3.0, 4.0].map(Some));
        assert!(coverage.missing().is_empty());
        let mut coverage = unseen;
        assert_eq!(coverage.update(4.0, |cell| cell.x < 10), 0.5);
        assert!((coverage.known_m2() - 2.0).abs() < 1e-9);
        assert_eq!(coverage.missing().len(), 200);
    }

    #[test]
    fn cells_off_the_worlds_grid_have_their_true_content() {
        let mut grid = Occupancy::filled(4, 1, 0.075, [0.0, 0.0], Class::Free);
        grid.set(GridCell { i: 3, j: 0 }, Class::Wall);
        let world = World::flat("strip", grid, Vec::new());
        // Columns end at 0.075, 0.15, 0.225 (then wall) and 0.3 m; all above 0.075 m is outside.
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
