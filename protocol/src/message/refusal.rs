//! Why a request is refused.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

#[cfg(doc)]
use super::{Laser, MAX_BEAMS, NO_RETURN_MM, Start, Terrain};

/// A parameter of [`Start`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Parameter {
    /// [`Start::lasers`]: one or two.
    Lasers,
    /// [`Laser::beams`]: 1 to [`MAX_BEAMS`].
    Beams,
    /// [`Laser::range_limit_mm`]: 1 to [`NO_RETURN_MM`] − 1.
    RangeLimit,
    /// [`Laser::first_bearing`] and [`Laser::bearing_step`]: within one turn, the step positive.
    Bearing,
    /// [`Laser::pitch`]: the first laser is level, the second looks down by less than 90°.
    Pitch,
    /// [`Laser::x`], [`Laser::y`] and [`Laser::z`]: at most 2 m from the centre, above the ground.
    Mount,
    /// [`Start::robot_radius_mm`]: 50 to 2000.
    Radius,
    /// [`Start::max_linear`]: positive.
    MaxLinear,
    /// [`Start::max_angular`]: positive.
    MaxAngular,
    /// [`Start::linear_accel`]: from the greatest speed to rest in 3 s at the most.
    LinearAccel,
    /// [`Start::angular_accel`]: from the greatest turn rate to rest in 3 s at the most.
    AngularAccel,
    /// [`Start::period_ms`]: 100 to 400.
    Period,
    /// [`Terrain::least`] and [`Terrain::most`]: from −2 to 0 and from 0 to 2, because beyond 2 the field diverges.
    Preference,
    /// Another of [`Terrain`]'s: a scale below 0, a height or slope of 0, a slope above 45°, or without a tilted laser.
    Terrain,
}

/// Why a request was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Refusal {
    /// No hello since the device booted.
    NotGreeted,
    /// No session is running.
    NotStarted,
    /// An older sequence number than the last one answered.
    OutOfOrder,
    /// The box's shape does not fit the device's slots.
    BadBox,
    /// A laser or limit out of range.
    BadParameter(Parameter),
    /// That strategy is not in this image.
    UnknownStrategy,
}
