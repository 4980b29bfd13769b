//! The signed-rank test of paired measurements \[Wilcoxon45\].
//!
//! ```text
//! W+ = Σ rank(|d_k|) over d_k > 0
//! p  = P(W+ as large, or larger)      if every sign were a coin toss
//! ```
//!
//! Pairs that are equal are left out, and equal differences share the mean of their ranks. Up to
//! 50 pairs all 2^n tosses are counted, by sums of ranks. Ranks are doubled, so that they are
//! integers. More pairs take the normal distribution with corrections for ties and continuity.

use statrs::distribution::{ContinuousCDF as _, Normal};

use super::{doubled_ranks, ties};

/// Most pairs whose tosses are counted exactly: counts are held in an f64.
const MOST_EXACT: usize = 50;

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedRank {
    /// Pairs that differ.
    pub pairs: usize,
    /// Sum of the ranks of positive differences.
    pub positive: f64,
    /// Probability of a sum as large or larger, if the signs were tossed.
    pub p_greater: f64,
    /// Probability of a sum as small or smaller.
    pub p_less: f64,
}

impl SignedRank {
    /// Returns the two-sided p.
    #[must_use]
    pub fn p(&self) -> f64 {
        (2.0 * self.p_greater.min(self.p_less)).min(1.0)
    }
}

/// Tests these differences.
#[must_use]
pub fn signed_rank(differences: &[f64]) -> SignedRank {
    let mut sorted: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0).collect();
    sorted.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let sizes: Vec<f64> = sorted.iter().map(|d| d.abs()).collect();
    let doubled = doubled_ranks(&sizes);
    let signed = sorted.iter().zip(&doubled);
    let positive: usize = signed
        .filter(|(d, _)| **d > 0.0)
        .map(|(_, rank)| rank)
        .sum();
    let [p_greater, p_less] = if sorted.len() <= MOST_EXACT {
        exact_p(&doubled, positive)
    } else {
        approximate_p(positive as f64 / 2.0, sorted.len(), ties(&sizes))
    };
    SignedRank {
        pairs: sorted.len(),
        positive: positive as f64 / 2.0,
        p_greater,
        p_less,
    }
}

/// Returns both tails of all tosses.
fn exact_p(doubled: &[usize], positive: usize) -> [f64; 2] {
    let counts = counts(doubled);
    let all: f64 = counts.iter().sum();
    let greater: f64 = counts[positive..].iter().sum();
    let less: f64 = counts[..=positive].iter().sum();
    [greater / all, less / all]
}

fn approximate_p(positive: f64, pairs: usize, ties: f64) -> [f64; 2] {
    let n = pairs as f64;
    let mean = n * (n + 1.0) / 4.0;
    let deviation = (n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - ties / 48.0).sqrt();
    let tail = |below: f64| Normal::standard().cdf((below + 0.5) / deviation);
    [tail(mean - positive), tail(positive - mean)]
}

/// Counts, for each sum of doubled ranks, the tosses that give it.
fn counts(doubled: &[usize]) -> Vec<f64> {
    let most: usize = doubled.iter().sum();
    let mut counts = vec![0.0; most + 1];
    counts[0] = 1.0;
    for &rank in doubled {
        for sum in (rank..=most).rev() {
            counts[sum] += counts[sum - rank];
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::signed_rank;
    use crate::session::choices::{Choices as _, Seeded};

    /// Hamilton's depression scale of nine patients before and after a tranquillizer, hundredths
    /// [Hollander & Wolfe 1973, table 3.1]: published W+ = 40 and one-sided p = 0.0195.
    #[test]
    fn a_published_example_is_reproduced() {
        let before = [183.0, 50.0, 162.0, 248.0, 168.0, 188.0, 155.0, 306.0, 130.0];
        let after = [87.8, 64.7, 59.8, 205.0, 106.0, 129.0, 106.0, 314.0, 129.0];
        let differences: Vec<f64> = before.iter().zip(after).map(|(a, b)| a - b).collect();
        let test = signed_rank(&differences);
        assert_eq!((test.pairs, test.positive), (9, 40.0));
        assert_eq!(test.p_greater, 10.0 / 512.0);
    }

    /// Two-sided 5 % points of the tables: n = 6, W = 0; n = 10, W = 8; n = 25, W = 89.
    #[test]
    fn critical_values_are_those_of_the_tables() {
        for (pairs, critical) in [(6, 0), (10, 8), (25, 89)] {
            let p_of = |positive: usize| {
                // The greedy sum of ranks makes every number up to n (n + 1) / 2.
                let mut rest = positive;
                let mut differences: Vec<f64> = (1..=pairs).map(|rank| -f64::from(rank)).collect();
                for difference in differences.iter_mut().rev() {
                    let rank = (-*difference) as usize;
                    if rank <= rest {
                        rest -= rank;
                        *difference = -*difference;
                    }
                }
                let test = signed_rank(&differences);
                assert_eq!(test.positive, positive as f64);
                2.0 * test.p_less
            };
            assert!(p_of(critical) <= 0.05, "{pairs}");
            assert!(p_of(critical + 1) > 0.05, "{pairs}");
        }
    }

    /// The oracle goes through all tosses, one by one.
    #[test]
    fn counts_are_those_of_all_tosses_with_ties_and_zeros() {
        let mut random = Seeded::new(3);
        for _ in 0..40 {
            let n = 1 + random.below(9);
            let differences: Vec<f64> = (0..n).map(|_| random.below(9) as f64 - 4.0).collect();
            let test = signed_rank(&differences);
            let sizes: Vec<f64> = differences
                .iter()
                .map(|d| d.abs())
                .filter(|d| *d > 0.0)
                .collect();
            let rank = |size: f64| {
                let below = sizes.iter().filter(|other| **other < size).count() as f64;
                let equal = sizes.iter().filter(|other| **other == size).count() as f64;
                below + (equal + 1.0) / 2.0
            };
            let tosses = 1_u32 << sizes.len();
            let sums = (0..tosses).map(|toss| {
                let heads = |k: &usize| toss >> k & 1 == 1;
                (0..sizes.len())
                    .filter(heads)
                    .map(|k| rank(sizes[k]))
                    .sum::<f64>()
            });
            let greater = sums.clone().filter(|sum| *sum >= test.positive).count();
            let less = sums.filter(|sum| *sum <= test.positive).count();
            assert_eq!(test.p_greater, greater as f64 / f64::from(tosses));
            assert_eq!(test.p_less, less as f64 / f64::from(tosses));
        }
    }

    #[test]
    fn equal_pairs_give_p_of_one() {
        let test = signed_rank(&[0.0, 0.0]);
        assert_eq!((test.pairs, test.p_greater, test.p_less), (0, 1.0, 1.0));
    }

    /// scipy 1.17: `wilcoxon(d, method='exact')` of eight differences, and `wilcoxon(d,
    /// method='asymptotic', correction=True, alternative=...)` of 70 with ties.
    #[test]
    fn p_is_that_of_scipy() {
        let test = signed_rank(&[1.5, -0.5, 2.5, 3.5, -4.0, 5.5, 6.5, 7.5]);
        assert_eq!((test.pairs, test.positive), (8, 30.0));
        assert_eq!(test.p(), 0.109375);
        let many: Vec<f64> = (1..=70).map(|k| f64::from(k * k * 7 % 101 - 45)).collect();
        let test = signed_rank(&many);
        assert_eq!((test.pairs, test.positive), (70, 1480.5));
        for (own, of_scipy) in [
            (test.p_greater, 0.082_257_135_526_991_82),
            (test.p_less, 0.918_627_835_662_558_1),
            (test.p(), 0.164_514_271_053_983_64),
        ] {
            assert!((own / of_scipy - 1.0).abs() < 1e-9, "{own} {of_scipy}");
        }
    }
}
