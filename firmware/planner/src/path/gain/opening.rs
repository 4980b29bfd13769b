//! Opening: a way of the robot from a place to unexplored cells that its gain does not count.
//!
//! A place is *open* if the robot's footprint passes from it to unexplored cells, and on through
//! unexplored cells to the edge of the square that the gain counts. The first part of the way, also
//! over free cells, may reach half as far. How much is unexplored beyond the edge cannot be told,
//! so an open place is worth any trip until it was tried.
//!
//! The footprint is the robot's disc. Paths lead through gaps that are narrower, but most of those
//! are pieces of a wall that was not seen yet, and noise makes more of them (measured:
//! docs/MEASURED.md, "Footprint that an opening is for").
//!
//! A straight line does not do. None leads through a door as narrow as the robot, so whole wings
//! behind such doors would count as seen (measured: "Ways and straight lines through openings").
//!
//! Units: map cells.

use core::array;

use crate::grid::{at, flood};
use crate::path::gain::{MIDDLE, SIDE, View};
use crate::roadmap::configuration_space::Footprint;

/// Cells of the square, a word each row.
type Cells = [u64; SIDE];

impl View {
    /// Returns true if the place is open for a robot of this footprint.
    pub(crate) fn is_open(&self, footprint: &Footprint) -> bool {
        // Two squares are all that the stack has room for.
        let near = |y| self.passable(y, footprint) & inside(y, self.reach / 2);
        let mut open: Cells = array::from_fn(near);
        let mut reached: Cells = array::from_fn(|y| inside(y, 0));
        flood::spread(&open, &mut reached);

        let beyond = |y| match self.row(y)[0] & inside(y, self.reach) {
            0 => 0,
            unknown => unknown & self.passable(y, footprint),
        };
        for (y, (open, reached)) in open.iter_mut().zip(&mut reached).enumerate() {
            *open = beyond(y);
            *reached &= *open;
        }
        flood::spread(&open, &mut reached);
        let is_at_edge = |(y, row): (usize, &u64)| row & !inside(y, self.reach - 1) != 0;
        reached.iter().enumerate().any(is_at_edge)
    }

    /// Returns the cells of a row in which the footprint holds no closed cell.
    fn passable(&self, y: usize, footprint: &Footprint) -> u64 {
        let closed = |y: usize| if y < SIDE { self.row(y)[1] } else { 0 };
        let near = footprint.near(|dy| closed(y.wrapping_sub(dy)) | closed(y + dy));
        !near
    }

    /// Returns the unexplored and the closed cells of a row.
    fn row(&self, y: usize) -> [u64; 2] {
        let [[unknown, closed], [unknown_high, closed_high]] = at(&self.rows, y);
        let join = |low: u32, high: u32| u64::from(high) << 32 | u64::from(low);
        [join(unknown, unknown_high), join(closed, closed_high)]
    }
}

/// Returns the columns of a row that lie within so many cells of the middle.
fn inside(y: usize, cells: i32) -> u64 {
    let is_row = (y as i32 - MIDDLE.y).abs() <= cells;
    let columns = (1 << (2 * cells + 1)) - 1;
    if is_row {
        columns << (MIDDLE.x - cells)
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::vec::Vec;

    use super::*;
    use crate::geometry::{CELL_M, Cell};
    use crate::grid::bits::tests::Rng;
    use crate::map::Class;
    use crate::path::gain::tests::{Map, ORIGIN, map};
    use crate::roadmap::configuration_space::is_passable;

    /// Length of the rays, cells: around their ends too the view knows what the footprint covers.
    const REACH: i32 = 28;

    fn is_open(tiles: &Map, radius_m: f32) -> bool {
        let footprint = Footprint::new(radius_m);
        let reach_m = (REACH as f32 + 0.5) * CELL_M;
        View::of(tiles, ORIGIN, reach_m, footprint.reach()).is_open(&footprint)
    }

    /// Free cells up to a wall at x = 10 with a gap of so many cells, all beyond it unexplored.
    fn door(cells: i32, at_y: i32) -> Map {
        map(|x, y| match x {
            10 if !(at_y..at_y + cells).contains(&y) => Some(Class::Obstacle),
            x if x > 10 => None,
            _ => Some(Class::Free),
        })
    }

    #[test]
    fn a_door_that_the_footprint_fits_through_is_open_wherever_it_is_ahead() {
        for at_y in [-12, -5, 0, 3, 8] {
            for cells in 1..9 {
                for (radius_m, least) in [(0.1, 1), (0.2, 3), (0.3, 5), (0.4, 7)] {
                    let open = is_open(&door(cells, at_y), radius_m);
                    assert_eq!(
                        open,
                        cells >= least,
                        "{cells} cells at {at_y}, {radius_m} m"
                    );
                }
            }
        }
    }

    #[test]
    fn what_ends_within_reach_is_no_opening() {
        let pocket = map(|x, y| {
            let is_pocket = (5..15).contains(&x) && (-8..10).contains(&y);
            (!is_pocket).then_some(Class::Free)
        });
        assert!(!is_open(&pocket, 0.3));
        // A room of which only the near part was seen.
        let room = map(|x, y| match x {
            -5..=20 if y.abs() < 12 => (x < 5).then_some(Class::Free),
            _ => Some(Class::Obstacle),
        });
        assert!(!is_open(&room, 0.3));
    }

    #[test]
    fn unexplored_cells_far_off_over_free_ones_are_no_opening_of_this_place() {
        let far = |first: i32| map(|x, _| (x < first).then_some(Class::Free));
        assert!(is_open(&far(REACH / 2), 0.3));
        assert!(!is_open(&far(REACH / 2 + 1), 0.3));
    }

    /// [`View::is_open`], cell by cell.
    fn slowly(tiles: &Map, radius_m: f32) -> bool {
        let footprint = Footprint::new(radius_m);
        let passes = |cell| is_passable(tiles, &footprint, cell);
        let is_unknown = |cell: Cell| tiles.class(cell) == Class::Unknown;
        let is_within = |cell: Cell, half: i32| cell.x.abs() <= half && cell.y.abs() <= half;
        let spread = |seeds: BTreeSet<(i32, i32)>, open: &dyn Fn(Cell) -> bool| {
            let mut all = seeds.clone();
            let mut waiting: Vec<_> = seeds.into_iter().collect();
            while let Some((x, y)) = waiting.pop() {
                for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                    let cell = Cell { x, y }.offset(dx, dy);
                    if open(cell) && all.insert((cell.x, cell.y)) {
                        waiting.push((cell.x, cell.y));
                    }
                }
            }
            all
        };
        let near = |cell: Cell| is_within(cell, REACH / 2) && passes(cell);
        let beyond = |cell: Cell| is_within(cell, REACH) && is_unknown(cell) && passes(cell);
        let mut entered = spread(BTreeSet::from([(ORIGIN.x, ORIGIN.y)]), &near);
        entered.retain(|&(x, y)| beyond(Cell { x, y }));
        let reached = spread(entered, &beyond);
        reached.iter().any(|&(x, y)| x.abs().max(y.abs()) == REACH)
    }

    #[test]
    fn an_opening_is_what_a_walk_cell_by_cell_finds() {
        let (mut rng, mut open) = (Rng(11), 0);
        for round in 0..120 {
            // Obstacles in one of 8 to of 256 cells; half planes or stripes unexplored.
            let closed: [u64; 64] = rng.rows(3 + round % 6);
            let map = map(|x, y| {
                let column = (x + 32) & 63;
                let is_closed = closed[((y + 32) & 63) as usize] >> column & 1 == 1;
                let is_unknown = if round % 2 == 0 {
                    2 * x + y > 9
                } else {
                    x & 8 == 0 || y > 5
                };
                let class = if is_closed {
                    Class::Obstacle
                } else {
                    Class::Free
                };
                (is_closed || !is_unknown).then_some(class)
            });
            for radius_m in [0.1, 0.2, 0.3] {
                let is_open = is_open(&map, radius_m);
                assert_eq!(
                    is_open,
                    slowly(&map, radius_m),
                    "round {round}, {radius_m} m"
                );
                open += u32::from(is_open);
            }
        }
        assert!((40..320).contains(&open), "{open} open");
    }
}
