//! Read access to the elevation window, and the layout of what it stores for a cell.
//!
//! A cell has a stored height of two bytes and a mark of one byte:
//!
//! | bits of the mark | what they hold |
//! | --- | --- |
//! | 0 to 3, [`COUNT`] | measurements in the mean height, 0 to 15 |
//! | 4 to 6, [`SCORE`] | score of something that stands, 0 to 7 points |
//! | 7, [`DROP`] | without a count: a drop; with a count: the height has low confidence |
//!
//! The stored height is the mean, an [`I7F9`], if the count is not 0. Without a count it is 0,
//! [`POSSIBLE_DROP`] or [`INFERRED_DROP`]. [`super::elevation`] writes all of it.
//!
//! Units: map cells, metres above the start.

use fixed::types::I7F9;

use crate::config::GroundTuning;
use crate::geometry::{CELL_M, Cell, Pose};
use crate::grid::{Rolling, at};
use crate::ground::ray::Attitude;
use crate::math;

/// Cells along the window's side.
pub const WINDOW_SIDE: i32 = 64;
/// Cells of the window.
pub const WINDOW_CELLS: usize = (WINDOW_SIDE * WINDOW_SIDE) as usize;
/// The geometry of the window.
pub(super) type Window = Rolling<WINDOW_SIDE, 1>;
/// Bits of a mark that count measurements.
pub(super) const COUNT: u8 = 0x0f;
/// Bits of a mark that hold the score of something that stands.
pub(super) const SCORE: u8 = 0x70;
/// One point of the score.
pub(super) const SCORE_POINT: u8 = 0x10;
/// Bit of a mark: the ground is gone, or the height has low confidence.
pub(super) const DROP: u8 = 0x80;
/// Stored height of a possible drop, and of a drop confirmed from one. It is no mean.
pub(super) const POSSIBLE_DROP: [u8; 2] = [1, 0];
/// Stored height of a drop inferred from its surroundings. It is no mean.
pub(super) const INFERRED_DROP: [u8; 2] = [2, 0];

/// The state of a cell's ground where something is known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum GroundState {
    /// Measured: its mean height, metres.
    Measured(f32),
    /// Never measured; a drop was inferred there, but no beam saw it.
    Uncertain,
    /// A beam saw a drop, or something stands there.
    Blocked,
}

/// The elevation window, for reading.
#[derive(Clone, Copy, Debug)]
pub struct Heights<'a> {
    pub(super) heights: &'a [[u8; 2]],
    pub(super) marks: &'a [u8],
    /// The cell with the least coordinates.
    pub(super) origin: Cell,
}

/// Words of four marks in a row of the window.
const ROW_WORDS: u32 = WINDOW_SIDE as u32 / 4;
/// The counts of four marks.
const COUNTS: u32 = u32::from_le_bytes([COUNT; 4]);
/// The highest bits of four bytes.
const TOPS: u32 = u32::from_le_bytes([0x80; 4]);

/// What a row of the window holds, one bit a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct MarkRows {
    /// Cells with a mark of any kind.
    pub(super) marked: u64,
    /// Cells with a mean height.
    pub(super) measured: u64,
}

/// All rows of the window, from the least on.
pub(crate) type WindowRows = [MarkRows; WINDOW_SIDE as usize];

/// Returns the highest bit of each byte that is not 0.
#[inline(always)]
const fn nonzero_bytes(word: u32) -> u32 {
    (((word & !TOPS) + !TOPS) | word) & TOPS
}

/// Returns the highest bits of four bytes, side by side.
#[inline(always)]
const fn top_bits(tops: u32) -> u32 {
    // The product moves each of the four bits to its place in the highest byte.
    ((tops & TOPS) >> 7).wrapping_mul(0x0102_0408) >> 24
}

/// Returns true if the mark's height has low confidence.
#[inline(always)]
pub(super) const fn is_low_confidence(mark: u8) -> bool {
    mark & DROP != 0 && mark & COUNT != 0
}

/// Returns true if the mark says that the ground is gone.
#[inline(always)]
const fn is_drop(mark: u8) -> bool {
    mark & (COUNT | DROP) == DROP
}

/// Returns true if the mark has the score of an obstacle.
#[inline(always)]
const fn is_obstacle(mark: u8, tuning: &GroundTuning) -> bool {
    mark & SCORE >= tuning.obstacle_score * SCORE_POINT
}

/// Returns the number of measurements in a mark, without those of low confidence.
#[inline(always)]
const fn count(mark: u8) -> u8 {
    if is_low_confidence(mark) {
        0
    } else {
        mark & COUNT
    }
}

/// Returns true if [`count`] is not 0, in one comparison.
#[inline(always)]
const fn is_measured(mark: u8) -> bool {
    (mark & (COUNT | DROP)).wrapping_sub(1) < COUNT
}

/// Returns the storage index of a cell of the window at `origin`; `None` outside the window.
#[inline(always)]
pub(super) const fn slot(origin: Cell, cell: Cell) -> Option<usize> {
    if Window::covers(origin, cell) {
        Some(Window::slot(cell))
    } else {
        None
    }
}

impl<'a> Heights<'a> {
    /// Creates a view of the window whose least cell is `origin`, over memory for [`WINDOW_CELLS`]
    /// cells: two bytes of height and one mark each. Cells that the memory does not hold were never
    /// measured.
    #[must_use]
    pub fn new(heights: &'a [u8], marks: &'a [u8], origin: Cell) -> Self {
        let (heights, _) = heights.as_chunks();
        Self {
            heights,
            marks,
            origin,
        }
    }

    /// The cell of the window with the least coordinates.
    #[must_use]
    pub const fn origin(&self) -> Cell {
        self.origin
    }

    #[inline(always)]
    fn mark_at(&self, slot: usize) -> u8 {
        at(self.marks, slot)
    }

    /// Returns the mark of a cell; 0 outside the window.
    #[inline(always)]
    pub(super) fn mark(&self, cell: Cell) -> u8 {
        slot(self.origin, cell).map_or(0, |slot| self.mark_at(slot))
    }

    /// Returns the mark and the stored height of a cell of the window.
    #[inline(always)]
    fn stored(&self, cell: Cell) -> Option<(u8, [u8; 2])> {
        let slot = slot(self.origin, cell)?;
        Some((self.mark_at(slot), *self.heights.get(slot)?))
    }

    /// Returns the cells of row `y` that have a mark, and those that are measured; none outside the
    /// window. Bit k is column `origin.x + k`.
    pub(super) fn rows(&self, y: i32) -> MarkRows {
        let least = Cell { y, ..self.origin };
        let from =
            slot(self.origin, least).map_or(WINDOW_CELLS, |_| Window::slot(Cell { x: 0, y }));
        let marks = self.marks.get(from..).unwrap_or_default();
        let (words, _) = marks.as_chunks::<4>();
        let (mut marked, mut measured) = (0, 0);
        for (&word, k) in words.iter().zip(0..ROW_WORDS) {
            let word = u32::from_le_bytes(word);
            let counts = nonzero_bytes(word & COUNTS) & !word;
            marked |= u64::from(top_bits(nonzero_bytes(word))) << (4 * k);
            measured |= u64::from(top_bits(counts)) << (4 * k);
        }
        let turn = (self.origin.x & (WINDOW_SIDE - 1)) as u32;
        MarkRows {
            marked: marked.rotate_right(turn),
            measured: measured.rotate_right(turn),
        }
    }

    /// Returns all rows of the window.
    pub(crate) fn all_rows(&self) -> WindowRows {
        core::array::from_fn(|k| self.rows(self.origin.y + k as i32))
    }

    /// Returns the mean height of a cell; `None` if it was never measured.
    #[inline(always)]
    pub(super) fn fixed(&self, cell: Cell) -> Option<I7F9> {
        let slot = slot(self.origin, cell)?;
        if !is_measured(self.mark_at(slot)) {
            return None;
        }
        Some(I7F9::from_le_bytes(*self.heights.get(slot)?))
    }

    /// Returns the mean height of a cell, metres; `None` if it was never measured.
    #[inline(always)]
    #[must_use]
    pub fn height_m(&self, cell: Cell) -> Option<f32> {
        self.fixed(cell).map(metres)
    }

    /// Returns how far the measured ground lies over the robot's plane in the mean, within a
    /// distance from the robot, metres; `None` if no cell there was measured twice.
    pub(crate) fn mean_over_plane_m(&self, pose: &Pose, reach_m: f32) -> Option<f32> {
        let attitude = Attitude::of(pose);
        let (robot, reach) = (pose.point(), math::floor(reach_m / CELL_M) + 1);
        let middle = robot.cell();
        let (mut sum_m, mut count) = (0.0, 0_u16);
        for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
            let cell = middle.offset(dx, dy);
            let centre = cell.centre();
            if centre.distance2(robot) > reach_m * reach_m || self.count(cell) < 2 {
                continue;
            }
            if let Some(height_m) = self.height_m(cell) {
                sum_m += height_m - attitude.plane_m(centre);
                count += 1;
            }
        }
        (count > 0).then(|| sum_m / f32::from(count))
    }

    /// Returns the mean height of a cell that was met only with low confidence, metres.
    pub(crate) fn low_confidence_m(&self, cell: Cell) -> Option<f32> {
        let (_, height) = self
            .stored(cell)
            .filter(|&(mark, _)| is_low_confidence(mark))?;
        Some(metres(I7F9::from_le_bytes(height)))
    }

    /// Returns the state of a cell's ground; `None` if nothing is known of it.
    #[inline(always)]
    pub(super) fn ground_state(&self, cell: Cell, tuning: &GroundTuning) -> Option<GroundState> {
        let (mark, stored) = self.stored(cell).filter(|&(mark, _)| mark != 0)?;
        if is_obstacle(mark, tuning) {
            Some(GroundState::Blocked)
        } else if is_drop(mark) {
            Some(if stored == POSSIBLE_DROP || stored == INFERRED_DROP {
                GroundState::Uncertain
            } else {
                GroundState::Blocked
            })
        } else {
            (count(mark) > 0).then(|| GroundState::Measured(metres(I7F9::from_le_bytes(stored))))
        }
    }

    /// Returns the number of measurements in a cell's mean, at most 15.
    pub(super) fn count(&self, cell: Cell) -> u8 {
        count(self.mark(cell))
    }

    /// Returns true if something stands in a cell.
    pub(super) fn is_obstacle(&self, cell: Cell, tuning: &GroundTuning) -> bool {
        is_obstacle(self.mark(cell), tuning)
    }

    /// Returns true if the ground of a cell is gone: seen, confirmed or inferred.
    pub(super) fn is_drop(&self, cell: Cell) -> bool {
        is_drop(self.mark(cell))
    }

    /// Returns true if a cell of the window has no mark at all, and at least one of its eight
    /// neighbours is a drop and at least one is measured.
    pub(super) fn is_on_rim(&self, cell: Cell) -> bool {
        let mut neighbours = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| cell.offset(dx, dy)));
        slot(self.origin, cell).is_some_and(|slot| self.mark_at(slot) == 0)
            && neighbours.clone().any(|near| self.is_drop(near))
            && neighbours.any(|near| self.count(near) > 0)
    }

    /// Returns true if the drop of a cell is only inferred, see
    /// [`Elevation::infer_drop`](super::Elevation::infer_drop).
    pub(super) fn is_inferred_drop(&self, cell: Cell) -> bool {
        self.stored(cell)
            .is_some_and(|(mark, stored)| is_drop(mark) && stored == INFERRED_DROP)
    }

    /// Returns true if a cell was never measured and a beam suggests that its ground is gone, and
    /// no drop is marked there yet.
    pub(super) fn is_possible_drop(&self, cell: Cell) -> bool {
        self.stored(cell)
            .is_some_and(|(mark, stored)| mark & (COUNT | DROP) == 0 && stored == POSSIBLE_DROP)
    }
}

/// Converts a height to metres.
#[inline(always)]
fn metres(height: I7F9) -> f32 {
    const STEP_M: f32 = 1.0 / (1 << I7F9::FRAC_NBITS) as f32;
    f32::from(height.to_bits()) * STEP_M
}
