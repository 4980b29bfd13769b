//! Means, quartiles, and tests without an assumption about distributions.
//!
//! | function | question |
//! | --- | --- |
//! | [`rank_sum`] | does one of two unpaired samples tend to be larger? \[Mann47\] |
//! | [`signed_rank`] | do paired differences lie around 0? \[Wilcoxon45\] |
//! | [`sign_test`] | are as many pairs larger as smaller? |
//!
//! Every p here is two-sided unless its name says otherwise: twice the smaller tail, at most 1.
//!
//! Mann47: H. Mann, D. Whitney, "On a test of whether one of two random variables is stochastically
//! larger than the other", Annals of Mathematical Statistics 18(1), 1947. Wilcoxon45: F. Wilcoxon,
//! "Individual comparisons by ranking methods", Biometrics Bulletin 1(6), 1945.

mod rank_sum;
mod sign;
mod signed_rank;

pub use rank_sum::{RankSum, rank_sum};
pub use sign::{Signs, sign_test};
pub use signed_rank::{SignedRank, signed_rank};

/// Numbers of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Number of values.
    pub n: usize,
    /// The mean.
    pub mean: f64,
    /// Standard deviation of the sample, by n - 1; `None` for one value.
    pub sd: Option<f64>,
    /// Least value, quartiles, greatest value.
    pub quartiles: [f64; 5],
}

impl Summary {
    /// Returns the numbers of a sample; `None` if it is empty.
    #[must_use]
    pub fn of(sample: &[f64]) -> Option<Self> {
        let n = sample.len();
        if n == 0 {
            return None;
        }
        let mean = sample.iter().sum::<f64>() / n as f64;
        let squares: f64 = sample.iter().map(|value| (value - mean).powi(2)).sum();
        Some(Self {
            n,
            mean,
            sd: (n > 1).then(|| (squares / (n - 1) as f64).sqrt()),
            quartiles: [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| quantile(sample, share)),
        })
    }
}

/// Returns a quantile of a sample that is not empty, by linear interpolation: definition 7 of
/// \[Hyndman96\]; 0 for an empty one.
///
/// Hyndman96: R. Hyndman, Y. Fan, "Sample quantiles in statistical packages", The American
/// Statistician 50(4), 1996.
#[must_use]
pub fn quantile(sample: &[f64], share: f64) -> f64 {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    let at = share.clamp(0.0, 1.0) * last as f64;
    let below = at.floor() as usize;
    let value = |index: usize| sorted.get(index.min(last)).copied().unwrap_or(0.0);
    value(below) + (at - at.floor()) * (value(below + 1) - value(below))
}

/// Returns twice the rank of every value of a sorted list; equal values share the mean rank.
fn doubled_ranks(sorted: &[f64]) -> Vec<usize> {
    let mut ranks = Vec::with_capacity(sorted.len());
    for equals in sorted.chunk_by(|a, b| a == b) {
        let first = ranks.len() + 1;
        let last = ranks.len() + equals.len();
        ranks.resize(last, first + last);
    }
    ranks
}

/// Returns the sum of t³ - t over the groups of t equal values of a sorted list.
fn ties(sorted: &[f64]) -> f64 {
    let groups = sorted.chunk_by(|a, b| a == b);
    groups
        .map(|group| (group.len() as f64).powi(3) - group.len() as f64)
        .sum()
}

/// Returns the two-sided p of a standard normal value.
fn normal_p(z: f64) -> f64 {
    use statrs::distribution::{ContinuousCDF as _, Normal};
    (2.0 * Normal::standard().sf(z.abs())).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::{Summary, quantile};

    /// numpy 2: `np.quantile([3, 1, 4, 1, 5, 9, 2, 6], [0, .25, .5, .75, 1])`, `np.mean`, and
    /// `np.std(ddof=1)`.
    #[test]
    fn the_summary_is_that_of_numpy() {
        let sample = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
        let summary = Summary::of(&sample).unwrap();
        assert_eq!((summary.n, summary.mean), (8, 3.875));
        assert_eq!(summary.quartiles, [1.0, 1.75, 3.5, 5.25, 9.0]);
        assert!((summary.sd.unwrap() - 2.748_376_143_938_713).abs() < 1e-12);
    }

    #[test]
    fn small_samples_have_what_they_have() {
        assert_eq!(Summary::of(&[]), None);
        let one = Summary::of(&[7.0]).unwrap();
        assert_eq!((one.mean, one.sd, one.quartiles), (7.0, None, [7.0; 5]));
        assert_eq!(quantile(&[], 0.5), 0.0);
    }
}
