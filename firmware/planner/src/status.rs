//! What the planner says of itself: exploring, finished and why, or at fault and why.

/// What the planner is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Status {
    /// Driving to unexplored space.
    #[default]
    Exploring,
    /// Done, and why.
    Finished(Finish),
    /// Cannot go on, and why.
    Fault(Fault),
}

/// Why an exploration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// No reachable frontier is left.
    Explored,
    /// The robot has no free way out of where it stands.
    BoxedIn,
}

/// Why the planner cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// Why a frontier was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Residue {
    /// No way for this radius.
    Unreachable,
    /// Reached, and still not seen.
    Unobservable,
    /// Beyond the map's box.
    OutOfBounds,
    /// The robot could not get there.
    NoProgress,
}

/// A frontier left over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frontier {
    /// A cell of it.
    pub cell: crate::geometry::Cell,
    /// Cells in it.
    pub cells: u16,
    /// Why it was left.
    pub reason: Residue,
}
