//! Scores of a robot's map against the true ground, class by class.
//!
//! A beam that hits the far side of a hole marks an obstacle there, rightly; from above the same
//! place is negative. So on steep ground the first question is if the map keeps the robot off, and
//! the second is by which class. Rims are one cell wide and beams spread: a cell of the map is
//! right if the true class lies within one cell of it, and a true cell is found if the map has its
//! class within one cell.

use core::ops::Add;

use fieldline_planner::geometry::Cell;

use super::ground_truth::{GroundTruth, TrueClass};
use crate::report::MapCell;

/// Scores of one class: shares of cells, `None` if there are no cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// Share of the map's cells of the class that are right.
    pub precision: Option<f64>,
    /// Share of the true cells of the class that the map has.
    pub recall: Option<f64>,
}

/// Scores of a map; the sum of two has the shares over the cells of both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapScore {
    /// Cells by true class (rows, in the order of [`TrueClass`]) and by class of the map (columns:
    /// unknown, free, obstacle, negative).
    pub cells: [[u32; 4]; 5],
    /// Counts behind the shares below.
    sums: Sums,
    /// Precision: free cells of the map that are no barrier. Recall: known traversable cells that
    /// are free on the map.
    pub traversable: Score,
    /// Precision: obstacles of the map within a cell of a barrier. Recall: visible rims of true
    /// obstacles that the map keeps the robot off.
    pub obstacle: Score,
    /// Precision: negative obstacles of the map within a cell of falling or unreachable ground.
    /// Recall: visible rims of true ones that the map keeps the robot off.
    pub negative: Score,
    /// Precision: unknown cells of the map that are not traversable. Recall: unreachable cells that
    /// the map leaves unknown; it may have seen some from afar.
    pub unknown: Score,
    /// Share of the found negative rims that the map has as negative, not as obstacle.
    pub negative_by_name: Option<f64>,
}

impl MapScore {
    /// Scores with the shares of these counts.
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

impl Add for MapScore {
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
    /// Scores a map.
    #[must_use]
    pub fn compare(&self, map: impl Fn(Cell) -> MapCell) -> MapScore {
        let known: Vec<MapCell> = (0..self.area.len())
            .map(|index| map(self.area.cell(index)))
            .collect();
        let (mut cells, mut sums) = ([[0; 4]; 5], Sums::default());
        for (index, (truly, held)) in self.classes.iter().zip(&known).enumerate() {
            cells[*truly as usize][column(*held)] += 1;
            self.count_held(&known, index, &mut sums);
            self.count_found(&known, index, &mut sums);
        }
        MapScore::with_shares(cells, sums)
    }

    /// Counts one cell by its class on the map: is the map right?
    fn count_held(&self, known: &[MapCell], index: usize, sums: &mut Sums) {
        use TrueClass::{Either, Negative, Obstacle, Traversable, Unjudged};
        let cell = self.area.cell(index);
        let beside = |wanted: &[TrueClass]| self.near(cell, |k| wanted.contains(&self.classes[k]));
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
    }

    /// Counts one cell by its true class: does the map have it?
    fn count_found(&self, known: &[MapCell], index: usize, sums: &mut Sums) {
        use TrueClass::{Negative, Obstacle, Traversable, Unjudged};
        let cell = self.area.cell(index);
        // Only the rim of a barrier is visible: cells beside ground that the robot covers and the
        // map knows.
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

    /// Returns true if a cell, or one of its eight neighbours, satisfies `test`.
    fn near(&self, cell: Cell, test: impl Fn(usize) -> bool) -> bool {
        self.area.around(cell, 1).any(test)
    }
}

/// Counts of one class: `[right, all]` of the map's cells and of the true cells.
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

/// Column of a map's class in [`MapScore::cells`].
fn column(held: MapCell) -> usize {
    match held {
        MapCell::Unknown => 0,
        MapCell::Free => 1,
        MapCell::Obstacle => 2,
        MapCell::NegativeObstacle => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::super::ground_truth::tests::{cliff, truths};
    use super::*;

    #[test]
    fn a_perfect_map_scores_one_and_an_all_free_map_less() {
        let truths = truths(1.0, &[], cliff);
        let perfect = truths.compare(|cell| match truths.class(cell) {
            TrueClass::Traversable => MapCell::Free,
            TrueClass::Obstacle => MapCell::Obstacle,
            TrueClass::Negative | TrueClass::Either => MapCell::NegativeObstacle,
            TrueClass::Unjudged => MapCell::Unknown,
        });
        let one = Score {
            precision: Some(1.0),
            recall: Some(1.0),
        };
        assert_eq!((perfect.traversable, perfect.obstacle), (one, one));
        assert_eq!(perfect.negative, Score::default());
        assert_eq!(perfect.unknown, one);
        assert_eq!(perfect.cells[TrueClass::Obstacle as usize], [0, 0, 60, 0]);
        // All free: the face of the cliff is free on the map, so it is not found.
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
    fn unknown_is_right_for_cells_out_of_reach() {
        // Columns up to 38 are covered, 39 and 40 are the face, the rest is out of reach.
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
        // A disc does not cover the corners of the strip: they are out of reach too, and free on
        // this map.
        let left = count(TrueClass::Unjudged, 39..60) / count(TrueClass::Unjudged, 0..80);
        assert_eq!(table.unknown.recall, Some(left));
        assert!((0.45..0.5).contains(&left));
        let blank = truths.compare(|_| MapCell::Unknown);
        let right = 1.0 - count(TrueClass::Traversable, 0..80) / 2400.0;
        assert!((blank.unknown.precision.unwrap() - right).abs() < 1e-12);
        assert_eq!(blank.traversable, Score::default());
    }

    #[test]
    fn the_sum_of_two_scores_is_over_the_cells_of_both() {
        let truths = truths(1.0, &[], cliff);
        let of = |held| truths.compare(move |_| held);
        let (free, blank) = (of(MapCell::Free), of(MapCell::Unknown));
        let both = free + blank;
        assert_eq!(both.traversable, free.traversable);
        assert_eq!(both.unknown.precision, blank.unknown.precision);
        // One map leaves all of the unreachable cells unknown, the other leaves none.
        assert_eq!(both.unknown.recall, Some(0.5));
        let covered = free.cells[TrueClass::Traversable as usize][1];
        assert_eq!(both.cells[0], [covered, covered, 0, 0]);
    }

    #[test]
    fn a_negative_rim_marked_as_obstacle_has_the_wrong_name() {
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
