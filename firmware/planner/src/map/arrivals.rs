//! Arrivals: obstacles that stand where the floor was free.
//!
//! ```text
//! came = an obstacle whose cell was free before
//! lone = came, no obstacle within 1 cell that did not come, no unknown cell within 2 cells
//! ```
//!
//! A person, a cart or a door may go again. A wall is mostly met before what lies behind it, but
//! noise frees some cells at its face before they become obstacles. These have the wall or unknown
//! cells beside them. So only lone cells are taken for something that came. On flat ground they
//! have the class [`Class::Negative`], which has no other meaning there; for everything else they
//! are obstacles.
//!
//! Units: map cells.

use crate::config::Config;
use crate::geometry::Cell;
use crate::grid::Class;
use crate::grid::bits::ones;
use crate::map::Map;
use crate::map::tiles::{TILE_ROWS, TILE_SIDE};

/// Fewer lone cells than this in the whole map are false echoes. A person has more from any side.
const LEAST_LONE: u32 = 4;

/// Returns the class of a cell in which something stands now, and whose class was `class`.
pub(super) const fn came(class: Class) -> Class {
    match class {
        Class::Free | Class::Negative => Class::Negative,
        Class::Unknown | Class::Obstacle => Class::Obstacle,
    }
}

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Returns true if something came that may be gone. For flat ground.
    pub(crate) fn has_arrivals(&self) -> bool {
        let mut lone = 0;
        for place in 0.. {
            let Some(tile) = self.tile_at(place) else {
                break;
            };
            let rows = self.lone_arrivals(tile);
            lone += rows.iter().map(|row| row.count_ones()).sum::<u32>();
        }
        lone >= LEAST_LONE
    }

    /// Takes the lone arrivals for gone that are farther from the robot than obstacle points reach.
    /// One that is nearer and still stands would be touched before it is seen: in front of the
    /// robot beams judge it anyway, behind it nothing does (measured: docs/MEASURED.md, "Arrivals
    /// near the robot"). For flat ground.
    pub fn forget_arrivals(&mut self, config: &Config, robot: Cell) {
        let reach_m = config.tuning.map.reach_m;
        // The tiles stay the same: only their cells change.
        for place in 0.. {
            let Some((tile_x, tile_y)) = self.tile_at(place) else {
                break;
            };
            let (x, first_y) = (tile_x * TILE_SIDE, tile_y * TILE_SIDE);
            for (y, lone) in (first_y..).zip(self.lone_arrivals((tile_x, tile_y))) {
                for k in ones(lone) {
                    let cell = Cell { x: x + k as i32, y };
                    if cell.distance2(robot) > reach_m * reach_m {
                        self.store(cell, Class::Free);
                        self.evidence.forget(cell);
                    }
                }
            }
        }
    }

    /// Returns the number of cells that were measured.
    pub(crate) fn known_cells(&self) -> u32 {
        let places = 0..self.tiles.keys().len();
        let stored = places.filter_map(|place| self.tiles.stored(self.tiles.entry_at(place)));
        stored.map(|stored| stored.known()).sum()
    }

    /// Returns a tile's cells as [`Tiles::packed`](crate::map::Tiles::packed) does. On flat ground
    /// lone arrivals are unknown, because they may be gone, and others are obstacles.
    #[must_use]
    pub fn shown(&self, tile_x: i32, tile_y: i32) -> Option<[u8; 256]> {
        let mut bytes = self.tiles.packed(tile_x, tile_y)?;
        if self.tiles.is_lent() {
            return Some(bytes);
        }
        let lone = self.lone_arrivals((tile_x, tile_y));
        for (lone, row) in lone.iter().zip(bytes.chunks_exact_mut(8)) {
            for (k, byte) in row.iter_mut().enumerate() {
                *byte &= !(*byte >> 1 & 0x55);
                for c in (0..4).filter(|c| lone >> (4 * k + c) & 1 != 0) {
                    *byte &= !(3 << (2 * c));
                }
            }
        }
        Some(bytes)
    }

    /// Returns the column and the row of the tile at a place in the directory.
    fn tile_at(&self, place: usize) -> Option<(i32, i32)> {
        let key = *self.tiles.keys().get(place)?;
        Some(self.tiles.directory.tile(key))
    }

    /// Returns the lone arrivals of a tile, row by row. It is large and has three callers, so it is
    /// not inlined.
    #[inline(never)]
    fn lone_arrivals(&self, (tile_x, tile_y): (i32, i32)) -> [u32; TILE_ROWS] {
        let mut lone = [0; TILE_ROWS];
        let stored = self.tiles.stored(self.tiles.entry(tile_x, tile_y));
        if !stored.is_some_and(|stored| stored.has_negative()) {
            return lone;
        }
        let first_y = tile_y * TILE_SIDE;
        let mut reader = self.tiles.measured(tile_x * TILE_SIDE - 2);
        // What keeps the cells of the last rows from being lone: unknown cells, and walls.
        let (mut unknown, mut walls) = ([0; 5], [0; 5]);
        let mut came = [0; 3];
        for y in first_y - 2..first_y + TILE_SIDE + 2 {
            let row = reader.row(y);
            unknown.rotate_left(1);
            walls.rotate_left(1);
            came.rotate_left(1);
            // Bit 2 is the tile's first cell.
            let (far, near) = (row.unknown(), row.obstacle() & !row.negative());
            unknown[4] = (far | far >> 1 | far >> 2 | far >> 3 | far >> 4) as u32;
            walls[4] = (near >> 1 | near >> 2 | near >> 3) as u32;
            came[2] = (row.negative() >> 2) as u32;
            if let Some(lone) = lone.get_mut((y - 2 - first_y) as usize) {
                let kept = unknown
                    .iter()
                    .fold(walls[1] | walls[2] | walls[3], |a, b| a | b);
                *lone = came[0] & !kept;
            }
        }
        lone
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::*;

    type Plan = Map<16, 64>;

    /// Draws a map, least y first: `.` free, `#` wall, `o` came, blank unknown.
    fn drawn(picture: &[&str]) -> Box<Plan> {
        let mut map = Box::new(Plan::new());
        map.reset();
        for (y, row) in (28..).zip(picture) {
            for (x, mark) in (28..).zip(row.chars()) {
                let class = match mark {
                    '.' => Class::Free,
                    '#' => Class::Obstacle,
                    'o' => Class::Negative,
                    _ => continue,
                };
                map.store(Cell { x, y }, class);
            }
        }
        map
    }

    fn row_of(map: &Plan, y: i32) -> Vec<Class> {
        (28..44).map(|x| map.class(Cell { x, y })).collect()
    }

    /// A person, cells beside a wall, and cells before what nobody saw.
    const PICTURE: [&str; 7] = [
        "................",
        "................",
        "...oo......o#...",
        "...oo......o#...",
        "................",
        "..............  ",
        "............oo  ",
    ];

    #[test]
    fn only_what_came_and_is_alone_is_forgotten() {
        let mut map = drawn(&PICTURE);
        let config = Config::pioneer_3at(heapless::Vec::new());
        assert!(map.has_arrivals());
        map.forget_arrivals(&config, Cell { x: 38, y: 34 });
        assert_eq!(
            map.class(Cell { x: 31, y: 30 }),
            Class::Negative,
            "it is near the robot"
        );
        map.forget_arrivals(&config, Cell { x: 60, y: 60 });
        let came = |map: &Plan, y| {
            let row = row_of(map, y);
            row.iter()
                .filter(|class| **class == Class::Negative)
                .count()
        };
        assert_eq!([30, 31, 34].map(|y| came(&map, y)), [1, 1, 2]);
        assert_eq!(map.class(Cell { x: 31, y: 30 }), Class::Free);
        assert_eq!(map.class(Cell { x: 40, y: 30 }), Class::Obstacle);
        assert!(!map.has_arrivals());
    }

    #[test]
    fn what_came_is_shown_as_unknown_and_what_belongs_to_a_wall_as_an_obstacle() {
        let map = drawn(&PICTURE);
        let shown = |cell: Cell| {
            let bytes = map.shown(cell.x >> 5, cell.y >> 5).expect("touched");
            let index = ((cell.y & 31) * 32 + (cell.x & 31)) as usize;
            bytes[index / 4] >> (2 * (index % 4)) & 3
        };
        let at = |x, y| shown(Cell { x, y });
        assert_eq!([at(31, 30), at(32, 31)], [0, 0]);
        assert_eq!([at(39, 30), at(40, 31), at(41, 34)], [2, 2, 2]);
        assert_eq!([at(28, 28), at(30, 30)], [1, 1]);
    }

    #[test]
    fn known_cells_are_counted() {
        assert_eq!(drawn(&PICTURE).known_cells(), 7 * 16 - 4);
    }

    #[test]
    fn an_obstacle_came_if_its_cell_was_free() {
        assert_eq!(came(Class::Free), Class::Negative);
        assert_eq!(came(Class::Negative), Class::Negative);
        assert_eq!(came(Class::Unknown), Class::Obstacle);
        assert_eq!(came(Class::Obstacle), Class::Obstacle);
    }
}
