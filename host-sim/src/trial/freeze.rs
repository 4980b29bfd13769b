//! Detects a robot that does not move while its planner says that it explores.
//!
//! The robot is frozen if its true pose stays within [`MOVED_M`] and [`TURNED_RAD`] for
//! [`FROZEN_AFTER_MS`] of exploring.

use crate::report::tum::Stamped;

/// Simulated time without motion after which the robot is frozen, milliseconds.
pub const FROZEN_AFTER_MS: u32 = 60_000;
/// Distance that counts as motion, metres.
pub const MOVED_M: f64 = 0.1;
/// Angle that counts as motion, radians.
pub const TURNED_RAD: f64 = 0.1;

/// The last pose from which the robot has not moved.
#[derive(Clone, Copy, Debug, Default)]
pub struct FreezeDetector {
    anchor: Option<Stamped>,
}

impl FreezeDetector {
    /// Takes a step's true pose; returns true if the robot is frozen.
    pub fn step(&mut self, pose: &Stamped, exploring: bool) -> bool {
        let held = self.anchor.filter(|a| exploring && !moved(a, pose));
        let Some(anchor) = held else {
            self.anchor = Some(*pose);
            return false;
        };
        pose.time_ms.saturating_sub(anchor.time_ms) >= FROZEN_AFTER_MS
    }
}

fn moved(a: &Stamped, b: &Stamped) -> bool {
    let turn = (b.yaw_rad - a.yaw_rad)
        .sin()
        .atan2((b.yaw_rad - a.yaw_rad).cos());
    (b.x_m - a.x_m).hypot(b.y_m - a.y_m) >= MOVED_M || turn.abs() >= TURNED_RAD
}

#[cfg(test)]
mod tests {
    use super::{FROZEN_AFTER_MS, FreezeDetector};
    use crate::report::tum::Stamped;

    /// Returns the first time at which the detector fires; poses come every 100 ms.
    fn fires(pose_at: impl Fn(u32) -> (f64, f64), exploring: impl Fn(u32) -> bool) -> Option<u32> {
        let mut detector = FreezeDetector::default();
        (0..3_000).map(|i| i * 100).find(|&time_ms| {
            let (x_m, yaw_rad) = pose_at(time_ms);
            let pose = Stamped {
                time_ms,
                x_m,
                yaw_rad,
                ..Stamped::default()
            };
            detector.step(&pose, exploring(time_ms))
        })
    }

    #[test]
    fn a_robot_at_rest_is_frozen_after_a_minute() {
        assert_eq!(fires(|_| (0.0, 0.0), |_| true), Some(FROZEN_AFTER_MS));
    }

    #[test]
    fn trembling_is_not_moving() {
        let tremble = |t: u32| (0.04 * f64::from(t / 100 % 2), 0.05 * f64::from(t / 100 % 2));
        assert_eq!(fires(tremble, |_| true), Some(FROZEN_AFTER_MS));
    }

    #[test]
    fn a_robot_that_creeps_turns_or_pauses_is_not_frozen() {
        assert_eq!(fires(|t| (f64::from(t) * 2e-6, 0.0), |_| true), None);
        assert_eq!(fires(|t| (0.0, f64::from(t) * 2e-5), |_| true), None);
        assert_eq!(fires(|_| (0.0, 0.0), |t| t % 50_000 != 0), None);
    }

    #[test]
    fn angles_are_compared_across_pi() {
        let flip = |t: u32| {
            (
                0.0,
                if (t / 30_000).is_multiple_of(2) {
                    3.1
                } else {
                    -3.1
                },
            )
        };
        assert_eq!(
            fires(flip, |_| true),
            Some(FROZEN_AFTER_MS),
            "0.08 rad across pi is no motion"
        );
    }
}
