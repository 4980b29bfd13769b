//! Tile compaction: a tile far from the robot takes less than a page of the pool.
//!
//! When pages run short, the map *compacts* tiles, the farthest from the robot first: each becomes
//! its [`code`](super::code), which loses nothing. Codes share pages, in units of 16 bytes. A tile
//! that is to be written is *expanded*: it takes a page again. Reading needs no page.
//!
//! | ground | a tile is compacted | and expanded |
//! | --- | --- | --- |
//! | flat | when a page is wanted and none is spare | by the first write |
//! | uneven | in [`Tiles::compact`], with fewer than [`LOW_PAGES`] | there, near the window |
//!
//! On uneven ground the heights of a tile go with its page, and only their owner, a [`SideTable`],
//! can keep them. So a write to a compact tile finds no room there.
//!
//! Invariant: a tile in the directory has one page or one code ([`pool`](super::pool)).
//!
//! Units: pages of 256 bytes, units of 16 bytes.

#[cfg(test)]
mod tests;

use crate::geometry::Cell;
use crate::grid::{TileKey, inside, inside_mut};
use crate::map::Map;
use crate::map::code::{Code, Writer, set_version};
use crate::map::pool::{MOST_SHARED, UNIT_WORDS, UNITS};
use crate::map::tile::{Plane, Stored};
use crate::map::tiles::{NoRoom, TILE_ROWS, TILE_SIDE, Tiles};
use crate::map::traversal::Traversal;
use crate::map::versions::Version;

/// Flag of the entry of a compact tile; the other bits are the number of its first unit.
pub(super) const CODED_FLAG: u16 = 0x8000;
/// On uneven ground tiles are compacted with fewer spare pages than this. The window touches nine
/// tiles at a time, and [`RESERVED_PAGES`] stay spare.
const LOW_PAGES: usize = 24;
/// Pages kept back, once there are compact tiles, to expand those that are written.
const RESERVED_PAGES: usize = 10;
/// Tiles up to so many columns and rows from the robot's tile stay as they are: most of the windows
/// of evidence and of heights lies there.
const NEAR: i32 = 2;
/// Margin around the window in which tiles are expanded, cells: the window is there in one or two
/// steps.
const EXPAND_MARGIN: i32 = 2;
/// Most tiles that a step compacts or tries to, so that a step has a bound. What then finds no room
/// finds it in the next one.
const MOST_TRIES: u16 = 48;
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
    /// Its code begins at this unit.
    Coded(usize),
}

impl Entry {
    /// Decodes a word of the directory.
    #[inline(always)]
    pub(super) const fn of(word: u16) -> Self {
        if word & CODED_FLAG != 0 {
            Self::Coded((word & !CODED_FLAG) as usize)
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
            Self::Coded(unit) => CODED_FLAG | unit as u16,
        }
    }
}

/// A table with data by page, of which a byte follows a tile through compaction.
pub trait SideTable {
    /// Called when a tile gives up its page. Returns the byte to keep.
    fn release_page(&mut self, page: usize) -> i8;
    /// Called when a tile is in a page again.
    fn restore_page(&mut self, page: usize, kept: i8);
}

/// No side table.
impl SideTable for () {
    fn release_page(&mut self, _: usize) -> i8 {
        0
    }

    fn restore_page(&mut self, _: usize, _: i8) {}
}

/// How far the compaction is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Compacting {
    /// Number of compact tiles.
    compact: u16,
    /// Tiles that this step tried to compact.
    tries: u16,
    /// The last tile of the present round that was tried: its distance and key. The next one is
    /// nearer.
    last: Option<(i32, TileKey)>,
    /// The round made a tile compact.
    gained: bool,
    /// The robot's tile.
    centre: (i32, i32),
    /// No tile can be compacted that would make room.
    is_exhausted: bool,
}

impl Compacting {
    /// No tile is compact.
    pub(super) const NONE: Self = Self {
        compact: 0,
        tries: 0,
        last: None,
        gained: false,
        centre: (0, 0),
        is_exhausted: false,
    };

    /// Begins a step of a robot in a cell.
    pub(super) fn follow(&mut self, robot: Cell) {
        let tile = (robot.x >> 5, robot.y >> 5);
        self.tries = 0;
        if tile != self.centre {
            (self.centre, self.last, self.gained) = (tile, None, false);
        }
    }
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Returns true if an untouched tile may take a page that is spare.
    fn has_spare_page(&self) -> bool {
        let kept_back = match self.compacting.compact {
            0 => 0,
            _ => RESERVED_PAGES,
        };
        self.free_pages() > kept_back
    }

    /// Returns true if an untouched tile may take a page.
    pub(super) fn has_page(&self) -> bool {
        self.has_spare_page() || !(self.is_lent() || self.compacting.is_exhausted)
    }

    /// Takes a page for an untouched tile.
    ///
    /// # Errors
    /// [`NoRoom::Pool`], or [`NoRoom::Later`] if this step has made all the room that it may.
    #[inline(never)]
    pub(super) fn take_new_page(&mut self) -> Result<usize, NoRoom> {
        if !self.has_spare_page() {
            if !self.has_page() {
                return Err(NoRoom::Pool);
            }
            self.make_room(RESERVED_PAGES + 1, &mut ())?;
        }
        self.take_page()
    }

    /// Returns the code that begins at a unit.
    pub(super) fn code(&self, unit: usize) -> Code<'_> {
        let words = self.words(unit / UNITS);
        Code::new(words.get(unit % UNITS * UNIT_WORDS..).unwrap_or_default())
    }

    /// Returns the byte of the side table that the code at a unit keeps.
    pub(crate) fn kept(&self, unit: usize) -> i8 {
        self.code(unit).kept()
    }

    /// Writes the version of a compact tile.
    pub(super) fn set_coded_version(&mut self, unit: usize, version: Version) {
        let words = self.words_mut(unit / UNITS);
        let code = words.get_mut(unit % UNITS * UNIT_WORDS..);
        set_version(code.unwrap_or_default(), version);
    }

    /// Compacts tiles, the farthest from the robot first, until so many pages are spare.
    ///
    /// # Errors
    /// [`NoRoom::Pool`] if all are compact that can be; [`NoRoom::Later`] if the step has tried
    /// enough of them.
    #[inline(never)]
    fn make_room(&mut self, pages: usize, side_table: &mut impl SideTable) -> Result<(), NoRoom> {
        while self.free_pages() < pages {
            if self.compacting.tries >= MOST_TRIES {
                return Err(NoRoom::Later);
            }
            self.compacting.tries += 1;
            if let Some((place, distance)) = self.farthest() {
                self.compacting.last = Some(distance);
                self.compacting.gained |= self.compact_tile(place, side_table);
            } else if self.compacting.gained {
                (self.compacting.last, self.compacting.gained) = (None, false);
            } else {
                self.compacting.is_exhausted = true;
                return Err(NoRoom::Pool);
            }
        }
        Ok(())
    }

    /// Returns the farthest tile with a page that was not tried yet: its place in the directory,
    /// and its distance with its key.
    #[inline(never)]
    fn farthest(&self) -> Option<(usize, (i32, TileKey))> {
        let (column, row) = self.compacting.centre;
        let mut best = None;
        for (place, &key) in self.directory.keys().iter().enumerate() {
            let (x, y) = self.directory.tile(key);
            let (dx, dy) = ((x - column).abs(), (y - row).abs());
            let distance = (dx * dx + dy * dy, key);
            let is_next = dx.max(dy) > NEAR
                && self.compacting.last.is_none_or(|last| distance < last)
                && best.is_none_or(|(_, most)| distance > most);
            if is_next && matches!(self.entry_at(place), Entry::Page(_)) {
                best = Some((place, distance));
            }
        }
        best
    }

    /// Replaces the page of a tile by its code, if that is shorter. Returns true then.
    #[inline(never)]
    fn compact_tile(&mut self, place: usize, side_table: &mut impl SideTable) -> bool {
        let Entry::Page(page) = self.entry_at(place) else {
            return false;
        };
        if page >= MOST_SHARED {
            return false;
        }
        let Some((cells, trail)) = inside(&self.pool, page).zip(inside(&self.trail, page)) else {
            return false;
        };
        let version = self.versions.of(page);
        let Some(mut code) = Writer::of(cells, trail, version) else {
            return false;
        };
        code.keep(side_table.release_page(page));
        self.return_page(page);
        // The page itself is the next spare one, so there are units.
        let units = code.words().len().div_ceil(UNIT_WORDS);
        let unit = self.take_units(units).unwrap_or(UNITS * page);
        let to = self.words_mut(unit / UNITS).iter_mut();
        let to = to.skip(unit % UNITS * UNIT_WORDS);
        to.zip(code.words()).for_each(|(to, word)| *to = *word);
        self.compacting.compact += 1;
        self.enter(place, Entry::Coded(unit));
        true
    }

    /// Gives a compact tile that is to be written a page. For flat ground.
    ///
    /// # Errors
    /// [`NoRoom::Later`] if there is none in this step.
    #[inline(never)]
    pub(super) fn expand_to_write(&mut self, tile: (i32, i32)) -> Result<usize, NoRoom> {
        if self.is_lent() {
            return Err(NoRoom::Later);
        }
        if self.free_pages() == 0 {
            self.make_room(1, &mut ()).or(Err(NoRoom::Later))?;
        }
        let place = self.directory.place(tile).ok_or(NoRoom::Box)?;
        self.expand_tile(place, &mut ())?;
        match self.entry_at(place) {
            Entry::Page(page) => Ok(page),
            _ => Err(NoRoom::Later),
        }
    }

    /// Gives the tile at a place of the directory a page, if it is compact.
    ///
    /// # Errors
    /// [`NoRoom`] if the pool is full.
    #[inline(never)]
    pub(super) fn expand_tile(
        &mut self,
        place: usize,
        side_table: &mut impl SideTable,
    ) -> Result<(), NoRoom> {
        let Entry::Coded(unit) = self.entry_at(place) else {
            return Ok(());
        };
        let page = self.take_page()?;
        let code = self.code(unit);
        let (units, kept) = (code.length().div_ceil(UNIT_WORDS), code.kept());
        let (cells, trail, version) = (code.cells(), code.trail(), code.version());
        self.return_units(unit, units);
        self.fill_page(page, cells);
        if let Some(place) = inside_mut(&mut self.trail, page) {
            *place = trail;
        }
        self.versions.put(page, version);
        side_table.restore_page(page, kept);
        self.compacting.compact -= 1;
        self.enter(place, Entry::Page(page));
        Ok(())
    }

    /// Expands all tiles.
    ///
    /// # Errors
    /// [`NoRoom`] if the pool is full.
    pub(super) fn expand_all(&mut self) -> Result<(), NoRoom> {
        let mut places = 0..self.directory.keys().len();
        places.try_for_each(|place| self.expand_tile(place, &mut ()))
    }

    /// Forgets a tile. Returns the page that it gave back.
    #[inline(never)]
    pub(super) fn forget_tile(&mut self, tile: (i32, i32)) -> Option<usize> {
        let page = match self.entry(tile.0, tile.1) {
            Entry::Untouched => return None,
            Entry::Page(page) => {
                self.return_page(page);
                Some(page)
            }
            Entry::Coded(unit) => {
                let units = self.code(unit).length().div_ceil(UNIT_WORDS);
                self.return_units(unit, units);
                self.compacting.compact -= 1;
                None
            }
        };
        self.directory.remove(tile);
        self.compacting.is_exhausted = false;
        page
    }

    /// Returns a tile as it is stored; `None` if it is untouched.
    pub(super) fn stored(&self, entry: Entry) -> Option<Stored<'_>> {
        match entry {
            Entry::Untouched => None,
            Entry::Page(page) => {
                let (cells, trail) = (inside(&self.pool, page)?, inside(&self.trail, page)?);
                Some(Stored::Page { cells, trail })
            }
            Entry::Coded(unit) => Some(Stored::Coded(self.code(unit))),
        }
    }

    /// On uneven ground: expands the tiles around the square of `side` cells at `window`, and
    /// compacts others if pages run short.
    pub(super) fn compact(&mut self, window: Cell, side: i32, side_table: &mut impl SideTable) {
        let is_short = self.free_pages() < LOW_PAGES;
        if is_short {
            // What is not compacted in this step is in the next one.
            let _ = self.make_room(LOW_PAGES, side_table);
        }
        if self.compacting.compact == 0 {
            return;
        }
        let is_near = |tile: i32, from: i32| {
            let least = tile * TILE_SIDE;
            least + TILE_SIDE > from - EXPAND_MARGIN && least < from + side + EXPAND_MARGIN
        };
        for place in 0..self.directory.keys().len() {
            let tile = inside(self.directory.keys(), place).map(|&key| self.directory.tile(key));
            if tile.is_some_and(|(x, y)| is_near(x, window.x) && is_near(y, window.y)) {
                // Without room the tile stays compact until the next call.
                let _ = self.expand_tile(place, side_table);
            }
        }
    }
}

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Crosses a compact tile without evidence in which the beam frees nothing, and leaves it as it
    /// is. Returns true if the beam continues; `None` if the tile is another one.
    #[inline]
    pub(super) fn cross_compact(&self, traversal: &mut Traversal, hit: bool) -> Option<bool> {
        let (x, y) = traversal.tile();
        let Entry::Coded(unit) = self.tiles.entry(x, y) else {
            return None;
        };
        // The window is larger than a tile, so one that it meets has a corner in it.
        let (x, y) = (x * TILE_SIDE, y * TILE_SIDE);
        let last = TILE_SIDE - 1;
        let corners = [(x, y), (x + last, y), (x, y + last), (x + last, y + last)];
        if corners
            .map(|(x, y)| Cell { x, y })
            .iter()
            .any(|&cell| self.evidence.covers(cell))
        {
            return None;
        }
        let code = self.tiles.code(unit);
        let (mut ahead, mut frees) = (*traversal, false);
        let goes_on = ahead.cross_tile(|row, bit, _| {
            let [low, high] = code.class_bits(row, bit.trailing_zeros());
            frees = low | high == 0;
            !frees && (high == 0 || hit)
        });
        if frees {
            return None;
        }
        *traversal = ahead;
        Some(goes_on)
    }
}
