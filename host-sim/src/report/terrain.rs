//! The report's part on uneven ground: limits, how steep the drive was, and the map's classes against the true ground.
//!
//! Degrees, metres, seconds; shares from 0 to 1, `null` where there was nothing to share.

use serde::{Deserialize, Serialize};

use crate::metrics::{MapScore, Ride, Score};

/// The ground, and how it was driven over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Terrain {
    /// Height of the start in the world; all other heights count from it.
    pub start_z_m: f64,
    /// Steepest pitch of the true robot, up or down.
    pub max_climb_deg: f64,
    /// Steepest roll of the true robot, to either side.
    pub max_side_deg: f64,
    /// Time that the true robot stood beyond the working slopes.
    pub over_limits_s: f64,
    /// Within these the ground counts as reachable and traversable.
    pub working: Limits,
    /// Beyond these the robot is stopped, falls or tips over.
    pub failing: Limits,
    /// The map's classes against the true ground; `null` where the map could not be read or its frame drifts.
    pub classes: Option<Classes>,
}

/// Limits of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Slope along the heading.
    pub climb_deg: f64,
    /// Slope across the heading.
    pub side_deg: f64,
    /// Edge up.
    pub step_m: f64,
    /// Edge down.
    pub drop_m: f64,
}

/// How the map compares, class by class ([`crate::metrics::GroundTruth`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Classes {
    /// Free cells.
    pub traversable: ClassScore,
    /// Obstacles.
    pub obstacle: ClassScore,
    /// Negative obstacles.
    pub negative: ClassScore,
    /// Cells that the map leaves unknown.
    pub unknown: ClassScore,
    /// Share of the found negative rims that the map calls negative.
    pub negative_by_name: Option<f64>,
    /// Cells by true class (rows: traversable, obstacle, negative, either, unjudged) and class of the map (columns: unknown,
    /// free, obstacle, negative).
    pub cells: [[u32; 4]; 5],
}

/// One class.
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
            side_deg: degrees(limits.side_rad),
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

impl From<&MapScore> for Classes {
    fn from(table: &MapScore) -> Self {
        Self {
            traversable: table.traversable.into(),
            obstacle: table.obstacle.into(),
            negative: table.negative.into(),
            unknown: table.unknown.into(),
            negative_by_name: table.negative_by_name,
            cells: table.cells,
        }
    }
}

impl Terrain {
    /// Takes over how steep the drive was.
    #[must_use]
    pub fn with_ride(self, ride: &Ride) -> Self {
        Self {
            max_climb_deg: degrees(ride.max_climb_rad),
            max_side_deg: degrees(ride.max_side_rad),
            // Whole milliseconds, summed up.
            over_limits_s: (ride.over_limits_s * 1000.0).round() / 1000.0,
            ..self
        }
    }
}

/// To a millionth of a degree, so that 20° reads as 20.
fn degrees(rad: f64) -> f64 {
    (rad.to_degrees() * 1e6).round() / 1e6
}
