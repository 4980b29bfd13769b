//! A host-only planner as a [`Link`]: everything but the strategy is the device's own code.
//!
//! ```text
//! observation → Map, ObstaclePoints → Chart → Plan (the strategy) → heading → Drive → command
//!                └→ HeightGrid ───────────┘   on uneven ground, where the map's rims take the near field's place
//! ```
//!
//! Map (with the capacity of the default image, so that a run ends for want of memory where the device's would), near
//! field, clearance and drive are those of `fieldline_planner`; so are the rules for a blocked start, for what an end means, and
//! that nothing is planned while the drive searches for a manoeuvre. What differs from the planner's own step is what a
//! [`Plan`] says. Departs from that step in one thing: a robot that looks around at its goal does so only where the turn is
//! clear.

use fieldline_device::convert;
use fieldline_device::session::{self, Boot};
use fieldline_device::{SLOTS, TILES};
use fieldline_planner::config::Config;
use fieldline_planner::config::UnevenGround;
use fieldline_planner::drive::{CollisionChecker, Drive, Ground, Place, recovery};
use fieldline_planner::geometry::{Cell, Point, Pose, Twist};
use fieldline_planner::input::Input;
use fieldline_planner::map::obstacle_points::{self, ObstaclePoints};
use fieldline_planner::map::{Map, Tiles};
use fieldline_planner::math;
use fieldline_planner::planner::starts_blocked;
use fieldline_planner::roadmap::configuration_space::Footprint;
use fieldline_planner::robot::is_level;
use fieldline_planner::status::{self, Residue};
use fieldline_protocol::message::{
    Command, Control, Cost, Fault, FieldRow, Finish, Identity, MAX_FRONTIERS, Observation, Path,
    Refusal, ResidualFrontier, Start, Status, TILE_SKELETON_BYTES, TILE_STAMPS, Tile,
};

use super::chart::Chart;
use super::heights::HeightGrid;
use crate::link::{Link, LinkError, LinkStats};

/// Turn rate of a robot that looks around at its goal, radians a second: the planner's.
const LOOK_AROUND_RADPS: f32 = 0.6;
/// Clearance kept in that turn, metres: the drive's when creeping.
const LOOK_AROUND_MARGIN_M: f32 = 0.025;
/// Time for which a plan must find nothing before the exploration is over, milliseconds.
const EMPTY_MS: u32 = 1_000;
/// A robot whose centre has less room than this, in cells, is boxed in: the planner's one square metre.
const BOX_CELLS: usize = 100;

/// What a plan is made from.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The known space.
    pub chart: &'a Chart,
    /// The robot.
    pub pose: Pose,
    /// The host's clock, milliseconds.
    pub time_ms: u32,
    /// The ground, if it is to be heeded.
    pub ground: Option<Uneven<'a>>,
}

/// Uneven ground.
#[derive(Clone, Copy, Debug)]
pub struct Uneven<'a> {
    /// Its parameters.
    pub terrain: &'a UnevenGround,
    /// How high it lies.
    pub heights: &'a HeightGrid,
}

/// What a strategy says of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outlook {
    /// There is a way to unexplored space.
    Way,
    /// There is none.
    Nothing,
    /// The robot cannot move, whatever the goal.
    Stuck,
}

/// A strategy: where to go next.
pub trait Plan {
    /// Forget everything.
    fn reset(&mut self);

    /// Look at the scene of this step.
    fn plan(&mut self, scene: &Scene<'_>) -> Outlook;

    /// The heading that the plan asks for at a point near the robot, radians; `None` where it asks for none.
    fn heading_at(&self, scene: &Scene<'_>, point: Point) -> Option<f32>;

    /// How far along the plan a point near the robot is, by a factor that is 1 where the robot stands and that doubles in
    /// about 0.1 m in a passage as wide as the robot, as the planner's q does.
    fn potential_at(&self, scene: &Scene<'_>, point: Point) -> f32;

    /// Goals that were given up, and why.
    fn dropped(&self) -> Vec<status::Frontier>;

    /// Solver cycles of the last plan.
    fn cycles(&self) -> u16 {
        0
    }

    /// Whether the last plan's solver ran out of cycles.
    fn is_exhausted(&self) -> bool {
        false
    }

    /// A row of the last field around the robot.
    fn field_row(&self, _row: u8) -> Option<FieldRow> {
        None
    }
}

/// A strategy at work.
#[derive(Debug)]
pub struct Session<P> {
    /// The strategy.
    pub plan: P,
    config: Option<Config>,
    status: Status,
    paused: bool,
    started: bool,
    empty_since_ms: Option<u32>,
    map: Box<Map<TILES, SLOTS>>,
    near: ObstaclePoints,
    heights: HeightGrid,
    /// Goals whose ground was given up with them.
    given_up: usize,
    drive: Drive,
    chart: Chart,
    scratch: Vec<u32>,
    calls: u64,
}

impl<P: Plan> Session<P> {
    /// Before a start.
    #[must_use]
    pub fn new(plan: P) -> Self {
        Self {
            plan,
            config: None,
            status: Status::Idle,
            paused: false,
            started: false,
            empty_since_ms: None,
            map: Box::new(Map::new()),
            near: ObstaclePoints::new(),
            heights: HeightGrid::default(),
            given_up: 0,
            drive: Drive::new(),
            chart: Chart::new(),
            scratch: vec![0; recovery::SCRATCH_WORDS],
            calls: 0,
        }
    }

    fn status(&self) -> Status {
        match self.status {
            Status::Exploring if self.paused => Status::Paused,
            status => status,
        }
    }

    fn start(&mut self, start: &Start) -> Result<(), Refusal> {
        let config = convert::config(start).map_err(Refusal::BadParameter)?;
        let (across, up) = config.box_tiles;
        if !Tiles::<TILES, SLOTS>::fits(across, up) {
            return Err(Refusal::BadBox);
        }
        self.map.begin(&config);
        self.near.clear();
        self.heights = HeightGrid::default();
        self.given_up = 0;
        self.drive = Drive::new();
        self.chart = Chart::new();
        self.plan.reset();
        self.config = Some(config);
        self.status = Status::Exploring;
        self.paused = false;
        self.started = false;
        self.empty_since_ms = None;
        Ok(())
    }

    fn step(&mut self, config: &Config, input: &Input<'_>) -> Command {
        self.sense(config, input);
        if self.status != Status::Exploring {
            return standing(self.status);
        }
        if !self.drive.is_searching() {
            let disc = Footprint::new(config.robot_radius_m);
            self.chart.draw(self.map.tiles(), &disc, input.pose.point());
            self.look(config, input);
        }
        if self.status == Status::Exploring && self.empty_since_ms.is_none() {
            self.follow(config, input)
        } else {
            standing(self.status)
        }
    }

    /// Let the strategy look at the scene.
    fn look(&mut self, config: &Config, input: &Input<'_>) {
        let ground = ground(config, &self.heights);
        let scene = scene(&self.chart, ground, input);
        match self.plan.plan(&scene) {
            Outlook::Way => self.empty_since_ms = None,
            Outlook::Stuck => self.status = Status::Fault(Fault::Stuck),
            Outlook::Nothing => {
                let since = *self.empty_since_ms.get_or_insert(input.time_ms);
                if input.time_ms.wrapping_sub(since) >= EMPTY_MS {
                    self.status = self.conclude(input.pose.point().cell());
                }
            }
        }
        if let Some(terrain) = &config.ground {
            self.resolve_gaps(terrain);
        }
    }

    /// Ground that stays out of view where a goal was given up is settled, as the planner settles it.
    fn resolve_gaps(&mut self, terrain: &UnevenGround) {
        let dropped = self.plan.dropped();
        let new = dropped.iter().skip(self.given_up);
        for frontier in new.filter(|frontier| frontier.reason == Residue::Unobservable) {
            self.map.resolve_gaps(terrain, frontier.cell);
        }
        self.given_up = dropped.len();
    }

    /// Scans and odometry into the map and the near field.
    fn sense(&mut self, config: &Config, input: &Input<'_>) {
        if !self.started {
            self.started = true;
            if starts_blocked(config, input) {
                self.status = Status::Fault(Fault::StartBlocked);
            }
        }
        self.map.observe(config, input);
        if config.ground.is_some() {
            self.heights.keep(&self.map.heights());
            self.map.compact(&mut ());
            return;
        }
        for (laser, ranges_mm) in config.lasers.iter().zip(input.scans) {
            if is_level(laser) {
                self.near
                    .update(&config.robot, &input.pose, laser, ranges_mm);
            }
        }
    }

    /// Why there is nothing left within reach.
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

    /// What is near: by the level beams, or on uneven ground, where they end on slopes, by the map.
    fn surround(&self, config: &Config, pose: &Pose) -> CollisionChecker {
        if config.ground.is_none() {
            return CollisionChecker::new(&config.robot, pose, self.near.points());
        }
        let mut surround = CollisionChecker::empty(&config.robot);
        surround.keep_off(
            pose,
            obstacle_points::inflated_border_cells(self.map.tiles(), pose.point()),
        );
        surround
    }

    /// Drive where the plan says.
    fn follow(&mut self, config: &Config, input: &Input<'_>) -> Command {
        let pose = input.pose;
        let scene = scene(&self.chart, ground(config, &self.heights), input);
        let plan = &self.plan;
        let surround = self.surround(config, &pose);
        let heading = plan.heading_at(&scene, pose.point());
        let velocity = if heading.is_some() {
            let heading_there = |place: Place| {
                let there = plan.heading_at(&scene, ahead(&pose, place));
                there.map(|heading| math::wrap(heading - pose.yaw_rad))
            };
            let potential_there = |place: Place| plan.potential_at(&scene, ahead(&pose, place));
            let ground = Ground {
                surround: &surround,
                heading_at: heading_there,
                potential_at: Some(&potential_there),
            };
            self.drive
                .follow(config, &ground, input.velocity, &mut self.scratch)
        } else {
            look_around(config, input, &surround)
        };
        Command {
            velocity: convert::wire_twist(&velocity),
            status: Status::Exploring,
            heading: convert::quantity(heading.unwrap_or(pose.yaw_rad)),
            cost: Cost {
                cycles: self.plan.cycles(),
                budget_exhausted: self.plan.is_exhausted(),
                ..Cost::default()
            },
            ..Command::default()
        }
    }
}

fn scene<'a>(chart: &'a Chart, ground: Option<Uneven<'a>>, input: &Input<'_>) -> Scene<'a> {
    Scene {
        chart,
        pose: input.pose,
        time_ms: input.time_ms,
        ground,
    }
}

/// The ground, where the session heeds it.
fn ground<'a>(config: &'a Config, heights: &'a HeightGrid) -> Option<Uneven<'a>> {
    let terrain = config.ground.as_ref()?;
    Some(Uneven { terrain, heights })
}

/// A turn on the spot where that touches nothing.
fn look_around(config: &Config, input: &Input<'_>, surround: &CollisionChecker) -> Twist {
    let turn = Twist {
        linear_mps: 0.0,
        angular_radps: LOOK_AROUND_RADPS,
    };
    if surround.admits(turn, input.velocity, config, LOOK_AROUND_MARGIN_M) {
        turn
    } else {
        Twist::default()
    }
}

/// A place relative to the robot, in the map.
fn ahead(pose: &Pose, place: Place) -> Point {
    let (sin, cos) = math::sin_cos(pose.yaw_rad);
    Point {
        x_m: pose.x_m + place.x_m * cos - place.y_m * sin,
        y_m: pose.y_m + place.x_m * sin + place.y_m * cos,
    }
}

/// Zero velocity, and why.
fn standing(status: Status) -> Command {
    Command {
        status,
        ..Command::default()
    }
}

fn refused(refusal: Refusal) -> LinkError {
    LinkError::Refused(refusal.to_string())
}

impl<P: Plan> Link for Session<P> {
    fn hello(&mut self) -> Result<Identity, LinkError> {
        Ok(session::identity(Boot::default(), TILES, SLOTS))
    }

    fn control(&mut self, control: &Control) -> Result<Status, LinkError> {
        self.calls += 1;
        match control {
            Control::Start(start) => self.start(start).map_err(refused)?,
            Control::Reset => {
                self.config = None;
                self.status = Status::Idle;
            }
            _ if self.config.is_none() => return Err(refused(Refusal::NotStarted)),
            Control::Pause => self.paused = true,
            Control::Resume => self.paused = false,
            Control::Stop => self.status = Status::Finished(Finish::Stopped),
        }
        Ok(self.status())
    }

    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        self.calls += 1;
        let Some(config) = self.config.take() else {
            return Err(refused(Refusal::NotStarted));
        };
        let command = match convert::input(observation, &config.lasers) {
            None => standing(Status::Fault(Fault::BadObservation)),
            Some(input) if self.status() == Status::Exploring => self.step(&config, &input),
            Some(_) => standing(self.status()),
        };
        self.config = Some(config);
        Ok(command)
    }

    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError> {
        self.calls += 1;
        let cells = self.map.tiles().packed(x.into(), y.into());
        Ok(cells.map(|cells| Tile {
            x,
            y,
            cells: cells.into_iter().collect(),
            skeleton: [0; TILE_SKELETON_BYTES].into_iter().collect(),
            closed_regions: 0,
            visit_stamps: [0; TILE_STAMPS],
        }))
    }

    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError> {
        self.calls += 1;
        Ok(self.plan.field_row(row))
    }

    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
        self.calls += 1;
        let dropped = self.plan.dropped();
        Ok(dropped
            .iter()
            .take(MAX_FRONTIERS)
            .map(convert::wire_frontier)
            .collect())
    }

    fn path(&mut self, _: u8) -> Result<Path, LinkError> {
        Ok(Path::default())
    }

    fn take_log(&mut self) -> Vec<u8> {
        Vec::new()
    }

    /// Every call counts as a frame sent and one received.
    fn stats(&self) -> LinkStats {
        LinkStats {
            sent: self.calls,
            received: self.calls,
            ..LinkStats::default()
        }
    }
}
