//! What the true ground is to a robot that starts somewhere, cell by cell, and how a robot's map compares.
//!
//! | class | true of a map cell |
//! | --- | --- |
//! | traversable | covered by the robot within its limits ([`Footing`]) |
//! | obstacle | a wall; or too steep, or an edge, rising from covered ground within `BESIDE_M` |
//! | negative | without a surface; or too steep, or an edge, falling from covered ground within `BESIDE_M` |
//! | either | too steep, or an edge, with covered ground above it and below it: it depends on the side it is seen from |
//! | unjudged | anything else: ground that the robot cannot get to |
//!
//! A beam that meets the far side of a hole rightly calls an obstacle what is negative from above, so on steep ground a map
//! is asked first whether it keeps the robot off, and only then by which word. Rims are a cell wide and beams spread: a
//! cell is right if the true class lies within one cell of it, and found if the map has it within one cell.

use core::ops::Add;

use fieldline_planner::geometry::Cell;

use super::coverage::{MAP_CELL_M, Truth, centre_m, truth};
use super::footing::Footing;
use super::frame::Frame;
use super::gentle::is_gentle;
use crate::report::MapCell;
use crate::robot::Limits;
use crate::world::World;

/// How far from a steep cell the ground that it is seen from may lie, metres.
const BESIDE_M: f64 = 0.5;

/// What a cell truly is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truly {
    /// The robot may be there.
    Traversable,
    /// Something rises.
    Obstacle,
    /// Something falls.
    Negative,
    /// One or the other, by the side it is seen from.
    Either,
    /// Out of reach.
    Unjudged,
}

/// The true class of every cell.
#[derive(Clone, Debug)]
pub struct GroundTruth {
    frame: Frame,
    classes: Vec<Truly>,
}

/// How one class of a map compares: shares of cells, `None` where there are none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// Of the map's cells of the class, those that are right.
    pub precision: Option<f64>,
    /// Of the true cells of the class, those that the map has.
    pub recall: Option<f64>,
}

/// How a map compares; tables of several maps add up to one of all their cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Table {
    /// Cells by true class (rows, in the order of [`Truly`]) and class of the map (columns: unknown, free, obstacle, negative).
    pub cells: [[u32; 4]; 5],
    /// What the shares below are made of.
    sums: Sums,
    /// Free cells of the map that are no barrier; traversable cells that are free on the map, of those that it knows.
    pub traversable: Score,
    /// Obstacles of the map within a cell of a barrier; the visible rims of true obstacles that the map keeps off.
    pub obstacle: Score,
    /// Negative obstacles of the map within a cell of ground that falls, or over ground out of reach; the rims of true ones
    /// that the map keeps off.
    pub negative: Score,
    /// Unknown cells of the map that are not traversable; cells out of reach that it leaves unknown, though it may have seen them from afar.
    pub unknown: Score,
    /// Share of the found negative rims that the map calls negative, not obstacle.
    pub negative_by_name: Option<f64>,
}

impl Table {
    /// The shares of these counts.
    fn with_shares(cells: [[u32; 4]; 5], sums: Sums) -> Self {
        Self {
            cells,
            traversable: sums.free.score(),
            obstacle: sums.obstacle.score(),
            negative: sums.negative.score(),
            unknown: sums.unknown.score(),
            negative_by_name: share(sums.named),
            sums,
        }
    }
}

impl Add for Table {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let row = |k: usize| sum(self.cells[k], other.cells[k]);
        let (a, b) = (&self.sums, &other.sums);
        let sums = Sums {
            free: a.free + b.free,
            obstacle: a.obstacle + b.obstacle,
            negative: a.negative + b.negative,
            unknown: a.unknown + b.unknown,
            named: sum(a.named, b.named),
        };
        Self::with_shares(core::array::from_fn(row), sums)
    }
}

impl GroundTruth {
    /// Classifies a world for a robot with this footing.
    #[must_use]
    pub fn new(world: &World, footing: &Footing, limits: &Limits) -> Self {
        let frame = *footing.frame();
        let heights_m: Vec<Option<f64>> = (0..frame.len())
            .map(|index| {
                let [x, y] = centre_m(frame.cell(index));
                world.ground_m(x, y)
            })
            .collect();
        let classes = (0..frame.len())
            .map(|index| {
                let cell = frame.cell(index);
                match heights_m[index] {
                    _ if truth(world, cell) != Truth::Free => Truly::Obstacle,
                    None => Truly::Negative,
                    _ if footing.covers(cell) => Truly::Traversable,
                    _ if is_gentle(world, cell, limits) => Truly::Unjudged,
                    Some(_) => steep(footing, &heights_m, cell),
                }
            })
            .collect();
        Self { frame, classes }
    }

    /// The cells that this is about.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// What a cell truly is; unjudged outside.
    #[must_use]
    pub fn class(&self, cell: Cell) -> Truly {
        self.frame
            .index(cell)
            .map_or(Truly::Unjudged, |index| self.classes[index])
    }

    /// Compares a map with it.
    #[must_use]
    pub fn compare(&self, map: impl Fn(Cell) -> MapCell) -> Table {
        let known: Vec<MapCell> = (0..self.frame.len())
            .map(|index| map(self.frame.cell(index)))
            .collect();
        let (mut cells, mut sums) = ([[0; 4]; 5], Sums::default());
        for (index, (truly, held)) in self.classes.iter().zip(&known).enumerate() {
            cells[*truly as usize][column(*held)] += 1;
            self.judge(&known, index, &mut sums);
        }
        Table::with_shares(cells, sums)
    }

    /// Counts one cell, as the map holds it and as it truly is.
    fn judge(&self, known: &[MapCell], index: usize, sums: &mut Sums) {
        use Truly::{Either, Negative, Obstacle, Traversable, Unjudged};
        let cell = self.frame.cell(index);
        let beside = |wanted: &[Truly]| self.near(cell, |k| wanted.contains(&self.classes[k]));
        match known[index] {
            MapCell::Unknown => sums.unknown.held(self.classes[index] != Traversable),
            MapCell::Free => sums
                .free
                .held(!matches!(self.classes[index], Obstacle | Negative | Either)),
            MapCell::Obstacle => sums.obstacle.held(beside(&[Obstacle, Negative, Either])),
            MapCell::NegativeObstacle => {
                sums.negative.held(beside(&[Negative, Either, Unjudged]));
            }
        }
        // Of a barrier only the rim can be seen: what lies beside ground that the robot covers and its map knows.
        let is_rim = || {
            self.near(cell, |k| {
                self.classes[k] == Traversable && known[k] != MapCell::Unknown
            })
        };
        let kept_off =
            |held: &MapCell| matches!(held, MapCell::Obstacle | MapCell::NegativeObstacle);
        match self.classes[index] {
            Traversable if known[index] != MapCell::Unknown => {
                sums.free.found(known[index] == MapCell::Free);
            }
            Obstacle if is_rim() => {
                sums.obstacle
                    .found(self.near(cell, |k| kept_off(&known[k])));
            }
            Negative if is_rim() => {
                let found = self.near(cell, |k| kept_off(&known[k]));
                sums.negative.found(found);
                if found {
                    sums.named[1] += 1;
                    let named = self.near(cell, |k| known[k] == MapCell::NegativeObstacle);
                    sums.named[0] += u32::from(named);
                }
            }
            Unjudged => sums.unknown.found(known[index] == MapCell::Unknown),
            _ => {}
        }
    }

    /// Does any cell within one of this satisfy `test`?
    fn near(&self, cell: Cell, test: impl Fn(usize) -> bool) -> bool {
        (-1..=1)
            .flat_map(|dy| (-1..=1).map(move |dx| [dx, dy]))
            .filter_map(|[dx, dy]| {
                self.frame.index(Cell {
                    x: cell.x + dx,
                    y: cell.y + dy,
                })
            })
            .any(test)
    }
}

/// Counts of what was right, and of all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Count {
    held: [u32; 2],
    found: [u32; 2],
}

impl Count {
    fn held(&mut self, right: bool) {
        self.held[0] += u32::from(right);
        self.held[1] += 1;
    }

    fn found(&mut self, right: bool) {
        self.found[0] += u32::from(right);
        self.found[1] += 1;
    }

    fn score(&self) -> Score {
        Score {
            precision: share(self.held),
            recall: share(self.found),
        }
    }
}

impl Add for Count {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            held: sum(self.held, other.held),
            found: sum(self.found, other.found),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sums {
    free: Count,
    obstacle: Count,
    negative: Count,
    unknown: Count,
    named: [u32; 2],
}

fn sum<const N: usize>(a: [u32; N], b: [u32; N]) -> [u32; N] {
    core::array::from_fn(|k| a[k] + b[k])
}

fn share([part, whole]: [u32; 2]) -> Option<f64> {
    (whole > 0).then(|| f64::from(part) / f64::from(whole))
}

/// Where a map's class stands in a row of [`Table::cells`].
fn column(held: MapCell) -> usize {
    match held {
        MapCell::Unknown => 0,
        MapCell::Free => 1,
        MapCell::Obstacle => 2,
        MapCell::NegativeObstacle => 3,
    }
}

/// What too steep a cell is from the covered ground around it: ground nearer to the height of its lower side sees it
/// rise, the other sees it fall.
fn steep(footing: &Footing, heights_m: &[Option<f64>], cell: Cell) -> Truly {
    let cells = (BESIDE_M / MAP_CELL_M).round() as i32;
    let frame = footing.frame();
    let within = |cells: i32| {
        (-cells..=cells)
            .flat_map(move |dy| (-cells..=cells).map(move |dx| [dx, dy]))
            .filter(move |[dx, dy]| cells == 1 || dx * dx + dy * dy <= cells * cells)
            .filter_map(move |[dx, dy]| {
                frame.index(Cell {
                    x: cell.x + dx,
                    y: cell.y + dy,
                })
            })
    };
    let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
    for height_m in within(1).map(|index| heights_m[index]) {
        // A hole is below everything.
        low_m = low_m.min(height_m.unwrap_or(f64::NEG_INFINITY));
        high_m = high_m.max(height_m.unwrap_or(f64::NEG_INFINITY));
    }
    let (mut above, mut below) = (false, false);
    for index in within(cells).filter(|index| footing.covers(frame.cell(*index))) {
        let lower = heights_m[index].map(|height_m| height_m < 0.5 * (low_m + high_m));
        above |= lower == Some(false);
        below |= lower == Some(true);
    }
    match (above, below) {
        (true, true) => Truly::Either,
        (true, false) => Truly::Negative,
        (false, true) => Truly::Obstacle,
        (false, false) => Truly::Unjudged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Class, Elevation, GridCell, Occupancy, Start};

    /// A strip of 8 × 3 m, sampled every 5 cm, with a start at `x_m`.
    fn truths(x_m: f64, walls: &[i64], height_m: impl Fn(f64) -> f64) -> GroundTruth {
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
                Truly::Traversable => '.',
                Truly::Obstacle => '#',
                Truly::Negative => 'v',
                Truly::Either => 'x',
                Truly::Unjudged => '?',
            })
            .collect()
    }

    fn cliff(x: f64) -> f64 {
        if x > 4.0 { 1.0 } else { 0.0 }
    }

    #[test]
    fn a_cliff_is_an_obstacle_from_below_and_negative_from_above() {
        let (below, above) = (row(&truths(1.0, &[], cliff)), row(&truths(7.0, &[], cliff)));
        assert_eq!(below, format!("{}##{}", ".".repeat(39), "?".repeat(39)));
        assert_eq!(above, format!("{}vv{}", "?".repeat(39), ".".repeat(39)));
    }

    #[test]
    fn walls_holes_and_what_lies_beyond() {
        let ground = |x: f64| if (x - 6.0).abs() < 0.3 { f64::NAN } else { 0.0 };
        let seen = row(&truths(1.0, &[80, 81, 82, 83], ground));
        assert_eq!(&seen[..42], format!("{}##", ".".repeat(40)));
        // The hole is cut where a patch lacks a corner; its far rim, and the ground before it, are out of reach.
        assert_eq!(seen[57..63], *"vvvvvv");
        assert!(seen[43..56].chars().all(|c| c == '?'), "{seen}");
    }

    #[test]
    fn the_rim_of_a_hole_without_a_floor_is_negative() {
        // Ground that tilts towards the hole and ground that tilts away from it.
        for tilt in [-0.02, 0.0, 0.02] {
            let ground = |x: f64| if x > 5.0 { f64::NAN } else { tilt * x };
            let seen = row(&truths(1.0, &[], ground));
            assert_eq!(seen, format!("{}{}", ".".repeat(49), "v".repeat(31)));
        }
    }

    #[test]
    fn a_perfect_map_scores_one_and_a_blind_one_does_not() {
        let truths = truths(1.0, &[], cliff);
        let perfect = truths.compare(|cell| match truths.class(cell) {
            Truly::Traversable => MapCell::Free,
            Truly::Obstacle => MapCell::Obstacle,
            Truly::Negative | Truly::Either => MapCell::NegativeObstacle,
            Truly::Unjudged => MapCell::Unknown,
        });
        let one = Score {
            precision: Some(1.0),
            recall: Some(1.0),
        };
        assert_eq!((perfect.traversable, perfect.obstacle), (one, one));
        assert_eq!(perfect.negative, Score::default());
        assert_eq!(perfect.unknown, one);
        assert_eq!(perfect.cells[Truly::Obstacle as usize], [0, 0, 60, 0]);
        // All free: the face of the cliff is called free, and is not found.
        let blind = truths.compare(|_| MapCell::Free);
        assert_eq!(blind.obstacle.recall, Some(0.0));
        assert_eq!(blind.traversable.recall, Some(1.0));
        assert_eq!(blind.traversable.precision, Some(2340.0 / 2400.0));
        // An obstacle two cells before the face is wrong; one cell before it is right.
        for (x, precision) in [(37, 0.0), (38, 1.0)] {
            let table = truths.compare(|cell| match cell.x {
                k if k == x => MapCell::Obstacle,
                k if k < x => MapCell::Free,
                _ => MapCell::Unknown,
            });
            assert_eq!(table.obstacle.precision, Some(precision), "{x}");
        }
    }

    #[test]
    fn unknown_is_right_where_the_robot_cannot_be() {
        // Covered up to column 38, the face at 39 and 40, and beyond it ground out of reach.
        let truths = truths(1.0, &[], cliff);
        let table = truths.compare(|cell| match cell.x {
            0..39 | 60.. => MapCell::Free,
            _ => MapCell::Unknown,
        });
        assert_eq!(table.unknown.precision, Some(1.0));
        let count = |class, columns: core::ops::Range<i32>| {
            let cells = columns.flat_map(|x| (0..30).map(move |y| Cell { x, y }));
            cells.filter(|cell| truths.class(*cell) == class).count() as f64
        };
        // A disc does not cover the corners of the strip: they are out of reach, too, and free on this map.
        let left = count(Truly::Unjudged, 39..60) / count(Truly::Unjudged, 0..80);
        assert_eq!(table.unknown.recall, Some(left));
        assert!((0.45..0.5).contains(&left));
        let blank = truths.compare(|_| MapCell::Unknown);
        let right = 1.0 - count(Truly::Traversable, 0..80) / 2400.0;
        assert!((blank.unknown.precision.unwrap() - right).abs() < 1e-12);
        assert_eq!(blank.traversable, Score::default());
    }

    #[test]
    fn tables_of_two_maps_are_one_of_all_their_cells() {
        let truths = truths(1.0, &[], cliff);
        let of = |held| truths.compare(move |_| held);
        let (free, blank) = (of(MapCell::Free), of(MapCell::Unknown));
        let both = free + blank;
        assert_eq!(both.traversable, free.traversable);
        assert_eq!(both.unknown.precision, blank.unknown.precision);
        // All of what lies beyond is left unknown on one map and on none of the other.
        assert_eq!(both.unknown.recall, Some(0.5));
        let covered = free.cells[Truly::Traversable as usize][1];
        assert_eq!(both.cells[0], [covered, covered, 0, 0]);
    }

    #[test]
    fn a_negative_rim_held_for_an_obstacle_is_found_under_the_wrong_name() {
        let truths = truths(7.0, &[], cliff);
        let held = |name| {
            truths.compare(move |cell| match cell.x {
                41.. => MapCell::Free,
                40 => name,
                _ => MapCell::Unknown,
            })
        };
        let right = held(MapCell::NegativeObstacle);
        assert_eq!(
            (right.negative.recall, right.negative_by_name),
            (Some(1.0), Some(1.0))
        );
        let wrong = held(MapCell::Obstacle);
        assert_eq!(
            (wrong.negative.recall, wrong.negative_by_name),
            (Some(1.0), Some(0.0))
        );
        assert_eq!(wrong.obstacle.precision, Some(1.0));
    }
}
