//! AttitudeFilter: the attitude as it is filtered, and how far a beam may be trusted with it.
//!
//! ```text
//! g      slope of the robot's plane in the world: turning on the spot does not change it
//! j      ← j + (|g − 2 g' + g''| − j) / n,    n = min(steps so far, MAX_STEPS)      g', g'': one and two steps ago
//! sigma  = j / (√6 √(2/π))              what noise from step to step gives; motion does not, it is smooth
//! ĝ      ← ĝ + GAIN (g − ĝ)             while |g − ĝ| < MOTION sigma, else ĝ ← g
//! reach  = ERROR_M / (√(GAIN / (2 − GAIN)) sigma)
//! ```
//!
//! An error of the attitude tilts a whole sweep: of 1° it lifts the ground 3 m to the side by 5 cm, and two sweeps that meet there make an
//! edge that is none. A mean over many sweeps would cure that, but a robot that drives on has one or two over a cell. So the attitude is
//! smoothed, and no height is measured farther off than errors of it stay small; the robot looks again from nearer. Below `EXACT_SIGMA` the
//! attitude is taken as it comes: an inertial unit without noise changes nothing. Not in [Maffei20], which measures attitude without
//! error. Units: tangents, metres, radians.

use crate::geometry::Pose;
use crate::ground::ray::Attitude;
use crate::math;

/// Share of the difference that a step makes up for.
const GAIN: f32 = 0.5;
/// Standard deviation of a smoothed slope over that of a single one, √(GAIN / (2 − GAIN)).
const SMOOTHED: f32 = 0.577;
/// Mean of |g − 2 g' + g''| over the standard deviation of g, √6 √(2/π).
const MEAN_SECOND: f32 = 1.954;
/// RiseLimits in the mean at the most.
const MAX_STEPS: u8 = 100;
/// Deviation below which there is none: 0.15°.
const EXACT_SIGMA: f32 = 0.0026;
/// What the attitude may lift the end of a beam by, metres.
const ERROR_M: f32 = 0.03;
/// Two deviations of a difference of two heights that each err by [`ERROR_M`], metres.
const SLACK_M: f32 = 2.0 * core::f32::consts::SQRT_2 * ERROR_M;
/// A difference of more deviations of a single slope than this is motion. That is 4.3 of the difference's own, √(1 + SMOOTHED²): at three, one
/// step in fifty would be taken for motion, and these steps, filtered as they come, would be just those that err most.
const MOTION: f32 = 5.0;

/// The filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudeFilter {
    /// The filtered slope, along x and y.
    slope: [f32; 2],
    /// The slopes one and two steps ago.
    last: [[f32; 2]; 2],
    /// Mean second difference.
    noise: f32,
    steps: u8,
}

impl AttitudeFilter {
    /// Before the first step.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            slope: [0.0; 2],
            last: [[0.0; 2]; 2],
            noise: 0.0,
            steps: 0,
        }
    }

    /// The attitude of this step; the pose as it is filtered.
    pub fn update(&mut self, pose: &Pose) -> Pose {
        let attitude = Attitude::of(pose);
        let slope = [attitude.rise(1.0, 0.0), attitude.rise(0.0, 1.0)];
        self.estimate_noise(slope);
        let sigma = self.sigma();
        let off = [slope[0] - self.slope[0], slope[1] - self.slope[1]];
        let is_motion = off.iter().any(|off| off.abs() > MOTION * sigma);
        let gain = if sigma < EXACT_SIGMA || is_motion {
            1.0
        } else {
            GAIN
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

    /// Whether the attitude is as good as without noise.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.sigma() < EXACT_SIGMA
    }

    /// How far from the robot a height may be measured, metres.
    #[must_use]
    pub fn reach_m(&self) -> f32 {
        if self.is_exact() {
            f32::INFINITY
        } else {
            ERROR_M / (SMOOTHED * self.sigma())
        }
    }

    /// What two heights may differ by for the attitude alone, metres: two deviations, at the reach.
    #[must_use]
    pub fn slack_m(&self) -> f32 {
        if self.is_exact() { 0.0 } else { SLACK_M }
    }

    /// Standard deviation of a single slope.
    fn sigma(&self) -> f32 {
        self.noise / MEAN_SECOND
    }

    fn estimate_noise(&mut self, slope: [f32; 2]) {
        let [one, two] = self.last;
        self.last = [slope, one];
        self.steps = self.steps.saturating_add(1).min(MAX_STEPS + 2);
        // The first two steps have no second difference.
        let Some(count) = self.steps.checked_sub(2).filter(|&count| count > 0) else {
            return;
        };
        let second = |k: usize| match (slope.get(k), one.get(k), two.get(k)) {
            (Some(now), Some(one), Some(two)) => (now - 2.0 * one + two).abs(),
            _ => 0.0,
        };
        let mean = 0.5 * (second(0) + second(1));
        self.noise += (mean - self.noise) / f32::from(count);
    }

    /// The pose with the filtered slope.
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
    use super::{AttitudeFilter, ERROR_M, EXACT_SIGMA, SMOOTHED};
    use crate::geometry::Pose;
    use crate::ground::ray::Attitude;

    /// Twelve uniform numbers of variance 1/12 each: about normal.
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

    /// A robot that goes round in circles on a slope of 0.25 that rises to the north-east.
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
    fn without_noise_the_attitude_is_taken_bit_by_bit() {
        let mut filter = AttitudeFilter::new();
        for step in 0..500 {
            let pose = on_a_slope(step);
            assert_eq!(filter.update(&pose), pose);
            assert_eq!(filter.reach_m(), f32::INFINITY);
        }
    }

    #[test]
    fn noise_is_estimated_and_half_of_its_variance_goes() {
        let sigma = 1.0_f32.to_radians();
        let (mut filter, mut seed) = (AttitudeFilter::new(), 5);
        let (mut before, mut after, mut count) = (0.0, 0.0, 0.0);
        for step in 0..2_000 {
            let truth = on_a_slope(step);
            let pose = noisy(truth, sigma, &mut seed);
            let filtered = filter.update(&pose);
            if step > 100 {
                // The error 3 m to the robot's left.
                let rise = |pose: &Pose| {
                    let left = (-pose.yaw_rad.sin() * 3.0, pose.yaw_rad.cos() * 3.0);
                    Attitude::of(pose).rise(left.0, left.1)
                };
                before += (rise(&pose) - rise(&truth)).powi(2);
                after += (rise(&filtered) - rise(&truth)).powi(2);
                count += 1.0;
                let ratio = filter.reach_m() / (ERROR_M / (SMOOTHED * sigma));
                assert!((0.7..1.3).contains(&ratio), "{ratio}");
            }
        }
        let (before, after): (f32, f32) = (before / count, after / count);
        assert!(before.sqrt() > 0.05, "{before}");
        assert!(after < 0.5 * before, "{after} of {before}");
    }

    /// The sweeps that err most decide how many edges the map has that are none.
    #[test]
    fn the_worst_of_many_attitudes_is_not_believed() {
        let sigma = 1.0_f32.to_radians();
        let (mut filter, mut seed) = (AttitudeFilter::new(), 11);
        let mut worst = 0.0_f32;
        for step in 0..5_000 {
            let filtered = filter.update(&noisy(Pose::default(), sigma, &mut seed));
            if step > 100 {
                worst = worst.max(filtered.roll_rad.abs().max(filtered.pitch_rad.abs()));
            }
        }
        // Of 10,000 numbers that are normal the largest is of about 3.9 deviations.
        assert!(worst < 4.5 * SMOOTHED * sigma, "{}", worst.to_degrees());
    }

    #[test]
    fn a_kerb_is_followed_at_once() {
        let sigma = 0.5_f32.to_radians();
        let (mut filter, mut seed) = (AttitudeFilter::new(), 9);
        for _ in 0..200 {
            filter.update(&noisy(Pose::default(), sigma, &mut seed));
        }
        let up = Pose {
            pitch_rad: -0.15,
            ..Pose::default()
        };
        assert_eq!(filter.update(&up), up);
        assert!(filter.reach_m() < ERROR_M / (SMOOTHED * EXACT_SIGMA));
    }
}
