//! Error of the odometry: mean and greatest planar distance from the truth over all observations,
//! metres.

/// The error so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Localization {
    sum_m: f64,
    max_m: f64,
    count: u64,
}

impl Localization {
    /// Adds one error, metres.
    pub fn add(&mut self, error_m: f64) {
        self.sum_m += error_m;
        self.max_m = self.max_m.max(error_m);
        self.count += 1;
    }

    /// Mean error, metres; 0 before the first observation.
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
