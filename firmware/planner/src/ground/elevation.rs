//! The elevation window: 64 × 64 cells around the robot, each with the running mean of the heights measured in it.
//!
//! ```text
//! h ← h + (z − h) / n,    n = min(measurements so far, MAX_COUNT)          [Maffei20, III-B]
//! ```
//!
//! A height is an [`I7F9`]: ±64 m around the start in steps of 2 mm. Beside it lies a byte of marks: how often the cell was
//! measured, how sure it is that something stands in it, and whether the ground seems to be gone. Of a cell never measured the height says
//! whether that is suspected. Ground met from too far off to be measured is glimpsed: it has a height of its own kind, counted and marked at
//! once, which denies that the ground is gone and gives way to the first that is measured.
//!
//! The window owns no memory. A session on flat ground has no use for it, and one on uneven ground none for the counts of
//! [`crate::map::Evidence`], so the heights lie in the latter's 8 KB and the marks in the last tiles of the map's pool.
//!
//! Invariant: a slot belongs to exactly one cell of the window (cell mod 64), and strips that enter are cleared.
//! Units: map cells, metres above the start.

use fixed::types::I7F9;

use crate::geometry::Cell;
use crate::ground::heights::{
    COUNT, DROP, INFERRED_DROP, POSSIBLE_DROP, SCORE, SCORE_STEP, Window, is_low_confidence, slot,
};
pub use crate::ground::heights::{Ground, Heights, WINDOW_CELLS, WINDOW_SIDE, metres};

/// Measurements that a mean remembers.
const MAX_COUNT: u8 = 15;
/// What is farther off a mean, in steps of a height, may be false: 0.15 m.
const OUTLIER_STEPS: i32 = I7F9::lit("0.15").to_bits() as i32;

/// The window.
#[derive(Debug)]
pub struct Elevation<'a> {
    heights: &'a mut [[u8; 2]],
    marks: &'a mut [u8],
    origin: &'a mut Cell,
}

impl<'a> Elevation<'a> {
    /// The window over memory for [`WINDOW_CELLS`] cells, all zeros at first.
    #[must_use]
    pub fn new(heights: &'a mut [u8], marks: &'a mut [u8], origin: &'a mut Cell) -> Self {
        let (heights, _) = heights.as_chunks_mut();
        Self {
            heights,
            marks,
            origin,
        }
    }

    /// The window, for reading.
    #[inline(always)]
    #[must_use]
    pub fn read(&self) -> Heights<'_> {
        Heights {
            heights: self.heights,
            marks: self.marks,
            origin: *self.origin,
        }
    }

    /// Keep the window around `centre`; nothing is known of cells that enter.
    pub fn follow(&mut self, centre: Cell) {
        let from = core::mem::replace(self.origin, Window::origin(centre));
        let Some([columns, rows]) = Window::entering(from, *self.origin) else {
            self.marks.fill(0);
            self.heights.fill([0; 2]);
            return;
        };
        let (left, lower) = (self.origin.x, self.origin.y);
        for y in rows {
            (left..left + WINDOW_SIDE).for_each(|x| self.clear(Cell { x, y }));
        }
        for x in columns {
            (lower..lower + WINDOW_SIDE).for_each(|y| self.clear(Cell { x, y }));
        }
    }

    fn mark_mut(&mut self, cell: Cell) -> Option<&mut u8> {
        self.marks.get_mut(slot(*self.origin, cell)?)
    }

    fn clear(&mut self, cell: Cell) {
        let Some(slot) = slot(*self.origin, cell) else {
            return;
        };
        if let (Some(mark), Some(stored)) = (self.marks.get_mut(slot), self.heights.get_mut(slot)) {
            (*mark, *stored) = (0, [0; 2]);
        }
    }

    /// Ground was measured in a cell: into its mean. What is far off the mean is left out, for it may be a false return; but then the mean
    /// counts for less, until it gives way, and where there was but one before, the lower one stays. Then the ground is not gone, and what stands there stands less surely. Outside the
    /// window nothing happens.
    pub fn measure(&mut self, cell: Cell, height_m: f32) {
        self.discard_low_confidence(cell);
        self.average(cell, height_m);
    }

    /// Ground was met in a cell from too far off to measure it: into the mean of such, if it was never measured.
    pub fn measure_low_confidence(&mut self, cell: Cell, height_m: f32) {
        if self.read().count(cell) > 0 {
            return;
        }
        self.average(cell, height_m);
        if let Some(mark) = self.mark_mut(cell) {
            *mark |= DROP;
        }
    }

    /// What was but glimpsed gives way.
    fn discard_low_confidence(&mut self, cell: Cell) {
        if let Some(mark) = self.mark_mut(cell)
            && is_low_confidence(*mark)
        {
            *mark &= SCORE;
        }
    }

    /// A height into the mean of a cell.
    fn average(&mut self, cell: Cell, height_m: f32) {
        let Some(slot) = slot(*self.origin, cell) else {
            return;
        };
        let (Some(mark), Some(stored)) = (self.marks.get_mut(slot), self.heights.get_mut(slot))
        else {
            return;
        };
        let count = (*mark & COUNT).saturating_add(1).min(MAX_COUNT);
        let height = I7F9::saturating_from_num(if height_m.is_nan() { 0.0 } else { height_m });
        let mean = i32::from(if count == 1 {
            height.to_bits()
        } else {
            I7F9::from_le_bytes(*stored).to_bits()
        });
        let off = i32::from(height.to_bits()) - mean;
        let n = i32::from(count);
        if off.abs() > OUTLIER_STEPS {
            *mark = *mark & !COUNT | count.saturating_sub(2).max(1);
            if count == 2 && off < 0 {
                *stored = height.to_le_bytes();
            }
            return;
        }
        // Rounded to nearest, so that a mean does not creep downwards.
        let mean = mean + (2 * off + n).div_euclid(2 * n);
        *stored = I7F9::from_bits(mean as i16).to_le_bytes();
        let standing = (*mark & SCORE).saturating_sub(SCORE_STEP) & SCORE;
        *mark = standing | count;
    }

    /// Something was met that stands in a cell.
    pub fn mark_obstacle(&mut self, cell: Cell) {
        self.discard_low_confidence(cell);
        if let Some(mark) = self.mark_mut(cell) {
            let standing = (*mark & SCORE).saturating_add(2 * SCORE_STEP);
            *mark = *mark & COUNT | standing.min(SCORE);
        }
    }

    /// The ground of a cell that was never measured was seen to be gone.
    pub fn mark_drop(&mut self, cell: Cell) {
        self.mark_unmeasured(cell, DROP, [0; 2]);
    }

    /// The ground of a cell that was never measured may be gone.
    pub fn mark_possible_drop(&mut self, cell: Cell) {
        if !self.read().is_drop(cell) {
            self.mark_unmeasured(cell, 0, POSSIBLE_DROP);
        }
    }

    /// Ground that was suspected to be gone is held to be.
    pub fn confirm_drop(&mut self, cell: Cell) {
        if !self.read().is_drop(cell) {
            self.mark_unmeasured(cell, DROP, POSSIBLE_DROP);
        }
    }

    /// Ground that lies beside what is gone, or was suspected in an attitude that errs, is held to be gone where the map knows of none.
    pub fn infer_drop(&mut self, cell: Cell) {
        if !self.read().is_drop(cell) {
            self.mark_unmeasured(cell, DROP, INFERRED_DROP);
        }
    }

    /// What is said of a cell where no ground was ever met.
    fn mark_unmeasured(&mut self, cell: Cell, mark: u8, stored: [u8; 2]) {
        if let Some(slot) = slot(*self.origin, cell)
            && let (Some(of_cell), Some(height)) =
                (self.marks.get_mut(slot), self.heights.get_mut(slot))
            && *of_cell & COUNT == 0
        {
            *of_cell |= mark;
            *height = stored;
        }
    }

    /// The robot stands on a cell.
    pub fn mark_wheel_contact(&mut self, cell: Cell, height_m: f32) {
        self.discard_low_confidence(cell);
        if let Some(mark) = self.mark_mut(cell) {
            *mark &= COUNT;
        }
        self.measure(cell, height_m);
    }
}

#[cfg(test)]
mod tests;
