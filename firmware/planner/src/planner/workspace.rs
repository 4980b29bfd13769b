//! The scratch memory of a step, and rows of the last field for display.
//!
//! Units: map cells; q is 1 at a goal.

use crate::field::local_grid::LocalGrid;
use crate::field::{GOAL, SCRATCH_FLOATS, SIDE, Window};
use crate::geometry::Cell;
use crate::path::PlanningScratch;
use crate::planner::deskew::Room;
use crate::robot::MAX_BEAMS;

/// Words of scratch.
pub(super) const SCRATCH: usize = SCRATCH_FLOATS;
/// Words of the wavefront's queue.
pub(super) const RING: usize = 1024;

/// The memory of a step: the field, which is the next step's warm start, and scratch that the
/// wavefront and the multigrid use in turn.
#[derive(Debug)]
pub struct Workspace {
    pub(super) window: Window,
    /// The window's least map cell, and its scale in map cells.
    pub(super) window_at: Option<(Cell, i32)>,
    /// The passable cells of the window.
    pub(super) local_grid: LocalGrid,
    pub(super) scratch: [f32; SCRATCH],
    /// The step's scans, moved to one instant.
    pub(super) scans: Room,
}

impl Workspace {
    /// Returns cleared memory.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            window: Window::new(),
            window_at: None,
            local_grid: LocalGrid::new(),
            scratch: [0.0; SCRATCH],
            scans: [[0; MAX_BEAMS as usize]; 2],
        }
    }

    /// Lends the memory that a search along a skeleton of so many tiles needs.
    pub(super) fn planning(&mut self, slots: usize) -> PlanningScratch<'_> {
        let words: &mut [u32] = bytemuck::cast_slice_mut(&mut self.scratch);
        let (residues, queue) = words.split_at_mut(slots * 16);
        let (residues, _) = residues.as_chunks_mut::<2>();
        PlanningScratch {
            residues,
            queue,
            local_grid: &mut self.local_grid,
        }
    }

    /// Returns the last window's field.
    #[must_use]
    pub const fn window(&self) -> &Window {
        &self.window
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

/// One row of the last step's window.
///
/// ```
/// use fieldline_planner::{CellKind, FIELD_SIDE, FieldRow, Workspace};
///
/// /// Returns the number of goal cells in a row.
/// fn goals(row: &FieldRow) -> usize {
///     row.kinds.iter().filter(|&&kind| kind == CellKind::Goal).count()
/// }
/// // Before the first step there is no window.
/// let workspace = Box::new(Workspace::new());
/// assert!((0..FIELD_SIDE as u8).all(|row| workspace.field_row(row).is_none()));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldRow {
    /// Least map cell of the window.
    pub origin: Cell,
    /// Map cells along a window cell.
    pub scale: u8,
    /// q = 1 − p: 1 at a goal, 0 on obstacles and where no goal can be reached.
    pub q: [f32; SIDE],
    /// The kind of each cell in the boundary-value problem.
    pub kinds: [CellKind; SIDE],
}

/// The kind of a cell in the window's boundary-value problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellKind {
    /// Its potential is relaxed.
    Free,
    /// p = 1: an obstacle, or no goal can be reached.
    #[default]
    Obstacle,
    /// p = 0.
    Goal,
}

impl Workspace {
    /// Returns one row of the last step's field; row 0 has the least y. `None` before the first
    /// window and beyond the last row.
    #[must_use]
    pub fn field_row(&self, row: u8) -> Option<FieldRow> {
        let (origin, scale) = self.window_at?;
        let y = usize::from(row);
        (y < SIDE).then(|| FieldRow {
            origin,
            scale: scale as u8,
            q: core::array::from_fn(|x| self.window.q(x, y) / GOAL),
            kinds: core::array::from_fn(|x| {
                if self.window.is_goal(x, y) {
                    CellKind::Goal
                } else if self.window.is_reached(x, y) {
                    CellKind::Free
                } else {
                    CellKind::Obstacle
                }
            }),
        })
    }
}
