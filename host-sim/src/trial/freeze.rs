//! Notices a robot that says it explores and does nothing.
//!
//! Frozen: for [`PATIENCE_MS`] of exploring, the true pose stayed within [`MOVED_M`] and [`TURNED_RAD`] of where it was.

use crate::report::tum::Stamped;

/// Simulated time without motion that counts as frozen, milliseconds.
pub const PATIENCE_MS: u32 = 60_000;
/// A robot that went this far has moved, metres.
pub const MOVED_M: f64 = 0.1;
/// A robot that turned this far has moved, radians.
pub const TURNED_RAD: f64 = 0.1;

/// The last pose from which the robot has not moved.
#[derive(Clone, Copy, Debug, Default)]
pub struct FreezeDetector {
    anchor: Option<Stamped>,
}

impl FreezeDetector {
    /// Take a step's true pose; whether the robot is frozen now.
    pub fn step(&mut self, pose: &Stamped, exploring: bool) -> bool {
        let held = self.anchor.filter(|a| exploring && !moved(a, pose));
        let Some(anchor) = held else {
            self.anchor = Some(*pose);
            return false;
        };
        pose.time_ms.saturating_sub(anchor.time_ms) >= PATIENCE_MS
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
    use super::{FreezeDetector, PATIENCE_MS};
    use crate::report::tum::Stamped;

    /// The first time at which the detector fires, of poses 100 ms apart.
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
    fn a_robot_that_stands_is_frozen_after_a_minute() {
        assert_eq!(fires(|_| (0.0, 0.0), |_| true), Some(PATIENCE_MS));
    }

    #[test]
    fn trembling_is_not_moving() {
        let tremble = |t: u32| (0.04 * f64::from(t / 100 % 2), 0.05 * f64::from(t / 100 % 2));
        assert_eq!(fires(tremble, |_| true), Some(PATIENCE_MS));
    }

    #[test]
    fn creeping_turning_and_pausing_are_fine() {
        assert_eq!(fires(|t| (f64::from(t) * 2e-6, 0.0), |_| true), None);
        assert_eq!(fires(|t| (0.0, f64::from(t) * 2e-5), |_| true), None);
        assert_eq!(fires(|_| (0.0, 0.0), |t| t % 50_000 != 0), None);
    }

    #[test]
    fn half_a_turn_across_pi_is_a_turn() {
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
            Some(PATIENCE_MS),
            "0.08 rad across the cut is no motion"
        );
    }
}
