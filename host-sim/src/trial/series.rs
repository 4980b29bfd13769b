//! Moments of a run, evenly in simulated time. The length of the run is not known before its end.
//!
//! The first moment is taken at 0, then one every interval. With more than twice as many as wanted,
//! every other one is dropped and the interval doubles. Invariant: moment k was taken at the first
//! step at or after k times the interval. So with m moments after the start, the i-th of n is
//! number `round(i m / n)`. Milliseconds.

/// First interval, milliseconds.
const FIRST_MS: u32 = 2_000;

/// Moments of a run.
#[derive(Clone, Debug)]
pub struct Series<T> {
    wanted: usize,
    interval_ms: u32,
    taken: Vec<T>,
}

impl<T> Series<T> {
    /// Makes a series of `wanted` moments; 0 takes none.
    #[must_use]
    pub fn new(wanted: usize) -> Self {
        Self {
            wanted,
            interval_ms: FIRST_MS,
            taken: Vec::new(),
        }
    }

    /// Returns true if a moment is to be taken at this time.
    #[must_use]
    pub fn is_due(&self, time_ms: u32) -> bool {
        let due_ms = self.taken.len() as u64 * u64::from(self.interval_ms);
        self.wanted > 0 && u64::from(time_ms) >= due_ms
    }

    /// Takes a moment that is due.
    pub fn take(&mut self, moment: T) {
        self.taken.push(moment);
        if self.taken.len() > 2 * self.wanted {
            let mut index = 0;
            self.taken.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.interval_ms = self.interval_ms.saturating_mul(2);
        }
    }

    /// Returns the moments wanted, without the start; fewer if the run was too short.
    #[must_use]
    pub fn pick(self) -> Vec<T> {
        let last = self.taken.len().saturating_sub(1);
        let wanted = self.wanted.min(last);
        let mut picks = (1..=wanted).map(|i| (2 * i * last + wanted) / (2 * wanted));
        let mut next = picks.next();
        let mut picked = Vec::with_capacity(wanted);
        for (index, moment) in self.taken.into_iter().enumerate() {
            if Some(index) == next {
                picked.push(moment);
                next = picks.next();
            }
        }
        picked
    }
}

#[cfg(test)]
mod tests {
    use super::Series;

    /// Makes a run of `steps` steps of 100 ms; returns the times picked and the number of moments
    /// taken.
    fn picked(wanted: usize, steps: u32) -> (Vec<u32>, usize) {
        let (mut series, mut taken) = (Series::new(wanted), 0);
        for time_ms in (0..steps).map(|k| k * 100) {
            if series.is_due(time_ms) {
                series.take(time_ms);
                taken += 1;
            }
        }
        (series.pick(), taken)
    }

    #[test]
    fn long_runs_give_the_wanted_number_evenly() {
        for (wanted, steps) in [
            (1, 50),
            (4, 1_000),
            (5, 12_345),
            (12, 36_000),
            (100, 36_000),
        ] {
            let (times, taken) = picked(wanted, steps);
            assert_eq!(times.len(), wanted, "{wanted} of {steps}");
            let end_ms = f64::from(steps) * 100.0;
            for (i, time) in times.iter().enumerate() {
                let even_ms = end_ms * (i + 1) as f64 / wanted as f64;
                // At most one interval is missing at the end, and half of one by rounding.
                let interval_ms = end_ms / wanted as f64;
                assert!(
                    (f64::from(*time) - even_ms).abs() <= 1.5 * interval_ms,
                    "{times:?}"
                );
            }
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
            assert!(taken <= 2 * wanted + 1 + 12 * wanted, "{taken}");
        }
    }

    #[test]
    fn the_times_of_a_known_case() {
        // Taken at 0, 2, .., 16 s, then 20 and 24 s after dropping every other one.
        assert_eq!(picked(4, 251).0, [8_000, 12_000, 20_000, 24_000]);
    }

    #[test]
    fn short_runs_give_fewer() {
        assert_eq!(picked(10, 45).0, [2_000, 4_000]);
        assert_eq!(picked(10, 1).0, [0; 0]);
        assert_eq!(picked(0, 1_000), (Vec::new(), 0));
        assert!(Series::<()>::new(3).pick().is_empty());
    }
}
