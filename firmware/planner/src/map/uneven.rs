//! The map on uneven ground: the elevation window's memory, and its classes into the tiles.
//!
//! Counts of hits and passes say nothing there, because beams pass over holes and end on slopes; so the window of heights takes their place,
//! in their memory: 8 KB for 4,096 heights of two bytes, and 16 tiles of the pool for a byte of marks each. On flat ground all tiles are the
//! map's.

use super::tiles::NoRoom;
use super::{Class, Map};
use crate::bits::ones64;
use crate::config::Config;
use crate::geometry::Cell;
use crate::planner::Input;
use crate::terrain::classify::{self, Steps};
use crate::terrain::elevation::{WINDOW_CELLS, WINDOW_SIDE};
use crate::terrain::survey::Survey;
use crate::terrain::{Elevation, Heights, Terrain};

/// Tiles that hold the marks.
const MARK_TILES: usize = WINDOW_CELLS / size_of::<super::tiles::TileRows>();

/// Cells around a goal that are given up with it.
const GIVEN_UP: i32 = 3;

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// From here on the window of heights lies where the counts were.
    pub(super) fn make_room_for_heights(&mut self) {
        self.tiles.lend(MARK_TILES);
    }

    /// The elevation window; without a single height on flat ground.
    #[must_use]
    pub fn heights(&self) -> Heights<'_> {
        Heights::new(self.evidence.bytes(), self.tiles.lent_bytes(), self.window)
    }

    /// Scans and pose into the window, and the window into the map.
    pub(super) fn survey(&mut self, config: &Config, terrain: &Terrain, input: &Input<'_>) {
        let mut elevation = Elevation::new(
            self.evidence.bytes_mut(),
            self.tiles.lent_bytes_mut(),
            &mut self.window,
        );
        Survey::new(&mut elevation, terrain, input).run(config, input, !self.surveyed);
        self.surveyed = true;
        let steps = Steps::new(terrain);
        for y in self.window.y..self.window.y + WINDOW_SIDE {
            self.classify(&steps, y);
        }
    }

    /// The robot stood by a cell, and neither it nor what is around it was measured. Behind a brow ground stays out of view: where what is
    /// measured on both sides leads over it gently it is taken for free, and else for gone.
    pub fn give_up_ground(&mut self, terrain: &Terrain, goal: Cell) {
        for y in goal.y - GIVEN_UP..=goal.y + GIVEN_UP + 1 {
            for x in goal.x - GIVEN_UP..=goal.x + GIVEN_UP + 1 {
                let cell = Cell { x, y };
                if self.tiles.class(cell) == Class::Unknown {
                    let leads_over = classify::leads_over(&self.heights(), terrain, cell);
                    let class = if leads_over {
                        Class::Free
                    } else {
                        Class::Negative
                    };
                    // Where there is no room nothing is known in any case.
                    let _ = self.tiles.set(cell, class);
                }
            }
        }
    }

    fn classify(&mut self, steps: &Steps, y: i32) {
        let x = self.window.x;
        let known = self.tiles.row(x, y);
        let classes = classify::row(&self.heights(), steps, y, known);
        let changed = [
            (
                Class::Obstacle,
                classes.obstacle & !(known.obstacle() & !known.negative()),
            ),
            (Class::Negative, classes.negative & !known.negative()),
            (Class::Free, classes.free & !known.free()),
        ];
        for (class, cells) in changed {
            for k in ones64(cells) {
                let cell = Cell { x: x + k as i32, y };
                match self.tiles.set(cell, class) {
                    Ok(()) => {}
                    Err(NoRoom::Box) => self.out_of_box = true,
                    Err(NoRoom::Pool) => self.pool_full = true,
                }
            }
        }
    }
}
