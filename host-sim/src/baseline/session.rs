//! A baseline as a link: only the strategy is its own, the rest is the code of the device.
//!
//! ```text
//! observation → Map, ObstaclePoints → Chart → Strategy → heading → Drive → command
//!                └→ HeightGrid ───────────┘   (on uneven ground)
//! ```
//!
//! Map, obstacle points, configuration space and drive come from `fieldline_planner`. The map has
//! the capacity of the default image, so a run ends with a full map where the device's run would.
//! The rules for a blocked start and for the reason of an end are the planner's too. While the
//! drive searches for a recovery, nothing is planned. On uneven ground the collision checker gets
//! the borders of the map's obstacles in place of the obstacle points.
//!
//! Departs from the planner's step in one point: at its goal the robot turns to the left only, and
//! stands still if that turn is blocked.

mod link;

use fieldline_device::convert;
use fieldline_device::{SLOTS, TILES};
use fieldline_planner::config::{Config, Tuning};
use fieldline_planner::drive::{CollisionChecker, Drive, Place, SCRATCH_WORDS, SearchQuery};
use fieldline_planner::geometry::{Cell, Point, Pose, Twist};
use fieldline_planner::input::Input;
use fieldline_planner::map::Map;
use fieldline_planner::map::obstacle_points::{self, ObstaclePoints};
use fieldline_planner::math;
use fieldline_planner::planner::{starts_blocked, tells};
use fieldline_planner::roadmap::configuration_space::Footprint;
use fieldline_planner::status::ResidualReason;
use fieldline_protocol::message::{Command, Cost, Fault, Finish, Refusal, Start, Status};

use super::chart::Chart;
use super::heights::HeightGrid;
use super::strategy::{Outcome, Scene, Strategy, UnevenScene};
use crate::link::LinkError;
use crate::trial::at_once::AtOnce;

/// Turn rate of a robot that looks around at its goal, radians per second; as in the planner.
const LOOK_AROUND_RADPS: f32 = 0.6;
/// Clearance of that turn, metres; the planner's for a robot that creeps.
const LOOK_AROUND_MARGIN_M: f32 = 0.025;
/// Time without a goal after which the exploration ends, milliseconds.
const EMPTY_MS: u32 = 1_000;
/// Time without a direction after which the exploration ends, milliseconds. \[Maffei14\]: a field
/// "can take a very long time to converge and start attracting the robot".
pub const FLAT_MS: u32 = 30_000;
/// A robot with less free space than this is boxed in, cells: 1 m², as in the planner.
const BOX_CELLS: usize = 100;

/// A session of one strategy.
#[derive(Debug)]
pub struct Session<S> {
    /// The strategy.
    pub strategy: S,
    config: Option<Config>,
    at_once: AtOnce,
    status: Status,
    paused: bool,
    started: bool,
    /// Since when the strategy has no path.
    idle_since_ms: Option<u32>,
    map: Box<Map<TILES, SLOTS>>,
    obstacle_points: ObstaclePoints,
    heights: HeightGrid,
    /// Number of dropped goals that `resolve_gaps` has handled.
    resolved: usize,
    drive: Drive,
    chart: Chart,
    scratch: Vec<u32>,
    calls: u64,
}

impl<S: Strategy> Session<S> {
    /// Makes a session that was not started yet.
    #[must_use]
    pub fn new(strategy: S) -> Self {
        Self {
            strategy,
            config: None,
            at_once: AtOnce::default(),
            status: Status::Idle,
            paused: false,
            started: false,
            idle_since_ms: None,
            map: Box::new(Map::new()),
            obstacle_points: ObstaclePoints::new(),
            heights: HeightGrid::default(),
            resolved: 0,
            drive: Drive::new(),
            chart: Chart::new(),
            scratch: vec![0; SCRATCH_WORDS],
            calls: 0,
        }
    }

    fn status(&self) -> Status {
        match self.status {
            Status::Exploring | Status::NoScan if self.paused => Status::Paused,
            status => status,
        }
    }

    fn start(&mut self, start: &Start) -> Result<(), Refusal> {
        let config = convert::config(start, &Tuning::DEFAULT).map_err(Refusal::BadParameter)?;
        self.map.begin(&config);
        self.obstacle_points.clear();
        self.heights = HeightGrid::default();
        self.resolved = 0;
        self.drive = Drive::new();
        self.chart = Chart::new();
        self.strategy.reset();
        self.config = Some(config);
        self.at_once = AtOnce::default();
        self.status = Status::Exploring;
        self.paused = false;
        self.started = false;
        self.idle_since_ms = None;
        Ok(())
    }

    fn step(&mut self, config: &Config, input: &Input<'_>) -> Command {
        self.sense(config, input);
        if self.status != Status::Exploring {
            return standing(self.status);
        }
        if !self.drive.is_searching() {
            let footprint = Footprint::new(config.radius_m());
            self.chart
                .draw(self.map.tiles(), &footprint, input.pose.point());
            self.plan(config, input);
        }
        if self.status == Status::Exploring && self.idle_since_ms.is_none() {
            self.follow(config, input)
        } else {
            standing(self.status)
        }
    }

    /// Lets the strategy plan.
    fn plan(&mut self, config: &Config, input: &Input<'_>) {
        let scene = scene(config, &self.chart, &self.heights, input);
        match self.strategy.plan(&scene) {
            Outcome::Path => self.idle_since_ms = None,
            Outcome::Stuck => self.status = Status::Fault(Fault::Stuck),
            Outcome::Nothing => {
                if self.is_idle_for(EMPTY_MS, input.time_ms) {
                    self.status = self.conclude(input.pose.point().cell());
                }
            }
            Outcome::Flat => {
                if self.is_idle_for(FLAT_MS, input.time_ms) {
                    self.status = Status::Finished(Finish::NothingAttracts);
                }
            }
        }
        if config.ground().is_some() {
            self.resolve_gaps(config);
        }
    }

    /// Returns true if the robot has had nowhere to go for this time. It stands meanwhile.
    fn is_idle_for(&mut self, limit_ms: u32, time_ms: u32) -> bool {
        let since_ms = *self.idle_since_ms.get_or_insert(time_ms);
        time_ms.wrapping_sub(since_ms) >= limit_ms
    }

    /// Marks the gaps of the ground at goals that were dropped as unobservable, as the planner
    /// does.
    fn resolve_gaps(&mut self, config: &Config) {
        let dropped = self.strategy.dropped();
        let new = dropped.iter().skip(self.resolved);
        for frontier in new.filter(|frontier| frontier.reason == ResidualReason::Unobservable) {
            self.map.resolve_gaps(config, frontier.cell);
        }
        self.resolved = dropped.len();
    }

    /// Integrates scans and odometry into the map and the obstacle points.
    fn sense(&mut self, config: &Config, input: &Input<'_>) {
        if !self.started {
            self.started = tells(input);
            self.status = match self.started {
                false => Status::NoScan,
                true if starts_blocked(config, input) => Status::Fault(Fault::StartBlocked),
                true => Status::Exploring,
            };
        }
        self.map.observe(config, input);
        if config.ground().is_some() {
            self.heights.keep(&self.map.heights());
            self.map.compact(&mut ());
            return;
        }
        for (laser, ranges_mm) in config.lasers().iter().zip(input.scans) {
            if laser.is_level() {
                self.obstacle_points
                    .update(config, &input.pose, (laser, ranges_mm), |_| false);
            }
        }
    }

    /// Returns the reason of the end, once no goal is reachable.
    fn conclude(&self, robot: Cell) -> Status {
        if self.map.pool_full() {
            Status::Fault(Fault::MapFull)
        } else if self.map.out_of_box() {
            Status::Fault(Fault::OutOfBox)
        } else if self.chart.room(robot, BOX_CELLS) < BOX_CELLS {
            Status::Finished(Finish::BoxedIn)
        } else {
            Status::Finished(Finish::Explored)
        }
    }

    /// Makes the collision checker for this step.
    ///
    /// On uneven ground level beams end on slopes, so the obstacles come from the map.
    fn collision_checker(&self, config: &Config, pose: &Pose) -> CollisionChecker {
        if config.ground().is_none() {
            return CollisionChecker::new(config.robot(), pose, self.obstacle_points.points());
        }
        let mut checker = CollisionChecker::empty(config.robot());
        let (tiles, robot) = (self.map.tiles(), pose.point());
        let borders = obstacle_points::inflated_border_cells(tiles, robot, config.tuning());
        checker.keep_off(pose, borders);
        checker
    }

    /// Drives along the heading of the plan.
    fn follow(&mut self, config: &Config, input: &Input<'_>) -> Command {
        let pose = input.pose;
        let scene = scene(config, &self.chart, &self.heights, input);
        let strategy = &self.strategy;
        let checker = self.collision_checker(config, &pose);
        let heading = strategy.heading_at(&scene, pose.point());
        let velocity = if heading.is_some() {
            let heading_there = |place: Place| {
                let there = strategy.heading_at(&scene, to_map(&pose, place));
                there.map(|heading| math::wrap(heading - pose.yaw_rad))
            };
            let potential_there =
                |place: Place| strategy.potential_at(&scene, to_map(&pose, place));
            let mut query = SearchQuery::new(&checker, heading_there, Some(&potential_there));
            self.drive
                .follow(config, &mut query, input.velocity, &mut self.scratch)
        } else {
            look_around(config, input, &checker)
        };
        Command {
            velocity: convert::wire_twist(&velocity),
            status: Status::Exploring,
            heading: convert::quantity(heading.unwrap_or(pose.yaw_rad)),
            cost: Cost {
                cycles: self.strategy.cycles(),
                budget_exhausted: self.strategy.is_exhausted(),
                ..Cost::default()
            },
            ..Command::default()
        }
    }
}

fn scene<'a>(
    config: &'a Config,
    chart: &'a Chart,
    heights: &'a HeightGrid,
    input: &Input<'_>,
) -> Scene<'a> {
    let uneven = |ground| UnevenScene { ground, heights };
    Scene {
        chart,
        pose: input.pose,
        time_ms: input.time_ms,
        uneven: config.ground().map(uneven),
    }
}

/// Returns a turn on the spot, or a standstill if the turn is blocked.
fn look_around(config: &Config, input: &Input<'_>, checker: &CollisionChecker) -> Twist {
    let turn = Twist {
        linear_mps: 0.0,
        angular_radps: LOOK_AROUND_RADPS,
    };
    if checker.admits(turn, input.velocity, config, LOOK_AROUND_MARGIN_M) {
        turn
    } else {
        Twist::default()
    }
}

/// Transforms a place from the robot frame to the map frame.
fn to_map(pose: &Pose, place: Place) -> Point {
    pose.to_map(Point {
        x_m: place.x_m,
        y_m: place.y_m,
    })
}

/// Makes a command with zero velocity.
fn standing(status: Status) -> Command {
    Command {
        status,
        ..Command::default()
    }
}

fn refused(refusal: Refusal) -> LinkError {
    LinkError::Refused(refusal.to_string())
}
