//! Guo–Hall thinning, 32 cells at a time, in place and in instalments \[GuoHall89\].
//!
//! A subiteration judges all cells before it deletes any. North is towards row 0, as in an image
//! with row 0 on top; `THINNING_GUOHALL` of `opencv_contrib` does the same and gives the same bits.
//! The two subiterations of the rule alternate until two in a row delete nothing.
//!
//! A pass looks only at words that may change: a word can lose a cell only if a cell of it or next
//! to it changed in one of the last two subiterations. Two bits a word, one for each subiteration,
//! say so. What a pass deletes waits in a plane of its own until the last word is judged.
//!
//! Units: words of the plane, tile by tile.

use crate::grid::{Block, PAGE_WORDS, PlaneMut, Tiling, TooSmall, at};
use crate::roadmap::Progress;
use crate::roadmap::thinning_rule::deletions;

/// The state of a thinning of up to `PAGES` tiles.
///
/// Invariant between two calls: the pages before the present one are judged, and the plane still
/// has the cells that they lose.
#[derive(Clone, Debug)]
pub struct Thinning<const PAGES: usize> {
    /// The cells that the present pass deletes.
    losses: [[u32; PAGE_WORDS]; PAGES],
    /// Per subiteration, the words of each page that its last pass touched.
    touched: [[u8; PAGES]; 2],
    /// The second subiteration is on.
    second: bool,
    /// The next page to be judged, of so many.
    next: usize,
    pages: usize,
    /// The present pass deletes something, and the one before it deleted nothing.
    deletes: bool,
    quiet_before: bool,
    passes: u16,
    running: bool,
}

impl<const PAGES: usize> Thinning<PAGES> {
    /// Makes a thinning with nothing to do.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            losses: [[0; PAGE_WORDS]; PAGES],
            touched: [[0; PAGES]; 2],
            second: false,
            next: 0,
            pages: 0,
            deletes: false,
            quiet_before: false,
            passes: 0,
            running: false,
        }
    }

    /// Starts to thin a plane of these tiles.
    ///
    /// # Errors
    /// If there are more than `PAGES` tiles.
    pub fn start(&mut self, tiling: Tiling<'_>) -> Result<(), TooSmall> {
        let (needs, has) = (tiling.words(), PAGES * PAGE_WORDS);
        if needs > has {
            return Err(TooSmall { needs, has });
        }
        self.pages = tiling.keys().len();
        self.losses.as_flattened_mut().fill(0);
        self.touched.as_flattened_mut().fill(u8::MAX);
        (self.second, self.next) = (false, 0);
        (self.deletes, self.quiet_before) = (false, false);
        (self.passes, self.running) = (0, true);
        Ok(())
    }

    /// Returns memory for a plane, which the next start clears.
    pub(super) const fn spare(&mut self) -> &mut [u32] {
        self.losses.as_flattened_mut()
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
    /// A unit is a word judged, or a page whose words are looked up. The last page may cost more
    /// than is left. The result does not depend on how the work is divided into budgets.
    pub fn advance(&mut self, plane: &mut PlaneMut<'_>, anchors: &[u32], budget: u32) -> Progress {
        let tiling = plane.tiling();
        debug_assert!(
            !self.running || tiling.keys().len() == self.pages,
            "another plane than at the start"
        );
        let words = plane.words_mut();
        let mut left = budget;
        while self.running {
            while self.next < self.pages {
                if left == 0 {
                    return Progress::Pending;
                }
                let cost = self.judge(tiling, words, anchors);
                left = left.saturating_sub(cost);
                self.next += 1;
            }
            left = left.saturating_sub(self.end_pass(tiling, words));
        }
        Progress::Done { left }
    }

    /// Judges the words of the next page that may change. Returns the units of work.
    fn judge(&mut self, tiling: Tiling<'_>, words: &[u32], anchors: &[u32]) -> u32 {
        let place = self.next;
        let [first, second] = &self.touched;
        let active = at(first, place) | at(second, place);
        let Some(losses) = self.losses.get_mut(place).filter(|_| active != 0) else {
            return 0;
        };
        let block = Block::read(tiling, words, place);
        for (k, lost) in losses.iter_mut().enumerate() {
            if active >> k & 1 != 0 {
                let anchors = at(anchors, place * PAGE_WORDS + k);
                *lost = deletions(&block, k, self.second) & !anchors;
                self.deletes |= *lost != 0;
            }
        }
        1 + active.count_ones()
    }

    /// Deletes what the pass lost, and begins the next one. Returns the units of work.
    fn end_pass(&mut self, tiling: Tiling<'_>, words: &mut [u32]) -> u32 {
        let [first, second] = &mut self.touched;
        let touched = if self.second { second } else { first };
        touched.fill(0);
        let mut units = 1;
        if self.deletes {
            let pages = words.chunks_exact_mut(PAGE_WORDS).zip(&mut self.losses);
            for (place, (page, losses)) in pages.enumerate() {
                if *losses == [0; PAGE_WORDS] {
                    continue;
                }
                units += 1;
                touch(touched, &tiling.around(place), losses);
                for (word, lost) in page.iter_mut().zip(losses) {
                    *word &= !core::mem::take(lost);
                }
            }
        }
        self.passes = self.passes.saturating_add(1);
        self.running = self.deletes || !self.quiet_before;
        self.quiet_before = !core::mem::take(&mut self.deletes);
        self.second = !self.second;
        self.next = 0;
        units
    }
}

impl<const PAGES: usize> Default for Thinning<PAGES> {
    fn default() -> Self {
        Self::new()
    }
}

/// Marks the words that have a cell of `losses` or next to one: of the page and of those around.
fn touch(touched: &mut [u8], around: &[usize; 9], losses: &[u32; PAGE_WORDS]) {
    // Words touched in the columns of tiles in the west, here, and in the east. Bit 0 is the last
    // word in the north, bit 9 the first one in the south.
    let mut columns = [0_u32; 3];
    for (k, &lost) in losses.iter().enumerate() {
        // Lost cells of the upper row touch the word above, those of the lower row the word below.
        let words = |lost: u32| {
            let any = u32::from(lost != 0) << 1;
            let above = u32::from(lost & 0xffff != 0);
            (any | above | u32::from(lost >> 16 != 0) << 2) << k
        };
        for (column, cells) in columns.iter_mut().zip([0x0001_0001, u32::MAX, 0x8000_8000]) {
            *column |= words(lost & cells);
        }
    }
    for (side, &column) in columns.iter().enumerate() {
        let marks = [(column & 1) << 7, column >> 1 & 0xff, column >> 9 & 1];
        for (row, marks) in marks.into_iter().enumerate() {
            // In the north, here, and in the south.
            let place = at(around, 3 * row + side);
            if let Some(touched) = touched.get_mut(place) {
                *touched |= marks as u8;
            }
        }
    }
}
