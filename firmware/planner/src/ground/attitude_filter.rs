//! The attitude filter: smooths pitch and roll, and limits how far from the robot heights are
//! measured.
//!
//! ```text
//! j      ← j + (|g − 2 g' + g''| − j) / n    n = min(steps so far, noise_steps)
//! sigma  = j / SECOND_DIFFERENCE_RATIO       standard deviation of g
//! ĝ      ← ĝ + attitude_gain (g − ĝ)         while |g − ĝ| < motion_sigmas sigma, else ĝ ← g
//! reach  = max_height_sigma_m / (smoothed_ratio sigma)
//! ```
//!
//! Here g, g' and g'' are the slopes of the robot's plane in the world, now and one and two steps
//! ago. A turn on the spot does not change g, and smooth motion adds nothing to j.
//!
//! An error of the attitude tilts a whole sweep. An error of 1° lifts the ground 3 m to the side by
//! 5 cm, and two sweeps that meet there make a false edge. A mean over many sweeps would remove the
//! edge, but a robot in motion has only one or two sweeps over a cell. Therefore the attitude is
//! smoothed, and no height is measured beyond the reach; the robot measures again from nearer.
//! Below `exact_sigma` the attitude is used unchanged and the reach is infinite.
//!
//! Departs from \[Maffei20, III-B\]: the paper measures attitude without error.
//!
//! Units: slopes are tangents; metres, radians.

use crate::config::GroundTuning;
use crate::geometry::Pose;
use crate::ground::ray::Attitude;
use crate::math;

/// Mean of |g − 2 g' + g''| over the standard deviation of g: √6 √(2/π), for normal noise.
const SECOND_DIFFERENCE_RATIO: f32 = 1.954;

/// The filter of the attitude.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AttitudeFilter {
    /// The filtered slope along x and y, tangents.
    slope: [f32; 2],
    /// The slopes one and two steps ago, tangents.
    last: [[f32; 2]; 2],
    /// Mean magnitude of the second difference, a tangent.
    noise: f32,
    steps: u8,
}

impl AttitudeFilter {
    /// Creates the filter as it is before the first step.
    pub(crate) const fn new() -> Self {
        Self {
            slope: [0.0; 2],
            last: [[0.0; 2]; 2],
            noise: 0.0,
            steps: 0,
        }
    }

    /// Takes the pose of this step and returns it with the filtered pitch and roll.
    pub(crate) fn update(&mut self, pose: &Pose, tuning: &GroundTuning) -> Pose {
        let attitude = Attitude::of(pose);
        let slope = [attitude.rise(1.0, 0.0), attitude.rise(0.0, 1.0)];
        self.estimate_noise(slope, tuning.noise_steps);
        let sigma = self.sigma();
        let off = [slope[0] - self.slope[0], slope[1] - self.slope[1]];
        let is_motion = off
            .iter()
            .any(|off| off.abs() > tuning.motion_sigmas * sigma);
        let gain = if self.is_exact(tuning) || is_motion {
            1.0
        } else {
            tuning.attitude_gain
        };
        for (filtered, off) in self.slope.iter_mut().zip(off) {
            *filtered += gain * off;
        }
        if gain < 1.0 {
            self.with_filtered_slope(pose)
        } else {
            *pose
        }
    }

    /// Returns true if the attitude has no noise worth filtering.
    pub(crate) fn is_exact(&self, tuning: &GroundTuning) -> bool {
        self.sigma() < tuning.exact_sigma
    }

    /// Returns the distance from the robot within which heights are measured, metres.
    pub(super) fn reach_m(&self, tuning: &GroundTuning) -> f32 {
        if self.is_exact(tuning) {
            f32::INFINITY
        } else {
            tuning.max_height_sigma_m / (tuning.smoothed_ratio * self.sigma())
        }
    }

    /// Returns the difference of two heights that errors of the attitude alone explain, metres: two
    /// standard deviations of the difference at the reach.
    pub(super) fn slack_m(&self, tuning: &GroundTuning) -> f32 {
        if self.is_exact(tuning) {
            0.0
        } else {
            2.0 * core::f32::consts::SQRT_2 * tuning.max_height_sigma_m
        }
    }

    /// Returns the standard deviation of one slope, a tangent.
    fn sigma(&self) -> f32 {
        self.noise / SECOND_DIFFERENCE_RATIO
    }

    fn estimate_noise(&mut self, slope: [f32; 2], max_steps: u8) {
        let [one, two] = self.last;
        self.last = [slope, one];
        self.steps = self
            .steps
            .saturating_add(1)
            .min(max_steps.saturating_add(2));
        // The first two steps have no second difference.
        let Some(count) = self.steps.checked_sub(2).filter(|&count| count > 0) else {
            return;
        };
        let second = |now: f32, one: f32, two: f32| (now - 2.0 * one + two).abs();
        let mean = 0.5 * (second(slope[0], one[0], two[0]) + second(slope[1], one[1], two[1]));
        self.noise += (mean - self.noise) / f32::from(count);
    }

    /// Returns the pose with the pitch and the roll of the filtered slope.
    fn with_filtered_slope(&self, pose: &Pose) -> Pose {
        let (sin, cos) = math::sin_cos(pose.yaw_rad);
        let [x, y] = self.slope;
        let (ahead, left) = (x * cos + y * sin, y * cos - x * sin);
        let pitch_rad = -math::atan2(ahead, 1.0);
        let (_, cos_pitch) = math::sin_cos(pitch_rad);
        Pose {
            pitch_rad,
            roll_rad: math::atan2(left * cos_pitch, 1.0),
            ..*pose
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::AttitudeFilter;
    use crate::config::GroundTuning;
    use crate::geometry::Pose;
    use crate::ground::ray::Attitude;

    const TUNING: GroundTuning = GroundTuning::DEFAULT;

    /// Returns a number that is about normal: the sum of twelve uniform numbers of variance 1/12.
    pub(in crate::ground) fn normal(seed: &mut u64) -> f32 {
        let mut sum = -6.0;
        for _ in 0..12 {
            *seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (*seed >> 40) as f32 / (1_u32 << 24) as f32;
        }
        sum
    }

    /// The pose of a robot that drives in circles on a slope of 0.25 which rises to the north-east.
    fn on_a_slope(step: u16) -> Pose {
        let yaw_rad = crate::math::wrap(0.04 * f32::from(step));
        let (sin, cos) = (yaw_rad.sin(), yaw_rad.cos());
        let (x, y) = (0.2_f32, 0.15);
        let pitch_rad = -(x * cos + y * sin).atan();
        Pose {
            yaw_rad,
            pitch_rad,
            roll_rad: ((y * cos - x * sin) * pitch_rad.cos()).atan(),
            ..Pose::default()
        }
    }

    fn noisy(truth: Pose, sigma_rad: f32, seed: &mut u64) -> Pose {
        Pose {
            roll_rad: truth.roll_rad + sigma_rad * normal(seed),
            pitch_rad: truth.pitch_rad + sigma_rad * normal(seed),
            ..truth
        }
    }

    #[test]
    fn without_noise_the_attitude_is_used_bit_for_bit() {
        let mut filter = AttitudeFilter::new();
        for step in 0..500 {
            let pose = on_a_slope(step);
            assert_eq!(filter.update(&pose, &TUNING), pose);
            assert_eq!(filter.reach_m(&TUNING), f32::INFINITY);
        }
    }

    #[test]
    fn noise_is_estimated_and_its_variance_halved() {
        let sigma = 1.0_f32.to_radians();
        let (mut filter, mut seed) = (AttitudeFilter::new(), 5);
        let (mut before, mut after, mut count) = (0.0, 0.0, 0.0);
        for step in 0..2_000 {
            let truth = on_a_slope(step);
            let pose = noisy(truth, sigma, &mut seed);
            let filtered = filter.update(&pose, &TUNING);
            if step > 100 {
                // The error 3 m to the robot's left.
                let rise = |pose: &Pose| {
                    let left = (-pose.yaw_rad.sin() * 3.0, pose.yaw_rad.cos() * 3.0);
                    Attitude::of(pose).rise(left.0, left.1)
                };
                before += (rise(&pose) - rise(&truth)).powi(2);
                after += (rise(&filtered) - rise(&truth)).powi(2);
                count += 1.0;
                let ratio = filter.reach_m(&TUNING)
                    / (TUNING.max_height_sigma_m / (TUNING.smoothed_ratio * sigma));
                assert!((0.7..1.3).contains(&ratio), "{ratio}");
            }
        }
        let (before, after): (f32, f32) = (before / count, after / count);
        assert!(before.sqrt() > 0.05, "{before}");
        assert!(after < 0.5 * before, "{after} of {before}");
    }

    /// The sweeps with the largest errors decide how many false edges the map has.
    #[test]
    fn the_largest_error_of_many_attitudes_is_filtered_too() {
        let sigma = 1.0_f32.to_radians();
        let (mut filter, mut seed) = (AttitudeFilter::new(), 11);
        let mut worst = 0.0_f32;
        for step in 0..5_000 {
            let filtered = filter.update(&noisy(Pose::default(), sigma, &mut seed), &TUNING);
            if step > 100 {
                worst = worst.max(filtered.roll_rad.abs().max(filtered.pitch_rad.abs()));
            }
        }
        // The largest of 10,000 normal numbers is about 3.9 standard deviations.
        assert!(
            worst < 4.5 * TUNING.smoothed_ratio * sigma,
            "{}",
            worst.to_degrees()
        );
    }

    #[test]
    fn the_jump_of_a_kerb_passes_unfiltered() {
        let sigma = 0.5_f32.to_radians();
        let (mut filter, mut seed) = (AttitudeFilter::new(), 9);
        for _ in 0..200 {
            filter.update(&noisy(Pose::default(), sigma, &mut seed), &TUNING);
        }
        let up = Pose {
            pitch_rad: -0.15,
            ..Pose::default()
        };
        assert_eq!(filter.update(&up, &TUNING), up);
        assert!(
            filter.reach_m(&TUNING)
                < TUNING.max_height_sigma_m / (TUNING.smoothed_ratio * TUNING.exact_sigma)
        );
    }
}
