//! The map: occupancy of the known space, from scans.
//!
//! [`tiles`] keeps the class of every cell for the whole run, [`evidence`] the counts around the robot, and
//! [`integrate`] turns beams into both.

pub(crate) mod compaction;
mod elevation_layer;
pub(crate) mod evidence;
mod extent;
pub(crate) mod integrate;
pub mod obstacle_points;
pub(crate) mod rows;
mod tile;
pub mod tiles;
mod traversal;
#[cfg(test)]
mod uneven_tests;

pub use crate::grid::Class;
pub use compaction::SideTable;
pub use tiles::Tiles;

use evidence::Evidence;

use crate::config::Config;
use crate::geometry::Cell;
use crate::ground::AttitudeFilter;
use crate::input::Input;

/// A robot that moved more cells than this between two observations was carried.
const MAX_STEP_CELLS: i32 = 10;
/// The robot stands where it is, so this much around it is free, metres.
const FOOTPRINT_M: f32 = 0.25;

/// Everything known of the space. `TILES` tiles in the pool, `SLOTS` places in the box.
#[derive(Debug)]
pub struct Map<const TILES: usize, const SLOTS: usize> {
    pub(crate) tiles: Tiles<TILES, SLOTS>,
    evidence: Evidence,
    /// Where the robot was at the last observation.
    last_cell: Option<Cell>,
    /// The least cell of the elevation window, once there is one.
    window: Cell,
    has_surveyed: bool,
    /// Which of the rows far off were classified.
    odd_rows: bool,
    attitude: AttitudeFilter,
    out_of_box: bool,
    pool_full: bool,
}

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// An empty map without a box.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            tiles: Tiles::new(),
            evidence: Evidence::new(),
            last_cell: None,
            window: Cell { x: 0, y: 0 },
            has_surveyed: false,
            odd_rows: false,
            attitude: AttitudeFilter::new(),
            out_of_box: false,
            pool_full: false,
        }
    }

    /// Forget everything and begin a session.
    pub fn begin(&mut self, config: &Config) {
        self.reset(config.box_tiles.0, config.box_tiles.1);
        if config.ground.is_some() {
            self.lend_memory_to_elevation();
        }
    }

    /// Forget everything; the box is `width` × `height` tiles.
    pub(crate) fn reset(&mut self, width: u8, height: u8) {
        self.tiles.reset(width, height);
        self.evidence.reset(Cell::default());
        self.last_cell = None;
        self.has_surveyed = false;
        self.odd_rows = false;
        self.attitude = AttitudeFilter::new();
        self.out_of_box = false;
        self.pool_full = false;
    }

    /// Enter everything that an input says of the space.
    pub fn observe(&mut self, config: &Config, input: &Input<'_>) {
        let robot = input.pose.point();
        if let Some(ground) = &config.ground {
            self.free_footprint(robot, FOOTPRINT_M);
            self.record_visit(robot.cell());
            self.update_elevation(config, ground, input);
            return;
        }
        self.evidence.follow(robot.cell());
        self.free_footprint(robot, FOOTPRINT_M);
        self.record_visit(robot.cell());
        for (laser, ranges_mm) in config.lasers.iter().zip(input.scans) {
            self.integrate(&input.pose, laser, ranges_mm);
        }
    }

    /// Mark the way from the last cell, with no diagonal steps, so that the trail is connected by sides.
    fn record_visit(&mut self, to: Cell) {
        let from = self.last_cell.unwrap_or(to);
        self.last_cell = Some(to);
        let steps = (to.x - from.x).abs().max((to.y - from.y).abs());
        if steps > MAX_STEP_CELLS {
            self.tiles.mark_visited(to);
            return;
        }
        let mut before = from;
        for k in 0..=steps {
            let part = |from: i32, to: i32| from + (to - from) * k / steps.max(1);
            let here = Cell {
                x: part(from.x, to.x),
                y: part(from.y, to.y),
            };
            self.tiles.mark_visited(Cell {
                x: here.x,
                y: before.y,
            });
            self.tiles.mark_visited(here);
            before = here;
        }
    }

    /// What is known of a cell.
    #[must_use]
    pub fn class(&self, cell: Cell) -> Class {
        self.tiles.class(cell)
    }

    /// The stored tiles.
    #[must_use]
    pub const fn tiles(&self) -> &Tiles<TILES, SLOTS> {
        &self.tiles
    }

    /// Something was seen that the box has no place for.
    #[must_use]
    pub const fn out_of_box(&self) -> bool {
        self.out_of_box
    }

    /// Something was seen that the pool has no tile for.
    #[must_use]
    pub const fn pool_full(&self) -> bool {
        self.pool_full
    }
}

impl<const TILES: usize, const SLOTS: usize> Default for Map<TILES, SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}
