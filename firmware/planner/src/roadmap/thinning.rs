//! Guo–Hall thinning, 32 cells at a time, in place and in instalments \[GuoHall89\].
//!
//! A subiteration judges all cells before it deletes any. North is towards row 0, as in an image
//! with row 0 on top; `THINNING_GUOHALL` of `opencv_contrib` does the same and gives the same bits.
//! The two subiterations of the rule alternate until two in a row delete nothing.
//!
//! A pass looks only at words that may change: a word can lose a cell only if a cell of it or next
//! to it changed in one of the last two subiterations. Two bits a word, one for each subiteration,
//! say so. What a pass deletes waits in lent memory until the last word is judged, so a pass is not
//! divided.
//!
//! Units: words of the plane, tile by tile.

use crate::grid::{Block, PAGE_WORDS, PlaneMut, Tiling, TooSmall, at};
use crate::roadmap::Progress;
use crate::roadmap::thinning_rule::deletions;

/// The state of a thinning of up to `PAGES` tiles.
///
/// Between two calls no pass is under way.
#[derive(Clone, Debug)]
pub struct Thinning<const PAGES: usize> {
    /// Per subiteration, the words of each page that its last pass touched.
    touched: [[u8; PAGES]; 2],
    /// The second subiteration is on.
    second: bool,
    pages: usize,
    /// The last pass deleted nothing.
    quiet_before: bool,
    passes: u16,
    running: bool,
}

impl<const PAGES: usize> Thinning<PAGES> {
    /// Makes a thinning with nothing to do.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            touched: [[0; PAGES]; 2],
            second: false,
            pages: 0,
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
        self.touched.as_flattened_mut().fill(u8::MAX);
        (self.second, self.quiet_before) = (false, false);
        (self.passes, self.running) = (0, true);
        Ok(())
    }

    /// Returns the number of subiterations since the start.
    #[must_use]
    pub const fn passes(&self) -> u16 {
        self.passes
    }

    /// Continues with about `budget` units of work, on the plane that it was started with and that
    /// nobody wrote to since. `anchors` has words as the plane; its cells are never deleted. An
    /// empty slice has none. `losses` needs as many words as the plane and may hold anything.
    ///
    /// A unit is a word judged, or a page whose words are looked up. The first pass of a call runs
    /// whatever it costs, if there is a budget at all. The result does not depend on how the work
    /// is divided into budgets.
    pub fn advance(
        &mut self,
        plane: &mut PlaneMut<'_>,
        anchors: &[u32],
        losses: &mut [u32],
        budget: u32,
    ) -> Progress {
        debug_assert!(
            !self.running || plane.tiling().keys().len() == self.pages,
            "another plane than at the start"
        );
        let mut left = budget;
        while self.running {
            let cost = self.cost();
            if left == 0 || (cost > left && left < budget) {
                return Progress::Pending;
            }
            left = left.saturating_sub(cost);
            self.pass(plane, anchors, losses);
        }
        Progress::Done { left }
    }

    /// Returns the words of a page that the next pass judges.
    fn active(&self, place: usize) -> u8 {
        let [first, second] = &self.touched;
        at(first, place) | at(second, place)
    }

    /// Returns the units of work of the next pass.
    fn cost(&self) -> u32 {
        let of_page = |place| match self.active(place) {
            0 => 0,
            active => 1 + active.count_ones(),
        };
        1 + (0..self.pages).map(of_page).sum::<u32>()
    }

    /// Runs a subiteration.
    fn pass(&mut self, plane: &mut PlaneMut<'_>, anchors: &[u32], losses: &mut [u32]) {
        let tiling = plane.tiling();
        let words = plane.words_mut();
        let mut deletes = false;
        for (place, losses) in losses
            .chunks_exact_mut(PAGE_WORDS)
            .take(self.pages)
            .enumerate()
        {
            losses.fill(0);
            let active = self.active(place);
            if active == 0 {
                continue;
            }
            let block = Block::read(tiling, words, place);
            for (k, lost) in losses.iter_mut().enumerate() {
                if active >> k & 1 != 0 {
                    let anchors = at(anchors, place * PAGE_WORDS + k);
                    *lost = deletions(&block, k, self.second) & !anchors;
                    deletes |= *lost != 0;
                }
            }
        }
        let [first, second] = &mut self.touched;
        let touched = if self.second { second } else { first };
        touched.fill(0);
        if deletes {
            delete(tiling, words, losses, touched);
        }
        self.passes = self.passes.saturating_add(1);
        self.running = deletes || !self.quiet_before;
        self.quiet_before = !deletes;
        self.second = !self.second;
    }
}

/// Deletes the cells of `losses`, and marks the words that this touches.
fn delete(tiling: Tiling<'_>, words: &mut [u32], losses: &[u32], touched: &mut [u8]) {
    let (losses, _) = losses.as_chunks::<PAGE_WORDS>();
    let pages = words.chunks_exact_mut(PAGE_WORDS).zip(losses);
    for (place, (page, losses)) in pages.enumerate() {
        // Comparing the arrays would compare their bytes, one by one.
        if losses.iter().fold(0, |all, lost| all | lost) == 0 {
            continue;
        }
        touch(touched, &tiling.around(place), losses);
        for (word, lost) in page.iter_mut().zip(losses) {
            *word &= !lost;
        }
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
