//! One step of the exploration, the papers' algorithm box \[Jorge15, Algorithm 1\]:
//!
//! ```text
//! sense:   scans + odometry → pose, map, ground model; first the beams to one instant
//! line 3:  update the Voronoi cells               skeleton, in instalments
//! line 4:  move the robot to the Voronoi          strategy
//! line 24: propagate from the unexplored          strategy
//! line 26: stop when nothing unexplored is left   ending
//! line 27: choose the local goal                  charge
//! line 28: compute the local potential            charge, prefer, field
//! line 29: follow it                              steer, drive
//! ```
//!
//! A step is a pure function of configuration, state, workspace and input: no clock, no I/O, no
//! globals, no logging. The same bits in give the same bits out, on host and target.

mod charge;
mod correction;
mod deskew;
mod door;
mod ending;
mod errand;
mod ground_model;
#[cfg(feature = "internals")]
pub mod host_copy;
mod make_way;
mod memory;
mod plan;
mod prefer;
mod readout;
#[cfg(not(feature = "internals"))]
mod recall;
#[cfg(feature = "internals")]
pub mod recall;
mod sense;
mod sight;
mod state;
mod steer;
mod step;
mod team;
#[cfg(not(feature = "internals"))]
mod wiring;
#[cfg(feature = "internals")]
pub mod wiring;
mod workspace;

pub use correction::{CorrectedTile, Correction, CorrectionError, CorrectionProgress};
pub use errand::{Task, TaskError};
pub use memory::{Capacity, F405, Memory, Planner};
pub use readout::LoopCounts;
pub use recall::{RECALLED_POINTS, RECALLED_TRACK, Recall, RecalledPoint};
#[cfg(feature = "internals")]
pub use sense::{may_stand, starts_blocked, tells};
pub use state::State;
pub use workspace::{CellKind, FieldRow, Workspace};

use crate::config::Config;
use crate::doing::{Doing, Events};
use crate::geometry::{MapPose, OdomPose, Twist};
use crate::input::{Input, InputError};
use crate::profiling::StageTimer;
use crate::status::{Fault, Status};
use step::explore;

/// The output of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Output {
    /// The velocity to drive.
    pub velocity: Twist,
    /// The planner's status.
    pub status: Status,
    /// What the robot does.
    pub doing: Doing,
    /// What happened in this step.
    pub events: Events,
    /// The field's heading at the robot, radians.
    pub heading_rad: f32,
    /// Number of multigrid cycles (or Gauss–Seidel sweeps) spent on the window.
    pub cycles: u16,
    /// True if the solver's budget ran out before its stop rule held.
    pub budget_exhausted: bool,
    /// True if this step took obstacles that had come for gone, for a second look at what they
    /// hide.
    pub forgot_arrivals: bool,
    /// Why the input was not used; `None` if it was. The robot then stands, and the exploration
    /// goes on with the next input.
    pub refused: Option<InputError>,
}

impl Output {
    /// Returns a zero velocity with a status.
    fn standing(status: Status) -> Self {
        Self {
            status,
            ..Self::default()
        }
    }

    /// Returns a zero velocity, for a robot on the last metre of its way by order.
    fn going() -> Self {
        Self {
            doing: Doing::GoesByOrder,
            ..Self::default()
        }
    }

    /// Returns a zero velocity, for a robot that has no path yet, or must let another one pass.
    fn waiting() -> Self {
        Self {
            doing: Doing::Waits,
            ..Self::default()
        }
    }
}

/// Runs one step, from scans and odometry to a velocity, and marks the end of each stage on
/// `timer`.
///
/// A chip with split memory holds state and workspace itself. Other programs use [`Planner`].
///
/// ```
/// use fieldline_planner::{
///     Config, Input, LaserMount, Output, Pose, RobotShape, State, Twist, Workspace, step,
/// };
///
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .build()?;
/// // A map of at most 20 tiles, 16 of them with obstacles.
/// let mut state = Box::new(State::<16, 20>::new());
/// let mut workspace = Box::new(Workspace::new());
/// state.reset(&config);
/// let ranges_mm = [2_000; 181];
/// let input = Input {
///     time_ms: 0,
///     pose: Pose::default(),
///     velocity: Twist::default(),
///     scans: [&ranges_mm, &[]],
/// };
/// let output: Output = step(&config, &mut state, &mut workspace, input, &mut ());
/// assert!(output.velocity.linear_mps.abs() <= config.max_speed().linear_mps);
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
pub fn step<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: Input<'_>,
    timer: &mut impl StageTimer,
) -> Output {
    let host_ms = input.time_ms;
    let (input, moved) = match state.door.admit(config, &input) {
        Ok(admitted) => admitted,
        Err(error) => {
            return Output {
                refused: Some(error),
                ..Output::standing(state.status)
            };
        }
    };
    if !state.started {
        // The last session's field is no start of this one's.
        workspace.window_at = None;
    }
    let told = (host_ms, state.door.faults().jumps);
    if let Some(mistake) = state
        .wiring
        .watch(config, &input, told, state.has_new_skeleton)
        && state.status.goes_on()
    {
        state.status = Status::Fault(Fault::Miswired(mistake));
    }
    let pose = state.team.to_map(&input.pose);
    let input = Input { pose, ..input };
    let MapPose(corrected) = state.localiser.to_map(&OdomPose(pose));
    let motion = (&corrected, input.velocity);
    state.team.begin_step(input.time_ms, motion, &mut state.map);
    // Nothing is planned in a map that is half corrected, and the robot is not blamed for it.
    if state.correcting.is_open() {
        state.strategy.frontier.hold(config.period_ms());
        state.drive.tell(Twist::default());
        state.wiring.tell(Twist::default());
        return Output::standing(state.status);
    }
    let output = match state.team.take_motion(&mut state.map) {
        Some(motion) => {
            state.move_into_team(config, &motion);
            Output::default()
        }
        None => explore(config, state, workspace, (&input, moved.as_ref()), timer),
    };
    let velocity = commanded(config, state.status, output.velocity);
    state.drive.tell(velocity);
    state.wiring.tell(velocity);
    Output {
        velocity,
        status: state.status,
        forgot_arrivals: core::mem::take(&mut state.forgot_arrivals),
        events: state.take_events(),
        ..output
    }
}

/// Returns what the robot is told of a wish: within the session's speeds, which recovery motions do
/// not know, and zero unless the status is one that drives.
fn commanded(config: &Config, status: Status, wish: Twist) -> Twist {
    let is_number = wish.linear_mps.is_finite() && wish.angular_radps.is_finite();
    if !status.drives() || !is_number {
        return Twist::default();
    }
    let (linear, angular) = (config.max_linear_mps, config.max_angular_radps);
    Twist {
        linear_mps: wish.linear_mps.min(linear).max(-linear),
        angular_radps: wish.angular_radps.min(angular).max(-angular),
    }
}
