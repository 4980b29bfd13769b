//! The rank-sum test of two unpaired samples \[Mann47\].
//!
//! ```text
//! U = Σ rank(a) - m (m + 1) / 2            m values of a, n of b, ranks in both together
//! p = 2 P(U as far from its mean m n / 2, or farther, on the same side)
//! ```
//!
//! Equal values share the mean of their ranks. If the samples are small, p is exact: the choices of
//! m of the m + n ranks are counted by their sum, with ties as they are. Ranks are doubled, so that
//! they are integers. Larger samples take the normal distribution with corrections for ties and
//! continuity.

use super::{doubled_ranks, normal_p, ties};

/// Most values of both samples together whose choices are counted: C(120, 60) is 1e35, and the
/// table of counts has 120 · 60 · 60 numbers.
const MOST_EXACT: usize = 120;

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankSum {
    /// Pairs of a value of each sample in which the first is larger; equal ones count a half.
    pub u: f64,
    /// Probability of a U as far from its mean, on either side, if all values were of one
    /// distribution.
    pub p: f64,
}

/// Tests if the values of `a` tend to be larger or smaller than those of `b`; `None` if one of them
/// is empty.
#[must_use]
pub fn rank_sum(a: &[f64], b: &[f64]) -> Option<RankSum> {
    let (m, n) = (a.len(), b.len());
    if m == 0 || n == 0 {
        return None;
    }
    let mut sorted: Vec<(f64, bool)> = a.iter().map(|value| (*value, true)).collect();
    sorted.extend(b.iter().map(|value| (*value, false)));
    sorted.sort_by(|x, y| x.0.total_cmp(&y.0));
    let values: Vec<f64> = sorted.iter().map(|(value, _)| *value).collect();
    let ranks = doubled_ranks(&values);
    let of_a = sorted.iter().zip(&ranks).filter(|((_, is_a), _)| *is_a);
    let sum: usize = of_a.map(|(_, rank)| rank).sum();
    let u = (sum - m * (m + 1)) as f64 / 2.0;
    let p = if m + n <= MOST_EXACT {
        exact_p(&ranks, m, sum)
    } else {
        approximate_p(u, [m, n], ties(&values))
    };
    Some(RankSum { u, p })
}

/// Returns twice the smaller tail of all choices of `m` doubled ranks.
fn exact_p(ranks: &[usize], m: usize, sum: usize) -> f64 {
    let most: usize = ranks.iter().rev().take(m).sum();
    // counts[k][s]: choices of k ranks with the sum s.
    let mut counts = vec![vec![0.0_f64; most + 1]; m + 1];
    counts[0][0] = 1.0;
    for &rank in ranks {
        for k in (1..=m).rev() {
            let (fewer, more) = counts.split_at_mut(k);
            let (fewer, more) = (&fewer[k - 1], &mut more[0]);
            for (more, fewer) in more.iter_mut().skip(rank).zip(fewer) {
                *more += fewer;
            }
        }
    }
    let counts = &counts[m];
    let all: f64 = counts.iter().sum();
    let less: f64 = counts[..=sum].iter().sum();
    let greater: f64 = counts[sum..].iter().sum();
    (2.0 * less.min(greater) / all).min(1.0)
}

fn approximate_p(u: f64, [m, n]: [usize; 2], ties: f64) -> f64 {
    let (m, n) = (m as f64, n as f64);
    let all = m + n;
    let variance = m * n / 12.0 * (all + 1.0 - ties / (all * (all - 1.0)));
    if variance <= 0.0 {
        return 1.0;
    }
    let far = ((u - m * n / 2.0).abs() - 0.5).max(0.0);
    normal_p(far / variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::rank_sum;

    fn numbers(n: u32, step: u32, modulus: u32) -> Vec<f64> {
        (1..=n).map(|k| f64::from(k * step % modulus)).collect()
    }

    #[track_caller]
    fn assert_test(a: &[f64], b: &[f64], u: f64, p: f64) {
        let test = rank_sum(a, b).unwrap();
        assert_eq!(test.u, u);
        assert!((test.p / p - 1.0).abs() < 1e-9, "{}", test.p);
    }

    /// Permeability of the human chorioamnion at term and at 12 to 26 weeks \[Hollander & Wolfe
    /// 1973, p. 69\]: the example of R's `wilcox.test`, W = 35; two-sided
    /// `scipy.stats.mannwhitneyu(a, b, method='exact')`.
    #[test]
    fn a_published_example_is_reproduced() {
        let at_term = [0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46];
        let early = [1.15, 0.88, 0.90, 0.74, 1.21];
        assert_test(&at_term, &early, 35.0, 0.254_412_254_412_254_4);
    }

    /// scipy 1.17: `mannwhitneyu(a, b, method='exact')` without ties, and with ties
    /// `permutation_test((a, b), lambda a, b: mannwhitneyu(a, b).statistic, vectorized=False,
    /// n_resamples=numpy.inf)`.
    #[test]
    fn exact_p_is_that_of_scipy() {
        assert_test(&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0], 0.0, 0.1);
        let b: Vec<f64> = numbers(9, 11, 103)
            .iter()
            .map(|it| it / 2.0 + 0.25)
            .collect();
        assert_test(&numbers(12, 7, 101), &b, 77.0, 0.111_053_652_230_122_84);
        let (a, b) = ([1.0, 2.0, 2.0, 3.0, 5.0], [2.0, 4.0, 5.0, 6.0, 7.0, 7.0]);
        assert_test(&a, &b, 4.5, 0.060_606_060_606_060_61);
    }

    /// scipy 1.17: `mannwhitneyu(a, b, method='asymptotic')`.
    #[test]
    fn the_normal_p_of_large_samples_is_that_of_scipy() {
        let (a, b) = (numbers(90, 37, 211), numbers(80, 53, 241));
        assert_test(&a, &b, 3108.5, 0.125_299_035_967_925_08);
        let (a, b) = (numbers(90, 7, 11), numbers(80, 5, 13));
        assert_test(&a, &b, 3019.0, 0.069_002_182_004_836_31);
    }

    #[test]
    fn samples_that_are_equal_or_empty_say_nothing() {
        assert_eq!(rank_sum(&[2.0; 4], &[2.0; 5]).unwrap().p, 1.0);
        assert_eq!(rank_sum(&[2.0; 90], &[2.0; 90]).unwrap().p, 1.0);
        assert_eq!(rank_sum(&[], &[1.0]), None);
    }
}
