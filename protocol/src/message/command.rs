//! The answer to an observation: what to drive, what the planner does, and what the step cost.

use fixed::types::I16F16;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

#[cfg(doc)]
use super::{Control, Identity};
use super::{Doing, Events, Location, Twist};

/// State of the planner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Status {
    /// There is no session yet.
    #[default]
    Idle,
    /// The robot drives to unexplored space.
    Exploring,
    /// The host paused the session.
    Paused,
    /// The emergency stop input stopped the robot.
    EmergencyStop,
    /// The exploration ended.
    Finished(Finish),
    /// The planner cannot continue.
    Fault(Fault),
    /// No beam has told anything yet. The robot stands until one does.
    NoScan,
    /// The robot is on the way, by order.
    Going(Errand),
    /// The robot is where it was ordered to go, and stands.
    Arrived(Errand),
    /// The robot cannot get where it was ordered to go, and stands.
    Unreachable(Errand),
}

/// Where a robot was ordered to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Errand {
    /// To the pose at which the session began ([`Control::Home`]).
    Home,
    /// To a point of the map ([`Control::GoTo`]).
    Goal,
}

impl Status {
    /// Returns true if the planner makes a step with the next observation.
    #[must_use]
    pub const fn goes_on(self) -> bool {
        matches!(self, Self::Exploring | Self::NoScan | Self::Going(_))
    }

    /// Returns true if a command with this status may move the robot.
    #[must_use]
    pub const fn drives(self) -> bool {
        matches!(self, Self::Exploring | Self::Going(_))
    }
}

/// Why an exploration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Finish {
    /// No reachable frontier is left.
    Explored,
    /// The robot has no free way out of the place where it stands.
    BoxedIn,
    /// The host stopped it.
    Stopped,
    /// The target coverage of the area is reached.
    Covered,
    /// No cell of the area attracts the robot, below the target coverage.
    NothingAttracts,
}

/// Why the planner cannot continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Fault {
    /// The start pose lies in an obstacle.
    StartBlocked,
    /// A way leads to further space, and every tile of the map's pool is in use.
    MapFull,
    /// A way leads to further space, and it leaves the map's range.
    OutOfBox,
    /// The scans of the observation do not match the session's lasers, or its pose is one that no
    /// robot reports: it lies beyond 10 km, or leans by more than 60°. The planner made no step.
    /// This fault ends with the next correct observation.
    BadObservation,
    /// The robot did not move for too long although it had a command.
    Stuck,
    /// The robot does not know where it is: no place around its last one agrees with the scan.
    PoseLost,
    /// The forces of a space-based potential field led the robot to no new cell for too long.
    Trapped,
    /// The robot started with a part of its hull where the fence forbids it to be.
    StartForbidden,
    /// Command, odometry, scan and clock contradict each other in the first metre or the first
    /// quarter turn.
    Miswired(Mistake),
}

/// What a first day with a robot may have wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Mistake {
    /// The scan turns against odometry and command.
    ScanMirrored,
    /// The laser looks 90° to the left of where its mount says.
    LaserTurnedLeft,
    /// The laser looks 180° away from where its mount says.
    LaserTurnedBack,
    /// The laser looks 90° to the right of where its mount says.
    LaserTurnedRight,
    /// The scan does not change although odometry moves.
    ScanStands,
    /// Odometry turns against command and scan.
    YawReversed,
    /// Odometry drives against command and scan.
    WayReversed,
    /// Odometry and scan turn against the command.
    TurnsReversed,
    /// Odometry and scan drive against the command.
    DriveReversed,
    /// Odometry counts twice the way of the scan, or far more than the robot can drive.
    WayTooLong,
    /// Odometry counts half the way of the scan, or nothing.
    WayTooShort,
    /// Odometry counts twice the turn of the scan.
    TurnTooGreat,
    /// Odometry counts half the turn of the scan, or nothing.
    TurnTooSmall,
    /// Every range is below a thousandth of the laser's greatest one.
    RangesTooShort,
    /// The level laser sees the ground that the tilted one should see.
    LasersSwapped,
    /// The host's clock does not go on.
    ClockStands,
    /// The host's clock goes on fifty periods or more from report to report.
    ClockFast,
}

/// Counters of the device since its boot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Counters {
    /// Frames received with a correct checksum.
    pub received: u32,
    /// Frames dropped for a wrong checksum.
    pub crc_errors: u32,
    /// Frames dropped for any other reason: framing, length, format, order.
    pub dropped: u32,
    /// Requests that were repeated and got the stored reply.
    pub duplicates: u32,
    /// Number of times that the host was silent for more than [`Identity::stale_ms`] while driving.
    pub stale_stops: u32,
}

/// Instructions of each stage of a step. Their sum is [`Cost::instructions`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Stages {
    /// Decoding this request and encoding the reply before it.
    pub session: u32,
    /// Adding scans and odometry to the map.
    pub sense: u32,
    /// One part of the work on the skeleton.
    pub topology: u32,
    /// The wavefront over a new skeleton, and the path.
    pub plan: u32,
    /// The window's cells and boundary.
    pub window: u32,
    /// The window's field.
    pub solve: u32,
    /// Descent, drive, and the search for a recovery manoeuvre.
    pub drive: u32,
}

/// Cost of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Cost {
    /// Instructions of the whole step: exact in the emulator, timer ticks on silicon, 0 on a host.
    pub instructions: u32,
    /// Instructions of each stage.
    pub stages: Stages,
    /// Deepest stack since the boot, bytes; 0 where it is not measured.
    pub stack_bytes: u32,
    /// Number of multigrid cycles or sweeps on the window.
    pub cycles: u16,
    /// True if the solver's budget ran out before its stop rule was met.
    pub budget_exhausted: bool,
}

/// Loops since the start of the session; all zero for a strategy that closes no loops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Loops {
    /// True if a loop is being closed: there is a shield behind the robot.
    pub closing: bool,
    /// Number of closed loops: the robot reached the tractor point by a way ahead.
    pub closed: u16,
    /// Number of loops given up because there was no loop or it was too long.
    pub given_up: u16,
}

/// Observations since the start of the session that were not as they should be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct InputFaults {
    /// Number of observations with a number that no robot reports. The planner made no step.
    pub refused: u32,
    /// Number of poses that no robot reaches in the time. The odometry was taken to have begun anew
    /// where the robot stood.
    pub jumps: u32,
    /// Number of times that were no later than the one before, or later by more than a minute.
    pub clock: u32,
}

/// The answer to an observation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Command {
    /// Velocity that the robot must drive.
    pub velocity: Twist,
    /// State of the planner.
    pub status: Status,
    /// What the robot does.
    pub doing: Doing,
    /// What happened in this step.
    pub events: Events,
    /// Heading of the robot that the field asks for, radians; it has a meaning only while
    /// exploring.
    pub heading: I16F16,
    /// Counts of loops.
    pub loops: Loops,
    /// True if the planner took obstacles that had come for gone, for a second look.
    pub forgot_arrivals: bool,
    /// Counts of observations that were not as they should be.
    pub input_faults: InputFaults,
    /// The last correction of the map that was closed; 0 if there was none since the session began.
    pub map_epoch: u16,
    /// The pose in the map; `None` if the session takes odometry for the pose.
    pub location: Option<Location>,
    /// Counters of the link.
    pub counters: Counters,
    /// Cost of the step.
    pub cost: Cost,
}
