//! Leftovers: what is listed at the end of frontiers that were never reached, in groups. Units: map cells, metres.

use crate::geometry::Cell;
use crate::path::PlanningContext;
use crate::status::{Frontier as Leftover, Residue};
use crate::strategy::frontier::{Frontier, near};

/// Leftover cells this near are one group, metres.
const GROUP_RADIUS_M: f32 = 2.0;

impl Frontier {
    /// List the frontier cells that were never within reach, in groups, behind the goals that were dropped.
    pub fn list_leftovers<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &PlanningContext<'_, TILES, SLOTS>,
    ) {
        let Some(goals) = known.topology.frontier() else {
            return;
        };
        for site in goals.sites() {
            let cell = known.topology.frame().cell(site);
            self.list(cell, Residue::Unreachable);
        }
    }

    /// List a cell beyond which the map has no room; a goal dropped beside it was dropped for that.
    pub fn list_way_out(&mut self, cell: Cell) {
        if let Some(left) = self.list(cell, Residue::OutOfBounds) {
            left.reason = Residue::OutOfBounds;
        }
    }

    /// Count a cell to the group it is near to, or begin one.
    fn list(&mut self, cell: Cell, reason: Residue) -> Option<&mut Leftover> {
        let group = |left: &Leftover| near(left.cell, cell, GROUP_RADIUS_M);
        if let Some(k) = self.dropped.iter().position(group) {
            let left = self.dropped.get_mut(k)?;
            left.cells = left.cells.saturating_add(1);
            return Some(left);
        }
        let left = Leftover {
            cell,
            cells: 1,
            reason,
        };
        // A full list names enough of them.
        self.dropped.push(left).ok()?;
        self.dropped.last_mut()
    }
}
