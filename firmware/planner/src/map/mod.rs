//! The map: the class of every known cell, from scans.
//!
//! | file | holds |
//! | --- | --- |
//! | [`tiles`], `tile` | the class of every cell, for the whole run |
//! | `compaction`, `code`, `pool` | shorter storage for tiles far from the robot |
//! | `versions`, [`exchange`], `join` | for a team: tiles with versions, and their joins |
//! | `rows` | rows of 32 and 64 cells, for all planning |
//! | `correction` | tiles that replace others |
//! | `turn` | the move of a whole map into a team's coordinates |
//! | `arrivals` | on flat ground, obstacles that came and may be gone |
//! | `evidence` | counts for and against an obstacle around the robot, on flat ground |
//! | `integrate`, `traversal` | beams into classes and counts |
//! | `elevation_layer` | the elevation window into classes, on uneven ground |
//! | `landmarks` | what beams met far off on uneven ground, for the localiser alone |
//! | `standing` | for a host, the beams that end at what stands |
//! | [`obstacle_points`] | single returns near the robot, finer than cells |
//!
//! Units: map cells of [`CELL_M`](crate::geometry::CELL_M).

pub(crate) mod arrivals;
mod code;
pub(crate) mod compaction;
mod correction;
mod elevation_layer;
pub(crate) mod evidence;
pub(crate) mod exchange;
pub(crate) mod integrate;
pub(crate) mod join;
pub(crate) mod landmarks;
pub(crate) mod neighbourhood;
pub mod obstacle_points;
mod pool;
pub(crate) mod rows;
#[cfg(feature = "internals")]
mod standing;
mod tile;
pub mod tiles;
mod traversal;
mod turn;
#[cfg(test)]
mod uneven_tests;
mod versions;

pub use crate::grid::Class;
pub use compaction::SideTable;
pub use tiles::Tiles;

use evidence::Evidence;
use integrate::Share;

use crate::config::Config;
use crate::geometry::Cell;
use crate::ground::AttitudeFilter;
use crate::input::Input;

/// A person carried the robot if it moved more cells than this between two observations. It drives
/// one or two.
const MAX_STEP_CELLS: i32 = 10;

/// The map, with `TILES` pages in the pool and `SLOTS` tiles in the directory.
#[derive(Debug)]
pub struct Map<const TILES: usize, const SLOTS: usize> {
    pub(crate) tiles: Tiles<TILES, SLOTS>,
    evidence: Evidence,
    /// The robot's cell at the last observation.
    last_cell: Option<Cell>,
    /// The least cell of the elevation window, on uneven ground.
    window: Cell,
    has_surveyed: bool,
    /// The last step classified the odd ones of the far rows.
    odd_rows: bool,
    attitude: AttitudeFilter,
    out_of_box: bool,
    pool_full: bool,
}

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Creates an empty map without a box.
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

    /// Clears the map and begins a session.
    pub fn begin(&mut self, config: &Config) {
        self.reset();
        self.tiles.set_fence(&config.fence);
        if config.ground.is_some() {
            self.lend_memory_to_elevation(config.localise);
        }
    }

    /// Clears the map.
    pub(crate) fn reset(&mut self) {
        self.tiles.reset();
        self.evidence.reset(Cell::default());
        self.last_cell = None;
        self.has_surveyed = false;
        self.odd_rows = false;
        self.attitude = AttitudeFilter::new();
        self.out_of_box = false;
        self.pool_full = false;
    }

    /// Enters an input's scans and pose.
    pub fn observe(&mut self, config: &Config, input: &Input<'_>) {
        let tuning = &config.tuning.map;
        let robot = input.pose.point();
        self.tiles.compacting.follow(robot.cell());
        if let Some(ground) = &config.ground {
            self.free_footprint(robot, tuning.stand_radius_m);
            self.record_visit(robot.cell());
            self.update_elevation(config, ground, input);
            return;
        }
        self.evidence.follow(robot.cell());
        self.free_footprint(robot, tuning.stand_radius_m);
        self.record_visit(robot.cell());
        let share = Share::of(config, input);
        for (laser, ranges_mm) in config.lasers.iter().zip(input.scans) {
            self.integrate(tuning, &input.pose, (laser, ranges_mm), share);
        }
    }

    /// Marks the trail from the last cell without diagonal steps, so that its cells share sides. A
    /// trail longer than [`MAX_STEP_CELLS`] is not marked: the robot was carried.
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

    /// Returns the class of a cell.
    #[must_use]
    pub fn class(&self, cell: Cell) -> Class {
        self.tiles.class(cell)
    }

    /// Returns the tiles.
    #[must_use]
    pub const fn tiles(&self) -> &Tiles<TILES, SLOTS> {
        &self.tiles
    }

    /// Returns true if a beam met a cell that is too far from the first tile.
    #[must_use]
    pub const fn out_of_box(&self) -> bool {
        self.out_of_box
    }

    /// Returns true if a beam met a cell that the pool has no page for.
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
