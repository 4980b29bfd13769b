//! Drifting odometry from a log whose poses are corrected.
//!
//! The motion between two poses is an arc and a shift sideways. The arc gets the errors of
//! [`OdometryNoise::default`] with the variances of its random walk times k; the scale errors stay
//! as they are. Wheels do not measure the shift, which is mostly the laser's lever, so it is kept.
//!
//! Units: metres, radians.

use super::relations::{Pose, compose, inverse};
use crate::robot::{self, Odometry, OdometryModel, OdometryNoise, Velocity, wrap};

/// Returns the noise with the variances of the random walk times `k`.
#[must_use]
pub fn noise(k: f64) -> OdometryNoise {
    let usual = OdometryNoise::default();
    OdometryNoise {
        turn_by_turn: k * usual.turn_by_turn,
        turn_by_distance: k * usual.turn_by_distance,
        distance_by_distance: k * usual.distance_by_distance,
        distance_by_turn: k * usual.distance_by_turn,
        height_by_distance: 0.0,
        attitude_rad: 0.0,
        ..usual
    }
}

/// Returns odometry that drifts from these poses. It begins at the first one.
#[must_use]
pub fn drifting(poses: &[Pose], noise: OdometryNoise, seed: u64) -> Vec<Pose> {
    let model = OdometryModel::Noisy(noise);
    let mut odometry = Odometry::new(model, robot::Pose::default(), seed);
    let planar = |odometry: &Odometry| {
        let pose = odometry.pose();
        [pose.x_m, pose.y_m, pose.yaw_rad]
    };
    let mut drifted: Vec<Pose> = poses.first().copied().into_iter().collect();
    for pair in poses.windows(2) {
        let [x, y, yaw] = compose(inverse(pair[0]), pair[1]);
        let turn = wrap(yaw);
        let (sin, cos) = (0.5 * turn).sin_cos();
        let (chord, sideways) = (cos * x + sin * y, cos * y - sin * x);
        // An arc is longer than its chord.
        let stretch = if sin.abs() < 1e-9 {
            1.0
        } else {
            0.5 * turn / sin
        };
        let before = planar(&odometry);
        let still = robot::Pose::default();
        odometry.advance(&still, stretch * chord, turn, Velocity::default());
        let [dx, dy, dyaw] = compose(inverse(before), planar(&odometry));
        let moved = [dx - sin * sideways, dy + cos * sideways, dyaw];
        if let Some(last) = drifted.last() {
            drifted.push(compose(*last, moved));
        }
    }
    drifted
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path() -> Vec<Pose> {
        let step = |k: i32| {
            let t = 0.1 * f64::from(k);
            [t.cos() + 0.3 * t, t.sin(), wrap(2.0 * t + 0.4)]
        };
        (0..200).map(step).collect()
    }

    #[test]
    fn without_noise_the_poses_stay() {
        let none = OdometryNoise {
            distance_scale: 0.0,
            turn_scale: 0.0,
            ..noise(0.0)
        };
        for (drifted, pose) in drifting(&path(), none, 3).iter().zip(path()) {
            let [x, y, yaw] = compose(inverse(pose), *drifted);
            assert!(x.hypot(y) < 1e-9 && wrap(yaw).abs() < 1e-9, "{pose:?}");
        }
    }

    #[test]
    fn a_seed_repeats_and_more_noise_drifts_further() {
        let end = |k: f64, seed| drifting(&path(), noise(k), seed)[199];
        assert_eq!(end(1.0, 5), end(1.0, 5));
        assert_ne!(end(1.0, 5), end(1.0, 6));
        // Scale errors do not grow with k, and outweigh the walk in so many turns.
        let walk = |k: f64| OdometryNoise {
            distance_scale: 0.0,
            turn_scale: 0.0,
            ..noise(k)
        };
        let error = |k: f64| {
            let of = |seed| {
                let end = drifting(&path(), walk(k), seed)[199];
                let [x, y, _] = compose(inverse(path()[199]), end);
                x.hypot(y)
            };
            (0..40).map(of).sum::<f64>()
        };
        assert!(error(16.0) > 3.0 * error(1.0));
    }
}
