//! Reasons for which the device refuses a request.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

#[cfg(doc)]
use super::{
    Control, Laser, MAX_BEAMS, MOST_CORRECTED, NO_RETURN_MM, Order, SpaceField, Start, UnevenGround,
};

/// A parameter of [`Start`], with its accepted range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Parameter {
    /// [`Start::lasers`]: one or two; two on uneven ground.
    Lasers,
    /// [`Laser::beams`]: 1 to [`MAX_BEAMS`].
    Beams,
    /// [`Laser::range_limit_mm`]: 1 to [`NO_RETURN_MM`] − 1.
    RangeLimit,
    /// [`Laser::first_bearing`] and [`Laser::bearing_step`]: within one turn, with a positive step.
    Bearing,
    /// [`Laser::pitch`]: the first laser is level within 0.05 rad; the second looks down by 0° to
    /// less than 90°.
    Pitch,
    /// [`Laser::x`], [`Laser::y`] and [`Laser::z`]: at most 2 m from the centre, above the ground.
    Mount,
    /// [`Start::robot_radius_mm`]: 50 to 600.
    Radius,
    /// [`Start::max_linear`]: positive.
    MaxLinear,
    /// [`Start::max_angular`]: positive.
    MaxAngular,
    /// [`Start::linear_accel`]: stops the robot from its maximum speed within 3 s.
    LinearAccel,
    /// [`Start::angular_accel`]: stops the robot from its maximum turn rate within 3 s.
    AngularAccel,
    /// [`Start::period_ms`]: 100 to 400.
    Period,
    /// [`UnevenGround::least`]: −2 to 0. [`UnevenGround::most`]: 0 to 2. Beyond 2 the field
    /// diverges.
    Preference,
    /// The rest of [`UnevenGround`]: scales at least 0; [`UnevenGround::hole`] negative; other
    /// heights and slopes positive; slopes at most 45°.
    UnevenGround,
    /// [`Start::hull`]: length and width 1 to 4000 mm, height at most 2000 mm.
    Hull,
    /// [`Start::loops`]: at least 0.
    LoopLimits,
    /// The worth of an [`Order`]: 0 to 7.
    Worth,
    /// [`SpaceField::size`]: 0.1 to 128 m. [`SpaceField::origin`]: within 3200 m.
    Area,
    /// [`SpaceField::until_permille`]: 1 to 1000.
    Coverage,
    /// [`Start::team`]: the origin within 400 m and a hundred turns.
    Team,
    /// [`Start::fence`]: the polygons have all corners, each at least 3 of them, an area and no
    /// crossing; corners within 3200 m.
    Fence,
    /// [`Laser::turn_time_ms`]: at most 500; 0 for a laser that looks down by 0.05 rad or more.
    TurnTime,
}

/// Why the device refused a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Refusal {
    /// The host sent no hello since the device booted.
    NotGreeted,
    /// No session is running.
    NotStarted,
    /// The sequence number is older than the last one answered.
    OutOfOrder,
    /// A parameter is out of its range.
    BadParameter(Parameter),
    /// The session has no team: [`Start::team`] is `None`.
    NoTeam,
    /// No correction of this epoch is open.
    NoCorrection,
    /// A correction has more than [`MOST_CORRECTED`] tiles, moves the robot more than 10 km from
    /// the map's origin, or is for uneven ground.
    BadCorrection,
    /// The cells of a tile are not those of a tile.
    BadTile,
    /// The robot takes no order to drive: it has seen nothing yet, does not know where it is, must
    /// not be where it started, only surveys, or its session was stopped.
    NotReady,
    /// The goal of [`Control::GoTo`] is farther than 3200 m from the map's origin, or forbidden by
    /// [`Start::fence`].
    BadGoal,
}
