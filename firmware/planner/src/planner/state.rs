//! What a planner remembers from step to step, and what can be read of it.
//!
//! Invariant: only [`super::step`] and [`State::reset`] change it. Units: map cells.

use crate::config::Config;
use crate::drive::side_slope::SlopeDirection;
use crate::drive::{self, Drive};
use crate::field::height_preference::Preferences;
use crate::geometry::Cell;
use crate::map::Map;
use crate::map::obstacle_points::ObstaclePoints;
use crate::path::height_levels::HeightLevels;
use crate::path::{Path, viewpoint};
use crate::planner::workspace::{RING, SCRATCH};
use crate::roadmap::reachability;
use crate::roadmap::skeleton::Skeleton;
use crate::status::{Frontier, Status};
use crate::strategy::Strategist;
use crate::strategy::ouroboros::Ouroboros;
use crate::strategy::tdbvp::Tdbvp;

/// What a planner remembers from step to step. `TILES` map tiles in the pool, `SLOTS` tile places in the box.
#[derive(Debug)]
pub struct State<const TILES: usize, const SLOTS: usize> {
    pub(super) map: Map<TILES, SLOTS>,
    pub(super) ground: GroundModel<TILES>,
    pub(super) topology: Skeleton<SLOTS>,
    pub(super) strategy: Strategist<SLOTS>,
    /// What ground is preferred, where it is uneven.
    pub(super) preferences: Preferences,
    /// What can only be seen is searched for, when nothing is left to drive to.
    pub(super) viewpoints: viewpoint::Search,
    pub(super) drive: Drive,
    /// Up or down the slope that it is on, where it may not be crossed.
    pub(super) wedge: Option<SlopeDirection>,
    /// The one in which the drive found no way, until it searches again.
    pub(super) shut: Option<SlopeDirection>,
    pub(super) status: Status,
    pub(super) started: bool,
    /// A skeleton was published that no path was planned on yet.
    pub(super) fresh: bool,
    /// Where the robot began.
    pub(super) start: Cell,
}

/// What is kept of the space beside the map. Flat ground has no heights, and on uneven ground level beams end on slopes: what is near is
/// what the map says.
///
/// With its tag of its own, so that the value without anything is all zeros and costs no flash as a static one.
#[derive(Debug)]
#[repr(u8)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; both are about as large with the pool of an image"
)]
pub(super) enum GroundModel<const TILES: usize> {
    Flat(ObstaclePoints),
    Uneven(HeightLevels<TILES>),
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    const CHECK: () = {
        assert!(SLOTS * 16 + RING <= SCRATCH, "the wave fits the scratch");
        assert!(
            reachability::scratch_words(SLOTS) <= SCRATCH,
            "the flood at the end fits the scratch"
        );
        assert!(
            drive::recovery::SCRATCH_WORDS <= SCRATCH,
            "a search fits the scratch"
        );
    };

    /// An empty planner.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::CHECK;
        Self {
            map: Map::new(),
            ground: GroundModel::Flat(ObstaclePoints::new()),
            topology: Skeleton::new(),
            strategy: Strategist::new(),
            preferences: Preferences::new(),
            viewpoints: viewpoint::Search::new(),
            drive: Drive::new(),
            wedge: None,
            shut: None,
            status: Status::Exploring,
            started: false,
            fresh: false,
            start: Cell { x: 0, y: 0 },
        }
    }

    /// Forget everything and take the box's shape from `config`.
    pub fn reset(&mut self, config: &Config) {
        self.map.begin(config);
        self.preferences = Preferences::new();
        self.ground = match config.ground {
            None => GroundModel::Flat(ObstaclePoints::new()),
            Some(_) => GroundModel::Uneven(HeightLevels::new()),
        };
        self.topology
            .reset(Strategist::<SLOTS>::space(config.strategy));
        self.strategy.reset(config);
        self.viewpoints = viewpoint::Search::new();
        self.drive = Drive::new();
        (self.wedge, self.shut) = (None, None);
        self.status = Status::Exploring;
        self.started = false;
        self.fresh = false;
    }

    /// The map.
    #[must_use]
    pub const fn map(&self) -> &Map<TILES, SLOTS> {
        &self.map
    }

    /// The centre cells.
    #[must_use]
    pub const fn topology(&self) -> &Skeleton<SLOTS> {
        &self.topology
    }

    /// The way to the present goal.
    #[must_use]
    pub const fn path(&self) -> &Path {
        self.strategy.frontier.path()
    }

    /// What is known of loops, where the session's strategy closes them.
    #[must_use]
    pub const fn ouroboros(&self) -> Option<&Ouroboros<SLOTS>> {
        self.strategy.ouroboros()
    }

    /// What is known of rails, where the session's strategy follows them.
    #[must_use]
    pub const fn tdbvp(&self) -> Option<&Tdbvp<SLOTS>> {
        self.strategy.tdbvp()
    }

    /// The cells of a tile (two bits each: 0 unknown, 1 free, 2 obstacle, 3 negative obstacle), or `None` where
    /// nothing was ever seen.
    #[must_use]
    pub fn tile(&self, x: i16, y: i16) -> Option<[u8; 256]> {
        self.map.tiles().packed(i32::from(x), i32::from(y))
    }

    /// The skeleton of a tile: 16 rows of 16 coarse cells.
    #[must_use]
    pub fn tile_skeleton(&self, x: i16, y: i16) -> [u16; 16] {
        let frame = self.topology.frame();
        let mut rows = [0; 16];
        let Some(plane) = self.topology.skeleton() else {
            return rows;
        };
        for (dy, row) in rows.iter_mut().enumerate() {
            let cell = Cell {
                x: i32::from(x) * 32,
                y: i32::from(y) * 32 + 2 * dy as i32,
            };
            if let Some(site) = frame.site(cell) {
                let word = plane.word(usize::from(site.y), usize::from(site.x / 32));
                *row = (word >> (site.x & 16)) as u16;
            }
        }
        rows
    }

    /// Frontiers left over, and why.
    #[must_use]
    pub fn frontiers(&self) -> &[Frontier] {
        self.strategy.frontier.dropped()
    }
}

impl<const TILES: usize, const SLOTS: usize> Default for State<TILES, SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}
