//! What the robot is visiting: places whose date is not written yet, and its last metres.
//!
//! A date is for 1.6 × 1.6 m. Written when the robot comes in, it would call visited what lies ahead in the same place, and the robot
//! would stand before it. So a place is *pending* until the robot is [`AWAY_M`] from it; meanwhile those centre cells in it
//! are visited that the robot came near to, and the others are what they were.
//!
//! A place that is left with centre cells not visited was visited *in part*. To explore that will do: going back for the
//! rest of every place takes rooms without a loop from 539 s to 883 s. A patrol is strict: it goes first to the places that the
//! exploration visited in part and remembers, and keeps the old date of one that it visits in part itself. Else a corner would wait for a tour
//! and another one behind its neighbour's date.
//!
//! Units: map cells, metres.

use heapless::Vec;

use crate::geometry::{CELL_M, Cell};
use crate::path::breadcrumbs::Crumbs;
use crate::strategy::tdbvp::rails::{PLACE_CELLS, Rails};

/// Centre cells this near to the robot are visited, metres: a metre, less half a centre cell's diagonal on either side, and little enough
/// that no wall of a corridor of 2 m is looked through.
pub(super) const VISIT_M: f32 = 0.95;
/// A place this far from the robot is done with, metres: most of the way to the window's edge.
const AWAY_M: f32 = 2.4;
/// Metres of the way that say where ahead is: as far as the preferred side reaches, so that it does not turn with a robot that turns
/// into it.
const AHEAD_M: f32 = 2.0;
/// Places that are pending at the most.
const MOST_PENDING: usize = 12;
/// Places visited in part that are remembered; what was left longer ago has an older date, too.
const MOST_PARTLY: usize = 32;

/// Centre cells along a place: one bit each.
const SIDE: i32 = PLACE_CELLS / 2;
const _: () = assert!(SIDE * SIDE == 64);

type Place = [i16; 2];

/// A place that the robot is visiting.
#[derive(Debug)]
struct Pending {
    place: Place,
    /// Its centre cells that were visited, row by row.
    visited: u64,
}

/// The last metres and the places they lead through.
#[derive(Debug)]
pub(super) struct Fresh {
    crumbs: Crumbs,
    /// The least cells of places, the first one entered first.
    pending: Vec<Pending, MOST_PENDING>,
    /// Those the exploration visited in part, the last one left last.
    partly: Vec<Place, MOST_PARTLY>,
}

/// The least cell of the place that a cell is in.
fn place(cell: Cell) -> Place {
    [cell.x & -PLACE_CELLS, cell.y & -PLACE_CELLS].map(|at| at as i16)
}

fn least_cell([x, y]: Place) -> Cell {
    let (x, y) = (x.into(), y.into());
    Cell { x, y }
}

fn is_near(a: Cell, b: Cell, radius_m: f32) -> bool {
    let (dx, dy) = ((a.x - b.x) as f32 * CELL_M, (a.y - b.y) as f32 * CELL_M);
    dx * dx + dy * dy <= radius_m * radius_m
}

impl Pending {
    /// Whether a centre cell in it was visited, or was another one beside it, as the skeleton was then.
    fn has(&self, cell: Cell) -> bool {
        // Columns 0 and 7 have nothing beside them on one side.
        let (west, east) = (0x0101_0101_0101_0101, 0x8080_8080_8080_8080);
        let row = self.visited | (self.visited & !east) << 1 | (self.visited & !west) >> 1;
        (row | row << SIDE | row >> SIDE) & bit(cell) != 0
    }
}

/// The bit of a centre cell in its place.
fn bit(cell: Cell) -> u64 {
    let [x, y] = [cell.x, cell.y].map(|at| at.rem_euclid(PLACE_CELLS) / 2);
    1 << (y * SIDE + x)
}

/// The exploration left a place.
fn remember(partly: &mut Vec<Place, MOST_PARTLY>, left: Place, whole: bool) {
    partly.retain(|&other| other != left);
    if !whole {
        if partly.is_full() {
            partly.remove(0);
        }
        let _ = partly.push(left);
    }
}

impl Fresh {
    /// Nothing yet.
    pub(super) const fn new() -> Self {
        Self {
            crumbs: Crumbs::new(),
            pending: Vec::new(),
            partly: Vec::new(),
        }
    }

    /// The robot is here.
    pub(super) fn come(&mut self, robot: Cell) {
        self.crumbs.note(robot);
    }

    /// Write down what the robot left; on patrol only what it visited whole. `centre_cells` calls back with those of the square of so many cells
    /// around a middle.
    pub(super) fn leave<const SLOTS: usize>(
        &mut self,
        robot: Cell,
        rails: &mut Rails<SLOTS>,
        is_patrolling: bool,
        centre_cells: impl Fn(Cell, i32, &mut dyn FnMut(Cell)),
    ) {
        let partly = &mut self.partly;
        self.pending.retain(|pending| {
            let left = pending.place;
            let (least, half) = (least_cell(left), PLACE_CELLS / 2);
            let middle = Cell {
                x: least.x + half,
                y: least.y + half,
            };
            if is_near(middle, robot, AWAY_M) {
                return true;
            }
            let mut whole = true;
            centre_cells(middle, half, &mut |cell| {
                whole &= place(cell) != left || pending.has(cell);
            });
            if whole || !is_patrolling {
                rails.visit(least);
            }
            if !is_patrolling {
                remember(partly, left, whole);
            }
            false
        });
    }

    /// A patrol begins: what was visited in part counts as never visited.
    pub(super) fn begin_patrol<const SLOTS: usize>(&mut self, rails: &mut Rails<SLOTS>) {
        for left in core::mem::take(&mut self.partly) {
            rails.forget(least_cell(left));
        }
    }

    /// The robot visits a centre cell; whether its place was never visited before.
    pub(super) fn visit<const SLOTS: usize>(
        &mut self,
        cell: Cell,
        rails: &mut Rails<SLOTS>,
    ) -> bool {
        let place = place(cell);
        let bit = bit(cell);
        if let Some(pending) = self.pending.iter_mut().find(|it| it.place == place) {
            pending.visited |= bit;
            return false;
        }
        let is_new = !rails.is_visited(cell);
        let visited = bit;
        if self.pending.push(Pending { place, visited }).is_err() {
            rails.visit(cell);
        }
        is_new
    }

    /// The way that the robot has been going for the last [`AHEAD_M`], map cells; its heading says nothing of it when it turns on the
    /// spot.
    pub(super) fn ahead(&self, robot: Cell) -> Option<[f32; 2]> {
        let mut crumbs = self.crumbs.newest_first();
        let came = crumbs.find(|&crumb| !is_near(crumb, robot, AHEAD_M))?;
        Some([robot.x - came.x, robot.y - came.y].map(|along| along as f32))
    }

    /// Whether a centre cell was visited and its date is not written yet.
    pub(super) fn holds(&self, cell: Cell) -> bool {
        let place = place(cell);
        let mut pending = self.pending.iter();
        let pending = pending.find(|pending| pending.place == place);
        pending.is_some_and(|pending| pending.has(cell))
    }

    /// Write everything down.
    pub(super) fn settle<const SLOTS: usize>(&mut self, rails: &mut Rails<SLOTS>) {
        for pending in core::mem::take(&mut self.pending) {
            rails.visit(least_cell(pending.place));
        }
    }
}

impl Default for Fresh {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::Fresh;
    use crate::geometry::Cell;
    use crate::strategy::tdbvp::rails::{Rails, UNVISITED};

    /// Centre cells along a line, for as far as there are.
    fn at(x: i32) -> Cell {
        Cell { x, y: 8 }
    }

    fn line(middle: Cell, half: i32, visit: &mut dyn FnMut(Cell)) {
        let columns = middle.x - half..middle.x + half;
        columns.filter(|x| x % 2 == 0).for_each(|x| visit(at(x)));
    }

    fn rails() -> Rails<16> {
        let mut rails = Rails::new();
        rails.reset((4, 4));
        rails
    }

    /// The robot goes from one centre cell to another, and visits what is so near.
    fn go(fresh: &mut Fresh, rails: &mut Rails<16>, ways: &[i32], near: i32, is_patrolling: bool) {
        for &x in ways {
            rails.pass();
            fresh.come(at(x));
            fresh.leave(at(x), rails, is_patrolling, line);
            for near in (x - near..=x + near).filter(|x| x % 2 == 0) {
                fresh.visit(at(near), rails);
            }
        }
    }

    #[test]
    fn what_lies_ahead_in_the_same_place_is_what_it_was_until_the_robot_is_gone() {
        let (mut rails, mut fresh) = (rails(), Fresh::new());
        assert!(fresh.visit(at(0), &mut rails), "new");
        assert!(!fresh.visit(at(2), &mut rails), "the place is not");
        assert!(fresh.holds(at(0)) && !fresh.holds(at(14)));
        assert_eq!(rails.potential(at(14)), UNVISITED);
        let way: Vec<i32> = (3..40).collect();
        go(&mut fresh, &mut rails, &way, 0, false);
        assert!(!fresh.holds(at(2)), "its date is written");
        assert!(rails.is_visited(at(2)) && rails.is_visited(at(14)));
        assert_eq!(rails.potential(at(35)), UNVISITED);
        fresh.settle(&mut rails);
        assert!(rails.is_visited(at(35)));
    }

    #[test]
    fn a_skeleton_that_moves_by_a_cell_is_still_visited() {
        let (mut rails, mut fresh) = (rails(), Fresh::new());
        fresh.visit(Cell { x: 20, y: 6 }, &mut rails);
        for (x, y, held) in [(20, 8, true), (18, 4, true), (22, 6, true), (24, 6, false)] {
            assert_eq!(fresh.holds(Cell { x, y }), held, "{x} {y}");
        }
        // The last column is not beside the first one of the row above.
        fresh.visit(Cell { x: 30, y: 6 }, &mut rails);
        assert!(!fresh.holds(Cell { x: 16, y: 8 }));
    }

    #[test]
    fn a_place_visited_in_part_has_a_date_while_all_is_explored_and_none_when_a_patrol_begins() {
        let (mut rails, mut fresh) = (rails(), Fresh::new());
        go(&mut fresh, &mut rails, &[20, 60], 2, false);
        go(&mut fresh, &mut rails, &[60], 8, false);
        assert!(rails.is_visited(at(30)), "to explore it will do");
        fresh.begin_patrol(&mut rails);
        assert!(!rails.is_visited(at(30)), "a patrol goes there first");
        // Whole places keep their dates.
        let (mut rails, mut fresh) = (self::rails(), Fresh::new());
        go(&mut fresh, &mut rails, &[20, 28, 60], 8, false);
        fresh.begin_patrol(&mut rails);
        assert!(rails.is_visited(at(30)));
    }

    #[test]
    fn a_patrol_that_visits_a_place_in_part_leaves_it_as_old_as_it_was() {
        let (mut rails, mut fresh) = (rails(), Fresh::new());
        go(&mut fresh, &mut rails, &[20, 28, 60], 8, false);
        let before = rails.rank(at(30));
        let wait = |rails: &mut Rails<16>| (0..40).for_each(|_| rails.pass());
        wait(&mut rails);
        go(&mut fresh, &mut rails, &[20, 60], 2, true);
        assert_eq!(rails.rank(at(30)), before);
        go(&mut fresh, &mut rails, &[20, 28, 60], 8, true);
        assert!(rails.rank(at(30)) > before);
    }
}
