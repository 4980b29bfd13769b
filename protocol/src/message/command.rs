//! What the planner answers an observation: what to drive, what it is doing, and what that cost.

use fixed::types::I16F16;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

#[cfg(doc)]
use super::Identity;
use super::Twist;

/// What the planner is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Status {
    /// No session yet.
    #[default]
    Idle,
    /// Driving to unexplored space.
    Exploring,
    /// Held by the host.
    Paused,
    /// Held by the e-stop input.
    EmergencyStop,
    /// Done.
    Finished(Finish),
    /// Cannot go on.
    Fault(Fault),
}

/// Why an exploration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Finish {
    /// No reachable frontier is left.
    Explored,
    /// The robot has no free way out of where it stands.
    BoxedIn,
    /// The host stopped it.
    Stopped,
}

/// Why the planner cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Fault {
    /// The start pose lies in an obstacle.
    StartBlocked,
    /// A way leads on, and every tile of the map's pool is in use.
    MapFull,
    /// A way leads out of the map's box.
    OutOfBox,
    /// An observation did not match the session's lasers.
    BadObservation,
    /// The robot did not move for too long although commanded.
    Stuck,
}

/// Counters of the device since boot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Counters {
    /// Frames received and accepted.
    pub received: u32,
    /// Frames dropped for a bad checksum.
    pub crc_errors: u32,
    /// Frames dropped for anything else: framing, length, format, order.
    pub dropped: u32,
    /// Requests answered again from the stored reply.
    pub duplicates: u32,
    /// Times that the host fell silent for longer than [`Identity::stale_ms`] while driving.
    pub stale_stops: u32,
}

/// Instructions of a step's stages; their sum is [`Cost::instructions`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Stages {
    /// Taking this request apart, and putting the reply before it together.
    pub session: u32,
    /// Scans and odometry into the map.
    pub sense: u32,
    /// An instalment of the skeleton.
    pub topology: u32,
    /// The wave over a new skeleton, and the road.
    pub plan: u32,
    /// The window's cells and boundary.
    pub window: u32,
    /// The window's field.
    pub solve: u32,
    /// Descent, drive, and the search for a manoeuvre.
    pub drive: u32,
}

/// What one step cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Cost {
    /// Instructions of the whole step (exact in the emulator, timer ticks on silicon, 0 on a host).
    pub instructions: u32,
    /// The same by stages.
    pub stages: Stages,
    /// Deepest stack so far, bytes; 0 where not measured.
    pub stack_bytes: u32,
    /// Multigrid cycles or sweeps spent on the window.
    pub cycles: u16,
    /// The solver's budget ran out before its stop rule held.
    pub budget_exhausted: bool,
}

/// What became of loops since the session began; nothing where the strategy closes none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Loops {
    /// One is being closed: there is a shield behind the robot.
    pub closing: bool,
    /// Loops closed: the tractor point was reached by the way ahead.
    pub closed: u16,
    /// Loops given up, because there is none or it is too long.
    pub given_up: u16,
}

/// The answer to an observation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Command {
    /// What to drive.
    pub velocity: Twist,
    /// What the planner is doing.
    pub status: Status,
    /// Robot heading that the field asks for, radians; meaningful while exploring.
    pub heading: I16F16,
    /// What became of loops.
    pub loops: Loops,
    /// Counters of the link.
    pub counters: Counters,
    /// Cost of the step.
    pub cost: Cost,
}
