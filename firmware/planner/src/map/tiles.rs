//! The tile pool: two bits per cell in pages of 32 × 32 cells. A tile takes a page when its first
//! cell is stored.
//!
//! The directory lists the tiles that were touched, so the map may start anywhere. When pages run
//! short, tiles far from the robot take less than a page (`compaction`).
//!
//! The *trail* has one bit for 2 × 2 cells: the robot's centre was there. Noise may close a passage
//! as narrow as the robot behind it. The trail keeps the passage open.
//!
//! Units: cells of [`crate::geometry::CELL_M`].

use crate::fence::Fence;
use crate::geometry::Cell;
use crate::grid::{Class, Row, TileKey, TileMap, inside_mut, masked_mut};
use crate::map::compaction::{Compacting, Entry, ZEROS};
use crate::map::elevation_layer::MARK_TILES;
use crate::map::pool::FreeList;
use crate::map::rows::RowReader;
pub(super) use crate::map::tile::{Cells, Plane, Stored, TileMut, Visited};
use crate::map::versions::Versions;

/// The reason why the map has no room for a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRoom {
    /// It is more than [`TileKey::REACH`] tiles from the first one.
    Box,
    /// Every page of the pool is in use, or the directory is full.
    Pool,
    /// There will be room in one of the next steps.
    Later,
}

/// Cells along a tile's side.
pub const TILE_SIDE: i32 = 32;
pub(super) const TILE_ROWS: usize = TILE_SIDE as usize;
/// The trail in a tile without any.
pub(super) static NO_TRAIL: Visited = [0; TILE_ROWS / 2];

/// The tile pool and its directory: `TILES` pages, `SLOTS` tiles.
#[derive(Debug)]
pub struct Tiles<const TILES: usize, const SLOTS: usize> {
    pub(super) pool: [Cells; TILES],
    /// An [`Entry`] for every tile that was touched.
    pub(super) directory: TileMap<u16, SLOTS>,
    /// The trail in the tile of each page: 16 rows of 16 blocks of 2 × 2 cells.
    pub(super) trail: [Visited; TILES],
    pub(super) versions: Versions<TILES>,
    pub(super) free: FreeList,
    pub(super) compacting: Compacting,
    /// Pages at the pool's end that are lent to the elevation window.
    lent: u16,
    /// Number of changes of any cell; wraps.
    pub(super) edits: u32,
    /// Where the robot may be. Only planning knows it.
    pub(super) fence: Fence,
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Creates an empty pool.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            pool: [[ZEROS; 2]; TILES],
            directory: TileMap::new(0),
            trail: [NO_TRAIL; TILES],
            versions: Versions::new(),
            free: FreeList::EMPTY,
            compacting: Compacting::NONE,
            lent: 0,
            edits: 0,
            fence: Fence::new(),
        }
    }

    /// Clears the map.
    pub fn reset(&mut self) {
        self.directory.clear();
        (self.free, self.compacting) = (FreeList::EMPTY, Compacting::NONE);
        self.lent = 0;
        self.edits = self.edits.wrapping_add(1);
    }

    /// Returns the number of pages that the map may use.
    pub(super) const fn capacity(&self) -> usize {
        TILES - self.lent as usize
    }

    /// Lends the pool's last pages, at most all, until the next reset, and clears them. Call it
    /// before the first cell is stored.
    pub(super) fn lend(&mut self, tiles: usize) {
        let tiles = if tiles < TILES { tiles } else { TILES };
        self.lent = tiles as u16;
        bytemuck::cast_slice_mut::<_, u8>(self.lent_mut()).fill(0);
    }

    /// Returns true if pages are lent to the elevation window: the ground is uneven.
    pub(super) const fn is_lent(&self) -> bool {
        self.lent > 0
    }

    /// Returns the lent pages of the marks, and those of the landmarks.
    fn lent(&self) -> (&[Cells], &[Cells]) {
        let lent = self.pool.get(self.capacity()..).unwrap_or_default();
        lent.split_at_checked(MARK_TILES).unwrap_or((lent, &[]))
    }

    fn lent_mut(&mut self) -> &mut [Cells] {
        let capacity = self.capacity();
        self.pool.get_mut(capacity..).unwrap_or_default()
    }

    /// Returns the memory of the elevation window's marks.
    pub(super) fn mark_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.lent().0)
    }

    /// Returns the memory of the elevation window's marks.
    pub(super) fn mark_bytes_mut(&mut self) -> &mut [u8] {
        let lent = self.lent_mut();
        let marks = MARK_TILES.min(lent.len());
        bytemuck::cast_slice_mut(lent.get_mut(..marks).unwrap_or_default())
    }

    /// Returns the memory of the landmarks.
    pub(super) fn landmark_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.lent().1)
    }

    /// Returns the memory of the landmarks.
    pub(super) fn landmark_bytes_mut(&mut self) -> &mut [u8] {
        let landmarks = self.lent_mut().get_mut(MARK_TILES..);
        bytemuck::cast_slice_mut(landmarks.unwrap_or_default())
    }

    /// Returns the column and the row of the first tile, from which the keys count.
    pub(crate) const fn origin(&self) -> (i32, i32) {
        self.directory.origin()
    }

    /// Returns the keys of the tiles that were touched, sorted.
    pub(crate) fn keys(&self) -> &[TileKey] {
        self.directory.keys()
    }

    /// Returns the columns and the rows of the tiles that were touched.
    pub fn touched(&self) -> impl Iterator<Item = (i32, i32)> {
        self.keys().iter().map(|&key| self.directory.tile(key))
    }

    /// Returns the planes of a tile, as a team's tile has them.
    #[cfg(test)]
    pub(crate) fn planes_of(&self, tile_x: i32, tile_y: i32) -> Option<[[u32; 32]; 2]> {
        let stored = self.stored(self.entry(tile_x, tile_y))?;
        Some(stored.cells())
    }

    /// Returns true if a cell was ever stored in this tile.
    pub(crate) fn is_touched(&self, tile_x: i32, tile_y: i32) -> bool {
        self.entry(tile_x, tile_y) != Entry::Untouched
    }

    /// Returns the number of pages in use.
    #[cfg(test)]
    pub(crate) const fn used(&self) -> usize {
        self.free.used()
    }

    /// Returns a number that changes with every change of a cell.
    #[must_use]
    pub const fn edits(&self) -> u32 {
        self.edits
    }

    /// Returns the directory's entry of a tile.
    #[inline(never)]
    pub(crate) fn entry(&self, tile_x: i32, tile_y: i32) -> Entry {
        let word = self.directory.get((tile_x, tile_y));
        word.map_or(Entry::Untouched, |&word| Entry::of(word))
    }

    /// Returns the directory's entry at a place.
    pub(super) fn entry_at(&self, place: usize) -> Entry {
        let word = self.directory.value(place);
        word.map_or(Entry::Untouched, |&word| Entry::of(word))
    }

    pub(super) fn enter(&mut self, place: usize, entry: Entry) {
        if let Some(word) = self.directory.value_mut(place) {
            *word = entry.word();
        }
    }

    /// Checks that a tile is stored or can be.
    ///
    /// # Errors
    /// [`NoRoom`] if it is too far off, or the pool is full.
    pub(crate) fn room(&self, tile_x: i32, tile_y: i32) -> Result<(), NoRoom> {
        if self.is_touched(tile_x, tile_y) {
            Ok(())
        } else if !self.directory.reaches((tile_x, tile_y)) {
            Err(NoRoom::Box)
        } else if !self.has_page() || self.directory.is_full() {
            Err(NoRoom::Pool)
        } else {
            Ok(())
        }
    }

    /// Returns the page of a tile; takes one on first touch, and for a compact tile.
    pub(super) fn touch(&mut self, tile_x: i32, tile_y: i32) -> Result<usize, NoRoom> {
        match self.entry(tile_x, tile_y) {
            Entry::Page(page) => Ok(page),
            Entry::Untouched => self.add(tile_x, tile_y),
            Entry::Coded(_) => self.expand_to_write((tile_x, tile_y)),
        }
    }

    /// Gives an untouched tile a fresh page.
    #[inline(never)]
    fn add(&mut self, tile_x: i32, tile_y: i32) -> Result<usize, NoRoom> {
        self.room(tile_x, tile_y)?;
        let page = self.take_new_page()?;
        self.directory
            .get_or_add((tile_x, tile_y), Entry::Page(page).word())
            .ok_or(NoRoom::Box)?;
        self.fill_page(page, [ZEROS; 2]);
        Ok(page)
    }

    /// Gives a page its first cells; it has no trail.
    pub(super) fn fill_page(&mut self, page: usize, cells: Cells) {
        if let Some((old, trail)) =
            inside_mut(&mut self.pool, page).zip(inside_mut(&mut self.trail, page))
        {
            (*old, *trail) = (cells, NO_TRAIL);
        }
        self.versions.begin(page);
    }

    /// Returns the class of a cell.
    #[inline(never)]
    #[must_use]
    pub fn class(&self, cell: Cell) -> Class {
        let stored = self.stored(self.entry(cell.x >> 5, cell.y >> 5));
        stored.map_or(Class::Unknown, |stored| {
            stored.class((cell.y & 31) as usize, (cell.x & 31) as u32)
        })
    }

    /// Stores the class of a cell. A compact tile stays as it is if the class is the cell's.
    ///
    /// # Errors
    /// [`NoRoom`] if it is too far off, or the pool is full; the map is then unchanged.
    pub fn set(&mut self, cell: Cell, class: Class) -> Result<(), NoRoom> {
        let tile = (cell.x >> 5, cell.y >> 5);
        if matches!(self.entry(tile.0, tile.1), Entry::Coded(_)) && self.class(cell) == class {
            return Ok(());
        }
        let mut page = self.open(tile)?;
        page.set((cell.y & 31) as usize, 1 << (cell.x & 31), class);
        Ok(())
    }

    /// Returns the page of a tile that was touched; `None` if it has none and cannot get one. Then
    /// the trail has a gap.
    fn touched_page(&mut self, tile: (i32, i32)) -> Option<usize> {
        match self.entry(tile.0, tile.1) {
            Entry::Untouched => None,
            _ => self.touch(tile.0, tile.1).ok(),
        }
    }

    /// Marks a cell of the trail: the robot's centre was there.
    pub(crate) fn mark_visited(&mut self, cell: Cell) {
        let Some(page) = self.touched_page((cell.x >> 5, cell.y >> 5)) else {
            return;
        };
        if let Some(rows) = inside_mut(&mut self.trail, page) {
            *masked_mut(rows, (cell.y & 31) as usize / 2) |= 1 << ((cell.x & 31) / 2);
        }
    }

    /// Marks blocks of the trail.
    pub(super) fn mark_blocks(&mut self, tile: (i32, i32), blocks: &Visited) {
        let Some(page) = self.touched_page(tile) else {
            return;
        };
        let rows = inside_mut(&mut self.trail, page).into_iter().flatten();
        for (row, &more) in rows.zip(blocks) {
            *row |= more;
        }
    }

    /// Sets where the robot may be. A reset keeps it.
    pub(crate) fn set_fence(&mut self, fence: &Fence) {
        self.fence.clone_from(fence);
    }

    /// Returns the fence.
    pub(crate) const fn fence(&self) -> &Fence {
        &self.fence
    }

    /// Returns the class of a cell for planning: a forbidden one is an obstacle.
    pub(crate) fn planned_class(&self, cell: Cell) -> Class {
        match self.fence.allows(cell) {
            true => self.class(cell),
            false => Class::Obstacle,
        }
    }

    /// Returns the 64 cells of row `y` from column `x` on, as measured.
    pub(crate) fn row(&self, x: i32, y: i32) -> Row {
        self.measured(x).row(y)
    }

    /// Returns a reader of rows of 64 cells from column `x` on, for planning: a forbidden cell is
    /// an obstacle.
    pub(crate) fn reader(&self, x: i32) -> RowReader<'_, TILES, SLOTS> {
        self.measured(x).fenced()
    }

    /// Returns a reader of rows of 64 cells from column `x` on, as measured.
    pub(crate) const fn measured(&self, x: i32) -> RowReader<'_, TILES, SLOTS> {
        RowReader::new(self, x)
    }

    /// Opens a tile to read and write its cells; takes a page on first touch.
    ///
    /// # Errors
    /// [`NoRoom`] if it is too far off, or the pool is full; the map is then unchanged.
    pub(super) fn open(&mut self, (tile_x, tile_y): (i32, i32)) -> Result<TileMut<'_>, NoRoom> {
        let index = self.touch(tile_x, tile_y)?;
        Ok(TileMut {
            cells: inside_mut(&mut self.pool, index).ok_or(NoRoom::Pool)?,
            edits: &mut self.edits,
            news: self.versions.news_mut(index).ok_or(NoRoom::Pool)?,
        })
    }

    /// Returns a tile's cells, two bits each, row by row from the least y, with the least x in the
    /// lowest bits; `None` if the tile is untouched.
    #[must_use]
    pub fn packed(&self, tile_x: i32, tile_y: i32) -> Option<[u8; 256]> {
        let stored = self.stored(self.entry(tile_x, tile_y))?;
        let mut bytes = [0; 256];
        for (row, out) in bytes.chunks_exact_mut(8).enumerate() {
            let [low, high] = stored.row(row);
            for (k, byte) in out.iter_mut().enumerate() {
                for c in 0..4 {
                    let column = 4 * k + c;
                    let code = (low >> column & 1) | (high >> column & 1) << 1;
                    *byte |= (code as u8) << (2 * c);
                }
            }
        }
        Some(bytes)
    }
}

impl<const TILES: usize, const SLOTS: usize> Default for Tiles<TILES, SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
