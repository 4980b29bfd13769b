//! The report's part on uneven worlds: limits, steepness of the drive, and the map's classes
//! against the true ground.
//!
//! Degrees, metres, seconds; shares from 0 to 1, `null` if there is nothing to share.

use serde::{Deserialize, Serialize};

use crate::metrics::{MapScore, Ride, Score};

/// The true ground, and the drive over it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrueGround {
    /// Height of the start in the world. All other heights count from it.
    pub start_z_m: f64,
    /// Steepest pitch of the true robot, up or down.
    pub max_pitch_deg: f64,
    /// Steepest roll of the true robot, to either side.
    pub max_roll_deg: f64,
    /// Time for which the true robot stood beyond the working slopes.
    pub over_limits_s: f64,
    /// Limits within which the ground counts as reachable and traversable.
    pub working: Limits,
    /// Limits beyond which the robot is stopped, falls or tips over.
    pub failing: Limits,
    /// The map's classes against the true ground; `null` if the map could not be read, or its
    /// frame drifts.
    pub map_score: Option<ClassScores>,
}

/// Limits of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Slope along the heading.
    pub climb_deg: f64,
    /// Slope across the heading.
    pub roll_deg: f64,
    /// Edge up.
    pub step_m: f64,
    /// Edge down.
    pub drop_m: f64,
}

/// Scores of the map, class by class ([`crate::metrics::GroundTruth`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClassScores {
    /// Free cells.
    pub traversable: ClassScore,
    /// Obstacles.
    pub obstacle: ClassScore,
    /// Negative obstacles.
    pub negative: ClassScore,
    /// Cells that the map leaves unknown.
    pub unknown: ClassScore,
    /// Of the negative rims that the map blocks, the share that it classifies as negative.
    pub rims_classed_negative: Option<f64>,
    /// Confusion matrix in cells. Rows are true classes: traversable, obstacle, negative, either,
    /// unjudged. Columns are the map's: unknown, free, obstacle, negative.
    pub confusion: [[u32; 4]; 5],
}

/// Score of one class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClassScore {
    /// Of the map's cells of the class, the share that is right.
    pub precision: Option<f64>,
    /// Of the true cells of the class, the share that the map has.
    pub recall: Option<f64>,
}

impl From<&crate::robot::Limits> for Limits {
    fn from(limits: &crate::robot::Limits) -> Self {
        Self {
            climb_deg: degrees(limits.climb_rad),
            roll_deg: degrees(limits.roll_rad),
            step_m: limits.step_m,
            drop_m: limits.drop_m,
        }
    }
}

impl From<Score> for ClassScore {
    fn from(Score { precision, recall }: Score) -> Self {
        Self { precision, recall }
    }
}

impl From<&MapScore> for ClassScores {
    fn from(table: &MapScore) -> Self {
        Self {
            traversable: table.traversable.into(),
            obstacle: table.obstacle.into(),
            negative: table.negative.into(),
            unknown: table.unknown.into(),
            rims_classed_negative: table.negative_by_name,
            confusion: table.cells,
        }
    }
}

impl TrueGround {
    /// Sets the steepness of the drive.
    #[must_use]
    pub fn with_ride(self, ride: &Ride) -> Self {
        Self {
            max_pitch_deg: degrees(ride.max_pitch_rad),
            max_roll_deg: degrees(ride.max_roll_rad),
            // The sum of whole milliseconds has rounding errors.
            over_limits_s: (ride.over_limits_s * 1000.0).round() / 1000.0,
            ..self
        }
    }
}

/// Converts to degrees, rounded to a millionth, so that 20° is shown as 20.
pub(crate) fn degrees(rad: f64) -> f64 {
    (rad.to_degrees() * 1e6).round() / 1e6
}
