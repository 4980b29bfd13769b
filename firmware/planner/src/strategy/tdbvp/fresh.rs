//! What the robot is visiting: places whose date is not written yet, and its last metres.
//!
//! A date is for 1.6 × 1.6 m. Written when the robot comes in, it would call visited what lies ahead in the same place, and the robot
//! would stand before it. So a place is *pending* until the robot is [`AWAY_M`] from it; meanwhile the centre cells in it
//! are visited that lie near the robot's path, and the others are what they were.
//!
//! Units: map cells, metres.

use heapless::Vec;

use super::rails::{PLACE_CELLS, Rails};
use crate::geometry::{CELL_M, Cell};
use crate::strategy::ouroboros::crumbs::Crumbs;

/// Centre cells this near to the path are visited, metres: three quarters of what a date is for, and little enough that no wall
/// of a corridor of 2 m is looked through. What is being visited is free, so this is also how far ahead the nearest rail attracts: at
/// 0.5 m there is no room left in the half disc for a preferred side, and at a cross 10 of 20 robots went straight on.
pub(super) const VISIT_M: f32 = 1.2;
/// A place this far from the robot is done with, metres: most of the way to the window's edge.
const AWAY_M: f32 = 2.4;
/// Metres of the way that say where ahead is: as far as the preferred side reaches, so that it does not turn with a robot that turns
/// into it.
const AHEAD_M: f32 = 2.0;
/// Places that are pending at the most.
const MOST_PENDING: usize = 12;

/// The last metres and the places they lead through.
#[derive(Debug)]
pub(super) struct Fresh {
    crumbs: Crumbs,
    /// The least cells of places, the first one entered first.
    pending: Vec<[i16; 2], MOST_PENDING>,
}

/// The least cell of the place that a cell is in.
fn place(cell: Cell) -> [i16; 2] {
    [cell.x & -PLACE_CELLS, cell.y & -PLACE_CELLS].map(|at| at as i16)
}

fn is_near(a: Cell, b: Cell, radius_m: f32) -> bool {
    let (dx, dy) = ((a.x - b.x) as f32 * CELL_M, (a.y - b.y) as f32 * CELL_M);
    dx * dx + dy * dy <= radius_m * radius_m
}

impl Fresh {
    /// Nothing yet.
    pub(super) const fn new() -> Self {
        Self {
            crumbs: Crumbs::new(),
            pending: Vec::new(),
        }
    }

    /// The robot is here: what it left is written down.
    pub(super) fn come<const SLOTS: usize>(&mut self, robot: Cell, rails: &mut Rails<SLOTS>) {
        self.crumbs.note(robot);
        self.pending.retain(|&place| {
            let least = Cell {
                x: i32::from(place[0]),
                y: i32::from(place[1]),
            };
            let middle = Cell {
                x: least.x + PLACE_CELLS / 2,
                y: least.y + PLACE_CELLS / 2,
            };
            let stays = is_near(middle, robot, AWAY_M);
            if !stays {
                rails.visit(least);
            }
            stays
        });
    }

    /// The robot visits a centre cell; whether its place was never visited before.
    pub(super) fn visit<const SLOTS: usize>(
        &mut self,
        cell: Cell,
        rails: &mut Rails<SLOTS>,
    ) -> bool {
        let place = place(cell);
        if self.pending.contains(&place) {
            return false;
        }
        let is_new = !rails.is_visited(cell);
        if self.pending.push(place).is_err() {
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

    /// Whether the place of a centre cell is being visited.
    pub(super) fn is_pending(&self, cell: Cell) -> bool {
        self.pending.contains(&place(cell))
    }

    /// Whether a centre cell was visited in the last metres and its date is not written yet.
    pub(super) fn holds(&self, cell: Cell) -> bool {
        self.is_pending(cell)
            && self
                .crumbs
                .newest_first()
                .any(|crumb| is_near(crumb, cell, VISIT_M))
    }

    /// Write everything down.
    pub(super) fn settle<const SLOTS: usize>(&mut self, rails: &mut Rails<SLOTS>) {
        for [x, y] in core::mem::take(&mut self.pending) {
            let (x, y) = (x.into(), y.into());
            rails.visit(Cell { x, y });
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
    use super::Fresh;
    use crate::geometry::Cell;
    use crate::strategy::tdbvp::rails::{Rails, UNVISITED};

    #[test]
    fn what_lies_ahead_in_the_same_place_is_what_it_was_until_the_robot_is_gone() {
        let mut rails: Rails<16> = Rails::new();
        rails.reset((4, 4));
        let mut fresh = Fresh::new();
        let at = |x| Cell { x, y: 8 };
        for x in 0..=2 {
            fresh.come(at(x), &mut rails);
            assert_eq!(fresh.visit(at(x), &mut rails), x == 0, "new once, at {x}");
        }
        assert!(fresh.holds(at(1)) && !fresh.holds(at(14)));
        assert_eq!(rails.potential(at(14)), UNVISITED);
        for x in 3..40 {
            fresh.come(at(x), &mut rails);
            fresh.visit(at(x), &mut rails);
        }
        assert!(!fresh.holds(at(2)), "its date is written");
        assert_eq!([2, 14].map(|x| rails.potential(at(x))), [1.0, 1.0]);
        assert_eq!(rails.potential(at(35)), UNVISITED);
        fresh.settle(&mut rails);
        assert_eq!(rails.potential(at(35)), 1.0);
    }
}
