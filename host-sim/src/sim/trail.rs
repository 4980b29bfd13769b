//! Where the robot was in the last moments, for lidars that turn while it moves.
//!
//! Between two substeps, at t₀ and t₁, the robot is taken to have moved evenly:
//!
//! ```text
//! pose(t) = pose₀ + s (pose₁ − pose₀)        s = (t − t₀) / (t₁ − t₀)
//! ```
//!
//! Angles go the short way round. Before the first substep it stood where it began. Without such a
//! lidar nothing is kept. Units: milliseconds, metres, radians; ages in seconds.

use std::collections::VecDeque;

use crate::robot::{LaserScanner, Pose, wrap};

/// The last poses of a robot, the oldest first.
#[derive(Clone, Debug)]
pub(super) struct Trail {
    /// Longest time that is asked for, milliseconds.
    most_ms: u32,
    poses: VecDeque<(u32, Pose)>,
}

impl Trail {
    /// Returns the trail that these lasers need, without a pose.
    pub(super) fn of(lasers: &[LaserScanner]) -> Self {
        let longest_s = lasers.iter().map(LaserScanner::turn_time_s);
        Self {
            most_ms: (1000.0 * longest_s.fold(0.0, f64::max)).ceil() as u32,
            poses: VecDeque::new(),
        }
    }

    /// Notes the pose at the beginning of a substep.
    pub(super) fn note(&mut self, time_ms: u32, pose: &Pose) {
        if self.most_ms == 0 {
            return;
        }
        // One pose from before the longest time stays.
        let is_old = |(then_ms, _): &(u32, Pose)| time_ms - then_ms >= self.most_ms;
        while self.poses.get(1).is_some_and(is_old) {
            self.poses.pop_front();
        }
        self.poses.push_back((time_ms, *pose));
    }

    /// Returns the pose some time ago.
    pub(super) fn pose(&self, (now_ms, now): (u32, &Pose), age_s: f64) -> Pose {
        let at_ms = f64::from(now_ms) - 1000.0 * age_s;
        let mut later = (now_ms, now);
        for (then_ms, then) in self.poses.iter().rev() {
            if f64::from(*then_ms) <= at_ms {
                let span_ms = f64::from(later.0 - then_ms);
                let share = if span_ms > 0.0 {
                    (at_ms - f64::from(*then_ms)) / span_ms
                } else {
                    1.0
                };
                return between(then, later.1, share);
            }
            later = (*then_ms, then);
        }
        *later.1
    }
}

/// Returns the pose at a share of the way from one to the other.
fn between(from: &Pose, to: &Pose, share: f64) -> Pose {
    let length = |from: f64, to: f64| from + share * (to - from);
    let angle = |from: f64, to: f64| wrap(from + share * wrap(to - from));
    Pose {
        x_m: length(from.x_m, to.x_m),
        y_m: length(from.y_m, to.y_m),
        z_m: length(from.z_m, to.z_m),
        roll_rad: angle(from.roll_rad, to.roll_rad),
        pitch_rad: angle(from.pitch_rad, to.pitch_rad),
        yaw_rad: angle(from.yaw_rad, to.yaw_rad),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x_m: f64, yaw_rad: f64) -> Pose {
        Pose {
            x_m,
            yaw_rad,
            ..Pose::default()
        }
    }

    #[test]
    fn poses_lie_on_the_way_and_stop_at_its_beginning() {
        let mut trail = Trail {
            most_ms: 100,
            poses: VecDeque::new(),
        };
        for step in 0..50 {
            trail.note(10 * step, &at(0.1 * f64::from(step), 0.0));
        }
        assert!(trail.poses.len() <= 12, "{}", trail.poses.len());
        let now = (500, &at(5.0, 0.0));
        for (age_s, x_m) in [(0.0, 5.0), (0.005, 4.95), (0.03, 4.7), (0.1, 4.0)] {
            assert!((trail.pose(now, age_s).x_m - x_m).abs() < 1e-9, "{age_s}");
        }
        let young = Trail {
            most_ms: 100,
            poses: [(0, at(0.0, 3.1))].into(),
        };
        assert_eq!(young.pose((10, &at(1.0, -3.1)), 0.1).x_m, 0.0);
        let turned = young.pose((10, &at(1.0, -3.1)), 0.005).yaw_rad;
        assert!(turned.abs() > 3.13, "the short way round: {turned}");
    }

    #[test]
    fn without_a_lidar_that_turns_nothing_is_kept() {
        let mut trail = Trail::of(&[]);
        trail.note(10, &at(1.0, 0.0));
        assert!(trail.poses.is_empty());
        assert_eq!(trail.pose((20, &at(2.0, 0.0)), 0.0).x_m, 2.0);
    }
}
