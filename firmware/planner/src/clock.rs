//! Time: a clock of milliseconds that wraps, and the one way to compare two of its readings.
//!
//! Units: milliseconds.

/// Returns the time from one reading of a clock to a later one; 0 if `then_ms` is not the earlier
/// one. Two readings are at most 2³¹ ms apart (24 days).
#[inline]
#[must_use]
pub(crate) const fn since(now_ms: u32, then_ms: u32) -> u32 {
    let elapsed_ms = now_ms.wrapping_sub(then_ms);
    if elapsed_ms < 1 << 31 { elapsed_ms } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::since;

    #[test]
    fn a_clock_that_wraps_goes_on_and_one_that_goes_back_stands() {
        assert_eq!(since(1_500, 1_000), 500);
        assert_eq!(since(499, u32::MAX - 500), 1_000);
        assert_eq!(since(1_000, 1_500), 0);
        assert_eq!(since(u32::MAX - 500, 499), 0);
        assert_eq!(since(7, 7), 0);
    }
}
