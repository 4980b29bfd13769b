//! The robot's own estimate of its motion.
//!
//! *Truth* is the exact pose. *Noisy* integrates its own pose from increments with two errors: a
//! scale error of distance and of turn, drawn once per run (tyre pressure, the slip of this
//! floor), and a random walk,
//!
//! ```text
//! turn′    = turn    (1 + s_turn)    + N(0, α₁|turn| + α₂|distance|)
//! distance′ = distance (1 + s_distance) + N(0, α₃|distance| + α₄|turn|)
//! ```
//!
//! Departs from [Thrun05, table 5.6]: there the variances grow with the squares, so they depend on
//! the sampling rate. Here they are linear, so the sum over a path does not depend on how the path
//! is cut.
//!
//! Wheels count their turning, not their slip. The distance is tilted by the pitch, which an
//! inertial unit averages over a period: `z′ −= distance′ sin(pitch)`, and `distance′ cos(pitch)`
//! seen from above. z has a random walk of its own. The unit's roll and pitch at one instant have
//! white noise.
//!
//! The frame starts at the robot's start pose in the world, so truth and world coincide. On level
//! ground the height is only that random walk. Metres, radians.
//!
//! [Thrun05]: S. Thrun, W. Burgard, D. Fox, "Probabilistic Robotics", 2005.

use super::noise::{Noise, Source};
use super::pose::{Pose, Velocity};

/// Errors of the odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryNoise {
    /// α₁: variance of the turn per turn, rad²/rad. Default: 4.4e-4 (3° per full turn).
    pub turn_by_turn: f64,
    /// α₂: variance of the turn per distance, rad²/m. Default: 1.2e-4 (2° over 10 m).
    pub turn_by_distance: f64,
    /// α₃: variance of the distance per distance, m²/m. Default: 2.5e-4 (5 cm over 10 m).
    pub distance_by_distance: f64,
    /// α₄: variance of the distance per turn, m²/rad. Default: 1.4e-4 (3 cm per full turn).
    pub distance_by_turn: f64,
    /// α₅: variance of the height per distance, m²/m. Default: 1e-4 (3 cm over 10 m).
    pub height_by_distance: f64,
    /// Standard deviation of the scale error of distances. Default: 0.01.
    pub distance_scale: f64,
    /// Standard deviation of the scale error of turns. Default: 0.02.
    pub turn_scale: f64,
    /// Standard deviation of roll and pitch, radians. Default: 0.5°.
    pub attitude_rad: f64,
}

impl Default for OdometryNoise {
    fn default() -> Self {
        Self {
            turn_by_turn: 4.4e-4,
            turn_by_distance: 1.2e-4,
            distance_by_distance: 2.5e-4,
            distance_by_turn: 1.4e-4,
            height_by_distance: 1e-4,
            distance_scale: 0.01,
            turn_scale: 0.02,
            attitude_rad: 0.5_f64.to_radians(),
        }
    }
}

impl OdometryNoise {
    /// Noise as the papers' groups assume it for their filters: the variances of the random walk
    /// are 20 times the default's.
    #[must_use]
    pub fn papers() -> Self {
        Self::default().times(20.0)
    }

    /// Returns the noise with the variances of its random walk in the plane times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            turn_by_turn: factor * self.turn_by_turn,
            turn_by_distance: factor * self.turn_by_distance,
            distance_by_distance: factor * self.distance_by_distance,
            distance_by_turn: factor * self.distance_by_turn,
            ..self
        }
    }

    /// Noise of `MobileSim`, the simulator of the papers' group: scale errors of 0.75 %, no random
    /// walk in the plane.
    #[must_use]
    pub fn mobilesim() -> Self {
        Self {
            turn_by_turn: 0.0,
            turn_by_distance: 0.0,
            distance_by_distance: 0.0,
            distance_by_turn: 0.0,
            distance_scale: 0.0075,
            turn_scale: 0.0075,
            ..Self::default()
        }
    }
}

/// The model of a robot's odometry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum OdometryModel {
    /// The exact pose.
    #[default]
    Truth,
    /// The exact position and heading; roll and pitch have white noise of this standard deviation,
    /// radians.
    Tilting(f64),
    /// Wheel encoders and an inertial unit.
    Noisy(OdometryNoise),
}

/// State of the odometry.
#[derive(Clone, Debug)]
pub struct Odometry {
    model: OdometryModel,
    pose: Pose,
    velocity: Velocity,
    scale: [f64; 2],
    walk: Noise,
    climb: Noise,
    inertial: Noise,
}

impl Odometry {
    /// Starts at the true start pose.
    #[must_use]
    pub fn new(model: OdometryModel, start: Pose, seed: u64) -> Self {
        let mut scale = Noise::new(seed, Source::OdometryScale);
        let scale = match model {
            OdometryModel::Truth | OdometryModel::Tilting(_) => [0.0; 2],
            OdometryModel::Noisy(noise) => [
                noise.distance_scale * scale.normal(),
                noise.turn_scale * scale.normal(),
            ],
        };
        Self {
            model,
            pose: start,
            velocity: Velocity::default(),
            scale,
            walk: Noise::new(seed, Source::OdometryWalk),
            climb: Noise::new(seed, Source::OdometryClimb),
            inertial: Noise::new(seed, Source::Inertial),
        }
    }

    /// The estimated pose.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The estimated velocity.
    #[must_use]
    pub fn velocity(&self) -> Velocity {
        self.velocity
    }

    /// Adds the motion of one period: the true pose at its end, the distance and turn of the
    /// wheels, and the true velocity.
    pub fn advance(&mut self, truth: &Pose, forward_m: f64, turn_rad: f64, velocity: Velocity) {
        self.velocity = velocity;
        match self.model {
            OdometryModel::Truth => self.pose = *truth,
            OdometryModel::Tilting(sigma_rad) => {
                self.pose = *truth;
                self.sense_attitude(truth, sigma_rad);
            }
            OdometryModel::Noisy(noise) => {
                self.reckon(&noise, truth, forward_m, turn_rad);
                self.sense_attitude(truth, noise.attitude_rad);
            }
        }
    }

    /// Dead reckoning.
    fn reckon(&mut self, noise: &OdometryNoise, truth: &Pose, forward_m: f64, turn_rad: f64) {
        let (distance, turn) = (forward_m.abs(), turn_rad.abs());
        let turn_variance = noise.turn_by_turn * turn + noise.turn_by_distance * distance;
        let distance_variance =
            noise.distance_by_distance * distance + noise.distance_by_turn * turn;
        let turn_error = self.scale[1] * turn_rad + turn_variance.sqrt() * self.walk.normal();
        let distance_error =
            self.scale[0] * forward_m + distance_variance.sqrt() * self.walk.normal();
        let height_error = (noise.height_by_distance * distance).sqrt() * self.climb.normal();
        let way_m = forward_m + distance_error;
        let height_m = self.pose.z_m - way_m * libm::sin(truth.pitch_rad) + height_error;
        self.pose = self
            .pose
            .moved(way_m * libm::cos(truth.pitch_rad), turn_rad + turn_error);
        self.pose.z_m = height_m;
    }

    /// Takes roll and pitch from the inertial unit.
    fn sense_attitude(&mut self, truth: &Pose, sigma_rad: f64) {
        self.pose.roll_rad = truth.roll_rad + sigma_rad * self.inertial.normal();
        self.pose.pitch_rad = truth.pitch_rad + sigma_rad * self.inertial.normal();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of the estimated pose after `periods` steps, each of `forward_m` and `turn_rad`.
    fn errors(noise: OdometryNoise, periods: u32, forward_m: f64, turn_rad: f64) -> Vec<[f64; 2]> {
        (0..400)
            .map(|seed| {
                let mut truth = Pose::default();
                let mut odometry = Odometry::new(OdometryModel::Noisy(noise), truth, seed);
                for _ in 0..periods {
                    truth = truth.moved(forward_m, turn_rad);
                    odometry.advance(&truth, forward_m, turn_rad, Velocity::default());
                }
                let believed = odometry.pose();
                let yaw = super::super::pose::wrap(believed.yaw_rad - truth.yaw_rad);
                [believed.x_m - truth.x_m, yaw]
            })
            .collect()
    }

    fn deviation(errors: &[[f64; 2]], which: usize) -> f64 {
        (errors.iter().map(|e| e[which] * e[which]).sum::<f64>() / errors.len() as f64).sqrt()
    }

    #[test]
    fn truth_is_exact() {
        let mut odometry = Odometry::new(OdometryModel::Truth, Pose::default(), 1);
        let truth = Pose::default().moved(1.3, 0.4);
        odometry.advance(&truth, 1.3, 0.4, Velocity::default());
        assert_eq!(*odometry.pose(), truth);
    }

    #[test]
    fn the_spread_is_as_stated_however_the_path_is_cut() {
        let walk = OdometryNoise {
            distance_scale: 0.0,
            turn_scale: 0.0,
            ..OdometryNoise::default()
        };
        // 10 m straight: 2° of heading and 5 cm of distance; 15 % is four standard errors of 400
        // runs.
        for (periods, forward_m) in [(100, 0.1), (20, 0.5)] {
            let errors = errors(walk, periods, forward_m, 0.0);
            let heading = deviation(&errors, 1).to_degrees();
            assert!((heading - 1.98).abs() < 0.3, "{heading}");
            assert!((deviation(&errors, 0) - 0.05).abs() < 0.0075);
        }
        // One full turn on the spot: 3°.
        let heading = deviation(&errors(walk, 50, 0.0, core::f64::consts::TAU / 50.0), 1);
        assert!((heading.to_degrees() - 3.01).abs() < 0.45, "{heading}");
    }

    #[test]
    fn on_a_slope_the_distance_splits_into_plan_and_height() {
        let exact = OdometryNoise {
            turn_by_turn: 0.0,
            turn_by_distance: 0.0,
            distance_by_distance: 0.0,
            distance_by_turn: 0.0,
            height_by_distance: 0.0,
            distance_scale: 0.0,
            turn_scale: 0.0,
            attitude_rad: 0.0,
        };
        let nose_up = Pose {
            pitch_rad: -0.2,
            ..Pose::default()
        };
        let mut odometry = Odometry::new(OdometryModel::Noisy(exact), nose_up, 1);
        for _ in 0..10 {
            odometry.advance(&nose_up, 0.1, 0.0, Velocity::default());
        }
        assert!((odometry.pose().x_m - 0.2_f64.cos()).abs() < 1e-12);
        assert!((odometry.pose().z_m - 0.2_f64.sin()).abs() < 1e-12);
        assert_eq!(odometry.pose().pitch_rad, -0.2);
    }

    #[test]
    fn over_ten_level_metres_the_height_drifts_by_3_cm() {
        let heights: Vec<[f64; 2]> = (0..400)
            .map(|seed| {
                let noise = OdometryNoise::default();
                let level = Pose::default();
                let mut odometry = Odometry::new(OdometryModel::Noisy(noise), level, seed);
                for _ in 0..100 {
                    odometry.advance(&level, 0.1, 0.0, Velocity::default());
                }
                [odometry.pose().z_m, 0.0]
            })
            .collect();
        let drift = deviation(&heights, 0);
        assert!((drift - 0.0316).abs() < 0.005, "{drift}");
    }

    #[test]
    fn tilting_is_the_truth_except_for_roll_and_pitch() {
        let sigma = 0.02;
        let mut odometry = Odometry::new(OdometryModel::Tilting(sigma), Pose::default(), 3);
        let truth = Pose {
            roll_rad: 0.1,
            pitch_rad: -0.2,
            ..Pose::default().moved(1.3, 0.4)
        };
        let errors: Vec<[f64; 2]> = (0..2000)
            .map(|_| {
                odometry.advance(&truth, 0.0, 0.0, Velocity::default());
                let believed = *odometry.pose();
                let level = Pose {
                    roll_rad: 0.1,
                    pitch_rad: -0.2,
                    ..believed
                };
                assert_eq!(level, truth);
                [believed.roll_rad - 0.1, believed.pitch_rad + 0.2]
            })
            .collect();
        assert!((deviation(&errors, 0) - sigma).abs() < 0.0013);
        assert!((deviation(&errors, 1) - sigma).abs() < 0.0013);
    }

    #[test]
    fn scale_errors_last_for_the_whole_run() {
        let scale = OdometryNoise {
            turn_by_turn: 0.0,
            turn_by_distance: 0.0,
            distance_by_distance: 0.0,
            distance_by_turn: 0.0,
            ..OdometryNoise::default()
        };
        let (short, long) = (errors(scale, 10, 0.1, 0.0), errors(scale, 100, 0.1, 0.0));
        for (short, long) in short.iter().zip(&long) {
            assert!((10.0 * short[0] - long[0]).abs() < 1e-9);
        }
        assert!((deviation(&long, 0) - 0.1).abs() < 0.015);
    }
}
