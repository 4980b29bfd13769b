//! What planning cost, and how good its fields were.
//!
//! The p-th percentile of n samples is the ⌈p·n⌉-th smallest (nearest rank).

use serde::{Deserialize, Serialize};

/// Cost of planning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Planner {
    /// Time from sending an observation to the command, on this host, microseconds.
    pub round_trip_us: Option<Percentiles>,
    /// Instructions of a step on the device; `null` if it does not count them.
    pub instructions: Option<Percentiles>,
    /// Instructions of each stage. The maxima of two stages may come from different steps.
    pub stage_instructions: Option<Stages>,
    /// Cycles of a step on the chip, by the model; `null` if nothing models them.
    #[serde(default)]
    pub cycles: Option<Percentiles>,
    /// The same in milliseconds at the clock of the chip.
    #[serde(default)]
    pub ms: Option<Percentiles>,
    /// Cycles of each stage, by the model.
    #[serde(default)]
    pub stage_cycles: Option<Stages>,
    /// Deepest stack of the device; `null` if it does not measure it.
    pub stack_bytes: Option<u32>,
}

/// Instructions or cycles of a step's stages. The maxima of two stages may come from different
/// steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stages {
    /// Decodes the request; encodes the reply to the request before it.
    pub session: Percentiles,
    /// Enters scans and odometry into the map.
    pub sense: Percentiles,
    /// Thins one share of the skeleton.
    pub topology: Percentiles,
    /// Runs the wavefront over a new skeleton, and searches the path.
    pub plan: Percentiles,
    /// Sets the window's cells and boundary.
    pub window: Percentiles,
    /// Solves the window's field.
    pub solve: Percentiles,
    /// Descends the field, drives, and searches for a recovery.
    pub drive: Percentiles,
}

impl Stages {
    /// Returns the percentiles of each stage over the steps, of which `parts` returns the stages;
    /// `None` without steps.
    #[must_use]
    pub fn over<T>(steps: &[T], parts: fn(&T) -> [u32; 7]) -> Option<Self> {
        let stage = |i: usize| {
            let of: Vec<f64> = steps.iter().map(|step| f64::from(parts(step)[i])).collect();
            Percentiles::of(&of)
        };
        Some(Self {
            session: stage(0)?,
            sense: stage(1)?,
            topology: stage(2)?,
            plan: stage(3)?,
            window: stage(4)?,
            solve: stage(5)?,
            drive: stage(6)?,
        })
    }

    /// Returns the stages with their names, in the order of a step.
    #[must_use]
    pub const fn by_name(&self) -> [(&'static str, Percentiles); 7] {
        [
            ("session", self.session),
            ("sense", self.sense),
            ("topology", self.topology),
            ("plan", self.plan),
            ("window", self.window),
            ("solve", self.solve),
            ("drive", self.drive),
        ]
    }
}

/// Nearest-rank percentiles over the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Half of the steps are at or below it.
    pub p50: f64,
    /// 99 of 100 steps are at or below it.
    pub p99: f64,
    /// The greatest.
    pub max: f64,
}

/// Quality of the windows' solutions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// Angle between a step's heading and that of the converged window; `null` without
    /// `--check-field`.
    pub heading_error_deg: Option<Percentiles>,
    /// Windows that `--check-field` compared.
    pub checked_windows: u64,
    /// Steps in which the solver's budget ended before it converged.
    pub budget_exhausted_steps: u64,
}

/// Cross-checks of the simulator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Debug {
    /// True if the map read over the link equals the host's copy, cell for cell; `null` if either
    /// is missing.
    pub map_matches_mirror: Option<bool>,
}

impl Percentiles {
    /// Returns the percentiles of `samples`, which may be in any order; `None` if there are none.
    ///
    /// Nearest rank: the p-th percentile of n samples is the ⌈p·n⌉-th smallest.
    #[must_use]
    pub fn of(samples: &[f64]) -> Option<Self> {
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rank = |per_cent: usize| (sorted.len() * per_cent).div_ceil(100).saturating_sub(1);
        Some(Self {
            p50: *sorted.get(rank(50))?,
            p99: *sorted.get(rank(99))?,
            max: *sorted.last()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Percentiles;

    #[test]
    fn percentiles_are_nearest_rank() {
        let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let p = Percentiles::of(&hundred).unwrap();
        assert_eq!((p.p50, p.p99, p.max), (50.0, 99.0, 100.0));
        let one = Percentiles::of(&[7.0]).unwrap();
        assert_eq!((one.p50, one.p99, one.max), (7.0, 7.0, 7.0));
        assert_eq!(Percentiles::of(&[]), None);
    }
}
