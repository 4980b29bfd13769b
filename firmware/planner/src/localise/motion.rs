//! The motion of a step, in the robot's frame before it.
//!
//! ```text
//! shift = R(yaw)ᵀ (after − before),  turn = wrap(yaw after − yaw before)
//! ```
//!
//! Invariant: `Motion::between(a, b).from(a)` is `b` in the plane, up to rounding. Height and tilt
//! stay those of the first pose. Units: metres, radians.

use crate::geometry::{Point, Pose};
use crate::math;

/// The motion of a step, in the robot's frame before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    shift: Point,
    turn_rad: f32,
}

impl Motion {
    /// No motion.
    pub(super) const NONE: Self = Self {
        shift: Point::ORIGIN,
        turn_rad: 0.0,
    };

    /// Returns the motion that leads from one pose to another.
    pub(super) fn between(before: &Pose, after: &Pose) -> Self {
        Self {
            shift: before.to_robot(after.point()),
            turn_rad: math::wrap(after.yaw_rad - before.yaw_rad),
        }
    }

    /// Returns where the motion leads from a pose.
    pub(super) fn from(&self, before: &Pose) -> Pose {
        let Point { x_m, y_m } = before.to_map(self.shift);
        Pose {
            x_m,
            y_m,
            yaw_rad: math::wrap(before.yaw_rad + self.turn_rad),
            ..*before
        }
    }
}
