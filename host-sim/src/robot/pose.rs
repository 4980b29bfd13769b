//! True poses and velocities in double precision, and their conversion to the wire's fixed point.
//!
//! Attitude is yaw, then pitch, then roll: `R = Rz(yaw) Ry(pitch) Rx(roll)`; positive pitch is
//! nose down. Metres, radians, seconds.

use fieldline_protocol::message;
use fixed::types::{I4F12, I16F16};

/// A pose in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Metres.
    pub x_m: f64,
    /// Metres.
    pub y_m: f64,
    /// Metres.
    pub z_m: f64,
    /// Radians about the forward axis.
    pub roll_rad: f64,
    /// Radians about the left axis; positive is nose down.
    pub pitch_rad: f64,
    /// Radians about the up axis, in [−π, π).
    pub yaw_rad: f64,
}

/// A planar velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity {
    /// Forward speed, metres a second.
    pub linear_mps: f64,
    /// Turn rate, radians a second, counter-clockwise.
    pub angular_radps: f64,
}

/// Wraps an angle into [−π, π).
#[must_use]
pub fn wrap(angle_rad: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    let turns = ((angle_rad + PI) / TAU).floor();
    (angle_rad - turns * TAU).clamp(-PI, PI)
}

/// Distance between two points of the plane, metres.
pub(crate) fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    (dx * dx + dy * dy).sqrt()
}

/// A frame in the plane of the world: its origin, and cosine and sine of its heading.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanarFrame {
    origin_m: [f64; 2],
    cos: f64,
    sin: f64,
}

impl PlanarFrame {
    /// Converts a point `[ahead, left]` of this frame to the world.
    pub(crate) fn to_world(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.origin_m[0] + x * self.cos - y * self.sin,
            self.origin_m[1] + x * self.sin + y * self.cos,
        ]
    }

    /// This frame with its origin moved to a point `[ahead, left]`.
    pub(crate) fn shifted(self, point: [f64; 2]) -> Self {
        Self {
            origin_m: self.to_world(point),
            ..self
        }
    }

    /// Converts a point of the world to this frame.
    pub(crate) fn to_local(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (dx, dy) = (x - self.origin_m[0], y - self.origin_m[1]);
        [dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin]
    }
}

impl Pose {
    /// Planar distance to another pose, metres.
    #[must_use]
    pub fn distance_m(&self, other: &Self) -> f64 {
        distance_m([self.x_m, self.y_m], [other.x_m, other.y_m])
    }

    /// The robot's frame, seen from above.
    pub(crate) fn planar_frame(&self) -> PlanarFrame {
        PlanarFrame {
            origin_m: [self.x_m, self.y_m],
            cos: libm::cos(self.yaw_rad),
            sin: libm::sin(self.yaw_rad),
        }
    }

    /// The pose after `seconds` at a constant velocity: the exact arc.
    #[must_use]
    pub fn driven(&self, velocity: Velocity, seconds: f64) -> Self {
        self.moved(
            velocity.linear_mps * seconds,
            velocity.angular_radps * seconds,
        )
    }

    /// The pose after an arc of `forward_m` that turns by `turn_rad`: its chord lies at half the
    /// turn.
    #[must_use]
    pub fn moved(&self, forward_m: f64, turn_rad: f64) -> Self {
        let half = 0.5 * turn_rad;
        let chord_m = if half.abs() < 1e-9 {
            forward_m
        } else {
            forward_m * libm::sin(half) / half
        };
        let heading = self.yaw_rad + half;
        Self {
            x_m: self.x_m + chord_m * libm::cos(heading),
            y_m: self.y_m + chord_m * libm::sin(heading),
            yaw_rad: wrap(self.yaw_rad + turn_rad),
            ..*self
        }
    }

    /// The robot's forward, left and up axes in the world: the columns of R.
    #[must_use]
    pub fn axes(&self) -> [[f64; 3]; 3] {
        let (cr, sr) = (libm::cos(self.roll_rad), libm::sin(self.roll_rad));
        let (cp, sp) = (libm::cos(self.pitch_rad), libm::sin(self.pitch_rad));
        let (cy, sy) = (libm::cos(self.yaw_rad), libm::sin(self.yaw_rad));
        [
            [cy * cp, sy * cp, -sp],
            [cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr],
            [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr],
        ]
    }

    /// Converts to the wire's type; saturates.
    #[must_use]
    pub fn to_wire(&self) -> message::Pose {
        message::Pose {
            x: I16F16::saturating_from_num(self.x_m),
            y: I16F16::saturating_from_num(self.y_m),
            z: I16F16::saturating_from_num(self.z_m),
            roll: I16F16::saturating_from_num(self.roll_rad),
            pitch: I16F16::saturating_from_num(self.pitch_rad),
            yaw: I16F16::saturating_from_num(self.yaw_rad),
        }
    }
}

impl Velocity {
    /// Converts to the wire's type; saturates.
    #[must_use]
    pub fn to_wire(self) -> message::Twist {
        message::Twist {
            linear: I4F12::saturating_from_num(self.linear_mps),
            angular: I4F12::saturating_from_num(self.angular_radps),
        }
    }
}

impl From<message::Twist> for Velocity {
    fn from(twist: message::Twist) -> Self {
        Self {
            linear_mps: twist.linear.to_num(),
            angular_radps: twist.angular.to_num(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn an_arc_is_the_sum_of_many_small_ones() {
        let start = Pose {
            x_m: 1.0,
            yaw_rad: 2.0,
            ..Pose::default()
        };
        let velocity = Velocity {
            linear_mps: 0.5,
            angular_radps: -1.1,
        };
        let whole = start.driven(velocity, 3.0);
        let mut parts = start;
        for _ in 0..300 {
            parts = parts.driven(velocity, 0.01);
        }
        assert!(whole.distance_m(&parts) < 1e-12);
        assert!((whole.yaw_rad - parts.yaw_rad).abs() < 1e-12);
        // A quarter turn to the left on a circle of 1 m around (0, 1).
        let quarter = Pose::default().moved(FRAC_PI_2, FRAC_PI_2);
        assert!((quarter.x_m - 1.0).abs() < 1e-12 && (quarter.y_m - 1.0).abs() < 1e-12);
    }

    #[test]
    fn angles_wrap_into_one_turn() {
        for (angle, wrapped) in [(0.5, 0.5), (PI, -PI), (-PI, -PI), (7.0, 7.0 - 2.0 * PI)] {
            assert!((wrap(angle) - wrapped).abs() < 1e-12, "{angle}");
        }
        assert!((-PI..=PI).contains(&wrap(-PI - 1e-17)));
    }

    #[test]
    fn axes_follow_the_signs_of_the_wire() {
        let pose = |roll_rad, pitch_rad, yaw_rad| Pose {
            roll_rad,
            pitch_rad,
            yaw_rad,
            ..Pose::default()
        };
        // Nose down: forward points below the horizon. Yaw to the left: forward points to +y.
        let [forward, ..] = pose(0.0, 0.3, 0.0).axes();
        assert!(forward[2] < 0.0 && forward[0] > 0.0);
        let [forward, left, up] = pose(0.0, 0.0, FRAC_PI_2).axes();
        assert!((forward[1] - 1.0).abs() < 1e-12 && (left[0] + 1.0).abs() < 1e-12);
        assert!((up[2] - 1.0).abs() < 1e-12);
        // Rolling about the forward axis lifts the left side.
        assert!(pose(0.3, 0.0, 0.0).axes()[1][2] > 0.0);
        // Always orthonormal and right-handed: forward × left = up.
        let [f, l, u] = pose(0.3, -0.8, 2.1).axes();
        let cross = [
            f[1] * l[2] - f[2] * l[1],
            f[2] * l[0] - f[0] * l[2],
            f[0] * l[1] - f[1] * l[0],
        ];
        assert!((0..3).all(|k| (cross[k] - u[k]).abs() < 1e-12));
    }
}
