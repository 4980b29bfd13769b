//! What the robot believes of its own motion.
//!
//! *Truth* is the exact pose. *Noisy* integrates its own pose from increments that err in two ways: a scale error
//! of distance and of turn, drawn once a run (tyre pressure, the slip of this floor), and a random walk,
//!
//! ```text
//! turn′    = turn    (1 + s_turn)    + N(0, α₁|turn| + α₂|distance|)
//! distance′ = distance (1 + s_distance) + N(0, α₃|distance| + α₄|turn|)
//! ```
//!
//! Departs from [Thrun05, table 5.6], whose variances grow with the squares: those depend on how often one samples,
//! while these add up to the same over the same path however it is cut.
//!
//! Wheels count what they turn, not what they slip. The way is tilted by the pitch, which an inertial unit averages over a
//! period: `z′ −= distance′ sin(pitch)`, seen from above `distance′ cos(pitch)`; and z takes a random walk of its own. What the unit
//! says of roll and pitch at one instant has white noise.
//!
//! The frame starts at the robot's start pose in the world, so that truth and world coincide. Metres, radians. On the level the
//! heights are nothing but that walk.
//!
//! [Thrun05]: S. Thrun, W. Burgard, D. Fox, "Probabilistic Robotics", 2005.

use super::noise::{Noise, Source};
use super::pose::{Pose, Velocity};

/// How odometry errs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryNoise {
    /// α₁: variance of the turn per turn, rad²/rad. Default: 4.4e-4 (3° a full turn).
    pub turn_by_turn: f64,
    /// α₂: variance of the turn per distance, rad²/m. Default: 1.2e-4 (2° over 10 m).
    pub turn_by_distance: f64,
    /// α₃: variance of the distance per distance, m²/m. Default: 2.5e-4 (5 cm over 10 m).
    pub distance_by_distance: f64,
    /// α₄: variance of the distance per turn, m²/rad. Default: 1.4e-4 (3 cm a full turn).
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

/// Which odometry a robot has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum OdometryModel {
    /// The exact pose.
    #[default]
    Truth,
    /// The exact position and heading; roll and pitch with white noise of this standard deviation, radians.
    Tilting(f64),
    /// Wheel encoders and an inertial unit.
    Noisy(OdometryNoise),
}

/// The odometry's state.
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
    /// Begins at the true start pose.
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

    /// Where the robot believes to be.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// How fast it believes to go.
    #[must_use]
    pub fn velocity(&self) -> Velocity {
        self.velocity
    }

    /// Takes in the motion of one period: the true pose now, the way the wheels went and turned, the true velocity.
    pub fn advance(&mut self, truth: &Pose, forward_m: f64, turn_rad: f64, velocity: Velocity) {
        self.velocity = velocity;
        match self.model {
            OdometryModel::Truth => self.pose = *truth,
            OdometryModel::Tilting(sigma_rad) => {
                self.pose = *truth;
                self.feel(truth, sigma_rad);
            }
            OdometryModel::Noisy(noise) => {
                self.reckon(&noise, truth, forward_m, turn_rad);
                self.feel(truth, noise.attitude_rad);
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

    /// What the inertial unit says of the attitude.
    fn feel(&mut self, truth: &Pose, sigma_rad: f64) {
        self.pose.roll_rad = truth.roll_rad + sigma_rad * self.inertial.normal();
        self.pose.pitch_rad = truth.pitch_rad + sigma_rad * self.inertial.normal();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of the believed pose after `periods` steps that each go `forward_m` and turn `turn_rad`.
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
    fn spread_is_the_stated_one_however_the_way_is_cut() {
        let walk = OdometryNoise {
            distance_scale: 0.0,
            turn_scale: 0.0,
            ..OdometryNoise::default()
        };
        // 10 m straight: 2° of heading and 5 cm of distance; 15 % is four standard errors of 400 runs.
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
    fn a_slope_is_reckoned_as_way_and_height() {
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
    fn a_level_way_of_ten_metres_drifts_by_three_centimetres_in_height() {
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
    fn tilting_is_the_truth_but_for_the_attitude() {
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
