//! Votes of all scans on each cell: is it an obstacle?
//!
//! ```text
//! obstacle   hits ≥ ¼ (hits + passes)      the usual rule of grid mapping
//! ```
//!
//! The planner's map has a short memory, for a world that moves: eight beams free a cell of a wall.
//! Passes of a place whose poses differ by a cell erase parts of each other's walls, and whoever
//! explores looks into each hole. A vote knows no order, so a wall that many have seen stays.
//!
//! Invariant: the votes are the same in whatever order the scans come.
//! Units: metres, map cells of 10 cm.

use std::collections::HashMap;

use fieldline_planner::LaserMount;
use fieldline_planner::geometry::CELL_M;
use fieldline_planner::map::tiles::TILE_SIDE;

use crate::link::correction::Classes;
use crate::replay::relations::{Pose, compose};

/// Every so many beams a beam's passes are counted: neighbours pass the same cells.
const EVERY: usize = 4;
/// Cells on a tile's side.
const SIDE: usize = TILE_SIDE as usize;
/// Passes for each hit up to which a cell is an obstacle.
const MOST_PASSES: u32 = 3;

/// Hits and passes of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Vote {
    hits: u32,
    passes: u32,
}

impl Vote {
    const fn is_obstacle(self) -> bool {
        self.hits > 0 && self.passes <= MOST_PASSES * self.hits
    }
}

type Cell = (i32, i32);
type Tile = [[Vote; SIDE]; SIDE];

/// The votes of each tile.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Votes(HashMap<(i16, i16), Box<Tile>>);

impl Votes {
    /// Enters a scan of a level laser; others see what is above the cells that they cross.
    pub(super) fn enter(&mut self, laser: &LaserMount, ranges_mm: &[u16], robot: Pose) {
        if !laser.is_level() {
            return;
        }
        let [x, y, yaw] = compose(robot, [laser.x_m.into(), laser.y_m.into(), 0.0]);
        for (number, &range_mm) in ranges_mm.iter().enumerate() {
            // A beam of no length measured nothing, and one that met nothing hits nothing.
            if range_mm == 0 || range_mm >= laser.range_limit_mm {
                continue;
            }
            let bearing = laser.first_bearing_rad + number as f32 * laser.bearing_step_rad;
            let (sin, cos) = (yaw + f64::from(bearing)).sin_cos();
            let range_m = f64::from(range_mm) * 1e-3;
            let cell = |along_m: f64| cell_at(x + along_m * cos, y + along_m * sin);
            let end = cell(range_m);
            vote(self.tile(tile_of(end)), end).hits += 1;
            if number % EVERY == 0 {
                let steps = (range_m / f64::from(CELL_M)) as u32;
                let crossed = (0..steps).map(|k| cell(f64::from(k) * f64::from(CELL_M)));
                self.pass(crossed.filter(|&crossed| crossed != end));
            }
        }
    }

    /// Marks the obstacles of a tile that the votes have and the tile has as free.
    pub(super) fn mark(&self, tile: (i16, i16), [low, high]: &mut Classes) {
        let Some(votes) = self.0.get(&tile) else {
            return;
        };
        for ((low, high), votes) in low.iter_mut().zip(high).zip(votes.iter()) {
            let obstacles = (0..).zip(votes).filter(|(_, vote)| vote.is_obstacle());
            let obstacles = obstacles.fold(0, |row, (column, _)| row | 1 << column);
            let closed = obstacles & *low & !*high;
            *low &= !closed;
            *high |= closed;
        }
    }

    /// Counts the passes of a beam. Its cells lie in few tiles, one after the other.
    fn pass(&mut self, crossed: impl Iterator<Item = Cell>) {
        let mut crossed = crossed.peekable();
        while let Some(first) = crossed.next() {
            let key = tile_of(first);
            let tile = self.tile(key);
            vote(tile, first).passes += EVERY as u32;
            while let Some(next) = crossed.next_if(|&next| tile_of(next) == key) {
                vote(tile, next).passes += EVERY as u32;
            }
        }
    }

    fn tile(&mut self, key: (i16, i16)) -> &mut Tile {
        let new = || Box::new([[Vote::default(); SIDE]; SIDE]);
        self.0.entry(key).or_insert_with(new)
    }
}

fn vote(tile: &mut Tile, (x, y): Cell) -> &mut Vote {
    let within = |at: i32| at.rem_euclid(TILE_SIDE) as usize;
    &mut tile[within(y)][within(x)]
}

fn tile_of((x, y): Cell) -> (i16, i16) {
    let tile = |at: i32| at.div_euclid(TILE_SIDE) as i16;
    (tile(x), tile(y))
}

fn cell_at(x_m: f64, y_m: f64) -> Cell {
    let cell = |m: f64| (m / f64::from(CELL_M)).floor() as i32;
    (cell(x_m), cell(y_m))
}

#[cfg(test)]
mod tests {
    use fieldline_planner::LaserMount;

    use super::*;

    /// A laser at the robot's middle with beams ahead, a tenth of a degree apart.
    fn laser() -> LaserMount {
        LaserMount {
            first_bearing_rad: -0.035,
            bearing_step_rad: 0.0017,
            ..LaserMount::level(0.0, 0.4)
        }
    }

    /// Ranges of 41 beams.
    fn wall(range_mm: u16) -> [u16; 41] {
        [range_mm; 41]
    }

    /// The row of cells ahead of the robot, from 1.0 m on: `#` obstacle, `.` free.
    fn row(votes: &Votes, cells: usize) -> String {
        let mut planes: Classes = [[u32::MAX; 32], [0; 32]];
        votes.mark((0, 0), &mut planes);
        let [low, high] = planes.map(|plane| plane[10] >> 10);
        let class = |k: usize| match (low >> k & 1, high >> k & 1) {
            (1, 0) => '.',
            (0, 1) => '#',
            _ => '?',
        };
        (0..cells).map(class).collect()
    }

    fn votes(ranges_mm: impl IntoIterator<Item = u16>) -> Votes {
        let mut votes = Votes::default();
        for range_mm in ranges_mm {
            votes.enter(&laser(), &wall(range_mm), [0.05, 1.05, 0.0]);
        }
        votes
    }

    #[test]
    fn a_wall_that_two_passes_saw_apart_stays_at_both_places_in_any_order() {
        let one = [1_200_u16; 4].into_iter().chain([1_400; 9]);
        let other = [1_400_u16; 9].into_iter().chain([1_200; 4]);
        assert_eq!(row(&votes(one.clone()), 6), "..#.#.");
        assert_eq!(votes(one), votes(other));
    }

    #[test]
    fn who_stood_there_for_a_while_is_gone() {
        let person = [1_200_u16; 4].into_iter().chain([1_400; 60]);
        assert_eq!(row(&votes(person), 6), "....#.");
    }

    #[test]
    fn a_beam_that_met_nothing_votes_for_nothing() {
        assert_eq!(
            votes([0, u16::MAX, laser().range_limit_mm]),
            Votes::default()
        );
    }

    #[test]
    fn what_is_not_free_stays_as_it_is() {
        let mut planes: Classes = [[0; 32]; 2];
        votes([1_200; 9]).mark((0, 0), &mut planes);
        assert_eq!(planes, [[0; 32]; 2]);
    }
}
