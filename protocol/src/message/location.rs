//! Where the device thinks the robot is, in the coordinates of its map.
//!
//! Units: metres, radians; covariances in squares of a centimetre and of a hundredth of a radian.

use fixed::types::{I4F12, I16F16};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// How well the device knows the pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Quality {
    /// The scan holds the pose in every direction.
    #[default]
    Tracking,
    /// Odometry alone holds the pose in some direction.
    Degenerate {
        /// The direction in the map that the scan does not observe, radians; `None` if it observes
        /// no direction.
        direction: Option<I4F12>,
    },
    /// The scan contradicts the map. The robot stands, and nothing is entered into the map.
    Lost,
}

/// The pose in the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Location {
    /// Metres.
    pub x: I16F16,
    /// Metres.
    pub y: I16F16,
    /// Radians about the up axis, in [−π, π].
    pub yaw: I16F16,
    /// Covariance of x, y and yaw: xx, xy, yy in cm²; x yaw, y yaw in cm · 0.01 rad; yaw yaw in
    /// (0.01 rad)².
    pub covariance: [I16F16; 6],
    /// The quality.
    pub quality: Quality,
}
