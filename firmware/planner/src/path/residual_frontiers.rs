//! Residual frontiers: the goals that were given up, and at the end of an exploration the frontiers
//! that were never reached, in groups.
//!
//! Units: map cells, metres.

use heapless::Vec;

use crate::geometry::{CELL_M, Cell};
use crate::grid::Shifts;
use crate::roadmap::skeleton::Skeleton;
use crate::status::{ResidualFrontier, ResidualReason};

/// Maximum number of residual frontiers.
const MOST_RESIDUAL: usize = 32;
/// Radius around a goal that was given up in which no other goal is taken, metres.
const GIVEN_UP_RADIUS_M: f32 = 0.5;
/// Cells at most this far from a group's first cell belong to the group, metres.
const GROUP_RADIUS_M: f32 = 2.0;

/// The list of residual frontiers, the oldest first.
#[derive(Debug)]
pub(crate) struct ResidualFrontiers {
    list: Vec<ResidualFrontier, MOST_RESIDUAL>,
}

impl ResidualFrontiers {
    /// Makes an empty list.
    pub(crate) const fn new() -> Self {
        Self { list: Vec::new() }
    }

    /// Returns the list.
    pub(crate) fn as_slice(&self) -> &[ResidualFrontier] {
        &self.list
    }

    /// Returns the goals that were given up.
    fn given_up(&self) -> impl Iterator<Item = &ResidualFrontier> {
        let list = self.list.iter();
        list.filter(|residual| !is_not_worth_it(residual))
    }

    /// Returns true if as many goals were given up as there is room for.
    pub(crate) fn is_full(&self) -> bool {
        self.given_up().count() == MOST_RESIDUAL
    }

    /// Returns true if a cell is beside a goal that was given up.
    pub(crate) fn is_given_up(&self, cell: Cell) -> bool {
        let mut given_up = self.given_up();
        given_up.any(|residual| is_near(residual.cell, cell, GIVEN_UP_RADIUS_M))
    }

    /// Gives up a goal. A full list loses one that is not worth the trip, or else its oldest one.
    pub(crate) fn give_up(&mut self, cell: Cell, reason: ResidualReason) {
        if !self.has_room() {
            self.list.remove(0);
        }
        // There is room now.
        let _ = self.list.push(ResidualFrontier {
            cell,
            cells: 1,
            reason,
        });
    }

    /// Lists frontier cells that are not worth the trip from where the robot is now.
    pub(crate) fn list_not_worth_it(&mut self, cell: Cell, cells: u16) {
        if let Some(group) = self.count(cell, ResidualReason::NotWorthIt) {
            group.cells = group.cells.saturating_add(cells.saturating_sub(1));
        }
    }

    /// Moves the goals with the tiles that they lie in.
    pub(crate) fn shift(&mut self, shifts: Shifts<'_>) {
        for residual in &mut self.list {
            residual.cell = shifts.moved(residual.cell);
        }
    }

    /// Takes off the list what was not worth the trip.
    pub(crate) fn forget_not_worth_it(&mut self) {
        self.list.retain(|residual| !is_not_worth_it(residual));
    }

    /// Takes the goals back that were given up because the robot came no nearer.
    pub(crate) fn retry_without_progress(&mut self) {
        self.list
            .retain(|residual| residual.reason != ResidualReason::NoProgress);
    }

    /// Takes the goals back that no path led to.
    pub(crate) fn retry_unreachable(&mut self) {
        self.list
            .retain(|residual| residual.reason != ResidualReason::Unreachable);
    }

    /// Returns true if no path led to a goal.
    pub(crate) fn has_unreachable(&self) -> bool {
        let mut list = self.list.iter();
        list.any(|residual| residual.reason == ResidualReason::Unreachable)
    }

    /// Takes a goal off the list that was reached and stayed unexplored.
    pub(crate) fn take_unobservable(&mut self) -> Option<Cell> {
        let unobservable =
            |residual: &ResidualFrontier| residual.reason == ResidualReason::Unobservable;
        let place = self.list.iter().position(unobservable)?;
        Some(self.list.remove(place).cell)
    }

    /// Lists the frontier cells that no path leads to, in groups, after the goals given up.
    pub(crate) fn list_unreachable<const SLOTS: usize>(&mut self, skeleton: &Skeleton<SLOTS>) {
        let Some(frontier) = skeleton.frontier() else {
            return;
        };
        for site in frontier.sites() {
            let cell = skeleton.frame().cell(site);
            self.count(cell, ResidualReason::Unreachable);
        }
    }

    /// Lists a cell beyond which the map has no room. A group beside it has the same reason. On a
    /// full list, something that is not worth the trip gives way.
    pub(crate) fn list_map_exit(&mut self, cell: Cell) {
        let has_group = |residual: &ResidualFrontier| is_near(residual.cell, cell, GROUP_RADIUS_M);
        if !self.list.iter().any(has_group) {
            // A list full of exits has no room for another.
            let _ = self.has_room();
        }
        if let Some(group) = self.count(cell, ResidualReason::OutOfBounds) {
            group.reason = ResidualReason::OutOfBounds;
        }
    }

    /// Returns true if there is room. On a full list, something that is not worth the trip gives
    /// way.
    fn has_room(&mut self) -> bool {
        if self.list.is_full()
            && let Some(place) = self.list.iter().position(is_not_worth_it)
        {
            self.list.remove(place);
        }
        !self.list.is_full()
    }

    /// Counts a cell to the first group near it, or begins a group. Returns the group; `None` if
    /// the list is full.
    fn count(&mut self, cell: Cell, reason: ResidualReason) -> Option<&mut ResidualFrontier> {
        let is_group = |residual: &ResidualFrontier| is_near(residual.cell, cell, GROUP_RADIUS_M);
        if let Some(k) = self.list.iter().position(is_group) {
            let group = self.list.get_mut(k)?;
            group.cells = group.cells.saturating_add(1);
            return Some(group);
        }
        let group = ResidualFrontier {
            cell,
            cells: 1,
            reason,
        };
        self.list.push(group).ok()?;
        self.list.last_mut()
    }
}

fn is_not_worth_it(residual: &ResidualFrontier) -> bool {
    residual.reason == ResidualReason::NotWorthIt
}

/// Returns true if two cells are less than a radius apart, metres. A radius is a number of whole
/// cells. It counts in integers, because it is asked for each cell of a frontier.
pub(crate) fn is_near(a: Cell, b: Cell, radius_m: f32) -> bool {
    let reach = (radius_m / CELL_M + 0.5) as u32;
    let (dx, dy) = (a.x.abs_diff(b.x), a.y.abs_diff(b.y));
    dx < reach && dy < reach && dx * dx + dy * dy < reach * reach
}
