//! Parameters of `explore_lite`; the defaults are those of its launch file.

/// The parameters; defaults as in the package's `explore.launch`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Cost per metre of path.
    pub potential_scale: f32,
    /// Cost saved per metre of frontier.
    pub gain_scale: f32,
    /// Least size of a frontier, metres; smaller ones are ignored.
    pub min_frontier_size_m: f32,
    /// Time between two choices of a goal, milliseconds.
    pub planner_period_ms: u32,
    /// Time without progress after which a goal is blacklisted, milliseconds.
    pub progress_timeout_ms: u32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            potential_scale: 3.0,
            gain_scale: 1.0,
            min_frontier_size_m: 0.75,
            planner_period_ms: 3_030,
            progress_timeout_ms: 30_000,
        }
    }
}
