//! Guo–Hall thinning, 32 cells at a time, in place and in instalments [Guo & Hall 1989].
//!
//! All cells of a subiteration are judged before any is deleted. North is towards row 0, so a plane is seen as an
//! image with row 0 on top; `opencv_contrib`'s `THINNING_GUOHALL` does too, and gives the same bits. The two subiterations
//! of the rule alternate until two in a row delete nothing.
//!
//! Only words that may change are looked at: a word can delete only if a word of its 3 × 3 block changed in one of the
//! last two subiterations. Two bits a word hold that. At the start of a subiteration's group of 32 words the older
//! bit, no longer needed, becomes "to be looked at"; a word that deletes nothing drops it, and what remains is the
//! new "changed". Deletions wait one row, because the row below still reads the old values.

use super::Progress;
use super::rule::{Edges, deletions_at};
use crate::grid::{MAX_WORDS_PER_ROW, PlaneMut, Region, Shape, ShapeError, at};

/// Words of marks that a [`Thinning`] needs for a plane of this many words.
#[must_use]
pub const fn marks_for(words: usize) -> usize {
    words.div_ceil(32)
}

/// The state of a thinning; `M` is at least [`marks_for`] the region's words.
///
/// Invariant between two calls: the deletions found in rows `row − 1` and `row` and not yet made are in `waiting`;
/// every deletion of an earlier row is made.
#[derive(Clone, Debug)]
pub struct Thinning<const M: usize> {
    shape: Shape,
    region: Region,
    /// Per subiteration: words that changed in its last pass, or are to be looked at in the present one.
    marks: [[u32; M]; 2],
    /// Which of the two subiterations is on.
    second: bool,
    window: MarkWindow,
    /// Words of the present group still to be looked at.
    todo: u32,
    row: usize,
    waiting: [Row; 2],
    /// Whether the present pass, and the one before, deleted anything.
    deleted: [bool; 2],
    passes: u16,
    done: bool,
}

/// Deletions found in a row.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Words with deletions, by word of the region.
    words: u32,
    deletions: [u32; MAX_WORDS_PER_ROW],
}

/// A sliding view of the marks: those of the next group, grown by a word to each side, with its two neighbours.
#[derive(Clone, Copy, Debug, Default)]
struct MarkWindow {
    /// The next group.
    group: usize,
    /// Either subiteration's marks in the next group and the one after, as they were.
    either: [u32; 2],
    /// The grown marks in the group before the next, and in the next.
    grown: [u32; 2],
}

impl<const M: usize> Thinning<M> {
    /// A thinning with nothing to do.
    #[must_use]
    pub const fn new() -> Self {
        let shape = Shape::UNIT;
        let empty = Row {
            words: 0,
            deletions: [0; MAX_WORDS_PER_ROW],
        };
        Self {
            shape,
            region: shape.whole(),
            marks: [[0; M]; 2],
            second: false,
            window: MarkWindow {
                group: 0,
                either: [0; 2],
                grown: [0; 2],
            },
            todo: 0,
            row: 0,
            waiting: [empty; 2],
            deleted: [false; 2],
            passes: 0,
            done: true,
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
        *self = Self {
            shape,
            region,
            done: region.size() == 0,
            deleted: [false, true],
            ..Self::new()
        };
        for marks in &mut self.marks {
            for (group, mark) in marks.iter_mut().enumerate() {
                *mark = words_of_group(region, group);
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
        self.done
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
        while !self.done {
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
        let groups = marks_for(self.region.size());
        loop {
            if !self.look::<SECOND>(words, anchors, left) {
                return false;
            }
            if self.window.group == groups {
                break;
            }
            if *left == 0 {
                return false;
            }
            *left -= 1;
            self.next_group();
        }
        self.end_pass(words);
        true
    }

    /// Look at the words of the present group; whether all were looked at.
    fn look<const SECOND: bool>(
        &mut self,
        words: &mut [u32],
        anchors: &[u32],
        left: &mut u32,
    ) -> bool {
        let mut todo = self.todo;
        if todo == 0 {
            return true;
        }
        let group = self.window.group.wrapping_sub(1);
        let (per_row, rows) = (
            usize::from(self.region.words),
            usize::from(self.region.rows),
        );
        let mut idle = 0;
        while todo != 0 && *left != 0 {
            *left -= 1;
            let bit = todo & todo.wrapping_neg();
            todo ^= bit;
            let place = group * 32 + bit.trailing_zeros() as usize;
            let (row, word) = (place / per_row, place % per_row);
            if row != self.row {
                self.turn_to(row, words);
            }
            let edges = Edges {
                top: row == 0,
                bottom: row + 1 == rows,
                left: word == 0,
                right: word + 1 == per_row,
            };
            let index = self.index(row, word);
            let deletions = deletions_at::<SECOND>(words, index, self.shape.words_per_row(), edges)
                & !at(anchors, index);
            if deletions == 0 {
                idle |= bit;
            } else {
                self.wait(row, word, deletions);
            }
        }
        if let Some(mark) = self.mark(group) {
            *mark &= !idle;
        }
        self.todo = todo;
        todo == 0
    }

    fn index(&self, row: usize, word: usize) -> usize {
        let (first_row, first_word) = (self.region.first_row, self.region.first_word);
        (usize::from(first_row) + row) * self.shape.words_per_row() + usize::from(first_word) + word
    }

    fn wait(&mut self, row: usize, word: usize, deletions: u32) {
        let Some(slot) = self.waiting.get_mut(row & 1) else {
            return;
        };
        if let Some(out) = slot.deletions.get_mut(word) {
            *out = deletions;
            slot.words |= 1 << word;
        }
    }

    /// Make the deletions that no row from `row` on reads any more.
    fn turn_to(&mut self, row: usize, words: &mut [u32]) {
        self.delete(self.row.wrapping_sub(1), words);
        if row != self.row + 1 {
            self.delete(self.row, words);
        }
        self.row = row;
    }

    /// Make the deletions that wait in a row.
    fn delete(&mut self, row: usize, words: &mut [u32]) {
        let Some(mut which) = self.waiting.get(row & 1).map(|slot| slot.words) else {
            return;
        };
        if which == 0 {
            return;
        }
        let start = self.index(row, 0);
        let Some(slot) = self.waiting.get_mut(row & 1) else {
            return;
        };
        slot.words = 0;
        while which != 0 {
            let word = which.trailing_zeros() as usize;
            which &= which - 1;
            let gone = slot.deletions.get(word).copied().unwrap_or(0);
            if let Some(out) = words.get_mut(start + word) {
                *out &= !gone;
            }
        }
        self.deleted[0] = true;
    }

    /// Take the next group's marks to be looked at.
    fn next_group(&mut self) {
        let group = self.window.group;
        let mut look = self
            .window
            .slide(&self.marks, usize::from(self.region.words));
        look &= words_of_group(self.region, group);
        if let Some(mark) = self.mark(group) {
            *mark = look;
        }
        self.todo = look;
    }

    /// The present subiteration's marks of a group.
    fn mark(&mut self, group: usize) -> Option<&mut u32> {
        let [first, second] = &mut self.marks;
        let marks = if self.second { second } else { first };
        marks.get_mut(group)
    }

    fn begin_pass(&mut self) {
        self.window = MarkWindow::at_start(&self.marks);
        self.row = 0;
    }

    fn end_pass(&mut self, words: &mut [u32]) {
        self.delete(self.row.wrapping_sub(1), words);
        self.delete(self.row, words);
        self.passes = self.passes.saturating_add(1);
        self.done = self.deleted == [false; 2];
        self.deleted = [false, self.deleted[0]];
        self.second = !self.second;
        self.begin_pass();
    }
}

impl<const M: usize> Default for Thinning<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl MarkWindow {
    fn at_start<const M: usize>(marks: &[[u32; M]; 2]) -> Self {
        let either = [either(marks, 0), either(marks, 1)];
        Self {
            group: 0,
            either,
            grown: [0, grow(0, either[0], either[1])],
        }
    }

    /// The words of the next group with a mark in their 3 × 3 block; the group is then behind.
    ///
    /// Words are counted through the region row by row, so the block's rows are `per_row` bits apart. The ends of
    /// adjacent rows count as neighbours: a few words too many, never one too few.
    fn slide<const M: usize>(&mut self, marks: &[[u32; M]; 2], per_row: usize) -> u32 {
        let beyond = either(marks, self.group + 2);
        let [before, here] = self.grown;
        let after = grow(self.either[0], self.either[1], beyond);
        let above = (u64::from(here) << 32 | u64::from(before)) >> (32 - per_row);
        let below = (u64::from(after) << 32 | u64::from(here)) >> per_row;
        *self = Self {
            group: self.group + 1,
            either: [self.either[1], beyond],
            grown: [here, after],
        };
        here | above as u32 | below as u32
    }
}

/// A bit for each word of the group that is in the region.
fn words_of_group(region: Region, group: usize) -> u32 {
    match region.size().saturating_sub(group * 32) {
        0 => 0,
        words @ 1..32 => u32::MAX >> (32 - words),
        _ => u32::MAX,
    }
}

fn either<const M: usize>(marks: &[[u32; M]; 2], group: usize) -> u32 {
    let [one, other] = marks;
    one.get(group).copied().unwrap_or(0) | other.get(group).copied().unwrap_or(0)
}

/// A group's marks grown by one word to either side.
const fn grow(before: u32, here: u32, after: u32) -> u32 {
    here | here << 1 | before >> 31 | here >> 1 | after << 31
}
