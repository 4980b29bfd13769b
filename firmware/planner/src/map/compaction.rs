//! Tile compaction: a tile with little content takes less than a page of the pool.
//!
//! | content of a tile | storage |
//! | --- | --- |
//! | free from edge to edge | its entry of the directory |
//! | no obstacle | its low plane, half a page |
//! | other | a page: low plane, high plane |
//!
//! Uneven ground shares the pool with the marks of its window. Open ground of 50 × 50 m then has
//! twice as many tiles as there are pages. So when pages run short, the map *compacts* every tile
//! away from the robot, and *expands* it before the robot's window reaches it. A compact tile reads
//! as before, without the robot's trail. It cannot be written, except that a free tile accepts free
//! cells.
//!
//! Spare pages and spare halves are two lists: the first word of an element is the number of the
//! next one, plus 1. Two spare halves of the same page become a spare page.
//!
//! Invariant: every page given out is in the directory once, or spare once, or it is two halves of
//! which this is true, or the team's sample (`exchange`).
//!
//! Units: pages of 256 bytes, halves of 128 bytes.

#[cfg(test)]
mod tests;

use crate::geometry::Cell;
use crate::grid::{inside, inside_mut};
use crate::map::tiles::{NoRoom, Plane, TILE_ROWS, TILE_SIDE, Tiles};
use crate::map::versions::MEASURED;

/// Flag of the entry of a tile that is all free; the low byte is kept for the side table.
const ALL_FREE_FLAG: u16 = 0x8000;
/// Flag of the entry of a tile in half a page.
const HALF_FLAG: u16 = 0x4000;
/// With fewer spare pages than this, tiles are compacted. The window touches nine tiles at a time,
/// and [`RESERVED_PAGES`] stay spare.
const LOW_PAGES: usize = 24;
/// Pages kept back, once there are compact tiles, to expand those that the robot reaches.
const RESERVED_PAGES: usize = 10;
/// Margin around the window in which tiles are expanded, cells: the window is there in one or two
/// steps.
const EXPAND_MARGIN: i32 = 2;
/// A plane of ones.
pub(super) static ONES: Plane = [u32::MAX; TILE_ROWS];
/// A plane of zeros.
pub(super) static ZEROS: Plane = [0; TILE_ROWS];

/// A tile's entry in the directory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    /// Never touched.
    Untouched,
    /// Stored in this page.
    Page(usize),
    /// Stored in half `h`, of page `h / 2`.
    Half(usize),
    /// All free; with the byte of the side table.
    AllFree(i8),
}

impl Entry {
    /// Decodes a word of the directory.
    #[inline(always)]
    pub(super) const fn of(word: u16) -> Self {
        if word & ALL_FREE_FLAG != 0 {
            Self::AllFree(word as i8)
        } else if word & HALF_FLAG != 0 {
            Self::Half((word & !HALF_FLAG) as usize)
        } else if word == 0 {
            Self::Untouched
        } else {
            Self::Page(word as usize - 1)
        }
    }

    /// Encodes the entry as a word of the directory.
    pub(super) const fn word(self) -> u16 {
        match self {
            Self::Untouched => 0,
            Self::Page(page) => page as u16 + 1,
            Self::Half(half) => HALF_FLAG | half as u16,
            Self::AllFree(kept) => ALL_FREE_FLAG | kept as u8 as u16,
        }
    }
}

/// A table with data by page, of which a byte follows a tile through compaction.
pub trait SideTable {
    /// Called when a tile gives up its page. Returns the byte to keep.
    fn release_page(&mut self, page: usize) -> i8;
    /// Called when a tile is in a page again.
    fn restore_page(&mut self, page: usize, kept: i8);
    /// Called when a tile moved to this half of a page.
    fn store_half(&mut self, half: usize, kept: i8);
    /// Called when a tile gives up its half. Returns the byte that was kept.
    fn release_half(&mut self, half: usize) -> i8;
}

/// No side table.
impl SideTable for () {
    fn release_page(&mut self, _: usize) -> i8 {
        0
    }

    fn restore_page(&mut self, _: usize, _: i8) {}

    fn store_half(&mut self, _: usize, _: i8) {}

    fn release_half(&mut self, _: usize) -> i8 {
        0
    }
}

/// The lists of spare pages and halves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FreeList {
    /// Pages given out so far, in order.
    pub(super) given: u16,
    /// Number of spare pages.
    pages: u16,
    /// The first spare page, plus 1; 0 if there is none.
    page: u16,
    /// The first spare half, plus 1; 0 if there is none.
    half: u16,
    /// Number of compact tiles.
    compact: u16,
}

impl FreeList {
    /// No page is given out.
    pub(super) const EMPTY: Self = Self {
        given: 0,
        pages: 0,
        page: 0,
        half: 0,
        compact: 0,
    };

    /// Returns the number of pages in use.
    pub(super) const fn used(&self) -> usize {
        (self.given - self.pages) as usize
    }
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Returns the number of pages not in use.
    fn free_pages(&self) -> usize {
        self.capacity().saturating_sub(self.free.used())
    }

    /// Returns true if an untouched tile may take a page.
    pub(super) fn has_page(&self) -> bool {
        let kept_back = if self.free.compact > 0 {
            RESERVED_PAGES
        } else {
            0
        };
        self.free_pages() > kept_back
    }

    /// Takes a page; its content is undefined.
    pub(super) fn take_page(&mut self) -> Result<usize, NoRoom> {
        if let Some(page) = self.free.page.checked_sub(1) {
            let page = usize::from(page);
            self.free.page = self.next(2 * page);
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

    fn plane_mut(&mut self, half: usize) -> Option<&mut Plane> {
        inside_mut(self.pool.as_flattened_mut(), half)
    }

    /// Returns the link in the first word of a spare half or page.
    fn next(&self, half: usize) -> u16 {
        inside(self.pool.as_flattened(), half).map_or(0, |[link, ..]| *link as u16)
    }

    fn set_next(&mut self, half: usize, next: u16) {
        if let Some([link, ..]) = self.plane_mut(half) {
            *link = next.into();
        }
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
    pub(super) fn return_page(&mut self, page: usize) {
        self.set_next(2 * page, self.free.page);
        self.free.page = page as u16 + 1;
        self.free.pages += 1;
    }

    /// Returns a half to the list; if the other half of the page is spare, returns the page.
    fn return_half(&mut self, half: usize) {
        let other = (half ^ 1) as u16 + 1;
        let mut before = None;
        let mut at = self.free.half;
        while let Some(here) = at.checked_sub(1) {
            let next = self.next(here.into());
            if at == other {
                match before {
                    Some(before) => self.set_next(before, next),
                    None => self.free.half = next,
                }
                return self.return_page(half / 2);
            }
            (before, at) = (Some(usize::from(here)), next);
        }
        self.set_next(half, self.free.half);
        self.free.half = half as u16 + 1;
    }

    /// Expands the tiles around the square of `side` cells at `window`. If pages run short,
    /// compacts all others.
    pub(super) fn compact(&mut self, window: Cell, side: i32, side_table: &mut impl SideTable) {
        let is_short = self.free_pages() < LOW_PAGES;
        if !is_short && self.free.compact == 0 {
            return;
        }
        let is_near = |tile: i32, from: i32| {
            let least = tile * TILE_SIDE;
            least + TILE_SIDE > from - EXPAND_MARGIN && least < from + side + EXPAND_MARGIN
        };
        for place in 0..self.directory.keys().len() {
            let Some((x, y)) = self.tile_at(place) else {
                continue;
            };
            if is_near(x, window.x) && is_near(y, window.y) {
                // Without room the tile stays compact until the next call.
                let _ = self.expand_tile(place, side_table);
            } else if is_short {
                self.compact_tile(place, side_table);
            }
        }
    }

    /// Expands all tiles.
    ///
    /// # Errors
    /// [`NoRoom`] if the pool is full.
    pub(super) fn expand_all(&mut self) -> Result<(), NoRoom> {
        let mut places = 0..self.directory.keys().len();
        places.try_for_each(|place| self.expand_tile(place, &mut ()))
    }

    /// Returns the column and the row of the tile at a place of the directory.
    fn tile_at(&self, place: usize) -> Option<(i32, i32)> {
        let &key = inside(self.directory.keys(), place)?;
        Some(self.directory.tile(key))
    }

    fn compact_tile(&mut self, place: usize, side_table: &mut impl SideTable) {
        let Entry::Page(page) = self.entry_at(place) else {
            return;
        };
        let Some(&[low, high]) = inside(&self.pool, page) else {
            return;
        };
        // A compact tile has no place for an epoch.
        if high != ZEROS || self.versions.epoch(page) != MEASURED {
            return;
        }
        let kept = side_table.release_page(page);
        let entry = if low == ONES {
            self.return_page(page);
            Entry::AllFree(kept)
        } else {
            let half = self.move_low(page, low);
            side_table.store_half(half, kept);
            Entry::Half(half)
        };
        self.free.compact += 1;
        self.enter(place, entry);
    }

    /// Moves the low plane of a page to a spare half, or leaves it in place if there is none. The
    /// rest of the page becomes spare. Returns the half.
    fn move_low(&mut self, page: usize, low: Plane) -> usize {
        let Some(half) = self.free.half.checked_sub(1) else {
            self.return_half(2 * page + 1);
            return 2 * page;
        };
        let half = usize::from(half);
        self.free.half = self.next(half);
        if let Some(plane) = self.plane_mut(half) {
            *plane = low;
        }
        self.return_page(page);
        half
    }

    /// Gives the tile at a place of the directory a page, if it is compact.
    ///
    /// # Errors
    /// [`NoRoom`] if the pool is full.
    pub(super) fn expand_tile(
        &mut self,
        place: usize,
        side_table: &mut impl SideTable,
    ) -> Result<(), NoRoom> {
        let entry = self.entry_at(place);
        let (low, kept) = match entry {
            Entry::Untouched | Entry::Page(_) => return Ok(()),
            Entry::AllFree(kept) => (ONES, kept),
            Entry::Half(half) => (self.plane_mut(half).map_or(ZEROS, |low| *low), 0),
        };
        let page = self.take_page()?;
        let kept = if let Entry::Half(half) = entry {
            self.return_half(half);
            side_table.release_half(half)
        } else {
            kept
        };
        self.fill_page(page, [low, ZEROS]);
        side_table.restore_page(page, kept);
        self.free.compact -= 1;
        self.enter(place, Entry::Page(page));
        Ok(())
    }
}
