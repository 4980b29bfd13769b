//! What a robot says of its place: pose, covariance, and a quality with a type.
//!
//! ```text
//! covariance = E[(p − p̂)(p − p̂)ᵀ],  p = (x, y, yaw)
//! ```
//!
//! Invariant: the covariance is that of the pose beside it, in the map's frame. Units: metres,
//! radians.

use crate::geometry::MapPose;

/// How well the robot knows where it is.
///
/// ```
/// use fieldline_planner::Quality;
///
/// /// Returns the speed that a careful user allows.
/// fn speed_mps(quality: Quality) -> f32 {
///     match quality {
///         Quality::Tracking => 0.7,
///         Quality::Degenerate(_) => 0.4,
///         Quality::Lost => 0.0,
///     }
/// }
/// assert_eq!(speed_mps(Quality::Degenerate(None)), 0.4);
/// ```
// With a tag of its own, the first value is all zeros. So is then the memory of a session that
// begins, and the image does not have to store it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(u8)]
pub enum Quality {
    /// The scan holds the pose in every direction.
    #[default]
    Tracking,
    /// The scan does not observe this direction of the map, radians, or none at all: odometry holds
    /// the pose there.
    Degenerate(Option<f32>),
    /// The scan contradicts the map. Nothing is entered into the map.
    Lost,
}

/// A pose in the map, and how well it is known.
///
/// ```
/// use fieldline_planner::{Location, MapPose, Quality, State};
///
/// let state = Box::new(State::<4, 64>::new());
/// let Location { pose, quality, .. } = state.location();
/// assert_eq!((pose, quality), (MapPose::default(), Quality::Tracking));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// The pose.
    pub pose: MapPose,
    /// Variances and covariances of x, y and yaw: xx, xy, yy, xt, yt, tt; m², m rad, rad².
    pub covariance: [f32; 6],
    /// The quality.
    pub quality: Quality,
}
