//! The report's part on the pose that the planner took for the true one.
//!
//! Metres; shares from 0 to 1.

use fieldline_protocol::message::Quality;
use serde::{Deserialize, Serialize};

/// The pose that the planner took for the true one: the device's, or odometry's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Localization {
    /// True if the device corrected odometry.
    pub corrected: bool,
    /// Mean distance to the true position over the steps.
    pub mean_error_m: Option<f64>,
    /// Greatest distance over the steps.
    pub max_error_m: Option<f64>,
    /// Distance in the last step.
    pub end_error_m: Option<f64>,
    /// Share of the steps of each quality; `null` if the device corrects nothing.
    pub quality: Option<QualityShares>,
}

/// Share of the steps of each quality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct QualityShares {
    /// The scan held the pose.
    pub tracking: f64,
    /// Odometry alone held it in some direction.
    pub degenerate: f64,
    /// The scan contradicted the map.
    pub lost: f64,
}

impl QualityShares {
    /// Returns the shares of these steps; all 0 if there are none.
    #[must_use]
    pub fn of(qualities: &[Quality]) -> Self {
        let share = |of: fn(&Quality) -> bool| {
            let count = qualities.iter().filter(|quality| of(quality)).count();
            count as f64 / qualities.len().max(1) as f64
        };
        Self {
            tracking: share(|it| *it == Quality::Tracking),
            degenerate: share(|it| matches!(it, Quality::Degenerate { .. })),
            lost: share(|it| *it == Quality::Lost),
        }
    }
}
