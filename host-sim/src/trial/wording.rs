//! The words that reports, tables and progress lines use for the wire's enums. They are part of the report's schema.

use fieldline_protocol::message::{Fault, Finish, ResidualReason, Status};

/// `exploring`, `finished(explored)`, `fault(stuck)` ...
#[must_use]
pub fn status(status: Status) -> String {
    match status {
        Status::Idle => "idle".into(),
        Status::Exploring => "exploring".into(),
        Status::Paused => "paused".into(),
        Status::EmergencyStop => "emergency-stop".into(),
        Status::Finished(why) => format!("finished({})", finish(why)),
        Status::Fault(why) => format!("fault({})", fault(why)),
    }
}

/// Why an exploration ended.
#[must_use]
pub fn finish(finish: Finish) -> &'static str {
    match finish {
        Finish::Explored => "explored",
        Finish::BoxedIn => "boxed-in",
        Finish::Stopped => "stopped",
    }
}

/// Why the planner cannot go on.
#[must_use]
pub fn fault(fault: Fault) -> &'static str {
    match fault {
        Fault::StartBlocked => "start-blocked",
        Fault::MapFull => "map-full",
        Fault::OutOfBox => "out-of-box",
        Fault::BadObservation => "bad-observation",
        Fault::Stuck => "stuck",
    }
}

/// Why a frontier was left.
#[must_use]
pub fn residue(residue: ResidualReason) -> &'static str {
    match residue {
        ResidualReason::Unreachable => "unreachable",
        ResidualReason::Unobservable => "unobservable",
        ResidualReason::OutOfBounds => "out-of-bounds",
        ResidualReason::NoProgress => "no-progress",
    }
}
