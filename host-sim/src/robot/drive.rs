//! The skid-steer drive: wheels, speed limits and acceleration limits.
//!
//! The wheels of a skid-steer robot slip when it turns. It behaves like a differential drive with
//! a wider *effective track* B [Mandow07],
//!
//! ```text
//! v = (v_right + v_left) / 2        ω = (v_right − v_left) / B
//! ```
//!
//! The maker's parameter file of the 3-AT, `p3at-sh.p`, gives B: `DiffConvFactor` 0.0034 rad/mm is
//! 2/B, so B = 0.588 m, 1.5 times the 0.39 m between the wheels. The centre of rotation is the
//! centre of the footprint. Slip that varies is an error of the odometry ([`super::odometry`]),
//! not of the motion.
//!
//! Limits: 0.7 m/s and 140°/s are from the data sheet. 0.3 m/s² and 100°/s² are the firmware's
//! factory accelerations, as far as we know. Braking is 0.6 m/s², a value that the firmware lets
//! its client choose. No side runs faster than 0.75 m/s: the limit scales both speeds by the same
//! factor, so the robot keeps the commanded arc.
//!
//! [Mandow07]: A. Mandow et al., "Experimental kinematics for wheeled skid-steer mobile robots",
//! IROS 2007.

use super::pose::Velocity;

/// Limits of the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// Greatest speed, m/s. Default: 0.7.
    pub linear_mps: f64,
    /// Greatest turn rate, rad/s. Default: 140°/s.
    pub angular_radps: f64,
    /// Acceleration, m/s². Default: 0.3.
    pub acceleration_mps2: f64,
    /// Braking, m/s². Default: 0.6.
    pub braking_mps2: f64,
    /// Angular acceleration and braking, rad/s². Default: 100°/s².
    pub angular_radps2: f64,
    /// Greatest speed of either side, m/s. Default: 0.75.
    pub side_mps: f64,
    /// Effective track, metres. Default: 0.588.
    pub track_m: f64,
}

impl Default for DriveLimits {
    fn default() -> Self {
        Self {
            linear_mps: 0.7,
            angular_radps: 140.0_f64.to_radians(),
            acceleration_mps2: 0.3,
            braking_mps2: 0.6,
            angular_radps2: 100.0_f64.to_radians(),
            side_mps: 0.75,
            track_m: 0.588,
        }
    }
}

/// State of the drive.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drive {
    limits: DriveLimits,
    target: Velocity,
    velocity: Velocity,
}

impl Drive {
    /// A drive at rest.
    #[must_use]
    pub fn new(limits: DriveLimits) -> Self {
        Self {
            limits,
            ..Self::default()
        }
    }

    /// Sets the target velocity, limited to what the drive can do.
    pub fn command(&mut self, target: Velocity) {
        let limits = &self.limits;
        let linear = target
            .linear_mps
            .clamp(-limits.linear_mps, limits.linear_mps);
        let angular = target
            .angular_radps
            .clamp(-limits.angular_radps, limits.angular_radps);
        let side = linear.abs() + 0.5 * limits.track_m * angular.abs();
        let share = (limits.side_mps / side.max(1e-9)).min(1.0);
        self.target = Velocity {
            linear_mps: linear * share,
            angular_radps: angular * share,
        };
    }

    /// The current velocity.
    #[must_use]
    pub fn velocity(&self) -> Velocity {
        self.velocity
    }

    /// Runs the wheels towards the target for `seconds` and returns the new velocity. `share`, 0 to
    /// 1, scales the greatest speed: it is less than 1 uphill.
    pub fn advance(&mut self, seconds: f64, share: f64) -> Velocity {
        let limits = &self.limits;
        let most_mps = limits.linear_mps * share;
        self.velocity = Velocity {
            linear_mps: approach(
                self.velocity.linear_mps,
                self.target.linear_mps.clamp(-most_mps, most_mps),
                limits.acceleration_mps2 * seconds,
                limits.braking_mps2 * seconds,
            ),
            angular_radps: approach(
                self.velocity.angular_radps,
                self.target.angular_radps,
                limits.angular_radps2 * seconds,
                limits.angular_radps2 * seconds,
            ),
        };
        self.velocity
    }

    /// Stops at once: something solid is in the way.
    pub fn halt(&mut self) {
        self.velocity = Velocity::default();
    }
}

/// One step of `from` towards `to`: at most `rise` away from zero, at most `fall` towards zero,
/// and never through zero.
fn approach(from: f64, to: f64, rise: f64, fall: f64) -> f64 {
    if from * to < 0.0 {
        return from.signum() * (from.abs() - fall).max(0.0);
    }
    let step = if to.abs() > from.abs() { rise } else { fall };
    from + (to - from).clamp(-step, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(drive: &mut Drive, linear_mps: f64, angular_radps: f64, seconds: f64) -> Velocity {
        drive.command(Velocity {
            linear_mps,
            angular_radps,
        });
        for _ in 0..(seconds / 0.01).round() as u32 {
            drive.advance(0.01, 1.0);
        }
        drive.velocity()
    }

    #[test]
    fn speeds_up_and_brakes_at_its_limits() {
        let mut drive = Drive::new(DriveLimits::default());
        assert!((run(&mut drive, 9.0, 0.0, 1.0).linear_mps - 0.3).abs() < 1e-9);
        assert!((run(&mut drive, 9.0, 0.0, 3.0).linear_mps - 0.7).abs() < 1e-9);
        assert!((run(&mut drive, 0.0, 0.0, 1.0).linear_mps - 0.1).abs() < 1e-9);
        assert_eq!(run(&mut drive, 0.0, 0.0, 1.0), Velocity::default());
        let spin = run(&mut drive, 0.0, -9.0, 3.0).angular_radps;
        assert!((spin + 140.0_f64.to_radians()).abs() < 1e-9);
    }

    #[test]
    fn reverses_through_rest() {
        let mut drive = Drive::new(DriveLimits::default());
        run(&mut drive, 0.3, 0.0, 2.0);
        // 0.5 s of braking to rest, then 0.5 s at 0.3 m/s².
        assert!((run(&mut drive, -0.7, 0.0, 1.0).linear_mps + 0.15).abs() < 1e-9);
    }

    #[test]
    fn uphill_it_brakes_to_its_share_of_the_speed_and_keeps_it() {
        let mut drive = Drive::new(DriveLimits::default());
        run(&mut drive, 0.7, 0.0, 4.0);
        drive.advance(0.1, 0.5);
        assert!((drive.velocity().linear_mps - 0.64).abs() < 1e-9);
        for _ in 0..100 {
            drive.advance(0.1, 0.5);
        }
        assert_eq!(drive.velocity().linear_mps, 0.35);
        assert_eq!(drive.target.linear_mps, 0.7);
    }

    #[test]
    fn the_limit_of_a_side_scales_both_speeds_and_keeps_the_arc() {
        let mut drive = Drive::new(DriveLimits::default());
        let velocity = run(&mut drive, 0.7, 2.0, 10.0);
        let outer = velocity.linear_mps + 0.294 * velocity.angular_radps;
        assert!((outer - 0.75).abs() < 1e-9, "{outer}");
        assert!((velocity.angular_radps / velocity.linear_mps - 2.0 / 0.7).abs() < 1e-9);
    }
}
