//! Words for the wire's enums in reports, tables and progress lines. They are part of the schema.

use fieldline_protocol::message::{
    Doing, Errand, Fault, Finish, Mistake, Order, Preference, ResidualReason, Status,
};

/// Returns `exploring`, `finished(explored)`, `fault(stuck)` ...
#[must_use]
pub fn status(status: Status) -> String {
    match status {
        Status::Idle => "idle".into(),
        Status::Exploring => "exploring".into(),
        Status::NoScan => "no-scan".into(),
        Status::Paused => "paused".into(),
        Status::EmergencyStop => "emergency-stop".into(),
        Status::Finished(why) => format!("finished({})", finish(why)),
        Status::Fault(why) => format!("fault({})", fault(why)),
        Status::Going(to) => format!("going({})", errand(to)),
        Status::Arrived(at) => format!("arrived({})", errand(at)),
        Status::Unreachable(to) => format!("unreachable({})", errand(to)),
    }
}

/// Returns what the robot does.
#[must_use]
pub const fn doing(doing: Doing) -> &'static str {
    match doing {
        Doing::Stands => "stands",
        Doing::Waits => "waits",
        Doing::Explores => "explores",
        Doing::FollowsForces => "follows the forces",
        Doing::GoesToLook => "goes to look",
        Doing::GoesByOrder => "goes by order",
        Doing::Searches => "searches a motion",
        Doing::Recovers => "recovers",
        Doing::GoesBack => "goes back",
        Doing::LooksForGaps => "looks for gaps",
        Doing::LooksAbout => "looks about",
        Doing::MakesWay => "makes way",
    }
}

/// Returns where a robot was ordered to go.
#[must_use]
pub fn errand(errand: Errand) -> &'static str {
    match errand {
        Errand::Home => "home",
        Errand::Goal => "goal",
    }
}

/// Returns the reason for the end of an exploration.
#[must_use]
pub fn finish(finish: Finish) -> &'static str {
    match finish {
        Finish::Explored => "explored",
        Finish::BoxedIn => "boxed-in",
        Finish::Stopped => "stopped",
        Finish::Covered => "covered",
        Finish::NothingAttracts => "nothing-attracts",
    }
}

/// Returns the reason why the planner cannot go on.
#[must_use]
pub fn fault(fault: Fault) -> &'static str {
    match fault {
        Fault::StartBlocked => "start-blocked",
        Fault::MapFull => "map-full",
        Fault::OutOfBox => "out-of-box",
        Fault::BadObservation => "bad-observation",
        Fault::Stuck => "stuck",
        Fault::PoseLost => "pose-lost",
        Fault::Trapped => "trapped",
        Fault::StartForbidden => "start-forbidden",
        Fault::Miswired(what) => mistake(what),
    }
}

/// Returns what is wired wrongly.
#[must_use]
pub fn mistake(mistake: Mistake) -> &'static str {
    match mistake {
        Mistake::ScanMirrored => "scan-mirrored",
        Mistake::LaserTurnedLeft => "laser-turned-left",
        Mistake::LaserTurnedBack => "laser-turned-back",
        Mistake::LaserTurnedRight => "laser-turned-right",
        Mistake::ScanStands => "scan-stands",
        Mistake::YawReversed => "yaw-reversed",
        Mistake::WayReversed => "way-reversed",
        Mistake::TurnsReversed => "turns-reversed",
        Mistake::DriveReversed => "drive-reversed",
        Mistake::WayTooLong => "way-too-long",
        Mistake::WayTooShort => "way-too-short",
        Mistake::TurnTooGreat => "turn-too-great",
        Mistake::TurnTooSmall => "turn-too-small",
        Mistake::RangesTooShort => "ranges-too-short",
        Mistake::LasersSwapped => "lasers-swapped",
        Mistake::ClockStands => "clock-stands",
        Mistake::ClockFast => "clock-fast",
    }
}

/// Returns the order in which frontiers are taken.
#[must_use]
pub fn order(order: Order) -> &'static str {
    match order {
        Order::Gain { .. } => "gain",
        Order::Nearest { .. } => "nearest",
    }
}

/// Returns the reason why a frontier was left.
#[must_use]
pub fn residual(reason: ResidualReason) -> &'static str {
    match reason {
        ResidualReason::Unreachable => "unreachable",
        ResidualReason::Unobservable => "unobservable",
        ResidualReason::OutOfBounds => "out-of-bounds",
        ResidualReason::NoProgress => "no-progress",
        ResidualReason::NotWorthIt => "not-worth-it",
    }
}

/// Returns the preferences of the field, as on the command line.
#[must_use]
pub fn preference(preference: Preference) -> &'static str {
    match preference {
        Preference::Off => "off",
        Preference::Height => "height",
        Preference::Global => "global",
        Preference::Both => "both",
    }
}
