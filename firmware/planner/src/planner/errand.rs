//! Errands: the robot drives to a place by order, and stands there.
//!
//! ```text
//! order ─► on the way ──────────────► approach ───────► turn ─────► arrived
//!          path, window, progress     straight, brakes  on the spot
//!              └── no path, no progress ──┴── no turn ──┘──────────► unreachable
//! ```
//!
//! The way there is a path to a chosen goal, as to a frontier: the skeleton, the window's field,
//! the progress checker, retreats, right of way. The field leads to a coarse cell of 20 cm. So the
//! robot drives the last metre straight, where that is open, and brakes for the place itself. To a
//! place behind it that it cannot turn to, it backs.
//!
//! It turns where it stands within 0.1 m, or within the promised 0.2 m where nothing leads nearer.
//! It has arrived if it then has the heading. The turn has a clock of its own, which goes by the
//! heading; the progress checker, which goes by the way, waits meanwhile.
//!
//! *Home* is the pose of the session's first scan, with its heading, or the one that is set: a
//! device that was reset is told where its session began. It is a pose of the map: a correction
//! moves it with its tile.
//!
//! A robot with a [`Budget`](crate::Budget) gives itself the order to drive home. The way home is
//! measured in the step after each plan, on the same skeleton.
//!
//! Invariant: each errand ends, because the progress checker's chances and the time for the turn
//! have an end.
//! Units: metres, radians, milliseconds, in the map's frame.

mod approach;

use crate::config::Config;
use crate::geometry::{CELL_M, Cell, MapFromOdom, MapPose, OdomPose, Point, Pose};
use crate::grid::Shifts;
use crate::math;
use crate::path::context::STEP_M;
use crate::path::nearest::Centres;
use crate::path::search::path_between;
use crate::path::{map_exits, viewpoint};
use crate::planner::state::State;
use crate::planner::step::Step;
use crate::status::{Errand, Fault, Status};

/// Greatest coordinate of a goal, metres: as of a fence.
const MOST_M: f32 = 3_200.0;
/// Where home and goal are promised to be at the end, metres and radians: 0.2 m and 10°.
const PROMISED: (f32, f32) = (0.2, 0.1745);

/// An order to drive.
///
/// ```
/// use fieldline_planner::{
///     Capacity, Config, Errand, Input, LaserMount, Planner, Point, Pose, RobotShape, Status, Task,
///     TaskError, Twist,
/// };
///
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .build()?;
/// let mut planner = Box::new(Planner::<Capacity<16, 20>>::new(&config));
/// assert_eq!(planner.order(Task::Home), Err(TaskError::NotReady), "nothing was seen yet");
/// planner.step(&Input {
///     time_ms: 0,
///     pose: Pose::default(),
///     velocity: Twist::default(),
///     scans: [&[2_000; 181], &[]],
/// });
/// let there = Task::GoTo(Point { x_m: 1.0, y_m: 0.0 });
/// assert_eq!(planner.order(there).unwrap(), Status::Going(Errand::Goal));
/// assert_eq!(planner.order(Task::Explore).unwrap(), Status::Exploring);
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// Go on exploring.
    Explore,
    /// Drive to the pose of the first scan, and take its heading.
    Home,
    /// Drive to a point of the map.
    GoTo(Point),
}

/// The reason why an order is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskError {
    /// The robot has seen nothing yet, does not know where it is, or only surveys.
    NotReady,
    /// The goal is no number, farther than 3200 m from the map's origin, or forbidden.
    BadGoal,
}

/// The errand, and where home is.
#[derive(Debug)]
pub(super) struct Errands {
    home: Pose,
    /// Home was set, so the first scan does not tell it.
    is_home_set: bool,
    /// The robot is on the errand `last`. It is no option: the initial value is all zeros, and a
    /// static one costs no flash.
    is_going: bool,
    last: Going,
    /// The way driven so far, by odometry, and where it ends, metres.
    driven_m: f32,
    driven_to: Point,
    /// The way home when it was last measured, and the way driven until then, metres.
    measured_m: (f32, f32),
    /// A path was planned since.
    is_due: bool,
}

/// An errand on which the robot is.
#[derive(Clone, Copy, Debug)]
struct Going {
    errand: Errand,
    to: Point,
    yaw_rad: Option<f32>,
    /// The robot has been there, and only its heading is missing.
    is_there: bool,
    /// Nothing leads nearer, so there is where the robot stands.
    settles: bool,
    /// The heading of the straight way.
    straight_rad: Option<f32>,
    /// When the robot last came nearer to its heading, and the least turn that was left to each
    /// side, radians.
    turned_ms: u32,
    left_rad: [f32; 2],
}

impl Going {
    /// Makes an errand that begins.
    const fn new(errand: Errand, to: Point, yaw_rad: Option<f32>) -> Self {
        Self {
            errand,
            to,
            yaw_rad,
            is_there: false,
            settles: false,
            straight_rad: None,
            turned_ms: 0,
            left_rad: [2.0 * math::PI; 2],
        }
    }

    /// Returns true if the turn to the heading was begun.
    fn has_turned(&self) -> bool {
        self.left_rad
            .iter()
            .any(|left_rad| *left_rad < 2.0 * math::PI)
    }

    /// Returns true if a robot at `pose` is where the errand promises to take it.
    fn is_promised(&self, pose: &Pose) -> bool {
        let (near_m, near_rad) = PROMISED;
        pose.point().distance_m(self.to) <= near_m && self.error_rad(pose).abs() <= near_rad
    }

    /// Returns the turn to the heading that the errand asks for, radians; 0 if it asks for none.
    fn error_rad(&self, pose: &Pose) -> f32 {
        self.yaw_rad
            .map_or(0.0, |yaw| math::wrap(yaw - pose.yaw_rad))
    }
}

impl Errands {
    /// Returns the state at the start of a session.
    pub(super) const fn new() -> Self {
        Self {
            home: Pose::ORIGIN,
            is_home_set: false,
            is_going: false,
            last: Going {
                left_rad: [0.0; 2],
                ..Going::new(Errand::Home, Point::ORIGIN, None)
            },
            driven_m: 0.0,
            driven_to: Point::ORIGIN,
            measured_m: (0.0, 0.0),
            is_due: false,
        }
    }

    /// Notes where the session began: in the map, and by odometry.
    pub(super) const fn begin_at(&mut self, home: Pose, driven_to: Point) {
        if !self.is_home_set {
            self.home = home;
        }
        self.driven_to = driven_to;
    }

    /// Notes where the robot is, by odometry.
    pub(super) fn note_driven(&mut self, to: Point) {
        self.driven_m += to.distance_m(self.driven_to);
        self.driven_to = to;
    }

    /// Returns the way home, metres: as measured last, or back to where that was and on.
    fn way_home_m(&self) -> f32 {
        let (way_m, at_m) = self.measured_m;
        way_m + self.driven_m - at_m
    }

    /// Notes that a path was planned: the way home may be measured on the same skeleton.
    pub(super) const fn note_planned(&mut self, config: &Config) {
        self.is_due = !config.budget.is_empty();
    }

    /// Returns true once after each path.
    pub(super) const fn take_due(&mut self) -> bool {
        core::mem::replace(&mut self.is_due, false)
    }

    /// Returns true on an errand.
    pub(super) const fn is_going(&self) -> bool {
        self.is_going
    }

    /// Returns the errand on which the robot is.
    const fn going(&self) -> Option<Going> {
        if self.is_going { Some(self.last) } else { None }
    }

    /// Returns the errand on which the robot is.
    const fn going_mut(&mut self) -> Option<&mut Going> {
        if self.is_going {
            Some(&mut self.last)
        } else {
            None
        }
    }

    /// Returns the heading of the straight way to the goal, radians, while the robot drives it.
    pub(super) fn straight_rad(&self) -> Option<f32> {
        self.going()?.straight_rad
    }

    /// Returns the cell that the robot drives to.
    pub(super) fn goal(&self) -> Option<Cell> {
        self.going().map(|going| going.to.cell())
    }

    /// Moves home and goal with the tiles that they lie in.
    pub(super) fn correct(&mut self, shifts: Shifts<'_>) {
        let moved = |point: Point| {
            let (from, to) = (point.cell(), shifts.moved(point.cell()));
            Point {
                x_m: point.x_m + (to.x - from.x) as f32 * CELL_M,
                y_m: point.y_m + (to.y - from.y) as f32 * CELL_M,
            }
        };
        let Point { x_m, y_m } = moved(self.home.point());
        self.home = Pose {
            x_m,
            y_m,
            ..self.home
        };
        if let Some(going) = self.going_mut() {
            going.to = moved(going.to);
        }
    }

    /// Moves home into the team's coordinates, in which a goal is given already.
    pub(super) fn turn(&mut self, by: &MapFromOdom) {
        let MapPose(home) = by.apply(&OdomPose(self.home));
        self.home = home;
        if let Some(going) = self.going_mut()
            && going.errand == Errand::Home
        {
            (going.to, going.yaw_rad) = (home.point(), Some(home.yaw_rad));
        }
    }
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Sets home, a pose of the map, in the place of the first scan's. An order to drive home that
    /// was given before keeps its goal.
    ///
    /// # Errors
    /// [`TaskError::BadGoal`] if it is no number, or too far away. Nothing has changed then.
    pub fn set_home(&mut self, home: Pose) -> Result<(), TaskError> {
        if !is_near(home.point()) || !home.yaw_rad.is_finite() {
            return Err(TaskError::BadGoal);
        }
        (self.errands.home, self.errands.is_home_set) = (home, true);
        Ok(())
    }

    /// Returns home: the pose of the first scan, in the map, or the one that was set.
    #[must_use]
    pub const fn home(&self) -> Pose {
        self.errands.home
    }

    /// Takes an order to drive. Returns the status that follows. A robot that is stuck or has
    /// finished takes it as well.
    ///
    /// # Errors
    /// [`TaskError`]. Nothing has changed then.
    #[inline(never)]
    pub fn order(&mut self, config: &Config, task: Task) -> Result<Status, TaskError> {
        let is_ready = match self.status {
            Status::NoScan => false,
            Status::Fault(fault) => !matches!(
                fault,
                Fault::StartBlocked | Fault::StartForbidden | Fault::PoseLost
            ),
            _ => self.started && !config.survey,
        };
        if !is_ready {
            return Err(TaskError::NotReady);
        }
        let (errand, to, yaw_rad) = match task {
            Task::Explore => {
                self.plan_anew(None);
                return Ok(self.status);
            }
            Task::Home => {
                let home = self.errands.home;
                (Errand::Home, home.point(), Some(home.yaw_rad))
            }
            Task::GoTo(to) => (Errand::Goal, to, None),
        };
        if !is_near(to) || !self.map.tiles().fence().allows(to.cell()) {
            return Err(TaskError::BadGoal);
        }
        self.plan_anew(Some(Going::new(errand, to, yaw_rad)));
        Ok(self.status)
    }

    /// Sends the robot home if its budget says so.
    pub(super) fn mind_budget(&mut self, config: &Config, time_ms: u32) {
        let is_on_the_way = matches!(self.status, Status::Exploring | Status::Going(Errand::Goal));
        if config.budget.is_empty() || !is_on_the_way {
            return;
        }
        let used = (self.errands.driven_m, time_ms);
        let way_m = self.errands.way_home_m();
        if config.budget.is_spent(used, way_m, config.max_linear_mps) {
            // The robot explores, so it takes the order.
            let _ = self.order(config, Task::Home);
        }
    }

    /// Begins an errand, or goes on exploring. What was begun before is given up.
    fn plan_anew(&mut self, going: Option<Going>) {
        self.status = going.map_or(Status::Exploring, |it| Status::Going(it.errand));
        self.errands.is_going = going.is_some();
        self.errands.last = going.unwrap_or(self.errands.last);
        self.strategy.begin_errand();
        self.viewpoints = viewpoint::Search::new();
        self.exits = map_exits::Search::new();
    }

    /// Nothing leads nearer to the errand's place. A robot that stands as near as promised turns
    /// there; one that turns goes on. Else the errand ends.
    pub(super) fn give_up_errand(&mut self) {
        let MapPose(pose) = self.localiser.pose();
        if let Some(going) = self.errands.going_mut() {
            let is_near = pose.point().distance_m(going.to) <= PROMISED.0;
            if !going.is_there && !going.settles && is_near {
                (going.settles, going.is_there) = (true, true);
            }
            if going.is_there {
                return;
            }
        }
        self.end_errand(false);
    }

    /// Ends the errand: the robot is there, or cannot get nearer.
    pub(super) fn end_errand(&mut self, arrived: bool) {
        let MapPose(pose) = self.localiser.pose();
        if let Some(going) = self.errands.going() {
            let errand = going.errand;
            self.errands.is_going = false;
            self.status = match arrived || going.is_promised(&pose) {
                true => Status::Arrived(errand),
                false => Status::Unreachable(errand),
            };
        }
    }

    /// Returns the heading that needs no window, radians: that of the strategy's own forces, or of
    /// the straight way to the goal of an errand.
    pub(super) fn lead_rad(&self) -> Option<f32> {
        match self.errands.is_going() {
            true => self.errands.straight_rad(),
            false => self.strategy.heading_rad(),
        }
    }
}

/// Returns true if a place is a number and not too far away.
fn is_near(place: Point) -> bool {
    place.x_m.abs() <= MOST_M && place.y_m.abs() <= MOST_M
}

impl<const TILES: usize, const SLOTS: usize> Step<'_, TILES, SLOTS> {
    /// Measures the way home on the published skeleton. Without one the robot knows its track.
    #[inline(never)]
    pub(super) fn measure_way_home(&mut self) {
        let (robot, state) = (self.robot().cell(), &mut *self.state);
        let (tiles, blocked) = (state.map.tiles(), state.strategy.frontier.blocked());
        let Some(centres) = Centres::of(&state.skeleton, tiles, &self.footprint, blocked) else {
            return;
        };
        let home = state.errands.home.point().cell();
        let mut scratch = self.workspace.planning(SLOTS);
        if let Some(path) = path_between(robot, home, centres, &mut scratch) {
            state.errands.measured_m = (path.steps() as f32 * STEP_M, state.errands.driven_m);
        }
    }
}

#[cfg(test)]
mod tests;
