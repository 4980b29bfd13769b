//! What a team's exchange needs of the map: the versions of its tiles, and joins with the tiles of
//! others.
//!
//! A tile in which nothing is known has no version, so it is never said, unless a correction forgot
//! it: others may have it.
//!
//! Units: tiles of 32 × 32 cells.

use crate::geometry::{Cell, Point};
use crate::grid::bits::ones;
use crate::grid::{Class, inside};
use crate::map::Map;
use crate::map::compaction::{Entry, ZEROS};
use crate::map::join::{hash, join_row, row_of};
use crate::map::tile::{Cells, Stored};
use crate::map::tiles::{NoRoom, TILE_SIDE, Tiles};
use crate::map::versions::{ERA, MEASURED, Version};

/// A tile with its version.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileView<'a> {
    /// Column and row of the tile.
    pub(crate) tile: (i32, i32),
    /// Its epoch.
    pub(crate) epoch: u16,
    stored: Stored<'a>,
}

/// The place where the robot stands.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stand {
    /// Its centre.
    pub(crate) centre: Point,
    /// Metres.
    pub(crate) radius_m: f32,
}

impl Stand {
    fn holds(self, cell: Cell) -> bool {
        cell.centre().distance2(self.centre) <= self.radius_m * self.radius_m
    }
}

impl TileView<'_> {
    /// Returns a hash of the cells.
    pub(crate) fn hash(&self, salt: u32) -> u32 {
        self.stored.with_planes(|planes| hash(planes, salt))
    }

    /// Returns the low and the high plane of the cells.
    pub(crate) fn cells(&self) -> Cells {
        self.stored.cells()
    }

    /// Returns the number of times that the tile's epoch was raised; less than 0 after a move.
    pub(crate) const fn raises(&self) -> u16 {
        self.epoch.wrapping_sub(MEASURED)
    }

    /// Returns true if nothing in the tile is known, and no correction forgot it.
    fn is_unknown(&self) -> bool {
        self.epoch < ERA && self.stored.with_planes(|planes| planes == [&ZEROS; 2])
    }
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Returns the number of places in the directory.
    fn places(&self) -> usize {
        self.directory.keys().len()
    }

    /// Returns the tile at a place of the directory; `None` if it has no version.
    fn view_at(&self, place: usize) -> Option<TileView<'_>> {
        let entry = self.entry_at(place);
        let view = TileView {
            tile: self.directory.tile(*inside(self.directory.keys(), place)?),
            epoch: self.version(entry)?.epoch,
            stored: self.stored(entry)?,
        };
        (!view.is_unknown()).then_some(view)
    }

    /// Returns the version of a tile; `None` if it is untouched.
    pub(super) fn version(&self, entry: Entry) -> Option<Version> {
        match entry {
            Entry::Untouched => None,
            Entry::Page(page) => Some(self.versions.of(page)),
            Entry::Coded(unit) => Some(self.code(unit).version()),
        }
    }

    fn is_due(&self, place: usize) -> bool {
        matches!(self.entry_at(place), Entry::Page(page) if self.versions.is_due(page))
    }
}

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Takes a page for the team's sample of another map. Give it back before the map is moved.
    pub(crate) fn take_sample(&mut self) -> Option<usize> {
        self.tiles.take_new_page().ok()
    }

    /// Gives the page of the sample back.
    pub(crate) fn return_sample(&mut self, page: usize) {
        self.tiles.return_page(page);
    }

    /// Returns the words of the sample's page.
    pub(crate) fn sample(&self, page: usize) -> &[u32] {
        self.tiles.words(page)
    }

    /// Returns the words of the sample's page.
    pub(crate) fn sample_mut(&mut self, page: usize) -> &mut [u32] {
        self.tiles.words_mut(page)
    }

    /// Counts a second for the tiles that changed.
    pub(crate) fn sweep_news(&mut self) {
        self.tiles.versions.sweep();
    }

    /// Returns a tile with its version; `None` if nothing in it is known.
    pub(crate) fn view(&self, tile: (i32, i32)) -> Option<TileView<'_>> {
        self.tiles.view_at(self.tiles.directory.place(tile)?)
    }

    /// Returns the tiles in which something is known, from a place of the directory on, each with
    /// its place.
    pub(crate) fn views_from(&self, place: usize) -> impl Iterator<Item = (usize, TileView<'_>)> {
        let places = place..self.tiles.places();
        places.filter_map(|place| Some((place, self.tiles.view_at(place)?)))
    }

    /// Returns the first place at or after this one, or before it, whose tile is to be said.
    pub(crate) fn due_place(&self, from: usize) -> Option<usize> {
        let places = self.tiles.places();
        let mut order = (from..places).chain(0..from.min(places));
        order.find(|&place| self.tiles.is_due(place))
    }

    /// Notes that a tile is said, and returns it; `None` if nothing in it is known.
    pub(crate) fn say_at(&mut self, place: usize) -> Option<TileView<'_>> {
        let entry = self.tiles.entry_at(place);
        let before = self.tiles.version(entry)?;
        let said = before.said();
        match entry {
            Entry::Untouched => {}
            Entry::Page(page) => self.tiles.versions.put(page, said),
            Entry::Coded(unit) => self.tiles.set_coded_version(unit, said),
        }
        self.tiles.edits = self
            .tiles
            .edits
            .wrapping_add((said.epoch != before.epoch).into());
        self.tiles.view_at(place)
    }

    /// Returns a tile's place in the directory.
    pub(crate) fn place(&self, tile: (i32, i32)) -> Option<usize> {
        self.tiles.directory.place(tile)
    }

    /// Joins a tile with what another robot knows of it. Of a cell that changes the evidence is
    /// forgotten. `has_evidence` is true on flat ground.
    ///
    /// The other one may have taken this robot for an obstacle: free cells of the `stand`, a disc
    /// around the robot, stay free.
    ///
    /// # Errors
    /// [`NoRoom`] if the map has no room for the tile, or the tile is compact. Nothing is joined
    /// then; the others go on to offer it.
    pub(crate) fn join(
        &mut self,
        tile: (i32, i32),
        (epoch, cells): (u16, &Cells),
        stand: Stand,
        has_evidence: bool,
    ) -> Result<(), NoRoom> {
        if *cells == [ZEROS; 2] && epoch < ERA {
            return Ok(());
        }
        let page = self.tiles.touch(tile.0, tile.1)?;
        self.tiles.settle(page);
        let own = self.tiles.versions.epoch(page);
        for row in 0..TILE_SIDE as usize {
            let theirs = row_of(cells, row);
            let [free, changed] = self.tiles.join_page_row(page, row, own, (epoch, theirs));
            for column in ones(changed) {
                let cell = Cell {
                    x: tile.0 * TILE_SIDE + column as i32,
                    y: tile.1 * TILE_SIDE + row as i32,
                };
                if has_evidence {
                    self.evidence.forget(cell);
                }
                if free >> column & 1 == 1 && stand.holds(cell) {
                    self.tiles.set(cell, Class::Free)?;
                }
            }
        }
        if epoch > own {
            self.tiles.versions.set_epoch(page, epoch);
            self.tiles.edits = self.tiles.edits.wrapping_add(1);
        }
        Ok(())
    }
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Raises the epoch of a page in which a cell's class went down.
    fn settle(&mut self, page: usize) {
        if self.versions.settle(page) {
            self.edits = self.edits.wrapping_add(1);
        }
    }

    /// Joins a row of a page. Returns the cells that were free, and those that changed.
    fn join_page_row(
        &mut self,
        page: usize,
        row: usize,
        own: u16,
        theirs: (u16, [u32; 2]),
    ) -> [u32; 2] {
        let Some([low, high]) = self.pool.get_mut(page) else {
            return [0; 2];
        };
        let (Some(low), Some(high)) = (low.get_mut(row), high.get_mut(row)) else {
            return [0; 2];
        };
        let free = *low & !*high;
        let joined = join_row((own, [*low, *high]), theirs);
        let changed = (*low ^ joined[0]) | (*high ^ joined[1]);
        [*low, *high] = joined;
        self.edits = self.edits.wrapping_add(changed.count_ones());
        [free, changed]
    }
}
