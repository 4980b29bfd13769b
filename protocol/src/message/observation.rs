//! Measurements of the robot.
//!
//! Units: metres, radians, seconds; ranges in millimetres.

use fixed::types::{I4F12, I16F16};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

#[cfg(doc)]
use super::{Fault, Start};

/// Maximum number of beams in a scan.
pub const MAX_BEAMS: usize = 181;
/// Maximum number of scans in an observation.
pub const MAX_SCANS: usize = 2;
/// Range code of a beam without a return: the beam is free up to the range limit. It is the largest
/// two-byte varint.
pub const NO_RETURN_MM: u16 = 16_383;
/// Range code of a beam that carries no information.
pub const INVALID_MM: u16 = 0;

/// A pose in the odometry's coordinates.
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

/// A velocity in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Twist {
    /// Forward, metres per second.
    pub linear: I4F12,
    /// Counter-clockwise, radians per second.
    pub angular: I4F12,
}

/// One sweep of one laser. [`Start::lasers`] holds its geometry.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Scan {
    /// Ranges in millimetres, or [`NO_RETURN_MM`], or [`INVALID_MM`].
    pub ranges_mm: Vec<u16, MAX_BEAMS>,
}

/// Measurements of the robot at one instant: that of the newest beam, if a laser turns while the
/// robot moves.
///
/// The scans must match the session's lasers in number and length, the pose must lie within 10 km,
/// and the robot may lean by at most 60°. If not, the device makes no step and answers with zero
/// velocity and [`Fault::BadObservation`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Observation {
    /// The host's clock, milliseconds since the start of the session.
    pub time_ms: u32,
    /// Pose from odometry.
    pub pose: Pose,
    /// Measured velocity.
    pub velocity: Twist,
    /// One scan per laser of [`Start::lasers`], in the same order, with one range per beam.
    pub scans: Vec<Scan, MAX_SCANS>,
}
