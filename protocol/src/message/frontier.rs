//! What was left over, and why.
//!
//! Units: map cells.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Residual frontiers a reply lists at the most.
pub const MAX_FRONTIERS: usize = 16;

/// Why a frontier was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Frontier {
    /// A cell of it.
    pub x: i16,
    /// A cell of it.
    pub y: i16,
    /// Cells in it.
    pub cells: u16,
    /// Why it was left.
    pub reason: Residue,
}
