//! The pool: the memory of the tiles, in pages.
//!
//! Spare pages are a list: the first word of a page is the number of the next one, plus 1. The
//! pages that codes share ([`code`](super::code)) are another: their trail, which nothing else
//! uses, has a bit for each unit in use, and the next one, plus 1.
//!
//! Invariant: every page given out is in the directory once, or spare once, or shared and holds a
//! code, or is the team's sample (`exchange`). A unit is in use if it is part of one code.
//!
//! Units: pages of 256 bytes, units of 16 bytes.

use crate::grid::{inside, inside_mut};
use crate::map::compaction::CODED_FLAG;
use crate::map::tiles::{NO_TRAIL, NoRoom, Tiles};

/// Units of a page.
pub(super) const UNITS: usize = 16;
/// Words of a unit.
pub(super) const UNIT_WORDS: usize = 4;
/// Pages that codes may share: an entry can tell no units beyond.
pub(super) const MOST_SHARED: usize = CODED_FLAG as usize / UNITS;

/// The lists of spare and shared pages.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FreeList {
    /// Pages given out so far, in order.
    pub(super) given: u16,
    /// Number of spare pages.
    pub(super) pages: u16,
    /// The first spare page, plus 1; 0 if there is none.
    pub(super) page: u16,
    /// The first shared page, plus 1; 0 if there is none.
    pub(super) shared: u16,
}

impl FreeList {
    /// No page is given out.
    pub(super) const EMPTY: Self = Self {
        given: 0,
        pages: 0,
        page: 0,
        shared: 0,
    };

    /// Returns the number of pages in use.
    pub(super) const fn used(&self) -> usize {
        (self.given - self.pages) as usize
    }
}

/// Returns the bits of some units.
pub(super) const fn run(first: usize, units: usize) -> u16 {
    (((1_u32 << units) - 1) << first) as u16
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Returns the number of pages not in use.
    pub(super) fn free_pages(&self) -> usize {
        self.capacity().saturating_sub(self.free.used())
    }

    /// Takes a spare page; its content is undefined.
    #[inline(never)]
    pub(super) fn take_page(&mut self) -> Result<usize, NoRoom> {
        if let Some(page) = self.free.page.checked_sub(1) {
            let page = usize::from(page);
            self.free.page = self.words(page).first().map_or(0, |link| *link as u16);
            self.free.pages -= 1;
            return Ok(page);
        }
        let page = usize::from(self.free.given);
        if page >= self.capacity() {
            return Err(NoRoom::Pool);
        }
        self.free.given += 1;
        Ok(page)
    }

    /// Returns the words of a page that was taken for another use than a tile.
    pub(super) fn words_mut(&mut self, page: usize) -> &mut [u32] {
        let page = inside_mut(&mut self.pool, page);
        page.map_or(&mut [], |cells| cells.as_flattened_mut())
    }

    /// Returns the words of a page that was taken for another use than a tile.
    pub(super) fn words(&self, page: usize) -> &[u32] {
        inside(&self.pool, page).map_or(&[], |cells| cells.as_flattened())
    }

    /// Gives a page back.
    #[inline(never)]
    pub(super) fn return_page(&mut self, page: usize) {
        let next = u32::from(self.free.page);
        if let Some(link) = self.words_mut(page).first_mut() {
            *link = next;
        }
        self.free.page = page as u16 + 1;
        self.free.pages += 1;
    }

    /// Returns the units in use of a shared page, and the next shared page, plus 1.
    pub(super) fn share(&self, page: usize) -> [u16; 2] {
        let trail = inside(&self.trail, page).unwrap_or(&NO_TRAIL);
        let [used, next, ..] = *trail;
        [used, next]
    }

    fn set_share(&mut self, page: usize, share: [u16; 2]) {
        if let Some([used, next, ..]) = inside_mut(&mut self.trail, page) {
            [*used, *next] = share;
        }
    }

    /// Returns a run of units that are not in use, of a page that is shared or is from now on.
    #[inline(never)]
    pub(super) fn take_units(&mut self, units: usize) -> Option<usize> {
        let mut at = self.free.shared;
        while let Some(page) = at.checked_sub(1).map(usize::from) {
            let [used, next] = self.share(page);
            let fits = |first: &usize| used & run(*first, units) == 0;
            if let Some(first) = (0..=UNITS - units).find(fits) {
                self.set_share(page, [used | run(first, units), next]);
                return Some(UNITS * page + first);
            }
            at = next;
        }
        let page = self.take_page().ok()?;
        self.set_share(page, [run(0, units), self.free.shared]);
        self.free.shared = page as u16 + 1;
        Some(UNITS * page)
    }

    /// Gives units back. A page without a unit in use is spare.
    #[inline(never)]
    pub(super) fn return_units(&mut self, unit: usize, units: usize) {
        let page = unit / UNITS;
        let [used, next] = self.share(page);
        let left = used & !run(unit % UNITS, units);
        self.set_share(page, [left, next]);
        if left != 0 {
            return;
        }
        let mut at = self.free.shared;
        if usize::from(at) == page + 1 {
            self.free.shared = next;
        }
        while let Some(before) = at.checked_sub(1).map(usize::from) {
            let [used, after] = self.share(before);
            if usize::from(after) == page + 1 {
                self.set_share(before, [used, next]);
            }
            at = after;
        }
        self.return_page(page);
    }
}
