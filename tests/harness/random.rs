//! Seeded numbers that are the same on every machine: xorshift64* (Vigna 2016).
//!
//! Vigna 2016: S. Vigna, "An experimental exploration of Marsaglia's xorshift generators,
//! scrambled", ACM TOMS 42(4), 2016.

/// Odd number near 2⁶⁴ divided by the golden ratio: it spreads neighbouring seeds.
const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;

/// A seeded source.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Starts a stream from a seed; every seed is allowed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self((seed ^ SPREAD).max(1))
    }

    /// Starts a stream whose first numbers differ also between neighbouring seeds. The windows of
    /// [`crate::field`] are drawn so.
    #[must_use]
    pub fn mixed(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(SPREAD) | 1);
        for _ in 0..8 {
            random.word();
        }
        random
    }

    /// Returns 64 random bits.
    pub fn word(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Returns 48 random bits: the upper ones of a word, which are the better ones.
    pub fn bits(&mut self) -> u64 {
        self.word() >> 16
    }

    /// Returns a number less than `bound`, or 0 if `bound` is 0.
    pub fn below(&mut self, bound: u64) -> u64 {
        self.bits() % bound.max(1)
    }

    /// Returns an index less than `bound`, or 0 if `bound` is 0.
    pub fn index(&mut self, bound: usize) -> usize {
        self.below(bound as u64) as usize
    }

    /// Returns true once in `times`.
    pub fn once_in(&mut self, times: u64) -> bool {
        self.below(times) == 0
    }

    /// Returns true with the given probability, per cent.
    pub fn percent(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }

    /// Returns a number from `low` to `high`, both included.
    pub fn between(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as u64) as i64
    }

    /// Returns a number from [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a number from `low` up to and without `high`.
    pub fn within(&mut self, low: i32, high: i32) -> i32 {
        low + (self.unit() * f64::from(high - low)) as i32
    }

    /// Returns true with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Returns an angle from [0, 2π), radians.
    pub fn angle(&mut self) -> f64 {
        self.unit() * core::f64::consts::TAU
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    #[test]
    fn the_same_seed_gives_the_same_numbers_within_their_bounds() {
        let draw = |seed| {
            let mut random = Random::new(seed);
            (0..100).map(|_| random.between(-3, 3)).collect::<Vec<_>>()
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        for number in -3..=3 {
            assert!(draw(1).contains(&number));
        }
        assert!(draw(1).iter().all(|number| (-3..=3).contains(number)));
    }
}
