//! The planner's memory from step to step, and views of it.
//!
//! Invariant: only [`super::step`] and [`State::reset`] change it.
//!
//! Units: map cells.

use super::correction::Correcting;
use super::door::Door;
use super::errand::Errands;
use super::ground_model::GroundModel;
use super::wiring::Wiring;
use super::workspace::{RING, SCRATCH};
use crate::config::Config;
use crate::doing::{Doing, Events};
use crate::drive::side_slope::SlopeDirection;
use crate::drive::{self, Drive};
use crate::field::preference::Preferences;
use crate::geometry::Cell;
use crate::input::InputFaults;
use crate::localise::{Localiser, Location};
use crate::map::Map;
use crate::path::{map_exits, viewpoint};
use crate::roadmap::reachability;
use crate::roadmap::skeleton::Skeleton;
use crate::status::Status;
use crate::strategy::Strategist;
use crate::team::Team;

/// The planner's memory from step to step.
///
/// `TILES` is the number of map tiles in the pool, `SLOTS` the number of tiles that the map may
/// have. Tiles with little content need no place in the pool.
#[derive(Debug)]
pub struct State<const TILES: usize, const SLOTS: usize> {
    /// What the host reported, checked.
    pub(super) door: Door,
    /// The check of the first moves.
    pub(super) wiring: Wiring,
    pub(super) localiser: Localiser,
    pub(super) map: Map<TILES, SLOTS>,
    /// All that differs between flat and uneven ground.
    pub(super) ground: GroundModel<TILES>,
    pub(super) skeleton: Skeleton<SLOTS>,
    pub(super) strategy: Strategist<SLOTS>,
    /// Preferences of the window's cells on uneven ground.
    pub(super) preferences: Preferences,
    /// The search for viewpoints, which begins when no frontier can be reached.
    pub(super) viewpoints: viewpoint::Search,
    pub(super) drive: Drive,
    /// The other robots, and what is said to them.
    pub(super) team: Team,
    /// The direction driven on a slope that the robot must not cross.
    pub(super) slope_direction: Option<SlopeDirection>,
    /// The direction in which the drive found no way, until its next search.
    pub(super) blocked_direction: Option<SlopeDirection>,
    pub(super) status: Status,
    pub(super) started: bool,
    /// Steps in a row in which no beam told anything.
    pub(super) dark_steps: u8,
    /// A skeleton is complete and no path was planned on it yet.
    pub(super) has_new_skeleton: bool,
    /// The search for ways out of a map without room, which ends the exploration.
    pub(super) exits: map_exits::Search,
    /// This step took what came for gone.
    pub(super) forgot_arrivals: bool,
    /// What happened in this step, but for what the strategy tells.
    pub(super) events: Events,
    /// What corrects the map.
    pub(super) correcting: Correcting,
    /// Where the robot is ordered to go.
    pub(super) errands: Errands,
    /// The session was told what lies around the robot.
    pub(super) is_recalled: bool,
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    const CHECK: () = {
        assert!(
            SLOTS * 16 + RING <= SCRATCH,
            "the wavefront fits the scratch"
        );
        assert!(
            reachability::scratch_words(SLOTS) <= SCRATCH,
            "the reachability flood fits the scratch"
        );
        assert!(
            drive::SCRATCH_WORDS <= SCRATCH,
            "a recovery search fits the scratch"
        );
    };

    /// Returns an empty planner.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::CHECK;
        Self {
            door: Door::new(),
            wiring: Wiring::new(),
            localiser: Localiser::new(),
            map: Map::new(),
            ground: GroundModel::new(),
            skeleton: Skeleton::new(),
            strategy: Strategist::new(),
            preferences: Preferences::new(),
            viewpoints: viewpoint::Search::new(),
            drive: Drive::new(),
            team: Team::new(),
            slope_direction: None,
            blocked_direction: None,
            status: Status::Exploring,
            started: false,
            dark_steps: 0,
            has_new_skeleton: false,
            exits: map_exits::Search::new(),
            forgot_arrivals: false,
            events: Events::NONE,
            correcting: Correcting::new(),
            errands: Errands::new(),
            is_recalled: false,
        }
    }

    /// Forgets everything and begins a session with `config`.
    pub fn reset(&mut self, config: &Config) {
        self.door = Door::new();
        put(&mut self.wiring, Wiring::new);
        put(&mut self.localiser, Localiser::new);
        self.map.begin(config);
        put(&mut self.preferences, Preferences::new);
        put(&mut self.ground, || GroundModel::of(config));
        self.skeleton
            .reset(Strategist::<SLOTS>::space(config.strategy));
        self.strategy.reset(config);
        put(&mut self.viewpoints, viewpoint::Search::new);
        put(&mut self.drive, Drive::new);
        self.team.reset(config.team, config.ground.is_some());
        (self.slope_direction, self.blocked_direction) = (None, None);
        self.status = Status::Exploring;
        self.started = false;
        self.dark_steps = 0;
        self.has_new_skeleton = false;
        put(&mut self.exits, map_exits::Search::new);
        self.forgot_arrivals = false;
        self.events = Events::NONE;
        self.correcting = Correcting::new();
        self.errands = Errands::new();
        self.is_recalled = false;
    }

    /// Returns the planner's status after the last step.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.status
    }

    /// Returns what happened in this step.
    pub(super) const fn take_events(&mut self) -> Events {
        self.events.take().and(self.strategy.frontier.take_events())
    }

    /// Returns what a robot does that follows a field or a heading.
    pub(super) fn follows(&self) -> Doing {
        if self.drive.is_searching() {
            Doing::Searches
        } else if self.drive.is_recovering() {
            Doing::Recovers
        } else if self.errands.is_going() {
            Doing::GoesByOrder
        } else if self.strategy.heading_rad().is_some() {
            Doing::FollowsForces
        } else if self.strategy.frontier.goes_to_look() {
            Doing::GoesToLook
        } else {
            Doing::Explores
        }
    }

    /// Takes what came for gone. It may stand, so scans that show it say nothing against the pose.
    pub(super) fn forget_arrivals(&mut self, config: &Config, robot: Cell) {
        self.map.forget_arrivals(config, robot);
        self.localiser.expect_contradiction(&config.tuning.localise);
    }

    /// Returns the location after the last step.
    #[must_use]
    pub fn location(&self) -> Location {
        self.localiser.location()
    }

    /// Returns the numbers of reports since the start of the session that were not as they should
    /// be.
    #[must_use]
    pub const fn input_faults(&self) -> InputFaults {
        self.door.faults()
    }
}

/// Puts a new value into its place. It is not inlined: the value's copies on the stack end with it.
#[inline(never)]
fn put<T>(place: &mut T, make: impl FnOnce() -> T) {
    *place = make();
}

impl<const TILES: usize, const SLOTS: usize> Default for State<TILES, SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}
