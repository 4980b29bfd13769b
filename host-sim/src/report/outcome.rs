//! How a run ended, and what was asked of it: its end, drives by order, requests of viewers.

use serde::{Deserialize, Serialize};

/// End of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// `finished`, `fault`, `lost`, `time-limit`, `frozen` or `interrupted`.
    pub status: String,
    /// Kind of finish or fault. Only `explored` and `covered` are successes.
    pub reason: String,
    /// What the device lost when it rebooted: `map`, `pose`, `strategy`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lost: Vec<String>,
    /// Frontiers left at the end.
    pub residual_frontiers: Vec<ResidualFrontier>,
}

/// A frontier left at the end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualFrontier {
    /// Centre of one of its cells, odometry frame.
    pub x_m: f64,
    /// Centre of one of its cells.
    pub y_m: f64,
    /// Number of its cells.
    pub cells: u32,
    /// `unreachable`, `unobservable`, `out-of-bounds`, `no-progress` or `not-worth-it`.
    pub reason: String,
}

/// A drive by order after the exploration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trip {
    /// `home` or `goal`.
    pub to: String,
    /// The place, odometry frame.
    pub to_m: [f64; 2],
    /// True if the device said that the robot arrived.
    pub reached: bool,
    /// The device's reason if it refused the order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// Distance from the place at the end, by the pose that the device took for the true one.
    pub error_m: f64,
    /// Difference from the first heading at the end, by that pose; the key is missing for a goal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_deg: Option<f64>,
    /// Distance of the true robot from the place at the end.
    pub true_error_m: f64,
    /// Where the robot stood at the end, by its own pose.
    pub stands_m: [f64; 2],
    /// Simulated seconds of the drive.
    pub time_s: f64,
}

/// A request of a viewer, and what became of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LiveRequest {
    /// Simulated time, seconds.
    pub time_s: f64,
    /// `pause`, `resume`, `stop`, `home`, `explore` or `go to X,Y`.
    pub request: String,
    /// The status that the device answered, or why it refused.
    pub answer: String,
    /// True if it was done.
    pub done: bool,
}
