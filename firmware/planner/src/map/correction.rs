//! The replacement of tiles by a correction of the map.
//!
//! A tile takes over the cells that it is told, and nothing else of what was known of it:
//!
//! | of a replaced tile | after |
//! | --- | --- |
//! | cells | as told; without a known cell the tile is forgotten, and its page is spare |
//! | evidence | none: the next beam counts from the class, 12 of an obstacle, 5 of a free cell |
//! | trail | forgotten here; the planner puts it where its places go, and adds what is told |
//! | heights of uneven ground | they stay with the tile: a shift is a small part of its side |
//! | version | in a team the first epoch of the next era, and news: others replace theirs |
//!
//! In a team a tile that is forgotten keeps its page: the others are told that it is unknown.
//!
//! The elevation window around the robot goes where the robot goes, by whole cells; it is not
//! turned.
//!
//! So three beams through an obstacle keep it and five free it; two hits on a free cell make it an
//! obstacle. A tile that the map has no room for is left out, as a beam's cell would be.
//!
//! Units: map cells; tiles of 32 × 32 cells.

use crate::geometry::{CELL_M, Cell, Point};
use crate::grid::bits::ones;
use crate::map::compaction::ZEROS;
use crate::map::tiles::{Cells, NO_TRAIL, NoRoom, TILE_SIDE, Tiles};
use crate::map::{Map, SideTable};
use crate::math;

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Gives a tile a page, so that it can be replaced, if it is compact and there is room.
    pub fn expand(&mut self, tile: (i32, i32), side_table: &mut impl SideTable) {
        if let Some(place) = self.tiles.directory.place(tile) {
            // Without room the tile stays, and so do its cells.
            let _ = self.tiles.expand_tile(place, side_table);
        }
    }

    /// Replaces a tile by its low and its high plane. On uneven ground it must be expanded. Of a
    /// robot `in_team` the others learn of a tile that is forgotten. Returns the page that the tile
    /// gave back.
    #[inline(never)]
    pub fn replace(
        &mut self,
        tile: (i32, i32),
        planes: &[[u32; 32]; 2],
        in_team: bool,
    ) -> Option<usize> {
        let mut spare = None;
        match self.tiles.replace(tile, planes, in_team) {
            Ok(page) => spare = page,
            Err(no_room) => self.record_failure(no_room),
        }
        // On uneven ground heights have this memory.
        if !self.tiles.is_lent() {
            self.evidence.forget_tile(tile);
        }
        spare
    }

    /// Ends a correction that moved the robot: its trail begins anew where it is, and the heights
    /// around it went with it.
    pub fn end_correction(&mut self, from: Point, to: Point) {
        self.last_cell = None;
        if self.tiles.is_lent() {
            let cells = |m: f32| math::floor(m / CELL_M + 0.5);
            self.move_heights([cells(to.x_m - from.x_m), cells(to.y_m - from.y_m)]);
        }
    }

    /// Returns the blocks of 2 × 2 cells of a tile that the robot's centre was in, each by its last
    /// cell: so an odd shift is rounded up, and an even one is exact.
    pub(crate) fn trail(&self, (column, row): (i32, i32)) -> impl Iterator<Item = Cell> {
        let rows = self.trail_rows((column, row));
        let at = move |y: i32, x: usize| Cell {
            x: column * TILE_SIDE + 2 * x as i32 + 1,
            y: row * TILE_SIDE + 2 * y + 1,
        };
        let rows = (0..).zip(rows);
        rows.flat_map(move |(y, word)| ones(word.into()).map(move |x| at(y, x as usize)))
    }

    /// Returns the trail in a tile: a word is a row of blocks, bit k of it block k.
    #[must_use]
    pub fn trail_rows(&self, (column, row): (i32, i32)) -> [u16; 16] {
        let stored = self.tiles.stored(self.tiles.entry(column, row));
        stored.map_or(NO_TRAIL, |stored| stored.trail())
    }

    /// Adds blocks to the trail in a tile. One without room has none.
    pub fn add_trail(&mut self, tile: (i32, i32), rows: &[u16; 16]) {
        self.tiles.mark_blocks(tile, rows);
    }

    /// Marks a cell of the trail.
    pub(crate) fn mark_trail(&mut self, cell: Cell) {
        self.tiles.mark_visited(cell);
    }

    /// Returns the low and the high plane of a tile; `None` if nothing was ever measured in it.
    #[must_use]
    pub fn planes(&self, tile: (i32, i32)) -> Option<[[u32; 32]; 2]> {
        let stored = self.tiles.stored(self.tiles.entry(tile.0, tile.1))?;
        Some(stored.cells())
    }
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    fn replace(
        &mut self,
        tile: (i32, i32),
        cells: &Cells,
        in_team: bool,
    ) -> Result<Option<usize>, NoRoom> {
        self.edits = self.edits.wrapping_add(1);
        let version = self.version(self.entry(tile.0, tile.1));
        let epoch = version.map(|version| version.epoch);
        if *cells == [ZEROS; 2] && !(in_team && epoch.is_some()) {
            return Ok(self.forget_tile(tile));
        }
        let page = self.touch(tile.0, tile.1)?;
        self.fill_page(page, *cells);
        if in_team {
            self.versions.begin_corrected(page, epoch);
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::*;
    use crate::config::{Config, MapTuning, UnevenGround};
    use crate::grid::Class;
    use crate::map::compaction::Entry;
    use crate::map::exchange::Stand;
    use crate::map::versions::{ERA, MEASURED};

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
        map.replace((0, 0), &row_of(Class::Free), false);
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
        map.tiles.compacting.follow(Cell { x: 64, y: 230 });
        for k in 0..4 {
            map.replace((k, 7), &row_of(Class::Obstacle), false);
        }
        map.replace((4, 7), &row_of(Class::Obstacle), false);
        assert!(map.pool_full() && map.planes((4, 7)).is_none());
        map.replace((1, 7), &[[0; 32]; 2], false);
        assert_eq!((map.tiles.used(), map.tiles.keys().len()), (3, 3));
        assert_eq!(map.planes((1, 7)), None);
        map.replace((4, 7), &row_of(Class::Free), false);
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
        map.replace((0, 0), &row_of(Class::Free), false);
        let mut hits = |cell| {
            let hit = |_: &i32| map.evidence.hit(cell, Class::Free, tuning) != Class::Free;
            (1..9).find(hit)
        };
        assert_eq!([hits(here), hits(beside)], [Some(2), Some(3)]);
        map.replace((0, 0), &row_of(Class::Obstacle), false);
        let pass = |_: &i32| map.evidence.pass(here, Class::Obstacle, tuning) == Class::Free;
        assert_eq!((1..9).find(pass), Some(5));
    }

    #[test]
    fn a_replaced_tile_is_news_of_the_next_era() {
        let mut map = plan();
        map.replace((0, 0), &row_of(Class::Free), true);
        let first = map.view((0, 0)).map(|view| view.epoch);
        map.replace((0, 0), &row_of(Class::Obstacle), true);
        let second = map.view((0, 0)).map(|view| view.epoch);
        assert_eq!([first, second], [Some(MEASURED + 1), Some(ERA)]);
        for _ in 0..3 {
            map.sweep_news();
        }
        assert_eq!(map.due_place(0), Some(0));
    }

    /// Joins another map with what this one says of the tile.
    fn tell(map: &Plan, other: &mut Plan) {
        let view = map.view((0, 0)).expect("it has a version");
        let joined = other.join((0, 0), (view.epoch, &view.cells()), Stand::default(), true);
        assert_eq!(joined, Ok(()));
    }

    /// The wall moved from the first row to the third, and what lay behind it is unknown.
    #[test]
    fn a_peers_tile_is_replaced_and_not_joined_with_the_old_wall() {
        let [mut map, mut peer] = [plan(), plan()];
        map.store(Cell { x: 3, y: 0 }, Class::Obstacle);
        tell(&map, &mut peer);
        peer.store(Cell { x: 9, y: 9 }, Class::Free);
        let mut moved = [[0; 32]; 2];
        moved[1][2] = 1 << 3;
        map.replace((0, 0), &moved, true);
        tell(&map, &mut peer);
        assert_eq!(peer.planes((0, 0)), Some(moved));
        tell(&peer, &mut map);
        assert_eq!(map.planes((0, 0)), Some(moved));
    }

    #[test]
    fn a_peer_learns_that_a_tile_is_forgotten() {
        let [mut map, mut peer] = [plan(), plan()];
        map.store(Cell { x: 3, y: 0 }, Class::Obstacle);
        tell(&map, &mut peer);
        map.replace((0, 0), &[[0; 32]; 2], true);
        tell(&map, &mut peer);
        assert_eq!(peer.planes((0, 0)), Some([[0; 32]; 2]));
        tell(&peer, &mut map);
        assert_eq!(map.planes((0, 0)), Some([[0; 32]; 2]));
    }

    /// A map on uneven ground, with room for the marks of its window.
    fn uneven() -> Box<Map<152, 400>> {
        let mut map = Box::new(Map::new());
        map.begin(&Config {
            ground: Some(UnevenGround::TABLE_I),
            ..Config::pioneer_3at(heapless::Vec::new())
        });
        map
    }

    #[test]
    fn heights_go_where_the_robot_goes_and_no_tile_changes_them() {
        let mut map = uneven();
        let slope = |cell: Cell| 0.05 * (cell.x % 16) as f32 + 0.01 * (cell.y % 16) as f32;
        map.set_ground_heights(Cell { x: 32, y: 40 }, |cell| Some(slope(cell)));
        let heights = |map: &Map<152, 400>, dx, dy| -> Vec<f32> {
            let cells = (10..50).flat_map(|y| {
                (2..60).map(move |x| Cell {
                    x: x + dx,
                    y: y + dy,
                })
            });
            let height = |cell| map.heights().height_m(cell).expect("it is in the window");
            cells.map(height).collect()
        };
        let before = heights(&map, 0, 0);
        map.replace((0, 0), &row_of(Class::Obstacle), false);
        assert_eq!(heights(&map, 0, 0), before);
        let from = Point { x_m: 3.2, y_m: 4.0 };
        let to = Point {
            x_m: 3.54,
            y_m: 2.78,
        };
        map.end_correction(from, to);
        assert_eq!(heights(&map, 3, -12), before);
    }

    #[test]
    fn a_compact_tile_is_replaced_as_well() {
        let mut map = uneven();
        for x in 0..120 {
            map.store(
                Cell {
                    x: 32 * x,
                    y: 3_000,
                },
                Class::Free,
            );
        }
        map.compact(&mut ());
        let is_compact = |map: &Map<152, 400>| matches!(map.tiles.entry(117, 93), Entry::Coded(_));
        assert!(is_compact(&map));
        map.expand((117, 93), &mut ());
        map.replace((117, 93), &row_of(Class::Obstacle), false);
        assert!(!is_compact(&map));
        assert_eq!(map.planes((117, 93)), Some(row_of(Class::Obstacle)));
    }
}
