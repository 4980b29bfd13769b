//! The elevation window: 64 × 64 cells around the robot, each with the running mean of the heights
//! measured in it \[Maffei20, III-B\].
//!
//! ```text
//! h ← h + (z − h) / n,    n = min(measurements so far, 15)
//! ```
//!
//! A height is an [`I7F9`]: ±64 m around the start in steps of 2 mm. Beside it lies a mark of one
//! byte: the count of measurements, the score of something that stands, and a bit for a drop. While
//! a cell is not measured, its stored height says how sure the drop is.
//!
//! Ground met from too far off to be measured has a height of *low confidence*: a mean of its own
//! kind. It denies a drop, and the first measured height replaces it.
//!
//! The window owns no memory. A session on uneven ground does not use the map's hit counts, and a
//! session on flat ground has no elevation window, so both share one memory. The map lends it.
//!
//! Invariant: a slot of the memory belongs to exactly one cell of the window (both coordinates
//! modulo 64), and a cell that enters the window is cleared.
//!
//! Units: map cells, metres above the start.

use fixed::types::I7F9;

use crate::config::GroundTuning;
use crate::geometry::Cell;
pub(super) use crate::ground::heights::GroundState;
use crate::ground::heights::{
    COUNT, DROP, INFERRED_DROP, POSSIBLE_DROP, SCORE, SCORE_POINT, Window, is_low_confidence, slot,
};
pub use crate::ground::heights::{Heights, WINDOW_CELLS, WINDOW_SIDE};

/// The elevation window, for writing.
#[derive(Debug)]
pub struct Elevation<'a> {
    heights: &'a mut [[u8; 2]],
    marks: &'a mut [u8],
    origin: &'a mut Cell,
    pub(super) tuning: &'a GroundTuning,
    /// `outlier_m` in steps of a height.
    outlier_steps: i32,
}

impl<'a> Elevation<'a> {
    /// Creates the window over memory for [`WINDOW_CELLS`] cells: two bytes of height and one mark
    /// each, all zeros at first. `origin` is the window's least cell.
    #[must_use]
    pub fn new(
        heights: &'a mut [u8],
        marks: &'a mut [u8],
        origin: &'a mut Cell,
        tuning: &'a GroundTuning,
    ) -> Self {
        let (heights, _) = heights.as_chunks_mut();
        Self {
            heights,
            marks,
            origin,
            tuning,
            outlier_steps: I7F9::saturating_from_num(tuning.outlier_m).to_bits().into(),
        }
    }

    /// Returns the window for reading.
    #[inline(always)]
    #[must_use]
    pub fn read(&self) -> Heights<'_> {
        Heights {
            heights: self.heights,
            marks: self.marks,
            origin: *self.origin,
        }
    }

    /// Moves the window so that `centre` is in its middle, and clears the cells that enter.
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

    /// Moves the window with its content by some cells along x and y.
    pub(crate) fn move_by(&mut self, [dx, dy]: [i32; 2]) {
        // Of each byte of a cell: the first one, and the distance to the next cell's.
        for [first, next] in [[0, 2], [1, 2]] {
            let heights = self.heights.as_flattened_mut();
            roll(heights, first, [next, next * SIDE], dx);
            roll(heights, first, [next * SIDE, next], dy);
        }
        roll(self.marks, 0, [1, SIDE], dx);
        roll(self.marks, 0, [SIDE, 1], dy);
        *self.origin = self.origin.offset(dx, dy);
    }

    fn mark_mut(&mut self, cell: Cell) -> Option<&mut u8> {
        self.marks.get_mut(slot(*self.origin, cell)?)
    }

    /// Returns the mark and the stored height of a cell of the window.
    fn stored_mut(&mut self, cell: Cell) -> Option<(&mut u8, &mut [u8; 2])> {
        let slot = slot(*self.origin, cell)?;
        self.marks.get_mut(slot).zip(self.heights.get_mut(slot))
    }

    fn clear(&mut self, cell: Cell) {
        if let Some((mark, stored)) = self.stored_mut(cell) {
            (*mark, *stored) = (0, [0; 2]);
        }
    }

    /// Adds a measured height to a cell's mean, metres; ignores cells outside the window.
    ///
    /// The cell is then no drop, and its obstacle score falls by one point. A height more than
    /// `outlier_m` off the mean may be a false return: the mean stays and its count falls, until
    /// the mean gives way. Of two first heights that differ so much, the lower one stays.
    pub fn measure(&mut self, cell: Cell, height_m: f32) {
        self.discard_low_confidence(cell);
        self.average(cell, height_m);
    }

    /// Adds a height of low confidence to the mean of a cell that was never measured, metres.
    pub(super) fn measure_low_confidence(&mut self, cell: Cell, height_m: f32) {
        if self.read().count(cell) > 0 {
            return;
        }
        self.average(cell, height_m);
        if let Some(mark) = self.mark_mut(cell) {
            *mark |= DROP;
        }
    }

    fn discard_low_confidence(&mut self, cell: Cell) {
        if let Some(mark) = self.mark_mut(cell)
            && is_low_confidence(*mark)
        {
            *mark &= SCORE;
        }
    }

    fn average(&mut self, cell: Cell, height_m: f32) {
        let outlier_steps = self.outlier_steps;
        let Some((mark, stored)) = self.stored_mut(cell) else {
            return;
        };
        let count = (*mark & COUNT).saturating_add(1).min(COUNT);
        let height = I7F9::saturating_from_num(if height_m.is_nan() { 0.0 } else { height_m });
        let mean = i32::from(if count == 1 {
            height.to_bits()
        } else {
            I7F9::from_le_bytes(*stored).to_bits()
        });
        let off = i32::from(height.to_bits()) - mean;
        let n = i32::from(count);
        if off.abs() > outlier_steps {
            *mark = *mark & !COUNT | count.saturating_sub(2).max(1);
            if count == 2 && off < 0 {
                *stored = height.to_le_bytes();
            }
            return;
        }
        // Rounded to nearest, so that the mean has no bias downwards.
        let mean = mean + (2 * off + n).div_euclid(2 * n);
        *stored = I7F9::from_bits(mean as i16).to_le_bytes();
        let score = (*mark & SCORE).saturating_sub(SCORE_POINT) & SCORE;
        *mark = score | count;
    }

    /// Marks a hit of something that stands in a cell. The second hit makes it an obstacle.
    pub(super) fn mark_obstacle(&mut self, cell: Cell) {
        self.discard_low_confidence(cell);
        let hit = self.tuning.hit_score * SCORE_POINT;
        if let Some(mark) = self.mark_mut(cell) {
            let score = (*mark & SCORE).saturating_add(hit);
            *mark = *mark & COUNT | score.min(SCORE);
        }
    }

    /// Marks a drop that a beam saw, in a cell that was never measured.
    pub(super) fn mark_drop(&mut self, cell: Cell) {
        self.mark_unmeasured(cell, DROP, [0; 2]);
    }

    /// Marks a possible drop, in a cell that was never measured. It may also be a slope.
    pub(super) fn mark_possible_drop(&mut self, cell: Cell) {
        if !self.read().is_drop(cell) {
            self.mark_unmeasured(cell, 0, POSSIBLE_DROP);
        }
    }

    /// Turns a possible drop into a drop.
    pub(super) fn confirm_drop(&mut self, cell: Cell) {
        if !self.read().is_drop(cell) {
            self.mark_unmeasured(cell, DROP, POSSIBLE_DROP);
        }
    }

    /// Infers a drop from the cells around, or from a possible drop of an uncertain attitude. It
    /// does not override ground that the map holds as free.
    pub(super) fn infer_drop(&mut self, cell: Cell) {
        if !self.read().is_drop(cell) {
            self.mark_unmeasured(cell, DROP, INFERRED_DROP);
        }
    }

    fn mark_unmeasured(&mut self, cell: Cell, bits: u8, height: [u8; 2]) {
        if let Some((mark, stored)) = self.stored_mut(cell)
            && *mark & COUNT == 0
        {
            *mark |= bits;
            *stored = height;
        }
    }

    /// Measures a cell that carries a wheel: it is ground, so nothing stands there and it is no
    /// drop.
    pub fn mark_wheel_contact(&mut self, cell: Cell, height_m: f32) {
        self.discard_low_confidence(cell);
        if let Some(mark) = self.mark_mut(cell) {
            *mark &= COUNT;
        }
        self.measure(cell, height_m);
    }
}

/// Cells along the window's side.
const SIDE: usize = WINDOW_SIDE as usize;

/// Moves the bytes of every line of a window by some places along the line, around its end.
/// `along` is the distance from one place of a line to the next, `across` from line to line.
///
/// It is called from four places, so it is not inlined.
#[inline(never)]
fn roll(bytes: &mut [u8], first: usize, [along, across]: [usize; 2], by: i32) {
    for line in 0..SIDE {
        let mut old = [0; SIDE];
        let place = |k: usize| first + line * across + k * along;
        for (k, old) in old.iter_mut().enumerate() {
            *old = bytes.get(place(k)).copied().unwrap_or(0);
        }
        for (k, old) in (by..).zip(old) {
            let to = (k & (WINDOW_SIDE - 1)) as usize;
            if let Some(byte) = bytes.get_mut(place(to)) {
                *byte = old;
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
