//! The planner's memory, and what a host may see of it.
//!
//! Units: map cells; tiles of 32 × 32 cells.

use fieldline_planner::{self as planner, CellKind, FIELD_SIDE as SIDE, State, Tuning, Workspace};
use fieldline_protocol::message::{
    FIELD_SIDE, FieldRow, MAX_FRONTIERS, Path, Reply, Request, ResidualFrontier, Tile,
};
use heapless::Vec;

use crate::convert;

// The planner's rows must fit into the wire's bounded lists.
const _: () = assert!(SIDE == FIELD_SIDE);

/// The planner's memory. The caller owns it, so that a board can place it.
#[derive(Debug)]
pub struct Memory<'a, const TILES: usize, const SLOTS: usize> {
    /// Map and state of the strategy.
    pub state: &'a mut State<TILES, SLOTS>,
    /// Scratch memory of a step.
    pub workspace: &'a mut Workspace,
    /// The tuned constants of the next session. A chip keeps them in flash.
    pub tuning: &'static Tuning,
}

impl<const TILES: usize, const SLOTS: usize> Memory<'_, TILES, SLOTS> {
    /// Answers a request that only looks; `None` for another one.
    #[must_use]
    pub fn show(&self, request: &Request) -> Option<Reply> {
        Some(match request {
            Request::Tile { x, y } => Reply::Tile(self.tile(*x, *y)),
            Request::FieldRow { row } => Reply::FieldRow(self.field_row(*row)),
            Request::Frontiers => Reply::Frontiers(self.frontiers()),
            Request::Path { from } => Reply::Path(self.path(*from)),
            _ => return None,
        })
    }

    /// Returns one map tile; `None` if nothing in it was ever seen.
    #[inline(never)]
    pub(crate) fn tile(&self, x: i16, y: i16) -> Option<Tile> {
        let cells = self.state.tile(x, y)?;
        let rows = self.state.tile_skeleton(x, y);
        Some(Tile {
            x,
            y,
            cells: cells.iter().copied().collect(),
            skeleton: rows.iter().flat_map(|row| row.to_le_bytes()).collect(),
            closed_regions: self.state.closed_regions(x, y),
            given_up_regions: self.state.given_up_regions(x, y),
            visit_stamps: self.state.visit_stamps(x, y),
        })
    }

    /// Returns one row of the field in the last window; `None` before the first window and for a
    /// row beyond the last one.
    #[inline(never)]
    pub(crate) fn field_row(&self, row: u8) -> Option<FieldRow> {
        self.workspace
            .field_row(row)
            .map(|found| field_row(row, &found))
    }

    /// Returns tractor point, shield, and the path without its first `from` cells.
    #[inline(never)]
    fn path(&self, from: u8) -> Path {
        convert::wire_path(self.state, from)
    }

    /// Returns the first [`MAX_FRONTIERS`] residual frontiers.
    #[inline(never)]
    fn frontiers(&self) -> Vec<ResidualFrontier, MAX_FRONTIERS> {
        let frontiers = self.state.frontiers().iter();
        frontiers
            .take(MAX_FRONTIERS)
            .map(convert::wire_frontier)
            .collect()
    }
}

/// Converts a field row for the wire: the origin in window cells, the cell kinds in two bits each.
fn field_row(row: u8, found: &planner::FieldRow) -> FieldRow {
    let scale = i32::from(found.scale.max(1));
    let short = |cell: i32| cell.div_euclid(scale) as i16;
    let kind = |kind: &CellKind| match kind {
        CellKind::Free => 0,
        CellKind::Obstacle => 1,
        CellKind::Goal => 2,
    };
    let pack = |four: &[CellKind]| {
        let bits = four.iter().enumerate();
        bits.fold(0, |byte, (i, cell)| byte | kind(cell) << (2 * i))
    };
    FieldRow {
        row,
        origin_x: short(found.origin.x),
        origin_y: short(found.origin.y),
        scale: found.scale,
        q: found.q.into_iter().collect(),
        cells: found.kinds.chunks(4).map(pack).collect(),
    }
}
