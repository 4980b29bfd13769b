//! Random choices of a drawing, from the simulator's own seeded stream.

use crate::robot::{Noise, Source};
use crate::world::canvas::Canvas;

/// A seeded source of choices.
#[derive(Clone, Debug)]
pub(super) struct Dice(Noise);

impl Dice {
    /// The choices of a world's seed.
    pub(super) fn new(seed: u64) -> Self {
        Self(Noise::new(seed, Source::Drawing))
    }

    /// A number from `low` up to and without `high`.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// A length from `low` to `high`, a whole number of cells.
    pub(super) fn metres(&mut self, low: f64, high: f64) -> f64 {
        let [low, high] = [low, high].map(|m| (m / Canvas::RESOLUTION_M).round());
        (low + (self.0.uniform() * (high - low + 1.0)).floor()) * Canvas::RESOLUTION_M
    }

    /// An index less than `count`; 0 if `count` is 0.
    pub(super) fn index(&mut self, count: usize) -> usize {
        (self.0.uniform() * count as f64) as usize
    }

    /// True with the given probability.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.0.uniform() < probability
    }

    /// Cosine and sine of an angle from −`most_rad` to `most_rad`.
    pub(super) fn turn(&mut self, most_rad: f64) -> [f64; 2] {
        let angle_rad = self.between(-most_rad, most_rad);
        [libm::cos(angle_rad), libm::sin(angle_rad)]
    }

    /// Puts items into a random order.
    pub(super) fn shuffle<T>(&mut self, items: &mut [T]) {
        for k in (1..items.len()).rev() {
            let other = self.index(k + 1);
            items.swap(k, other);
        }
    }
}
