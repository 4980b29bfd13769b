//! Guo–Hall thinning, 32 cells at a time, in place and in instalments \[GuoHall89\].
//!
//! A subiteration judges all cells before it deletes any. North is towards row 0, as in an image
//! with row 0 on top; `THINNING_GUOHALL` of `opencv_contrib` does the same and gives the same bits.
//! The two subiterations of the rule alternate until two in a row delete nothing.
//!
//! A pass looks only at words that may change: a word can lose a cell only if a cell of it or next
//! to it changed in one of the last two subiterations. Two bits a word, one for each subiteration,
//! say if its last pass changed a cell of the word, or one that touches the word from the left or
//! the right; the rows above and below follow by a shift. The older bit has then served, and the
//! new one takes its place, so nothing else is kept.
//!
//! Deletions wait until no word reads the old values any more. Such readers are at most a row and a
//! word ahead, that is 32 words. So a pass deletes the cells of a group of 32 words when the next
//! group but one begins.
//!
//! Units: words of the plane, counted row by row.

use crate::grid::{PlaneMut, Shape, ShapeError, at, inside_mut, masked};
use crate::roadmap::Progress;
use crate::roadmap::thinning_rule::deletions;

/// Returns the words of marks that a [`Thinning`] needs for a plane of this many words.
#[must_use]
pub const fn marks_for(words: usize) -> usize {
    words.div_ceil(32)
}

/// The state of a thinning; `M` is at least [`marks_for`] the plane's words.
///
/// 32 words of the plane share a word of marks and are a *group*.
///
/// Invariant between two calls: the words before the present one are judged, and the cells that
/// they lose are deleted from the plane or wait.
#[derive(Clone, Debug)]
pub struct Thinning<const M: usize> {
    shape: Shape,
    /// Per subiteration, the words that its last pass touched; for the groups behind the present
    /// pass, those that this one touched.
    marks: [[u32; M]; 2],
    /// The second subiteration is on.
    second: bool,
    window: Window,
    /// Words of the present group that are still to be judged.
    todo: u32,
    /// The present group may be touched: it has words to judge, or the next field is true.
    active: bool,
    /// The last word of the group before touched the first one of the present group.
    touched_from_before: bool,
    /// The losses of the present group and of the one before it, by the lowest bit of the group.
    losses: [Losses; 2],
    /// The present pass deleted something, and the one before it nothing.
    deleted: bool,
    quiet_before: bool,
    passes: u16,
    running: bool,
}

/// The cells that the words of a group lose, before they are deleted.
#[derive(Clone, Copy, Debug)]
struct Losses {
    /// The words that lose cells.
    words: u32,
    /// Those that lose their first cell, and those that lose their last one: they touch the words
    /// beside.
    first_cells: u32,
    last_cells: u32,
    /// The cells lost by each word.
    cells: [u32; 32],
}

/// A sliding window on the marks of both subiterations, as they were before the present pass.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    /// The next group.
    group: usize,
    /// The marks of the group before it, and its own.
    before: u32,
    here: u32,
}

impl<const M: usize> Thinning<M> {
    /// Makes a thinning with nothing to do.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            shape: Shape::UNIT,
            marks: [[0; M]; 2],
            second: false,
            window: Window {
                group: 0,
                before: 0,
                here: 0,
            },
            todo: 0,
            active: false,
            touched_from_before: false,
            losses: [Losses::NONE; 2],
            deleted: false,
            quiet_before: false,
            passes: 0,
            running: false,
        }
    }

    /// Starts to thin a plane of this shape.
    ///
    /// # Errors
    /// If `M` words of marks are too few for the plane.
    pub fn start(&mut self, shape: Shape) -> Result<(), ShapeError> {
        let needs = shape.words();
        if marks_for(needs) > M {
            return Err(ShapeError::TooLarge { needs, has: M * 32 });
        }
        self.shape = shape;
        self.losses.iter_mut().for_each(Losses::clear);
        (self.second, self.todo) = (false, 0);
        (self.deleted, self.quiet_before) = (false, false);
        (self.passes, self.running) = (0, true);
        for marks in &mut self.marks {
            for (group, mark) in marks.iter_mut().enumerate() {
                *mark = words_of_group(needs, group);
            }
        }
        self.begin_pass();
        Ok(())
    }

    /// Returns the number of subiterations since the start.
    #[must_use]
    pub const fn passes(&self) -> u16 {
        self.passes
    }

    /// Continues with at most `budget` units of work, on the plane that it was started with and
    /// that nobody wrote to since. `anchors` has words as the plane; its cells are never deleted.
    /// An empty slice has none.
    ///
    /// A unit is a word judged, or a group of 32 words passed. The result does not depend on how
    /// the work is divided into budgets.
    pub fn advance(&mut self, plane: &mut PlaneMut<'_>, anchors: &[u32], budget: u32) -> Progress {
        debug_assert_eq!(plane.shape(), self.shape, "another plane than at the start");
        let words = plane.words_mut();
        let mut left = budget;
        while self.running {
            let through = if self.second {
                self.pass::<true>(words, anchors, &mut left)
            } else {
                self.pass::<false>(words, anchors, &mut left)
            };
            if !through {
                return Progress::Pending;
            }
        }
        Progress::Done { left }
    }

    /// Runs a subiteration as far as the budget lasts. Returns true at its end.
    fn pass<const SECOND: bool>(
        &mut self,
        words: &mut [u32],
        anchors: &[u32],
        left: &mut u32,
    ) -> bool {
        loop {
            if self.todo != 0 {
                *left = self.judge::<SECOND>(words, anchors, *left);
                if self.todo != 0 {
                    return false;
                }
            }
            if self.window.group == marks_for(self.shape.words()) {
                break;
            }
            if *left == 0 {
                return false;
            }
            *left -= 1;
            self.next_group(words);
        }
        self.end_pass(words);
        true
    }

    /// Judges the words of the present group as far as the budget lasts. Returns what is left of
    /// it.
    #[inline(never)]
    fn judge<const SECOND: bool>(&mut self, words: &[u32], anchors: &[u32], mut left: u32) -> u32 {
        let group = self.window.group - 1;
        let losses = of_group(&mut self.losses, group);
        let mut todo = self.todo;
        while todo != 0 && left != 0 {
            left -= 1;
            let k = todo.trailing_zeros();
            todo &= todo - 1;
            let index = group as u32 * 32 + k;
            let mut lost = deletions::<SECOND>(self.shape, words, index);
            if lost != 0 {
                lost &= !at(anchors, index as usize);
            }
            if lost != 0 {
                losses.add(k, lost);
            }
        }
        self.todo = todo;
        left
    }

    /// Goes on to the next group's words.
    fn next_group(&mut self, words: &mut [u32]) {
        if self.active {
            self.note_touched();
        }
        let group = self.window.group;
        if of_group(&mut self.losses, group).words != 0 {
            self.delete(group - 2, words);
        }
        let look = self
            .window
            .slide(&self.marks, self.shape.words_per_row() as u32);
        self.active = look != 0 || self.touched_from_before;
        if look != 0 {
            self.todo = look & words_of_group(self.shape.words(), group);
        }
    }

    /// Deletes the cells that the words of a group lose, one of the last two.
    fn delete(&mut self, group: usize, words: &mut [u32]) {
        let losses = of_group(&mut self.losses, group);
        let mut todo = losses.words;
        losses.clear();
        while todo != 0 {
            let k = todo.trailing_zeros();
            todo &= todo - 1;
            let k = k as usize;
            if let Some(word) = inside_mut(words, group * 32 + k) {
                *word &= !*masked(&losses.cells, k);
            }
        }
    }

    /// Marks the words that the present group's losses touch.
    fn note_touched(&mut self) {
        let Some(group) = self.window.group.checked_sub(1) else {
            return;
        };
        let losses = of_group(&mut self.losses, group);
        let before = u32::from(self.touched_from_before);
        let touched = losses.words | (losses.first_cells >> 1 | losses.last_cells << 1) | before;
        let [first, second] = &mut self.marks;
        let marks = if self.second { second } else { first };
        if let Some(mark) = marks.get_mut(group) {
            *mark = touched;
        }
        if losses.first_cells & 1 != 0
            && let Some(mark) = marks.get_mut(group.wrapping_sub(1))
        {
            *mark |= 1 << 31;
        }
        self.touched_from_before = losses.last_cells >> 31 != 0;
        self.deleted |= losses.words != 0;
    }

    fn begin_pass(&mut self) {
        self.window = Window {
            group: 0,
            before: 0,
            here: either(&self.marks, 0),
        };
        (self.active, self.touched_from_before) = (false, false);
    }

    fn end_pass(&mut self, words: &mut [u32]) {
        self.note_touched();
        let groups = self.window.group;
        self.delete(groups.saturating_sub(2), words);
        self.delete(groups.saturating_sub(1), words);
        self.passes = self.passes.saturating_add(1);
        self.running = self.deleted || !self.quiet_before;
        self.quiet_before = !core::mem::take(&mut self.deleted);
        self.second = !self.second;
        self.begin_pass();
    }
}

impl<const M: usize> Default for Thinning<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl Losses {
    const NONE: Self = Self {
        words: 0,
        first_cells: 0,
        last_cells: 0,
        cells: [0; 32],
    };

    /// Clears the losses.
    fn clear(&mut self) {
        (self.words, self.first_cells, self.last_cells) = (0, 0, 0);
    }

    /// Adds the cells that word `k` of the group loses.
    #[inline(always)]
    fn add(&mut self, k: u32, lost: u32) {
        self.words |= 1 << k;
        self.first_cells |= (lost & 1) << k;
        self.last_cells |= lost >> 31 << k;
        if let Some(cells) = self.cells.get_mut(k as usize) {
            *cells = lost;
        }
    }
}

impl Window {
    /// Returns the words of the next group that are marked, or lie under or over a marked word, and
    /// slides past the group. `per_row` is at most 31.
    fn slide<const M: usize>(&mut self, marks: &[[u32; M]; 2], per_row: u32) -> u32 {
        let Self {
            group,
            before,
            here,
        } = *self;
        let after = either(marks, group + 1);
        let above = here << per_row | before >> (32 - per_row);
        let below = here >> per_row | after << (32 - per_row);
        *self = Self {
            group: group + 1,
            before: here,
            here: after,
        };
        here | above | below
    }
}

/// Returns a bit for each word of the group in a plane of `size` words.
fn words_of_group(size: usize, group: usize) -> u32 {
    match size.saturating_sub(group * 32) {
        0 => 0,
        words @ 1..32 => u32::MAX >> (32 - words),
        _ => u32::MAX,
    }
}

/// Returns the losses of a group, one of the last two.
fn of_group([even, odd]: &mut [Losses; 2], group: usize) -> &mut Losses {
    if group.is_multiple_of(2) { even } else { odd }
}

/// Returns the marks of both subiterations.
fn either<const M: usize>(marks: &[[u32; M]; 2], group: usize) -> u32 {
    let [first, second] = marks;
    at(first, group) | at(second, group)
}
