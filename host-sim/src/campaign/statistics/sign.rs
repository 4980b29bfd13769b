//! The sign test: of the pairs that differ, half should be larger.

use statrs::distribution::{Binomial, DiscreteCDF as _};

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signs {
    /// Pairs with a positive difference.
    pub positive: usize,
    /// Pairs with a negative difference.
    pub negative: usize,
    /// Probability of signs as uneven as these or more, if each were a coin toss; 1 if no pair
    /// differs.
    pub p: f64,
}

/// Tests these differences. Pairs that are equal are left out.
#[must_use]
pub fn sign_test(differences: &[f64]) -> Signs {
    let count = |is: fn(&&f64) -> bool| differences.iter().filter(is).count();
    let (positive, negative) = (count(|d| **d > 0.0), count(|d| **d < 0.0));
    let tosses = Binomial::new(0.5, (positive + negative) as u64);
    // A half is a probability, so there is always a distribution.
    let tail = tosses.map_or(0.5, |tosses| tosses.cdf(positive.min(negative) as u64));
    Signs {
        positive,
        negative,
        p: (2.0 * tail).min(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::sign_test;

    /// scipy 1.17: `scipy.stats.binomtest(k, n, 0.5).pvalue`.
    #[test]
    fn p_is_that_of_scipy() {
        for (positive, negative, p) in [
            (9, 1, 0.021_484_375),
            (7, 3, 0.34375),
            (0, 6, 0.03125),
            (5, 5, 1.0),
            (35, 15, 0.006_600_447_966_810_918),
            (300, 200, 8.940_066_542_253_288e-6),
        ] {
            let mut differences = vec![2.5; positive];
            differences.resize(positive + negative, -1.0);
            differences.push(0.0);
            let signs = sign_test(&differences);
            assert_eq!((signs.positive, signs.negative), (positive, negative));
            assert!(
                (signs.p / p - 1.0).abs() < 1e-9,
                "{positive}, {negative}: {}",
                signs.p
            );
        }
    }

    #[test]
    fn equal_pairs_say_nothing() {
        assert_eq!(sign_test(&[0.0, 0.0]).p, 1.0);
        assert_eq!(sign_test(&[]).p, 1.0);
    }
}
