//! Operations on words of cells, one bit a cell.

/// Returns the positions of a word's set bits, lowest first.
pub(crate) fn ones(mut word: u32) -> impl Iterator<Item = u32> {
    core::iter::from_fn(move || {
        let position = (word != 0).then(|| word.trailing_zeros());
        word &= word.wrapping_sub(1);
        position
    })
}

/// Returns the number of set bits. The core has no instruction for it, so it is not inlined.
#[inline(never)]
pub(crate) const fn count(word: u32) -> u32 {
    word.count_ones()
}

/// Returns the positions of a 64-bit word's set bits, lowest first.
///
/// It is a function of its own because 64-bit words cost twice as much on a 32-bit core.
pub(crate) fn ones64(mut word: u64) -> impl Iterator<Item = u32> {
    core::iter::from_fn(move || {
        let position = (word != 0).then(|| word.trailing_zeros());
        word &= word.wrapping_sub(1);
        position
    })
}

/// Packs the even bits of a word: bit k of the result is bit 2 k.
pub(crate) const fn even(word: u32) -> u16 {
    let mut bits = word & 0x5555_5555;
    bits = (bits | bits >> 1) & 0x3333_3333;
    bits = (bits | bits >> 2) & 0x0f0f_0f0f;
    bits = (bits | bits >> 4) & 0x00ff_00ff;
    (bits | bits >> 8) as u16
}

/// Halves a word's resolution: bit k of the result is set if bit 2 k or 2 k + 1 is.
pub(crate) const fn halve(word: u32) -> u16 {
    even(word | word >> 1)
}

/// Doubles a word's resolution: bits 2 k and 2 k + 1 of the result are bit k.
pub(crate) const fn twice(bits: u16) -> u32 {
    let mut wide = bits as u32;
    wide = (wide | wide << 8) & 0x00ff_00ff;
    wide = (wide | wide << 4) & 0x0f0f_0f0f;
    wide = (wide | wide << 2) & 0x3333_3333;
    wide = (wide | wide << 1) & 0x5555_5555;
    wide | wide << 1
}

#[cfg(test)]
pub(crate) mod tests {
    use super::{even, halve, twice};

    /// A xorshift generator.
    pub(crate) struct Rng(pub(crate) u64);

    impl Rng {
        pub(crate) fn next(&mut self) -> u64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            self.0
        }

        /// Rows with about one in 2^`sparsity` cells set.
        pub(crate) fn rows<const N: usize>(&mut self, sparsity: u32) -> [u64; N] {
            core::array::from_fn(|_| (0..sparsity).fold(u64::MAX, |bits, _| bits & self.next()))
        }
    }

    pub(crate) fn get(rows: &[u64], x: i32, y: i32) -> bool {
        (0..64).contains(&x) && rows.get(y as usize).is_some_and(|row| row >> x & 1 == 1)
    }

    #[test]
    fn half_the_resolution_joins_two_cells_and_twice_gives_both() {
        let mut rng = Rng(5);
        for _ in 0..200 {
            let [word, _] = rng.rows(2);
            let word = word as u32;
            for k in 0..16 {
                let pair = word >> (2 * k) & 3;
                assert_eq!(even(word) >> k & 1 == 1, pair & 1 != 0, "column {k}");
                assert_eq!(halve(word) >> k & 1 == 1, pair != 0, "column {k}");
            }
            assert_eq!(halve(twice(word as u16)), word as u16);
            assert_eq!(even(twice(word as u16) >> 1), word as u16);
        }
    }
}
