//! One step of the exploration, the papers' algorithm box \[Jorge15, Algorithm 1\]:
//!
//! ```text
//! sense:   scans + odometry → pose, map, ground model
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
mod sight;
mod state;
mod steer;
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
pub use state::State;
pub use workspace::{CellKind, FieldRow, Workspace};

use crate::config::Config;
use crate::doing::{Doing, Event, Events};
use crate::field::{SolverConfig, Stop, solve};
use crate::geometry::{CELL_M, MapPose, OdomPose, Point, Pose, Twist};
use crate::input::{INVALID_MM, Input, InputError};
use crate::math;
use crate::profiling::{Stage, StageTimer};
use crate::roadmap::configuration_space::Footprint;
use crate::robot::LaserMount;
use crate::status::{Fault, Status};
use charge::{charge_path, charge_rails};
use errand::{approach, measure_way_home};
use make_way::{Way, make_way};
use plan::{end_now, replan, search_viewpoints};
use prefer::{note_flatness, prefer};
use steer::{begin_retreat, look_about, retreat, steer};

/// A range below this is inside the robot's own hull, metres.
const BLOCKED_M: f32 = 0.12;
/// Steps in a row in which no beam tells anything, from which on the robot stands until one does.
/// One scan may be lost on the line.
const DARK_STEPS: u8 = 2;

/// Thinning budget of a step, words of 32 coarse cells. It is about 1.3 million instructions
/// (`tests/golden/costs.txt`).
const THINNING_WORDS: u32 = 3_000;

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
    let input = match state.door.admit(config, &input) {
        Ok(input) => input,
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
            Output::standing(state.status)
        }
        None => explore(config, state, workspace, input, timer),
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

/// Runs one step, but for the note of what the robot is told.
fn explore<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: Input<'_>,
    timer: &mut impl StageTimer,
) -> Output {
    if !state.status.goes_on() {
        return Output::standing(state.status);
    }
    let MapPose(expected) = state.localiser.to_map(&OdomPose(input.pose));
    let peers = state.team.peers();
    let MapPose(pose) = if peers.may_be_seen(input.time_ms, &expected, &config.lasers) {
        sight::sense_without_peers(config, state, (&input, &expected))
    } else {
        sense(config, state, &input)
    };
    let input = Input { pose, ..input };
    if state.team.has_own_frame() {
        state.team.sight(config, state.map.tiles(), &input);
    }
    note_surroundings(config, state, &input);
    state.drive.note_pose(&MapPose(input.pose));
    if state.localiser.has_given_up() {
        state.status = Status::Fault(Fault::PoseLost);
    }
    let plans = !state.localiser.is_lost() && !config.survey;
    if plans && !state.errands.is_going() {
        tell_strategy(config, state, &input);
    }
    state.errands.note_driven(state.localiser.odom().0.point());
    if plans {
        state.mind_budget(config, input.time_ms);
    }
    timer.mark(Stage::Sense);
    if !plans || !state.status.drives() {
        return Output::standing(state.status);
    }
    state.dark_steps = if tells(&input) {
        0
    } else {
        state.dark_steps.saturating_add(1)
    };
    if state.dark_steps >= DARK_STEPS {
        state.strategy.frontier.hold(config.period_ms());
        return Output::standing(state.status);
    }
    let drive = &state.drive;
    if drive.is_searching() || drive.is_retreating() || state.viewpoints.is_running() {
        state.strategy.frontier.hold(config.period_ms());
    }
    // A search for a recovery owns the scratch: the robot stands and plans nothing until it is
    // over.
    if state.drive.is_searching() {
        let lead_rad = state.lead_rad();
        let output = steer(config, state, workspace, &input, lead_rad);
        timer.mark(Stage::Drive);
        return output;
    }
    let footprint = Footprint::new(config.passage_radius_m());
    if state.viewpoints.is_running() {
        search_viewpoints(config, state, workspace, &footprint, &input);
        timer.mark(Stage::Plan);
        if !state.status.drives() {
            return Output::standing(state.status);
        }
        return Output {
            velocity: look_about(config, state, &input),
            doing: Doing::LooksForGaps,
            ..Output::default()
        };
    }
    let planned = advance_plan(config, state, workspace, &footprint, &input, timer);
    if !state.status.drives() {
        return Output::standing(state.status);
    }
    let frontier = &mut state.strategy.frontier;
    if frontier.take_blocked() || frontier.goes_back() {
        begin_retreat(config, state, &input);
    }
    if state.drive.is_retreating() {
        let velocity = retreat(config, state, &input);
        timer.mark(Stage::Drive);
        return Output {
            velocity,
            doing: Doing::GoesBack,
            ..Output::default()
        };
    }
    let way = if state.team.is_member() {
        make_way(config, state, workspace, &footprint, &input)
    } else {
        Way::Free
    };
    if !matches!(way, Way::Free) {
        state.strategy.frontier.pause(input.time_ms);
    }
    if matches!(way, Way::Hold) {
        timer.mark(Stage::Window);
        return Output::waiting();
    }
    if matches!(way, Way::Retreat) {
        // The window is charged with the way already.
    } else if let Some(output) = approach(config, state, workspace, &footprint, &input) {
        timer.mark(Stage::Drive);
        return output;
    } else if let Some(heading_rad) = state.lead_rad() {
        let output = steer(config, state, workspace, &input, Some(heading_rad));
        timer.mark(Stage::Drive);
        return output;
    } else if charge_rails(config, state, workspace, &footprint, &input).is_none() {
        let Some(is_closed) = charge_path(config, state, workspace, &footprint, &input) else {
            if !state.strategy.frontier.path().is_empty() {
                state.strategy.frontier.note_closed();
            }
            timer.mark(Stage::Window);
            return without_path(look_about(config, state, &input));
        };
        if is_closed {
            state.strategy.frontier.note_closed();
        }
    }
    if let Some(ground) = &config.ground {
        prefer(ground, state, workspace, &input);
    }
    timer.mark(Stage::Window);
    let solver = budget(config, planned);
    let solution = solve(&mut workspace.window, &mut workspace.scratch, &solver);
    if state.ground.is_uneven() {
        note_flatness(state, workspace, &input);
    }
    timer.mark(Stage::Solve);
    let output = steer(config, state, workspace, &input, None);
    timer.mark(Stage::Drive);
    let doing = match (way, output.doing) {
        (Way::Retreat, Doing::Explores | Doing::GoesToLook) => Doing::MakesWay,
        (_, doing) => doing,
    };
    Output {
        cycles: solution.cycles + solution.sweeps,
        budget_exhausted: solution.stop == Stop::Budget,
        doing,
        ..output
    }
}

/// Returns the output of a step without a path: the robot looks about, or stands.
fn without_path(look: Twist) -> Output {
    if look == Twist::default() {
        return Output::waiting();
    }
    Output {
        velocity: look,
        doing: Doing::LooksAbout,
        ..Output::default()
    }
}

/// Plans on a new skeleton, or continues to thin the next one. Planning on a skeleton begins in the
/// step after it is complete, so no step does both. Returns true if this step planned.
fn advance_plan<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    input: &Input<'_>,
    timer: &mut impl StageTimer,
) -> bool {
    if state.ends {
        end_now(config, state, workspace, footprint, input);
        timer.mark(Stage::Plan);
        return true;
    }
    let planned = state.has_new_skeleton;
    if planned {
        state.has_new_skeleton = !replan(config, state, workspace, footprint, input);
        state.errands.note_planned(config);
        timer.mark(Stage::Plan);
    } else if state.errands.take_due() {
        measure_way_home(state, workspace, footprint, input);
        timer.mark(Stage::Plan);
        return true;
    } else {
        state.has_new_skeleton = state.skeleton.advance(
            state.map.tiles(),
            footprint,
            bytemuck::cast_slice_mut(&mut workspace.scratch),
            THINNING_WORDS,
        );
        timer.mark(Stage::Topology);
    }
    planned
}

/// Returns the solver's budget. A step that planned a path has spent the time of half the cycles.
const fn budget(config: &Config, planned: bool) -> SolverConfig {
    let most = config.solver.max_cycles;
    SolverConfig {
        max_cycles: if planned { most.div_ceil(2) } else { most },
        ..config.solver
    }
}

/// Locates the robot and enters scans and odometry into the map. It is large and called from two
/// places, so it is not inlined.
#[inline(never)]
fn sense<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) -> MapPose {
    let MapPose(pose) = state.localiser.locate(config, &state.map, input);
    let input = &Input { pose, ..*input };
    if !state.started {
        state.started = config.survey || tells(input);
        state
            .errands
            .begin_at(pose, state.localiser.odom().0.point());
        state.status = match state.started {
            false => Status::NoScan,
            true if config.survey => Status::Exploring,
            // A session that was given a map goes on where another one was: it is no start.
            true if state.map_epoch() != 0 => Status::Exploring,
            true if starts_blocked(config, input) => Status::Fault(Fault::StartBlocked),
            true if !may_stand(config, &input.pose) => Status::Fault(Fault::StartForbidden),
            true => Status::Exploring,
        };
        if state.started && !state.is_recalled {
            let odom = state.localiser.odom();
            state.ground.surround(&odom, &config.robot);
        }
    }
    if state.localiser.may_enter() {
        state.map.observe(config, input);
    }
    let level = level_scans(config, input).find(|(_, ranges_mm)| !ranges_mm.is_empty());
    state
        .strategy
        .note(&input.pose, input.time_ms, level, config.tuning);
    MapPose(pose)
}

/// Enters scans and odometry into the ground model. What protects the hull takes every beam, also
/// one that seems to end in a peer: a wall may stand there instead, beside a peer that has moved.
#[inline(never)]
fn note_surroundings<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) {
    let odom = state.localiser.odom();
    state.ground.observe(
        config,
        (input, &odom),
        state.team.peers(),
        &mut state.map,
        &mut state.preferences,
    );
    // Wheels that slip on a slope are no contact.
    if !state.ground.is_uneven()
        && let Some(contact) = state.drive.feel(config, input.velocity)
    {
        state.ground.feel(&odom, &config.robot, contact);
        state.events.add(Event::Touched);
    }
}

/// Tells the strategy what the map and the peers know. The strategy may end the exploration.
#[inline(never)]
fn tell_strategy<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) {
    let peers = state.team.peers().iter();
    for peer in peers.filter(|peer| peer.has_claims(input.time_ms)) {
        let place = peer.pose(input.time_ms).point();
        state.strategy.note_peer(place);
    }
    let rivals = state.team.rivals(input.time_ms);
    let rivals = rivals.map(|peer| peer.pose(input.time_ms).point());
    let (places, tiles) = ((input.pose.point(), rivals), state.map.tiles());
    if let Some(end) = state
        .strategy
        .note_map(tiles, places, input.time_ms, config)
    {
        state.status = end;
    }
}

/// Returns the level lasers, each with its scan.
fn level_scans<'a>(
    config: &'a Config,
    input: &Input<'a>,
) -> impl Iterator<Item = (&'a LaserMount, &'a [u16])> {
    let scans = config.lasers.iter().zip(input.scans);
    scans.filter(|(laser, _)| laser.is_level())
}

/// Returns true if the fence allows every cell under the hull of a robot at `pose`.
#[must_use]
pub fn may_stand(config: &Config, pose: &Pose) -> bool {
    let (length_m, width_m) = (config.robot.half_length_m, config.robot.half_width_m);
    // Places across a hull, at most half a cell apart, its edges included.
    let parts = |half_m: f32| math::floor(4.0 * half_m / CELL_M) + 1;
    let at = |k: i32, half_m: f32| half_m * (2.0 * k as f32 / parts(half_m) as f32 - 1.0);
    let is_free = |i: i32, j: i32| {
        let place = Point {
            x_m: at(i, length_m),
            y_m: at(j, width_m),
        };
        config.fence.allows(pose.to_map(place).cell())
    };
    config.fence.is_empty()
        || (0..=parts(length_m)).all(|i| (0..=parts(width_m)).all(|j| is_free(i, j)))
}

/// Returns true if a beam tells anything.
#[must_use]
pub fn tells(input: &Input<'_>) -> bool {
    let mut ranges = input.scans.iter().copied().flatten();
    ranges.any(|&range_mm| range_mm != INVALID_MM)
}

/// Returns true if nine of ten beams of the level laser that tell anything end inside the robot's
/// own hull.
#[must_use]
pub fn starts_blocked(config: &Config, input: &Input<'_>) -> bool {
    let level = level_scans(config, input).next();
    level.is_some_and(|(_, ranges_mm)| {
        let told = || ranges_mm.iter().filter(|&&range_mm| range_mm != INVALID_MM);
        let blocked = |&&range: &&u16| f32::from(range) * 1e-3 < BLOCKED_M;
        let count = told().count();
        count > 0 && told().filter(blocked).count() * 10 >= count * 9
    })
}
