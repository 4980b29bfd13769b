//! Settings of a run that are more than a word: known map, fence, relaxation, area, noise.
//!
//! The fence also has the greatest depth of the true hull in what was forbidden.

use serde::{Deserialize, Serialize};

/// Bounds and no-go polygons, and whether the robot kept to them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fence {
    /// Corners of the polygons that the robot had to stay inside, world frame.
    pub bounds_m: Vec<Vec<[f64; 2]>>,
    /// Corners of the polygons that the robot had to stay out of.
    pub no_go_m: Vec<Vec<[f64; 2]>>,
    /// Greatest depth of the true hull in what was forbidden, metres.
    pub deepest_m: f64,
}

/// What the device knew before its first step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Known {
    /// The map's file.
    pub file: String,
    /// Tiles that the device was told.
    pub tiles: usize,
    /// Area of the free cells and of the obstacles in them, square metres.
    pub known_m2: f64,
}

/// The relaxation of a stored potential.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Relaxation {
    /// Sweeps of the whole grid in each step.
    pub sweeps: u16,
    /// Type of the stored values: `f32` or `f64`.
    pub precision: String,
}

/// The parameters of a space-based potential field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceField {
    /// Least x and y, width and height of the area, world frame.
    pub area_m: [f64; 4],
    /// Share of the area whose coverage ends the exploration.
    pub until: f64,
    /// Seconds without a newly covered cell after which the robot follows a path, or `never`.
    pub impatience: String,
}

/// Standard deviations of the sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Of a laser's range.
    pub laser_m: f64,
    /// Of roll and pitch.
    pub imu_deg: f64,
}
