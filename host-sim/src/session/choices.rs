//! Where a generator takes its numbers from: a seeded stream, or the bytes of a fuzzer.

/// A source of numbers.
pub trait Choices {
    /// Returns a number of this many bits, at most 64.
    fn bits(&mut self, bits: u32) -> u64;

    /// Returns a number less than `bound`, or 0 if `bound` is 0.
    fn below(&mut self, bound: u64) -> u64;

    /// Returns true if the source has no more numbers; from then on it gives zeros.
    fn is_over(&self) -> bool;

    /// Returns a number from `low` to `high`, both included.
    fn between(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as u64) as i64
    }

    /// Returns true once in `times`. A zero is false, so that a source that is over does nothing
    /// rare.
    fn once_in(&mut self, times: u64) -> bool {
        self.below(times) == times.saturating_sub(1)
    }

    /// Returns one of `of`, which has at least one item.
    fn pick<T: Copy>(&mut self, of: &[T]) -> T
    where
        Self: Sized,
    {
        of[self.below(of.len() as u64) as usize]
    }

    /// Returns a seeded stream for bulk data. It takes few bytes of a fuzzer's input.
    fn fork(&mut self) -> Seeded {
        Seeded::new(self.bits(16))
    }
}

/// Odd number near 2⁶⁴ divided by the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A seeded stream: the mix of 64 bits of G. Steele, D. Lea and C. Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014.
#[derive(Clone, Debug)]
pub struct Seeded(u64);

impl Seeded {
    /// Starts a stream; streams of neighbouring seeds differ.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(GOLDEN) ^ 0x5555)
    }

    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GOLDEN);
        let mut word = self.0;
        word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        word ^ (word >> 31)
    }
}

impl Choices for Seeded {
    fn bits(&mut self, bits: u32) -> u64 {
        self.word() >> (64 - bits.clamp(1, 64))
    }

    fn below(&mut self, bound: u64) -> u64 {
        self.word() % bound.max(1)
    }

    fn is_over(&self) -> bool {
        false
    }
}

/// The bytes of a fuzzer.
#[derive(Clone, Debug)]
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    /// Takes the numbers from `bytes`.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }
}

impl Choices for Bytes<'_> {
    fn bits(&mut self, bits: u32) -> u64 {
        let count = (bits.clamp(1, 64).div_ceil(8) as usize).min(self.0.len());
        let (now, later) = self.0.split_at(count);
        self.0 = later;
        let whole = now
            .iter()
            .rev()
            .fold(0, |number, byte| number << 8 | u64::from(*byte));
        whole & (u64::MAX >> (64 - bits.clamp(1, 64)))
    }

    /// Takes as few bytes as hold the bound.
    fn below(&mut self, bound: u64) -> u64 {
        if bound <= 1 {
            return 0;
        }
        let bits = 64 - (bound - 1).leading_zeros();
        self.bits(bits.next_multiple_of(8)) % bound
    }

    fn is_over(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::{Bytes, Choices, Seeded};

    #[test]
    fn the_same_seed_gives_the_same_numbers_within_their_bounds() {
        let draw = |seed| {
            let mut source = Seeded::new(seed);
            (0..100).map(|_| source.between(-3, 3)).collect::<Vec<_>>()
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        assert!((-3..=3).all(|number| draw(1).contains(&number)));
        assert!(draw(1).iter().all(|number| (-3..=3).contains(number)));
    }

    #[test]
    fn bytes_are_used_up_and_then_zero() {
        let mut source = Bytes::new(&[7, 0x34, 0x12, 9]);
        assert_eq!(source.below(5), 2);
        assert_eq!(source.bits(16), 0x1234);
        assert!(!source.is_over());
        assert_eq!(source.bits(64), 9);
        assert!(source.is_over());
        assert_eq!((source.bits(8), source.below(9)), (0, 0));
        assert!(!source.once_in(2));
    }
}
