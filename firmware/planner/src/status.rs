//! The planner's status: exploring, finished with a reason, or at fault with a reason.
//!
//! Every type has a `Display` in plain words for a log or a screen.
//!
//! Units: map cells.

use core::fmt;

use crate::geometry::Cell;

/// The activity of the planner.
///
/// ```
/// use fieldline_planner::{Fault, Finish, Status};
///
/// assert_eq!(Status::Exploring.to_string(), "exploring");
/// assert_eq!(Status::Finished(Finish::Explored).to_string(), "finished: explored");
/// assert_eq!(Status::Fault(Fault::MapFull).to_string(), "fault: the map is full");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Status {
    /// The planner drives to unexplored space.
    #[default]
    Exploring,
    /// The exploration is complete.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Errand {
    /// To the pose at which the session began.
    Home,
    /// To a point of the map.
    Goal,
}

impl Status {
    /// Returns true if the planner goes on with the next observation.
    #[must_use]
    pub const fn goes_on(self) -> bool {
        matches!(self, Self::Exploring | Self::NoScan | Self::Going(_))
    }

    /// Returns true if the robot may be driven.
    #[must_use]
    pub const fn drives(self) -> bool {
        matches!(self, Self::Exploring | Self::Going(_))
    }
}

/// The reason why an exploration is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// No reachable frontier is left.
    Explored,
    /// Less than one square metre is free around the robot.
    BoxedIn,
    /// The target coverage of the area is reached.
    Covered,
    /// No cell of the area attracts the robot, below the target coverage.
    NothingAttracts,
}

/// The reason why the planner cannot continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The robot started inside an obstacle.
    StartBlocked,
    /// A frontier is reachable, and every tile of the map's pool is in use.
    MapFull,
    /// A reachable frontier lies beyond the map's range.
    OutOfBox,
    /// The robot did not move for too long, although it was commanded to move.
    Stuck,
    /// The robot does not know where it is: the search around its last place found nothing.
    PoseLost,
    /// The forces of a space-based potential field led the robot to no new cell for too long.
    Trapped,
    /// The robot started with a part of its hull where the fence forbids it to be.
    StartForbidden,
    /// Command, odometry, scan and clock contradict each other in the first metre or the first
    /// quarter turn.
    Miswired(Mistake),
}

/// What a first day with a robot may have wrong. A laser is *turned* if it looks elsewhere than its
/// mount says, or if another laser's scan stands in its place.
///
/// ```
/// use fieldline_planner::Mistake;
///
/// let told = Mistake::ScanMirrored.to_string();
/// assert_eq!(told, "the scan turns against the odometry: is it mirrored?");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// The reason why a frontier was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResidualReason {
    /// No path for the robot's radius leads there.
    Unreachable,
    /// The robot was there and could not see it.
    Unobservable,
    /// It lies beyond the map's range.
    OutOfBounds,
    /// The robot did not come nearer to it.
    NoProgress,
    /// There is too little to see for the way there.
    NotWorthIt,
}

/// A residual frontier: cells that border on unexplored space and that the exploration left.
///
/// ```
/// use fieldline_planner::{Cell, ResidualFrontier, ResidualReason};
///
/// let reason = ResidualReason::Unreachable;
/// let left = ResidualFrontier { cell: Cell { x: 12, y: -3 }, cells: 4, reason };
/// assert_eq!(left.to_string(), "4 cells at (1.2, -0.3) m: unreachable");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResidualFrontier {
    /// One of its cells.
    pub cell: Cell,
    /// The number of its cells. One that is not worth the trip may have more: the search ends when
    /// it has met enough goals.
    pub cells: u16,
    /// Why it was left.
    pub reason: ResidualReason,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exploring => f.write_str("exploring"),
            Self::Finished(finish) => write!(f, "finished: {finish}"),
            Self::Fault(fault) => write!(f, "fault: {fault}"),
            Self::NoScan => f.write_str("no scan yet"),
            Self::Going(errand) => write!(f, "on the way {errand}"),
            Self::Arrived(Errand::Home) => f.write_str("at home"),
            Self::Arrived(Errand::Goal) => f.write_str("at the goal"),
            Self::Unreachable(errand) => write!(f, "cannot get {errand}"),
        }
    }
}

impl fmt::Display for Errand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Home => "home",
            Self::Goal => "to the goal",
        })
    }
}

impl fmt::Display for Finish {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Explored => "explored",
            Self::BoxedIn => "boxed in",
            Self::Covered => "covered",
            Self::NothingAttracts => "nothing attracts",
        })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Miswired(mistake) => return mistake.fmt(f),
            Self::StartBlocked => "the robot started inside an obstacle",
            Self::MapFull => "the map is full",
            Self::OutOfBox => "a path leads out of the map's range",
            Self::Stuck => "the robot is stuck",
            Self::PoseLost => "the robot does not know where it is",
            Self::Trapped => "the forces lead nowhere",
            Self::StartForbidden => "the robot started where it must not be",
        })
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ScanMirrored => "the scan turns against the odometry: is it mirrored?",
            Self::LaserTurnedLeft => "the laser seems turned by 90 degrees to the left",
            Self::LaserTurnedBack => "the laser seems turned by 180 degrees",
            Self::LaserTurnedRight => "the laser seems turned by 90 degrees to the right",
            Self::ScanStands => "the scan stands while the odometry moves",
            Self::YawReversed => "the odometry turns against command and scan",
            Self::WayReversed => "the odometry drives against command and scan",
            Self::TurnsReversed => "the robot turns against the command",
            Self::DriveReversed => "the robot drives against the command",
            Self::WayTooLong => "the odometry counts too long a way",
            Self::WayTooShort => "the odometry counts too short a way",
            Self::TurnTooGreat => "the odometry counts too great a turn",
            Self::TurnTooSmall => "the odometry counts too small a turn",
            Self::RangesTooShort => "all ranges are a few millimetres",
            Self::LasersSwapped => "the two lasers seem swapped",
            Self::ClockStands => "the clock stands",
            Self::ClockFast => "the clock runs too fast",
        })
    }
}

impl fmt::Display for ResidualReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unreachable => "unreachable",
            Self::Unobservable => "unobservable",
            Self::OutOfBounds => "out of bounds",
            Self::NoProgress => "no progress",
            Self::NotWorthIt => "not worth the trip",
        })
    }
}

impl fmt::Display for ResidualFrontier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let corner = self.cell.corner();
        write!(
            f,
            "{} cells at ({:.1}, {:.1}) m: {}",
            self.cells, corner.x_m, corner.y_m, self.reason
        )
    }
}
