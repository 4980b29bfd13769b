//! Runs of set bits in a row of the window: the solver loops over runs, without a test per cell.

use core::ops::Range;

/// Iterator over the runs of set bits in a word, from the lowest, as ranges of bit positions.
#[derive(Clone, Debug)]
pub(super) struct Runs(pub(super) u64);

impl Iterator for Runs {
    type Item = Range<usize>;

    #[inline]
    fn next(&mut self) -> Option<Range<usize>> {
        if self.0 == 0 {
            return None;
        }
        let first = self.0.trailing_zeros() as usize;
        let length = (!(self.0 >> first)).trailing_zeros() as usize;
        // Adding the lowest bit carries through the lowest run and out of it.
        self.0 &= self.0.wrapping_add(self.0 & self.0.wrapping_neg());
        Some(first..first + length)
    }
}

#[cfg(test)]
mod tests {
    use super::Runs;
    use std::vec::Vec;

    #[test]
    fn runs_of_a_word() {
        let runs = |bits| {
            Runs(bits)
                .map(|run| (run.start, run.end))
                .collect::<Vec<_>>()
        };
        assert_eq!(runs(0), []);
        assert_eq!(runs(0b0111_0010), [(1, 2), (4, 7)]);
        assert_eq!(runs((1 << 61) - 1), [(0, 61)]);
        assert_eq!(runs(1 | 1 << 60), [(0, 1), (60, 61)]);
        assert_eq!(runs(u64::MAX), [(0, 64)]);
    }
}
