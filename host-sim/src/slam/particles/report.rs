//! What the particles told of a run, as in a report.

use core::fmt;

use serde::{Deserialize, Serialize};

/// What the particles told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParticleReport {
    /// The filter, as given to `--particles`.
    pub filter: String,
    /// PFErr: mean over the run of the particles' mean distance to the true place, metres.
    pub pf_error_m: f64,
    /// Mean over the run of the best particle's distance to the true place, metres.
    pub best_error_m: f64,
    /// Mean distance of the particles to the true place at the end, metres.
    pub end_error_m: f64,
    /// Share of the run in which the particles' mean distance is below 1 m.
    pub below_1m: f64,
    /// Known area of the best particle's map, in per cent of what a whole exploration at the true
    /// poses would know.
    pub area_percent: f64,
    /// Scans that the filter took.
    pub updates: u64,
    /// Times that it drew its particles anew.
    pub resampled: u64,
    /// Memory of all maps at the end, megabytes of 10⁶ bytes.
    pub maps_mb: f64,
}

impl fmt::Display for ParticleReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "wrong by {:.2} m on average, {:.2} m at the end, below 1 m for {:.0} %; area {:.1} %",
            self.pf_error_m,
            self.end_error_m,
            100.0 * self.below_1m,
            self.area_percent,
        )
    }
}
