//! Conversions between the wire's quantities and the planner's. No other file mixes `fixed` and
//! `f32`.
//!
//! To the planner the conversion is exact for an `I4F12` (16 bits; f32 has 24). It rounds an
//! `I16F16` beyond ±128 m to nearest: to 2⁻¹⁶ m or better up to 256 m. To the wire it rounds to
//! nearest and saturates, and a NaN becomes zero. Both directions are integer arithmetic and give
//! the same bits on every machine.

use fieldline_planner::{
    self as planner, Area, Budget, Cell, Config, Fence, Input, InputFaults, LaserMount, LoopCounts,
    LoopLimits, Order, Parameter, Point, Pose, PreferenceMode, ResidualReason, RobotShape,
    SpaceField, State, Strategy, Task, TaskError, Tuning, Twist, UnevenGround,
};
use fieldline_protocol::message as wire;
use fixed::traits::{Fixed, LossyInto};
use fixed::types::I16F16;
use heapless::Vec;

mod team;
mod tiles;

pub use team::{packet, wire_packet};
pub use tiles::{
    corrected_bytes, corrected_tile, correction, recall, wire_progress, wire_recall, wire_refusal,
};

/// Returns a wire quantity as f32.
fn float(quantity: impl LossyInto<f32>) -> f32 {
    quantity.lossy_into()
}

/// Returns the nearest wire quantity; zero for a NaN.
#[must_use]
pub fn quantity<F: Fixed>(value: f32) -> F {
    if value.is_nan() {
        F::ZERO
    } else {
        F::saturating_from_num(value)
    }
}

/// Converts a pose from the wire.
#[must_use]
pub fn pose(pose: &wire::Pose) -> Pose {
    Pose {
        x_m: float(pose.x),
        y_m: float(pose.y),
        z_m: float(pose.z),
        roll_rad: float(pose.roll),
        pitch_rad: float(pose.pitch),
        yaw_rad: float(pose.yaw),
    }
}

/// Converts a velocity from the wire.
#[must_use]
pub fn twist(twist: &wire::Twist) -> Twist {
    Twist {
        linear_mps: float(twist.linear),
        angular_radps: float(twist.angular),
    }
}

/// Converts an observation from the wire. `None` unless it has one scan per laser, with one range
/// per beam.
#[must_use]
pub fn input<'a>(observation: &'a wire::Observation, lasers: &[LaserMount]) -> Option<Input<'a>> {
    let scans = &observation.scans;
    let has_beams = |(scan, laser): (&wire::Scan, &LaserMount)| {
        scan.ranges_mm.len() == usize::from(laser.beams)
    };
    if scans.len() != lasers.len() || !scans.iter().zip(lasers).all(has_beams) {
        return None;
    }
    let scan = |number: usize| match scans.get(number) {
        Some(scan) => scan.ranges_mm.as_slice(),
        None => &[],
    };
    Some(Input {
        time_ms: observation.time_ms,
        pose: pose(&observation.pose),
        velocity: twist(&observation.velocity),
        scans: [scan(0), scan(1)],
    })
}

/// Converts a velocity for the wire.
#[must_use]
pub fn wire_twist(twist: &Twist) -> wire::Twist {
    wire::Twist {
        linear: quantity(twist.linear_mps),
        angular: quantity(twist.angular_radps),
    }
}

fn laser(laser: &wire::Laser) -> LaserMount {
    LaserMount {
        x_m: float(laser.x),
        y_m: float(laser.y),
        z_m: float(laser.z),
        pitch_rad: float(laser.pitch),
        first_bearing_rad: float(laser.first_bearing),
        bearing_step_rad: float(laser.bearing_step),
        beams: laser.beams,
        range_limit_mm: laser.range_limit_mm,
        turn_time_ms: laser.turn_time_ms,
        newest_first: laser.newest_first,
    }
}

fn uneven_ground(ground: &wire::UnevenGround) -> UnevenGround {
    UnevenGround {
        mode: match ground.preference {
            wire::Preference::Off => PreferenceMode::Off,
            wire::Preference::Height => PreferenceMode::Height,
            wire::Preference::Global => PreferenceMode::Global,
            wire::Preference::Both => PreferenceMode::Both,
        },
        levels: ground.levels,
        obstacle_m: float(ground.obstacle),
        near_m: float(ground.near),
        hole_m: float(ground.hole),
        least_preference: float(ground.least),
        most_preference: float(ground.most),
        height_scale: float(ground.height_scale),
        global_scale: float(ground.global_scale),
        climb: UnevenGround::slope(float(ground.climb)),
        roll: UnevenGround::slope(float(ground.roll)),
        step_m: float(ground.step),
    }
}

fn hull(hull: &wire::Hull) -> RobotShape {
    let metres = |mm: u16| f32::from(mm) / 1000.0;
    RobotShape::rectangle(
        metres(hull.length_mm),
        metres(hull.width_mm),
        metres(hull.height_mm),
    )
}

fn order(order: wire::Order) -> Order {
    match order {
        wire::Order::Gain { worth } => Order::Gain {
            worth: float(worth),
        },
        wire::Order::Nearest { worth } => Order::Nearest {
            worth: worth.to_num(),
        },
    }
}

fn loop_limits(limits: &wire::LoopLimits) -> LoopLimits {
    LoopLimits {
        least_m: float(limits.least),
        most_m: float(limits.most),
        most_per_frontier: float(limits.most_per_frontier),
        detour: float(limits.detour),
        slack_m: float(limits.slack),
    }
}

fn space_field(field: &wire::SpaceField) -> SpaceField {
    let [origin, size] = [field.origin, field.size].map(|(x, y)| (float(x), float(y)));
    SpaceField {
        area: Area::of_metres(origin, size),
        until_permille: field.until_permille,
        impatience_s: field.impatience_s,
    }
}

/// Converts a fence from the wire; `None` if its polygons do not have all corners.
fn fence(fence: &wire::Fence) -> Option<Fence> {
    let mut corners = fence.corners.as_slice();
    let mut result = Fence::new();
    for polygon in &fence.polygons {
        let (own, rest) = corners.split_at_checked(polygon.corners.into())?;
        let point = |&(x, y): &(I16F16, I16F16)| Point {
            x_m: float(x),
            y_m: float(y),
        };
        let own: Vec<Point, { wire::FENCE_CORNERS }> = own.iter().map(point).collect();
        result = match polygon.bounds {
            true => result.bounds(&own),
            false => result.no_go(&own),
        };
        corners = rest;
    }
    corners.is_empty().then_some(result)
}

/// Converts the parameters of a session from the wire. The planner checks them. Not inlined: the
/// builder's copies must not be on the stack while the state is cleared.
///
/// # Errors
/// [`wire::Parameter`]: the first parameter that is out of its range.
#[inline(never)]
pub fn config(start: &wire::Start, tuning: &'static Tuning) -> Result<Config, wire::Parameter> {
    let mut builder = Config::builder(hull(&start.hull))
        .tuning(tuning)
        .strategy(match start.strategy {
            wire::Strategy::Frontier => Strategy::Frontier,
            wire::Strategy::Ouroboros => Strategy::Ouroboros,
            wire::Strategy::Tdbvp {
                patrol_s,
                impatience_s,
            } => Strategy::Tdbvp {
                patrol_s,
                impatience_s,
            },
            wire::Strategy::Sbpf(field) => Strategy::Sbpf(space_field(&field)),
            wire::Strategy::Esbpf(field) => Strategy::Esbpf(space_field(&field)),
        })
        .order(order(start.order))
        .loops(loop_limits(&start.loops))
        .radius_m(f32::from(start.robot_radius_mm) / 1000.0)
        .max_speed(float(start.max_linear), float(start.max_angular))
        .acceleration(float(start.linear_accel), float(start.angular_accel))
        .period_s(f32::from(start.period_ms) / 1000.0)
        .localise(start.localise)
        .survey(start.survey);
    for mount in &start.lasers {
        builder = builder.laser(laser(mount));
    }
    if let Some(ground) = &start.uneven_ground {
        builder = builder.uneven_ground(uneven_ground(ground));
    }
    if let Some(team) = &start.team {
        builder = builder.team(team::place(team));
    }
    builder
        .fence(fence(&start.fence).ok_or(wire::Parameter::Fence)?)
        .budget(Budget {
            range_m: start.budget.range_m,
            time_s: start.budget.time_s,
        })
        .build()
        .map_err(|error| wire_parameter(error.parameter))
}

/// Returns the wire's name of a parameter that the planner refused.
const fn wire_parameter(parameter: Parameter) -> wire::Parameter {
    match parameter {
        Parameter::Lasers => wire::Parameter::Lasers,
        Parameter::Beams => wire::Parameter::Beams,
        Parameter::RangeLimit => wire::Parameter::RangeLimit,
        Parameter::FirstBearing | Parameter::BearingStep | Parameter::Sweep => {
            wire::Parameter::Bearing
        }
        Parameter::Pitch => wire::Parameter::Pitch,
        Parameter::Mount | Parameter::LaserHeight => wire::Parameter::Mount,
        Parameter::TurnTime => wire::Parameter::TurnTime,
        Parameter::HalfLength | Parameter::HalfWidth | Parameter::Height => wire::Parameter::Hull,
        Parameter::Radius => wire::Parameter::Radius,
        Parameter::MaxLinear => wire::Parameter::MaxLinear,
        Parameter::MaxAngular => wire::Parameter::MaxAngular,
        Parameter::LinearAccel => wire::Parameter::LinearAccel,
        Parameter::AngularAccel => wire::Parameter::AngularAccel,
        Parameter::Period => wire::Parameter::Period,
        Parameter::LeastPreference | Parameter::MostPreference => wire::Parameter::Preference,
        Parameter::Area => wire::Parameter::Area,
        Parameter::Coverage => wire::Parameter::Coverage,
        Parameter::LoopLimits => wire::Parameter::LoopLimits,
        Parameter::Worth => wire::Parameter::Worth,
        Parameter::TeamPlace => wire::Parameter::Team,
        Parameter::FenceCorners
        | Parameter::FenceCorner
        | Parameter::FenceArea
        | Parameter::FenceCrossings => wire::Parameter::Fence,
        // The solver's parameters do not come from the wire.
        Parameter::UnevenGround | Parameter::Solver => wire::Parameter::UnevenGround,
    }
}

const fn errand(errand: planner::Errand) -> wire::Errand {
    match errand {
        planner::Errand::Home => wire::Errand::Home,
        planner::Errand::Goal => wire::Errand::Goal,
    }
}

/// Converts an order to drive from the wire; `None` for any other change of the session.
#[must_use]
pub fn task(control: &wire::Control) -> Option<Task> {
    match *control {
        wire::Control::Home => Some(Task::Home),
        wire::Control::Explore => Some(Task::Explore),
        wire::Control::GoTo { x, y } => Some(Task::GoTo(Point {
            x_m: float(x),
            y_m: float(y),
        })),
        _ => None,
    }
}

/// Converts home, a pose of the map.
#[must_use]
pub fn home((x, y): (I16F16, I16F16), yaw: I16F16) -> Pose {
    Pose {
        x_m: float(x),
        y_m: float(y),
        yaw_rad: float(yaw),
        ..Pose::default()
    }
}

/// Converts the reason for which an order to drive is refused, for the wire.
#[must_use]
pub const fn wire_task_error(error: TaskError) -> wire::Refusal {
    match error {
        TaskError::NotReady => wire::Refusal::NotReady,
        TaskError::BadGoal => wire::Refusal::BadGoal,
    }
}

/// Converts what the robot does for the wire.
#[must_use]
pub const fn wire_doing(doing: planner::Doing) -> wire::Doing {
    match doing {
        planner::Doing::Stands => wire::Doing::Stands,
        planner::Doing::Waits => wire::Doing::Waits,
        planner::Doing::Explores => wire::Doing::Explores,
        planner::Doing::FollowsForces => wire::Doing::FollowsForces,
        planner::Doing::GoesToLook => wire::Doing::GoesToLook,
        planner::Doing::GoesByOrder => wire::Doing::GoesByOrder,
        planner::Doing::Searches => wire::Doing::Searches,
        planner::Doing::Recovers => wire::Doing::Recovers,
        planner::Doing::GoesBack => wire::Doing::GoesBack,
        planner::Doing::LooksForGaps => wire::Doing::LooksForGaps,
        planner::Doing::LooksAbout => wire::Doing::LooksAbout,
        planner::Doing::MakesWay => wire::Doing::MakesWay,
    }
}

/// Converts the planner's status for the wire.
#[must_use]
pub fn wire_status(status: planner::Status) -> wire::Status {
    match status {
        planner::Status::Exploring => wire::Status::Exploring,
        planner::Status::NoScan => wire::Status::NoScan,
        planner::Status::Going(to) => wire::Status::Going(errand(to)),
        planner::Status::Arrived(to) => wire::Status::Arrived(errand(to)),
        planner::Status::Unreachable(to) => wire::Status::Unreachable(errand(to)),
        planner::Status::Finished(finish) => wire::Status::Finished(match finish {
            planner::Finish::Explored => wire::Finish::Explored,
            planner::Finish::BoxedIn => wire::Finish::BoxedIn,
            planner::Finish::Covered => wire::Finish::Covered,
            planner::Finish::NothingAttracts => wire::Finish::NothingAttracts,
        }),
        planner::Status::Fault(fault) => wire::Status::Fault(match fault {
            planner::Fault::StartBlocked => wire::Fault::StartBlocked,
            planner::Fault::MapFull => wire::Fault::MapFull,
            planner::Fault::OutOfBox => wire::Fault::OutOfBox,
            planner::Fault::Stuck => wire::Fault::Stuck,
            planner::Fault::PoseLost => wire::Fault::PoseLost,
            planner::Fault::Trapped => wire::Fault::Trapped,
            planner::Fault::StartForbidden => wire::Fault::StartForbidden,
            planner::Fault::Miswired(mistake) => wire::Fault::Miswired(wire_mistake(mistake)),
        }),
    }
}

const fn wire_mistake(mistake: planner::Mistake) -> wire::Mistake {
    use planner::Mistake;
    match mistake {
        Mistake::ScanMirrored => wire::Mistake::ScanMirrored,
        Mistake::LaserTurnedLeft => wire::Mistake::LaserTurnedLeft,
        Mistake::LaserTurnedBack => wire::Mistake::LaserTurnedBack,
        Mistake::LaserTurnedRight => wire::Mistake::LaserTurnedRight,
        Mistake::ScanStands => wire::Mistake::ScanStands,
        Mistake::YawReversed => wire::Mistake::YawReversed,
        Mistake::WayReversed => wire::Mistake::WayReversed,
        Mistake::TurnsReversed => wire::Mistake::TurnsReversed,
        Mistake::DriveReversed => wire::Mistake::DriveReversed,
        Mistake::WayTooLong => wire::Mistake::WayTooLong,
        Mistake::WayTooShort => wire::Mistake::WayTooShort,
        Mistake::TurnTooGreat => wire::Mistake::TurnTooGreat,
        Mistake::TurnTooSmall => wire::Mistake::TurnTooSmall,
        Mistake::RangesTooShort => wire::Mistake::RangesTooShort,
        Mistake::LasersSwapped => wire::Mistake::LasersSwapped,
        Mistake::ClockStands => wire::Mistake::ClockStands,
        Mistake::ClockFast => wire::Mistake::ClockFast,
    }
}

/// Converts the numbers of loops for the wire.
pub(crate) const fn wire_loops(loops: LoopCounts) -> wire::Loops {
    wire::Loops {
        closing: loops.closing,
        closed: loops.closed,
        given_up: loops.given_up,
    }
}

/// Converts the numbers of observations that were not as they should be for the wire.
pub(crate) const fn wire_input_faults(faults: InputFaults) -> wire::InputFaults {
    wire::InputFaults {
        refused: faults.refused,
        jumps: faults.jumps,
        clock: faults.clock,
    }
}

/// Converts a location for the wire.
pub(crate) fn wire_location(location: &planner::Location) -> wire::Location {
    let pose = &location.pose.0;
    wire::Location {
        x: quantity(pose.x_m),
        y: quantity(pose.y_m),
        yaw: quantity(pose.yaw_rad),
        // From metres and radians to their hundredths.
        covariance: location.covariance.map(|it| quantity(1e4 * it)),
        quality: match location.quality {
            planner::Quality::Tracking => wire::Quality::Tracking,
            planner::Quality::Degenerate(direction) => wire::Quality::Degenerate {
                direction: direction.map(quantity),
            },
            planner::Quality::Lost => wire::Quality::Lost,
        },
    }
}

/// Converts tractor point, shield and path for the wire, without the first `from` cells of the
/// path.
pub(crate) fn wire_path<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    from: u8,
) -> wire::Path {
    let cells = state.path();
    let rest = cells.iter().skip(from.into());
    wire::Path {
        tractor: state.tractor().map(wire_cell),
        shield: state.shield().map(|ends| ends.map(wire_cell)),
        length: u8::try_from(cells.len()).unwrap_or(u8::MAX),
        cells: rest
            .take(wire::PATH_PAGE)
            .map(|&cell| wire_cell(cell))
            .collect(),
    }
}

/// Converts a map cell for the wire. It saturates.
fn wire_cell(cell: Cell) -> (i16, i16) {
    let short = |at: i32| at.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
    (short(cell.x), short(cell.y))
}

/// Converts a residual frontier for the wire.
#[must_use]
pub fn wire_frontier(frontier: &planner::ResidualFrontier) -> wire::ResidualFrontier {
    let (x, y) = wire_cell(frontier.cell);
    wire::ResidualFrontier {
        x,
        y,
        cells: frontier.cells,
        reason: match frontier.reason {
            ResidualReason::Unreachable => wire::ResidualReason::Unreachable,
            ResidualReason::Unobservable => wire::ResidualReason::Unobservable,
            ResidualReason::OutOfBounds => wire::ResidualReason::OutOfBounds,
            ResidualReason::NoProgress => wire::ResidualReason::NoProgress,
            ResidualReason::NotWorthIt => wire::ResidualReason::NotWorthIt,
        },
    }
}

#[cfg(test)]
mod tests;
