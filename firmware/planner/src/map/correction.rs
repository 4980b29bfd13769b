//! The replacement of tiles by a correction of the map.
//!
//! A tile takes over the cells that it is told, and nothing else of what was known of it:
//!
//! | of a replaced tile | after |
//! | --- | --- |
//! | cells | as told; without a known cell the tile is forgotten, and its page is spare |
//! | evidence | none: the next beam counts from the class, 12 of an obstacle, 5 of a free cell |
//! | trail | forgotten here; the planner puts it where its places go |
//! | version | the next epoch, and news for the team |
//!
//! So three beams through an obstacle keep it and five free it; two hits on a free cell make it an
//! obstacle. A tile that the map has no room for is left out, as a beam's cell would be.
//!
//! Units: map cells; tiles of 32 × 32 cells.

use crate::geometry::Cell;
use crate::grid::bits::ones;
use crate::map::Map;
use crate::map::compaction::{Entry, ZEROS};
use crate::map::tiles::{Cells, NO_TRAIL, NoRoom, TILE_SIDE, Tiles};

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Replaces a tile by its low and its high plane. For flat ground.
    #[inline(never)]
    pub fn replace(&mut self, tile: (i32, i32), planes: &[[u32; 32]; 2]) {
        match self.tiles.replace(tile, planes) {
            Ok(()) => {}
            Err(NoRoom::Box) => self.out_of_box = true,
            Err(NoRoom::Pool) => self.pool_full = true,
        }
        self.evidence.forget_tile(tile);
    }

    /// Ends a correction: the robot is somewhere else, and its trail begins anew there.
    pub const fn end_correction(&mut self) {
        self.last_cell = None;
    }

    /// Returns the blocks of 2 × 2 cells of a tile that the robot's centre was in, each by its last
    /// cell: so an odd shift is rounded up, and an even one is exact.
    pub(crate) fn trail(&self, (column, row): (i32, i32)) -> impl Iterator<Item = Cell> {
        let tile = self.tiles.column(column, row);
        let rows = tile.map_or(NO_TRAIL, |tile| *tile.visited);
        let at = move |y: i32, x: usize| Cell {
            x: column * TILE_SIDE + 2 * x as i32 + 1,
            y: row * TILE_SIDE + 2 * y + 1,
        };
        let rows = (0..).zip(rows);
        rows.flat_map(move |(y, word)| ones(word.into()).map(move |x| at(y, x as usize)))
    }

    /// Marks a cell of the trail.
    pub(crate) fn mark_trail(&mut self, cell: Cell) {
        self.tiles.mark_visited(cell);
    }

    /// Returns the low and the high plane of a tile; `None` if nothing was ever measured in it.
    #[must_use]
    pub fn planes(&self, tile: (i32, i32)) -> Option<[[u32; 32]; 2]> {
        let planes = self.tiles.planes(self.tiles.entry(tile.0, tile.1))?;
        Some(planes.map(|plane| *plane))
    }
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    fn replace(&mut self, tile: (i32, i32), cells: &Cells) -> Result<(), NoRoom> {
        self.edits = self.edits.wrapping_add(1);
        if *cells == [ZEROS; 2] {
            if let Entry::Page(page) = self.entry(tile.0, tile.1) {
                self.return_page(page);
                self.directory.remove(tile);
            }
            return Ok(());
        }
        let page = self.touch(tile.0, tile.1)?;
        let epoch = self.versions.epoch(page);
        self.fill_page(page, *cells);
        self.versions.begin_corrected(page, epoch);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::*;
    use crate::config::MapTuning;
    use crate::grid::Class;

    type Plan = Map<4, 8>;

    /// A tile with one class in its first row.
    fn row_of(class: Class) -> [[u32; 32]; 2] {
        let mut planes = [[0; 32]; 2];
        planes[0][0] = if class as u32 & 1 != 0 { u32::MAX } else { 0 };
        planes[1][0] = if class as u32 & 2 != 0 { u32::MAX } else { 0 };
        planes
    }

    fn plan() -> Box<Plan> {
        let mut map = Box::new(Plan::new());
        map.reset();
        map
    }

    #[test]
    fn a_tile_takes_over_its_cells_and_no_other_tile_changes() {
        let mut map = plan();
        let cells = [0, 32].map(|x| Cell { x, y: 0 });
        for cell in cells {
            map.store(cell, Class::Obstacle);
            map.tiles.mark_visited(cell);
        }
        map.replace((0, 0), &row_of(Class::Free));
        assert_eq!(
            cells.map(|cell| map.class(cell)),
            [Class::Free, Class::Obstacle]
        );
        assert_eq!(map.planes((0, 0)), Some(row_of(Class::Free)));
        let trail = |x| map.tiles.row(x, 0).visited();
        assert_eq!([trail(0) & 1, trail(32) & 1], [0, 1]);
    }

    #[test]
    fn a_tile_without_a_known_cell_gives_its_page_back() {
        let mut map = plan();
        for k in 0..4 {
            map.replace((k, 7), &row_of(Class::Obstacle));
        }
        map.replace((4, 7), &row_of(Class::Obstacle));
        assert!(map.pool_full() && map.planes((4, 7)).is_none());
        map.replace((1, 7), &[[0; 32]; 2]);
        assert_eq!((map.tiles.used(), map.tiles.keys().len()), (3, 3));
        assert_eq!(map.planes((1, 7)), None);
        map.replace((4, 7), &row_of(Class::Free));
        assert_eq!(map.planes((4, 7)), Some(row_of(Class::Free)));
        assert_eq!(map.planes((3, 7)), Some(row_of(Class::Obstacle)));
    }

    /// A cell that was passed often needs three hits; one of a replaced tile, two.
    #[test]
    fn evidence_begins_anew_with_the_class() {
        let tuning = &MapTuning::DEFAULT;
        let mut map = plan();
        let (here, beside) = (Cell { x: 3, y: 0 }, Cell { x: 35, y: 0 });
        for cell in [here, beside] {
            for _ in 0..9 {
                map.evidence.pass(cell, Class::Free, tuning);
            }
        }
        map.replace((0, 0), &row_of(Class::Free));
        let mut hits = |cell| {
            let hit = |_: &i32| map.evidence.hit(cell, Class::Free, tuning) != Class::Free;
            (1..9).find(hit)
        };
        assert_eq!([hits(here), hits(beside)], [Some(2), Some(3)]);
        map.replace((0, 0), &row_of(Class::Obstacle));
        let pass = |_: &i32| map.evidence.pass(here, Class::Obstacle, tuning) == Class::Free;
        assert_eq!((1..9).find(pass), Some(5));
    }

    #[test]
    fn a_replaced_tile_is_news_of_the_next_epoch() {
        let mut map = plan();
        map.replace((0, 0), &row_of(Class::Free));
        let first = map.view((0, 0)).map(|view| view.epoch);
        map.replace((0, 0), &row_of(Class::Obstacle));
        let second = map.view((0, 0)).map(|view| view.epoch);
        assert_eq!(second, first.map(|epoch| epoch + 1));
        for _ in 0..3 {
            map.sweep_news();
        }
        assert_eq!(map.due_place(0), Some(0));
    }
}
