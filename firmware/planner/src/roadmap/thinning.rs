//! Guo–Hall thinning, 32 cells at a time, in place and in instalments [GuoHall89].
//!
//! All cells of a subiteration are judged before any is deleted. North is towards row 0, so a plane is seen as an
//! image with row 0 on top; `opencv_contrib`'s `THINNING_GUOHALL` does too, and gives the same bits. The two
//! subiterations of the rule alternate until two in a row delete nothing.
//!
//! Only words that may change are looked at: a word can delete only if a cell of it or next to it changed in one of the
//! last two subiterations. Two bits a word, one for each subiteration, say where its last pass changed a cell of the
//! word or one that touches the word from the left or the right; the rows above and below follow by a shift. The older
//! bit has then served and gives its place to the new one, so nothing else is kept.
//!
//! Deletions wait until no word reads the old values any more. Such readers are at most a row and a word ahead, that is
//! 32 words, so what a group of 32 words loses is deleted when the next group but one begins.

use crate::grid::{PlaneMut, Region, Shape, ShapeError};
use crate::roadmap::Progress;
use crate::roadmap::thinning_rule::Patch;

/// Words of marks that a [`Thinning`] needs for a plane of this many words.
#[must_use]
pub const fn marks_for(words: usize) -> usize {
    words.div_ceil(32)
}

/// The state of a thinning; `M` is at least [`marks_for`] the region's words.
///
/// The region's words are counted row by row; 32 of them share a word of marks and are a *group*.
///
/// Invariant between two calls: the words before the present one have been judged, and what they lose is deleted from
/// the plane or waits.
#[derive(Clone, Debug)]
pub struct Thinning<const M: usize> {
    shape: Shape,
    patch: Patch,
    /// Per subiteration: the words touched by its last pass; the groups behind the present pass, by this one.
    marks: [[u32; M]; 2],
    /// Which of the two subiterations is on.
    second: bool,
    window: Window,
    /// Words of the present group still to be looked at.
    todo: u32,
    /// Whether the present group may be touched: it has words to look at, or the next field holds.
    active: bool,
    /// The first word of the present group is touched by the last one of the group before.
    touched_from_before: bool,
    /// What the present group and the one before it lose, by the lowest bit of the group.
    losses: [Losses; 2],
    /// Whether the present pass deleted anything, and whether the one before it did not.
    deleted: bool,
    quiet_before: bool,
    passes: u16,
    running: bool,
}

/// What the words of a group lose, before it is deleted.
#[derive(Clone, Copy, Debug)]
struct Losses {
    /// The words that lose cells.
    words: u32,
    /// Those that lose their first cell, and those that lose their last one: the words beside are touched.
    first_cells: u32,
    last_cells: u32,
    /// The cells lost by each word.
    cells: [u32; 32],
}

/// A sliding view of the marks of both subiterations, as they were before the present pass.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    /// The next group.
    group: usize,
    /// The marks of the group before it, and its own.
    before: u32,
    here: u32,
}

impl<const M: usize> Thinning<M> {
    /// A thinning with nothing to do.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            shape: Shape::UNIT,
            patch: Patch::NONE,
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

    /// Begin to thin `region` of a plane of this shape, as if nothing lay outside it. No other word is touched.
    ///
    /// # Errors
    /// When `M` marks are too few for the region.
    pub fn start(&mut self, shape: Shape, region: Region) -> Result<(), ShapeError> {
        let region = region.within(shape);
        if marks_for(region.size()) > M {
            return Err(ShapeError::TooLarge {
                needs: region.size(),
                has: M * 32,
            });
        }
        (self.shape, self.patch) = (shape, Patch::new(shape, region));
        self.losses.iter_mut().for_each(Losses::clear);
        (self.second, self.todo) = (false, 0);
        (self.deleted, self.quiet_before) = (false, false);
        (self.passes, self.running) = (0, region.size() != 0);
        for marks in &mut self.marks {
            for (group, mark) in marks.iter_mut().enumerate() {
                *mark = words_of_group(region.size(), group);
            }
        }
        self.begin_pass();
        Ok(())
    }

    /// Subiterations finished since the start.
    #[must_use]
    pub const fn passes(&self) -> u16 {
        self.passes
    }

    /// Whether the plane holds its skeleton.
    #[must_use]
    pub const fn is_done(&self) -> bool {
        !self.running
    }

    /// Go on with at most `budget` units of work, on the plane that was started with and not written since. Cells set in
    /// `anchors`, words as in the plane, are never deleted; an empty slice holds none.
    ///
    /// A unit is a word looked at, or a group of 32 words gone through. The result does not depend on how the work is
    /// divided into budgets.
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

    /// One subiteration, as far as the budget lasts; whether it is through.
    fn pass<const SECOND: bool>(
        &mut self,
        words: &mut [u32],
        anchors: &[u32],
        left: &mut u32,
    ) -> bool {
        loop {
            if self.todo != 0 {
                *left = self.look::<SECOND>(words, anchors, *left);
                if self.todo != 0 {
                    return false;
                }
            }
            if self.window.group == marks_for(self.patch.size()) {
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

    /// Look at the words of the present group, as far as the budget lasts; what is left of it.
    #[inline(never)]
    fn look<const SECOND: bool>(&mut self, words: &[u32], anchors: &[u32], mut left: u32) -> u32 {
        let group = self.window.group - 1;
        let losses = of_group(&mut self.losses, group);
        let mut todo = self.todo;
        while todo != 0 && left != 0 {
            left -= 1;
            let k = todo.trailing_zeros();
            todo &= todo - 1;
            let place = group as u32 * 32 + k;
            let mut lost = self.patch.deletions::<SECOND>(words, place);
            if lost != 0 {
                lost &= !anchors.get(self.patch.index(place)).copied().unwrap_or(0);
            }
            if lost != 0 {
                losses.add(k, lost);
            }
        }
        self.todo = todo;
        left
    }

    /// Take the next group's words to be looked at.
    fn next_group(&mut self, words: &mut [u32]) {
        if self.active {
            self.note_touched();
        }
        let group = self.window.group;
        if of_group(&mut self.losses, group).words != 0 {
            self.delete(group - 2, words);
        }
        let look = self.window.slide(&self.marks, self.patch.words_per_row());
        self.active = look != 0 || self.touched_from_before;
        if look != 0 {
            self.todo = look & words_of_group(self.patch.size(), group);
        }
    }

    /// Delete what the words of a group lose, one of the last two.
    fn delete(&mut self, group: usize, words: &mut [u32]) {
        let losses = of_group(&mut self.losses, group);
        let mut todo = losses.words;
        losses.clear();
        while todo != 0 {
            let k = todo.trailing_zeros();
            todo &= todo - 1;
            let index = self.patch.index(group as u32 * 32 + k);
            if let (Some(word), Some(lost)) = (words.get_mut(index), losses.cells.get(k as usize)) {
                *word &= !lost;
            }
        }
    }

    /// Mark what the present group's words touched.
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

    /// Nothing is lost.
    fn clear(&mut self) {
        (self.words, self.first_cells, self.last_cells) = (0, 0, 0);
    }

    /// Word `k` of the group loses these cells.
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
    /// The words of the next group that are marked, or lie under or over a marked word; the group is then behind.
    ///
    /// Rows of the region are `per_row` bits apart, at most 31.
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

/// A bit for each word of the group in a region of `size` words.
fn words_of_group(size: usize, group: usize) -> u32 {
    match size.saturating_sub(group * 32) {
        0 => 0,
        words @ 1..32 => u32::MAX >> (32 - words),
        _ => u32::MAX,
    }
}

/// The losses of a group, one of the last two.
fn of_group([even, odd]: &mut [Losses; 2], group: usize) -> &mut Losses {
    if group.is_multiple_of(2) { even } else { odd }
}

/// The marks of both subiterations.
fn either<const M: usize>(marks: &[[u32; M]; 2], group: usize) -> u32 {
    let [first, second] = marks;
    first.get(group).copied().unwrap_or(0) | second.get(group).copied().unwrap_or(0)
}
