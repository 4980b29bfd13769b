//! The elevation window as it is read: heights and the bits of a cell's mark.
//!
//! What they mean is told, and written, in [`super::elevation`]. Units: map cells, metres above the start.

use fixed::types::I7F9;

use crate::geometry::Cell;
use crate::grid::Rolling;

/// Cells along the window's side.
pub const WINDOW_SIDE: i32 = 64;
/// Cells of the window.
pub const WINDOW_CELLS: usize = (WINDOW_SIDE * WINDOW_SIDE) as usize;
/// The geometry of the window.
pub(super) type Window = Rolling<WINDOW_SIDE, 1>;
/// Bits of the count.
pub(super) const COUNT: u8 = 0x0f;
/// Bits of what stands.
pub(super) const SCORE: u8 = 0x70;
/// One hit of something that stands.
pub(super) const SCORE_STEP: u8 = 0x10;
/// The ground seems to be gone; with a count, the height is but glimpsed.
pub(super) const DROP: u8 = 0x80;
/// Hits from which on something stands there: fewer are false returns.
const OBSTACLE_FROM_STEPS: u8 = 3;

/// What is known of the ground of a cell, if anything is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// Measured, metres.
    Measured(f32),
    /// Never measured, and held to be gone.
    Uncertain,
    /// Seen to be gone, or something stands on it.
    Blocked,
}

/// The window, for reading.
#[derive(Clone, Copy, Debug)]
pub struct Heights<'a> {
    pub(super) heights: &'a [[u8; 2]],
    pub(super) marks: &'a [u8],
    /// Its least cell.
    pub(super) origin: Cell,
}

/// Whether a mark is of a height that is but glimpsed.
#[inline(always)]
pub(super) const fn is_low_confidence(mark: u8) -> bool {
    mark & DROP != 0 && mark & COUNT != 0
}

/// How often a cell of this mark was measured.
#[inline(always)]
const fn measured(mark: u8) -> u8 {
    if is_low_confidence(mark) {
        0
    } else {
        mark & COUNT
    }
}

/// Where a cell of the window at `origin` is stored; `None` outside of it.
#[inline(always)]
pub(super) const fn slot(origin: Cell, cell: Cell) -> Option<usize> {
    if Window::covers(origin, cell) {
        Some(Window::slot(cell))
    } else {
        None
    }
}

impl<'a> Heights<'a> {
    /// A window whose least cell is `origin`, over memory for [`WINDOW_CELLS`] cells; what is missing was never measured.
    #[must_use]
    pub fn new(heights: &'a [u8], marks: &'a [u8], origin: Cell) -> Self {
        let (heights, _) = heights.as_chunks();
        Self {
            heights,
            marks,
            origin,
        }
    }

    /// Its least cell.
    #[must_use]
    pub const fn origin(&self) -> Cell {
        self.origin
    }

    #[inline(always)]
    fn mark(&self, slot: usize) -> u8 {
        self.marks.get(slot).copied().unwrap_or(0)
    }

    /// The stored height of a cell; `None` where none was measured.
    #[inline(always)]
    #[must_use]
    pub fn fixed(&self, cell: Cell) -> Option<I7F9> {
        let slot = slot(self.origin, cell)?;
        if measured(self.mark(slot)) == 0 {
            return None;
        }
        Some(I7F9::from_le_bytes(*self.heights.get(slot)?))
    }

    /// The mean height of a cell, metres; `None` where none was measured.
    #[inline(always)]
    #[must_use]
    pub fn height_m(&self, cell: Cell) -> Option<f32> {
        self.fixed(cell).map(metres)
    }

    /// The mean height of a cell that was glimpsed and never measured, metres.
    #[must_use]
    pub fn low_confidence_m(&self, cell: Cell) -> Option<f32> {
        let slot = slot(self.origin, cell).filter(|&slot| is_low_confidence(self.mark(slot)))?;
        Some(metres(I7F9::from_le_bytes(*self.heights.get(slot)?)))
    }

    /// What is known of a cell's ground: `None` where it was never measured.
    #[inline(always)]
    #[must_use]
    pub fn ground(&self, cell: Cell) -> Option<Ground> {
        let slot = slot(self.origin, cell)?;
        let mark = self.mark(slot);
        if mark == 0 {
            return None;
        }
        let stored = *self.heights.get(slot)?;
        if mark & SCORE >= OBSTACLE_FROM_STEPS * SCORE_STEP {
            Some(Ground::Blocked)
        } else if mark & (COUNT | DROP) == DROP {
            Some(if stored == POSSIBLE_DROP || stored == INFERRED_DROP {
                Ground::Uncertain
            } else {
                Ground::Blocked
            })
        } else {
            (measured(mark) > 0).then(|| Ground::Measured(metres(I7F9::from_le_bytes(stored))))
        }
    }

    /// How often a cell was measured, up to 15.
    #[must_use]
    pub fn count(&self, cell: Cell) -> u8 {
        slot(self.origin, cell).map_or(0, |slot| measured(self.mark(slot)))
    }

    /// Whether something stands in a cell.
    #[must_use]
    pub fn is_obstacle(&self, cell: Cell) -> bool {
        slot(self.origin, cell)
            .is_some_and(|slot| self.mark(slot) & SCORE >= OBSTACLE_FROM_STEPS * SCORE_STEP)
    }

    /// Whether the ground of a cell seems to be gone.
    #[must_use]
    pub fn is_drop(&self, cell: Cell) -> bool {
        slot(self.origin, cell).is_some_and(|slot| self.mark(slot) & (COUNT | DROP) == DROP)
    }

    /// Whether nothing was ever met in a cell, and of the eight around one seems to be gone and one is measured.
    #[must_use]
    pub fn is_on_rim(&self, cell: Cell) -> bool {
        let around = || {
            (-1..=1)
                .flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)))
                .map(|(dx, dy)| Cell {
                    x: cell.x + dx,
                    y: cell.y + dy,
                })
        };
        slot(self.origin, cell).is_some_and(|slot| self.mark(slot) == 0)
            && around().any(|near| self.is_drop(near))
            && around().any(|near| self.count(near) > 0)
    }

    /// Whether the ground of a cell is but presumed to be gone: it lies on a rim, or was suspected in an attitude that errs.
    #[must_use]
    pub fn is_inferred_drop(&self, cell: Cell) -> bool {
        slot(self.origin, cell).is_some_and(|slot| {
            self.mark(slot) & (COUNT | DROP) == DROP
                && self.heights.get(slot) == Some(&INFERRED_DROP)
        })
    }

    /// Whether the ground of a cell never measured is suspected to be gone, and not yet believed to be.
    #[must_use]
    pub fn is_possible_drop(&self, cell: Cell) -> bool {
        slot(self.origin, cell).is_some_and(|slot| {
            self.mark(slot) & (COUNT | DROP) == 0 && self.heights.get(slot) == Some(&POSSIBLE_DROP)
        })
    }
}

/// What the height of a cell never measured says if its ground is suspected to be gone, or but held to be for that.
pub(super) const POSSIBLE_DROP: [u8; 2] = [1, 0];
/// And if it is but presumed to be gone; nothing else is ever stored there.
pub(super) const INFERRED_DROP: [u8; 2] = [2, 0];

/// A stored height in metres.
#[inline(always)]
#[must_use]
pub fn metres(height: I7F9) -> f32 {
    const STEP_M: f32 = 1.0 / (1 << I7F9::FRAC_NBITS) as f32;
    f32::from(height.to_bits()) * STEP_M
}
