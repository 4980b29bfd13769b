//! Residual frontiers: frontiers that the planner does not explore, each with its reason.
//!
//! Units: map cells of 10 cm.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Maximum number of residual frontiers in a reply.
pub const MAX_FRONTIERS: usize = 16;

/// Why the planner does not explore a frontier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ResidualReason {
    /// No way to it is wide enough for the robot's radius.
    Unreachable,
    /// The robot reached it and still did not see the cells behind it.
    Unobservable,
    /// It lies beyond the map's range.
    OutOfBounds,
    /// The robot made no progress towards it.
    NoProgress,
    /// There is too little to see for the way there.
    NotWorthIt,
}

/// A residual frontier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ResidualFrontier {
    /// Column of one of its cells.
    pub x: i16,
    /// Row of the same cell.
    pub y: i16,
    /// Number of its cells.
    pub cells: u16,
    /// Why the planner does not explore it.
    pub reason: ResidualReason,
}
