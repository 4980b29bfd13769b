//! How far the odometry is from the truth: mean and greatest planar error, metres, over all observations.

/// The error so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Localization {
    sum_m: f64,
    max_m: f64,
    count: u64,
}

impl Localization {
    /// Takes in one error, metres.
    pub fn add(&mut self, error_m: f64) {
        self.sum_m += error_m;
        self.max_m = self.max_m.max(error_m);
        self.count += 1;
    }

    /// Mean error, metres; 0 before the first.
    #[must_use]
    pub fn mean_error_m(&self) -> f64 {
        self.sum_m / self.count.max(1) as f64
    }

    /// Greatest error, metres.
    #[must_use]
    pub fn max_error_m(&self) -> f64 {
        self.max_m
    }
}
