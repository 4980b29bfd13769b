//! The parameters of `explore_lite`, with the values of its own launch file.

/// Parameters; the default is what the package starts with (`explore.launch`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Cost of a metre of way.
    pub potential_scale: f32,
    /// Cost saved by a metre of frontier.
    pub gain_scale: f32,
    /// Shorter frontiers are ignored, metres.
    pub min_frontier_size_m: f32,
    /// Time from one choice of a goal to the next, milliseconds.
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
