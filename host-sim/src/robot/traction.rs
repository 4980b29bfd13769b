//! Traction: slopes slow the robot, make its wheels slip, and let it drift downhill.
//!
//! With `g` the tangent of a slope's angle, the wheels slip over this share of their distance:
//!
//! ```text
//! s(g) = κ g / (μ − g)     0 on level ground, 1 near the angle at which rubber slides on soil
//! ```
//!
//! This is the usual shape of slip over demanded traction. κ = 0.05 and μ = 0.65 are our choice:
//! plausible for tyres on firm soil, and parameters. Uphill the robot moves 1 − s of what its
//! wheels turn, downhill 1 + s. Across a slope it slides downhill by s of the distance that its
//! wheels rub over the ground, in driving or in turning. Uphill the motors have less power left:
//! the greatest speed falls linearly to zero at the grade on which they stall.
//!
//! Seen from above, distances along a slope shorten by the cosine of the pitch. On level ground
//! every term is exactly zero. Metres, radians, seconds.

use super::pose::{Pose, Velocity};

/// Grip of wheels and strength of motors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traction {
    /// μ: tangent of the angle at which the wheels slide. Default: 0.65.
    pub friction: f64,
    /// κ: slip at little demand. Default: 0.05.
    pub creep: f64,
    /// Tangent of the angle at which the motors stall. Default: 1.
    pub stall_grade: f64,
}

impl Default for Traction {
    fn default() -> Self {
        Self {
            friction: 0.65,
            creep: 0.05,
            stall_grade: 1.0,
        }
    }
}

/// Least share of the full speed that is left to the motors.
const LEAST_SPEED: f64 = 0.1;
/// Half the track, metres: distance from the centre at which the wheels rub in a turn.
const RUB_M: f64 = 0.197;

/// A motion, seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Along the heading, metres.
    pub forward_m: f64,
    /// To the left, metres.
    pub left_m: f64,
    /// Counter-clockwise, radians.
    pub turn_rad: f64,
    /// Distance driven along the heading and the slope, metres.
    pub driven_m: f64,
}

impl Traction {
    /// The share of their distance that wheels slip on a grade of either sign, 0 to 1.
    #[must_use]
    pub fn slip(&self, grade: f64) -> f64 {
        let demand = grade.abs();
        if demand >= self.friction {
            return 1.0;
        }
        (self.creep * demand / (self.friction - demand)).min(1.0)
    }

    /// The share of its full speed that the robot has in this attitude, forwards or backwards.
    #[must_use]
    pub fn speed_share(&self, pose: &Pose, forwards: bool) -> f64 {
        let uphill = climb(pose, forwards).max(0.0);
        (1.0 - uphill / self.stall_grade).max(LEAST_SPEED)
    }

    /// The motion of wheels that keep a speed for `seconds` on the slope where the robot stands.
    #[must_use]
    pub fn shift(&self, pose: &Pose, wheels: Velocity, seconds: f64) -> Shift {
        let (forward_m, turn_rad) = (wheels.linear_mps * seconds, wheels.angular_radps * seconds);
        let uphill = climb(pose, forward_m >= 0.0);
        let share = if uphill > 0.0 {
            1.0 - self.slip(uphill)
        } else {
            1.0 + self.slip(uphill)
        };
        let driven_m = forward_m * share;
        let across = libm::tan(pose.roll_rad);
        let rubbed_m = driven_m.abs() + RUB_M * turn_rad.abs();
        Shift {
            forward_m: driven_m * libm::cos(pose.pitch_rad),
            // The left side is the higher one where the roll is positive.
            left_m: -across.signum() * rubbed_m * self.slip(across),
            turn_rad,
            driven_m,
        }
    }
}

/// Tangent of the slope that the robot drives up; negative downhill.
fn climb(pose: &Pose, forwards: bool) -> f64 {
    let nose_up = -libm::tan(pose.pitch_rad);
    if forwards { nose_up } else { -nose_up }
}

impl Shift {
    /// The pose after this motion: the arc, then the drift aside. Height and attitude stay.
    #[must_use]
    pub fn applied(&self, pose: &Pose) -> Pose {
        let moved = pose.moved(self.forward_m, self.turn_rad);
        if self.left_m == 0.0 {
            return moved;
        }
        Pose {
            x_m: moved.x_m - self.left_m * libm::sin(pose.yaw_rad),
            y_m: moved.y_m + self.left_m * libm::cos(pose.yaw_rad),
            ..moved
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRIP: Traction = Traction {
        friction: 0.65,
        creep: 0.05,
        stall_grade: 1.0,
    };

    fn tilted(pitch_deg: f64, roll_deg: f64) -> Pose {
        Pose {
            pitch_rad: pitch_deg.to_radians(),
            roll_rad: roll_deg.to_radians(),
            yaw_rad: 0.7,
            ..Pose::default()
        }
    }

    fn driving(linear_mps: f64) -> Velocity {
        Velocity {
            linear_mps,
            angular_radps: 0.3,
        }
    }

    #[test]
    fn level_ground_changes_no_bit() {
        for velocity in [driving(0.37), driving(-0.11), driving(0.0)] {
            let shift = GRIP.shift(&tilted(0.0, 0.0), velocity, 0.01);
            let pose = tilted(0.0, 0.0);
            assert_eq!(shift.applied(&pose), pose.driven(velocity, 0.01));
            assert_eq!(shift.driven_m, velocity.linear_mps * 0.01);
            assert_eq!(GRIP.speed_share(&pose, true), 1.0);
        }
    }

    #[test]
    fn slip_grows_with_the_slope_up_to_sliding() {
        let slips: Vec<f64> = (0..40).map(|k| GRIP.slip(0.02 * f64::from(k))).collect();
        assert_eq!(slips[0], 0.0);
        assert!(slips.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!(GRIP.slip(0.65), 1.0);
        // 20°: 0.05 · 0.364 / 0.286.
        assert!((GRIP.slip(20.0_f64.to_radians().tan()) - 0.0636).abs() < 1e-3);
    }

    #[test]
    fn uphill_is_slower_than_downhill_forwards_and_backwards() {
        let forward = |pitch_deg, speed| {
            let shift = GRIP.shift(&tilted(pitch_deg, 0.0), driving(speed), 1.0);
            shift.forward_m.abs()
        };
        let (up, down) = (forward(-15.0, 0.4), forward(15.0, 0.4));
        assert!(up < 0.4 * 15.0_f64.to_radians().cos() && up > 0.3, "{up}");
        assert!(down > up && down < 0.41);
        // Backwards with the nose down is uphill.
        assert_eq!(forward(15.0, -0.4), up);
        assert_eq!(GRIP.speed_share(&tilted(45.0, 0.0), true), 1.0);
        assert!((GRIP.speed_share(&tilted(-20.0, 0.0), true) - 0.636).abs() < 1e-3);
        assert!((GRIP.speed_share(&tilted(20.0, 0.0), false) - 0.636).abs() < 1e-3);
        assert_eq!(GRIP.speed_share(&tilted(-50.0, 0.0), true), LEAST_SPEED);
    }

    #[test]
    fn across_a_slope_the_robot_drifts_downhill() {
        // The left side is higher: the robot drifts to the right.
        let shift = GRIP.shift(&tilted(0.0, 12.0), driving(0.4), 1.0);
        assert!(shift.left_m < -0.005 && shift.left_m > -0.02, "{shift:?}");
        let pose = tilted(0.0, 12.0);
        let (there, straight) = (shift.applied(&pose), pose.driven(driving(0.4), 1.0));
        let right = [pose.yaw_rad.sin(), -pose.yaw_rad.cos()];
        let (dx, dy) = (there.x_m - straight.x_m, there.y_m - straight.y_m);
        assert!((dx * right[0] + dy * right[1] + shift.left_m).abs() < 1e-12);
        assert!(GRIP.shift(&tilted(0.0, -12.0), driving(0.4), 1.0).left_m > 0.0);
    }
}
