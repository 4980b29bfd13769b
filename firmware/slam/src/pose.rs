//! Planar poses and the motions between them.
//!
//! ```text
//! a ∘ b      = b, given in the frame of a
//! between(a, b) = a⁻¹ ∘ b
//! ```
//!
//! Units: metres, radians.

use core::f32::consts::PI;

/// A planar pose, or the motion from one pose to another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Metres east, or forward.
    pub x_m: f32,
    /// Metres north, or left.
    pub y_m: f32,
    /// Radians, counter-clockwise.
    pub yaw_rad: f32,
}

impl Pose {
    /// Returns a pose given in the frame of this one.
    ///
    /// ```
    /// use fieldline_slam::Pose;
    ///
    /// let left = Pose { x_m: 1.0, y_m: 2.0, yaw_rad: core::f32::consts::FRAC_PI_2 };
    /// let ahead = left.compose(&Pose { x_m: 3.0, ..Pose::default() });
    /// assert!((ahead.x_m - 1.0).abs() < 1e-6 && (ahead.y_m - 5.0).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn compose(&self, other: &Self) -> Self {
        let [x_m, y_m] = self.point([other.x_m, other.y_m]);
        Self {
            x_m,
            y_m,
            yaw_rad: wrap(self.yaw_rad + other.yaw_rad),
        }
    }

    /// Returns the other pose in the frame of this one.
    #[must_use]
    pub fn between(&self, other: &Self) -> Self {
        let (sin, cos) = sin_cos(self.yaw_rad);
        let (dx, dy) = (other.x_m - self.x_m, other.y_m - self.y_m);
        Self {
            x_m: cos * dx + sin * dy,
            y_m: cos * dy - sin * dx,
            yaw_rad: wrap(other.yaw_rad - self.yaw_rad),
        }
    }

    /// Returns the motion back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        self.between(&Self::default())
    }

    /// Returns a point of this pose's frame in the frame of the pose.
    #[must_use]
    pub fn point(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let (sin, cos) = sin_cos(self.yaw_rad);
        [self.x_m + cos * x - sin * y, self.y_m + sin * x + cos * y]
    }

    /// Returns the length of a motion, metres.
    #[must_use]
    pub fn length_m(&self) -> f32 {
        sqrt(self.x_m * self.x_m + self.y_m * self.y_m)
    }

    /// Returns true if all three numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.x_m.is_finite() && self.y_m.is_finite() && self.yaw_rad.is_finite()
    }

    pub(crate) const fn array(&self) -> [f32; 3] {
        [self.x_m, self.y_m, self.yaw_rad]
    }

    /// Returns the pose with three numbers added; the angle is not wrapped.
    pub(crate) fn plus(&self, [x, y, yaw]: [f32; 3]) -> Self {
        Self {
            x_m: self.x_m + x,
            y_m: self.y_m + y,
            yaw_rad: self.yaw_rad + yaw,
        }
    }

    /// Returns the three differences to another pose, the angle in [−π, π].
    pub(crate) fn minus(&self, other: &Self) -> [f32; 3] {
        [
            self.x_m - other.x_m,
            self.y_m - other.y_m,
            wrap(self.yaw_rad - other.yaw_rad),
        ]
    }
}

/// Returns the equal angle in [−π, π].
#[must_use]
pub fn wrap(angle: f32) -> f32 {
    angle - 2.0 * PI * libm::floorf(angle / (2.0 * PI) + 0.5)
}

pub(crate) fn sin_cos(angle: f32) -> (f32, f32) {
    (libm::sinf(angle), libm::cosf(angle))
}

pub(crate) fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

#[cfg(test)]
mod tests {
    use super::{PI, Pose, wrap};

    #[test]
    fn between_undoes_compose_in_any_direction() {
        for k in 0..40 {
            let at = |a: f32, b: f32| (a * k as f32 + b) % 7.0 - 3.5;
            let pose = |a, b| Pose {
                x_m: at(a, b),
                y_m: at(b, a),
                yaw_rad: wrap(at(a + b, 0.3)),
            };
            let (one, other) = (pose(1.3, 0.4), pose(2.9, 1.1));
            let back = one.between(&one.compose(&other));
            assert!(back.minus(&other).iter().all(|it| it.abs() < 1e-5), "{k}");
            let none = one.compose(&one.inverse());
            assert!(none.array().iter().all(|it| it.abs() < 1e-5), "{k}");
        }
    }

    #[test]
    fn wrapped_angles_are_within_half_a_turn() {
        for k in -100..100 {
            let angle = k as f32 * 0.37;
            let wrapped = wrap(angle);
            assert!(wrapped.abs() <= PI + 1e-5);
            let turns = (angle - wrapped) / (2.0 * PI);
            assert!((turns - turns.round()).abs() < 1e-4);
        }
    }
}
