//! Pending visits: the places around the robot whose stamp is not written yet, and its last metres.
//!
//! A stamp is for 1.6 × 1.6 m. Written when the robot enters, it would make the centre cells ahead
//! in the same place visited, and the robot would stop before them. So a place is *pending* until
//! the robot is `away_m` from it. Meanwhile only those of its centre cells are visited that the
//! robot came near to.
//!
//! A place that is left with other centre cells was visited *in part*. For the exploration that is
//! enough: going back for the rest of every place takes rooms without a loop from 539 s to 883 s. A
//! patrol is strict. It begins with the places that the exploration visited in part and remembers,
//! and a place that it visits in part itself keeps its old stamp. Otherwise a corner would wait for
//! a whole tour, and another one behind its neighbour's stamp.
//!
//! Units: map cells, metres.

use heapless::Vec;

use crate::geometry::Cell;
use crate::grid::Shifts;
use crate::path::breadcrumbs::Crumbs;
use crate::strategy::tdbvp::rails::{PLACE_CELLS, Rails};

/// Most pending places: those within `away_m` of a robot on its way, and some more.
const MOST_PENDING: usize = 12;
/// Most places visited in part that are remembered. Those that were left longer ago have older
/// stamps anyway.
const MOST_PARTIAL: usize = 32;

/// Centre cells along the side of a place: one bit each.
const SIDE: i32 = PLACE_CELLS / 2;
const _: () = assert!(SIDE * SIDE == 64);

/// A place, by its least map cell.
type Place = [i16; 2];

/// A place whose stamp is not written yet.
#[derive(Debug)]
struct PendingVisit {
    place: Place,
    /// Its centre cells that were visited, a byte a row: an u64 would be aligned to 8 bytes, and
    /// the whole state of the planner with it.
    visited: [u8; SIDE as usize],
}

/// The robot's last metres, and the places on them.
#[derive(Debug)]
pub(super) struct PendingVisits {
    crumbs: Crumbs,
    /// The first one entered first.
    pending: Vec<PendingVisit, MOST_PENDING>,
    /// Places that the exploration visited in part, the last one left last.
    partial: Vec<Place, MOST_PARTIAL>,
}

/// Returns the place of a cell.
fn place(cell: Cell) -> Place {
    [cell.x & -PLACE_CELLS, cell.y & -PLACE_CELLS].map(|at| at as i16)
}

fn least_cell([x, y]: Place) -> Cell {
    let (x, y) = (x.into(), y.into());
    Cell { x, y }
}

fn is_within(a: Cell, b: Cell, radius_m: f32) -> bool {
    a.distance2(b) <= radius_m * radius_m
}

impl PendingVisit {
    /// Returns true if a centre cell was visited, or one beside it: the skeleton moves by a cell.
    fn has(&self, cell: Cell) -> bool {
        // Columns 0 and 7 have no neighbour on one side.
        let (west, east) = (0x0101_0101_0101_0101, 0x8080_8080_8080_8080);
        let visited = u64::from_le_bytes(self.visited);
        let row = visited | (visited & !east) << 1 | (visited & !west) >> 1;
        (row | row << SIDE | row >> SIDE) & bit(cell) != 0
    }
}

/// Returns the bit of a centre cell in its place.
fn bit(cell: Cell) -> u64 {
    let [x, y] = [cell.x, cell.y].map(|at| at.rem_euclid(PLACE_CELLS) / 2);
    1 << (y * SIDE + x)
}

/// Records that the exploration left a place, visited whole or in part.
fn remember(partial: &mut Vec<Place, MOST_PARTIAL>, left: Place, is_whole: bool) {
    partial.retain(|&other| other != left);
    if !is_whole {
        if partial.is_full() {
            partial.remove(0);
        }
        let _ = partial.push(left);
    }
}

impl PendingVisits {
    /// No place is pending.
    pub(super) const fn new() -> Self {
        Self {
            crumbs: Crumbs::new(),
            pending: Vec::new(),
            partial: Vec::new(),
        }
    }

    /// Records the robot's cell.
    pub(super) fn note(&mut self, robot: Cell) {
        self.crumbs.note(robot);
    }

    /// Writes the stamps of the places that the robot has left; on patrol only of those that it
    /// visited whole. `centre_cells(middle, half, visit)` visits those in a square.
    pub(super) fn leave<const SLOTS: usize>(
        &mut self,
        (robot, away_m): (Cell, f32),
        rails: &mut Rails<SLOTS>,
        is_patrolling: bool,
        centre_cells: impl Fn(Cell, i32, &mut dyn FnMut(Cell)),
    ) {
        let partial = &mut self.partial;
        self.pending.retain(|pending| {
            let left = pending.place;
            let (least, half) = (least_cell(left), PLACE_CELLS / 2);
            let middle = least.offset(half, half);
            if is_within(middle, robot, away_m) {
                return true;
            }
            let mut is_whole = true;
            centre_cells(middle, half, &mut |cell| {
                is_whole &= place(cell) != left || pending.has(cell);
            });
            if is_whole || !is_patrolling {
                rails.visit(least);
            }
            if !is_patrolling {
                remember(partial, left, is_whole);
            }
            false
        });
    }

    /// Begins a patrol: places visited in part count as never visited.
    pub(super) fn begin_patrol<const SLOTS: usize>(&mut self, rails: &mut Rails<SLOTS>) {
        for left in core::mem::take(&mut self.partial) {
            rails.forget(least_cell(left));
        }
    }

    /// Visits a centre cell. Returns true if its place was never visited before.
    pub(super) fn visit<const SLOTS: usize>(
        &mut self,
        cell: Cell,
        rails: &mut Rails<SLOTS>,
    ) -> bool {
        let (place, visited) = (place(cell), bit(cell));
        if let Some(pending) = self.pending.iter_mut().find(|it| it.place == place) {
            pending.visited = (u64::from_le_bytes(pending.visited) | visited).to_le_bytes();
            return false;
        }
        let is_new = !rails.is_visited(cell);
        let visited = visited.to_le_bytes();
        if self.pending.push(PendingVisit { place, visited }).is_err() {
            rails.visit(cell);
        }
        is_new
    }

    /// Returns the direction of the last `disc_m` driven, map cells. The robot's heading is not it
    /// while the robot turns on the spot.
    pub(super) fn ahead(&self, robot: Cell, disc_m: f32) -> Option<[f32; 2]> {
        let mut crumbs = self.crumbs.newest_first();
        let came = crumbs.find(|&crumb| !is_within(crumb, robot, disc_m))?;
        Some([robot.x - came.x, robot.y - came.y].map(|along| along as f32))
    }

    /// Returns true if a centre cell was visited and its stamp is not written yet.
    pub(super) fn holds(&self, cell: Cell) -> bool {
        let place = place(cell);
        let mut pending = self.pending.iter();
        let pending = pending.find(|pending| pending.place == place);
        pending.is_some_and(|pending| pending.has(cell))
    }

    /// Writes all stamps, and moves what lies in the map with its tiles.
    pub(super) fn correct<const SLOTS: usize>(
        &mut self,
        shifts: Shifts<'_>,
        rails: &mut Rails<SLOTS>,
    ) {
        self.write_all(rails);
        self.crumbs.shift(shifts);
        for left in &mut self.partial {
            let half = PLACE_CELLS / 2;
            *left = place(shifts.moved(least_cell(*left).offset(half, half)));
        }
    }

    /// Writes all stamps.
    pub(super) fn write_all<const SLOTS: usize>(&mut self, rails: &mut Rails<SLOTS>) {
        for pending in core::mem::take(&mut self.pending) {
            rails.visit(least_cell(pending.place));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::PendingVisits;
    use crate::config::TdbvpTuning;
    use crate::geometry::Cell;
    use crate::strategy::tdbvp::rails::{Rails, UNVISITED};

    /// The centre cells are a line.
    fn at(x: i32) -> Cell {
        Cell { x, y: 8 }
    }

    fn line(middle: Cell, half: i32, visit: &mut dyn FnMut(Cell)) {
        let columns = middle.x - half..middle.x + half;
        columns.filter(|x| x % 2 == 0).for_each(|x| visit(at(x)));
    }

    fn rails() -> Rails<16> {
        Rails::new(TdbvpTuning::DEFAULT.first_tick_ms, 200)
    }

    /// The robot drives from one centre cell to another, and visits those within `near`.
    fn drive(
        pending: &mut PendingVisits,
        rails: &mut Rails<16>,
        stops: &[i32],
        near: i32,
        is_patrolling: bool,
    ) {
        for &x in stops {
            rails.step();
            pending.note(at(x));
            let robot = (at(x), TdbvpTuning::DEFAULT.away_m);
            pending.leave(robot, rails, is_patrolling, line);
            for near in (x - near..=x + near).filter(|x| x % 2 == 0) {
                pending.visit(at(near), rails);
            }
        }
    }

    #[test]
    fn cells_ahead_in_the_same_place_stay_unvisited_until_the_robot_is_away() {
        let (mut rails, mut pending) = (rails(), PendingVisits::new());
        assert!(pending.visit(at(0), &mut rails), "new");
        assert!(!pending.visit(at(2), &mut rails), "the place is not");
        assert!(pending.holds(at(0)) && !pending.holds(at(14)));
        assert_eq!(rails.potential(at(14)), UNVISITED);
        let stops: Vec<i32> = (3..40).collect();
        drive(&mut pending, &mut rails, &stops, 0, false);
        assert!(!pending.holds(at(2)), "its stamp is written");
        assert!(rails.is_visited(at(2)) && rails.is_visited(at(14)));
        assert_eq!(rails.potential(at(35)), UNVISITED);
        pending.write_all(&mut rails);
        assert!(rails.is_visited(at(35)));
    }

    #[test]
    fn a_skeleton_that_moves_by_a_cell_is_still_visited() {
        let (mut rails, mut pending) = (rails(), PendingVisits::new());
        pending.visit(Cell { x: 20, y: 6 }, &mut rails);
        for (x, y, held) in [(20, 8, true), (18, 4, true), (22, 6, true), (24, 6, false)] {
            assert_eq!(pending.holds(Cell { x, y }), held, "{x} {y}");
        }
        // The last column is not beside the first one of the row above.
        pending.visit(Cell { x: 30, y: 6 }, &mut rails);
        assert!(!pending.holds(Cell { x: 16, y: 8 }));
    }

    #[test]
    fn a_place_visited_in_part_has_a_stamp_until_a_patrol_begins() {
        let (mut rails, mut pending) = (rails(), PendingVisits::new());
        drive(&mut pending, &mut rails, &[20, 60], 2, false);
        drive(&mut pending, &mut rails, &[60], 8, false);
        assert!(rails.is_visited(at(30)), "enough for the exploration");
        pending.begin_patrol(&mut rails);
        assert!(!rails.is_visited(at(30)), "a patrol goes there first");
        // Places visited whole keep their stamps.
        let (mut rails, mut pending) = (self::rails(), PendingVisits::new());
        drive(&mut pending, &mut rails, &[20, 28, 60], 8, false);
        pending.begin_patrol(&mut rails);
        assert!(rails.is_visited(at(30)));
    }

    #[test]
    fn a_patrol_that_visits_a_place_in_part_leaves_its_stamp() {
        let (mut rails, mut pending) = (rails(), PendingVisits::new());
        drive(&mut pending, &mut rails, &[20, 28, 60], 8, false);
        let before = rails.stamp(at(30));
        let wait = |rails: &mut Rails<16>| (0..40).for_each(|_| rails.step());
        wait(&mut rails);
        drive(&mut pending, &mut rails, &[20, 60], 2, true);
        assert_eq!(rails.stamp(at(30)), before);
        drive(&mut pending, &mut rails, &[20, 28, 60], 8, true);
        assert!(rails.stamp(at(30)) > before);
    }
}
