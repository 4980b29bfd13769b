//! What the robot measured.
//!
//! Units: metres, radians, seconds; ranges in millimetres.

use fixed::types::{I4F12, I16F16};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

#[cfg(doc)]
use super::Start;

/// Beams a scan may have at the most.
pub const MAX_BEAMS: usize = 181;
/// Laser scanners an observation may carry at the most.
pub const MAX_SCANS: usize = 2;
/// Range code of a beam that came back from nothing: free up to the range limit. It is the largest two-byte varint.
pub const NO_RETURN_MM: u16 = 16_383;
/// Range code of a beam that carries no information.
pub const INVALID_MM: u16 = 0;

/// A pose in the odometry frame, metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Pose {
    /// Metres.
    pub x: I16F16,
    /// Metres.
    pub y: I16F16,
    /// Metres above the start.
    pub z: I16F16,
    /// Radians about the forward axis.
    pub roll: I16F16,
    /// Radians about the left axis; positive is nose down.
    pub pitch: I16F16,
    /// Radians about the up axis, in [−π, π].
    pub yaw: I16F16,
}

/// A planar velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Twist {
    /// Metres a second, forward.
    pub linear: I4F12,
    /// Radians a second, counter-clockwise.
    pub angular: I4F12,
}

/// One sweep of one laser. Its geometry is in [`Start::lasers`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Scan {
    /// Ranges in millimetres, or [`NO_RETURN_MM`], or [`INVALID_MM`].
    pub ranges_mm: Vec<u16, MAX_BEAMS>,
}

/// What the robot sensed at one instant.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Observation {
    /// The host's clock, milliseconds since the start of the session.
    pub time_ms: u32,
    /// Odometry.
    pub pose: Pose,
    /// Measured velocity.
    pub velocity: Twist,
    /// One scan per laser of [`Start::lasers`], in that order.
    pub scans: Vec<Scan, MAX_SCANS>,
}
