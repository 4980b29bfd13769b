//! Seeded randomness: one independent stream for every source of noise, and for drawings.
//!
//! Every source draws from its own `ChaCha8` stream, so a change to one source does not shift the
//! others. Every sample takes a fixed number of draws, so a change of a standard deviation does
//! not shift them either. Only sums, products, square roots and `libm` are used: the same seed
//! gives the same bits on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Sources of random numbers; the discriminant is the number of the stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Source {
    /// Ranges of the level laser.
    LevelRange = 1,
    /// Lost and false returns of the level laser.
    LevelFault = 2,
    /// Ranges of the tilted laser.
    TiltedRange = 3,
    /// Lost and false returns of the tilted laser.
    TiltedFault = 4,
    /// The odometry's scale errors, drawn once per run.
    OdometryScale = 5,
    /// The odometry's random walk.
    OdometryWalk = 6,
    /// Roll and pitch of the inertial unit.
    Inertial = 7,
    /// The odometry's random walk in height.
    OdometryClimb = 8,
    /// The drawing of a generated world, under the world's own seed.
    Drawing = 9,
    /// Losses and delays of the radio between robots.
    Radio = 10,
    /// Missing beams of both lasers.
    Missing = 11,
    /// Places, goals and speeds of people.
    People = 12,
    /// Errors of the starts that a team's robots are told.
    Start = 13,
    /// Draws of a particle filter: a stream for each particle, and one for their choice.
    Particle = 14,
}

/// One stream.
#[derive(Clone, Debug)]
pub struct Noise {
    rng: ChaCha8Rng,
    spare: Option<f64>,
}

impl Noise {
    /// The stream of a source under a seed.
    #[must_use]
    pub fn new(seed: u64, source: Source) -> Self {
        Self::numbered(seed, source, 0)
    }

    /// One of many streams of a source under a seed, by its number below 2⁵⁶.
    #[must_use]
    pub fn numbered(seed: u64, source: Source, number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(source as u64 | number << 8);
        Self { rng, spare: None }
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        // 53 bits: every double in [0, 1) that is a multiple of 2⁻⁵³.
        (self.rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal with mean 0 and standard deviation 1, by Box and Muller's transform.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        let angle = core::f64::consts::TAU * self.uniform();
        self.spare = Some(radius * libm::sin(angle));
        radius * libm::cos(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_has_its_moments() {
        let mut noise = Noise::new(3, Source::LevelRange);
        let count = 200_000;
        let samples: Vec<f64> = (0..count).map(|_| noise.normal()).collect();
        let mean = samples.iter().sum::<f64>() / f64::from(count);
        let variance = samples.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / f64::from(count);
        // One standard deviation holds 68.27 % of the samples; the bounds are five standard errors.
        let within = samples.iter().filter(|s| s.abs() < 1.0).count() as f64 / f64::from(count);
        assert!(mean.abs() < 0.0112, "{mean}");
        assert!((variance - 1.0).abs() < 0.0159, "{variance}");
        assert!((within - 0.6827).abs() < 0.0053, "{within}");
    }

    #[test]
    fn streams_repeat_and_differ() {
        let draw = |seed, source| {
            let mut noise = Noise::new(seed, source);
            [0; 4].map(|_| noise.uniform().to_bits())
        };
        let first = draw(1, Source::LevelRange);
        assert_eq!(first, draw(1, Source::LevelRange));
        assert_ne!(first, draw(2, Source::LevelRange));
        assert_ne!(first, draw(1, Source::TiltedRange));
        let numbered = |number| Noise::numbered(1, Source::LevelRange, number).uniform();
        assert_eq!(numbered(0).to_bits(), first[0]);
        assert_ne!(numbered(1).to_bits(), first[0]);
    }
}
