//! Uneven ground: how high it lies around the robot, what of it can be driven on, and what of it is preferred
//! [Maffei-Terrain, III-B and III-C].
//!
//! ```text
//! both scans + pose (z, roll, pitch, yaw) → elevation → classes → the map's tiles          each step
//!                                           elevation → ε_height ┐
//!                               field → p_diff → ε_global ───────┴→ ε of the window's cells
//! ```
//!
//! | room | what it holds |
//! | --- | --- |
//! | [`elevation`] | the mean height of every cell in a window of 64 × 64 cells around the robot |
//! | [`ray`] | beams in three dimensions, from the tilted robot |
//! | [`survey`] | beams into heights, and into marks where something stands or the ground is gone |
//! | [`suspicion`] | ground that is held to be gone because it was not measured on the way |
//! | [`rooms`] | what level beams say through a doorway |
//! | [`glimpse`] | ground met from too far off to be measured, and when that is enough |
//! | [`classify`] | heights and marks into the map's classes |
//! | [`falls`] | where the ground lies too high over that beside it: edges, and slopes in any direction |
//! | [`preference`] | eqs. 3 to 5 and their hysteresis |
//! | [`sidling`] | how far the robot leans aside on a slope, and which headings keep that within its limit |
//! | [`tilt`] | what is believed of the attitude |
//! | [`storeys`] | how high the ground lies everywhere, and which goals are preferred for it |
//!
//! Everything is judged against the ground that the robot stands on and against ground measured beside it, never against the height of the
//! start. Units: metres; slopes are tangents; heights count from the start.
//!
//! [Maffei-Terrain]: "Exploration of 3D terrains using potential fields with elevation-based local distortions".

pub mod classify;
pub mod elevation;
pub mod falls;
pub mod glimpse;
mod heights;
pub mod preference;
pub mod ray;
pub mod rooms;
pub mod sidling;
pub mod storeys;
pub mod survey;
pub mod suspicion;
pub mod tilt;

#[cfg(test)]
mod tests;

pub use elevation::{Elevation, Heights};
pub use preference::{Mode, Preferences};
pub use storeys::{Levels, Storeys};
pub use tilt::Tilt;

/// Parameters of uneven ground [Maffei-Terrain, Table I], and the robot's limits on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terrain {
    /// Which preferences are used. Default: both.
    pub mode: Mode,
    /// `h_obs`: what stands higher than this over the mean ground around it is an obstacle, metres. Default: 0.30.
    pub obstacle_m: f32,
    /// `d_obs`: what the level laser meets nearer than this over ground not yet measured is an obstacle, metres. Default: 1.5.
    pub near_m: f32,
    /// `h_hole`: ground lower than this under what is beside it, with nothing measured between, is itself a negative obstacle, metres.
    /// Default: −0.60.
    pub hole_m: f32,
    /// `ε_hmin`, at least −2. Default: −0.5.
    pub least_preference: f32,
    /// `ε_gmax`, at most 2. Default: 0.5.
    pub most_preference: f32,
    /// `λ_h`, per metre. Default: 2.0.
    pub height_scale: f32,
    /// `λ_g`. Default: 0.005.
    pub global_scale: f32,
    /// Steepest slope that may be driven on, a tangent. Default: 0.364 (20°, the 3-AT's grade).
    pub climb: f32,
    /// Steepest slope that may be driven across, a tangent; as large as `climb`, there is no such limit. Default: as `climb`; the 3-AT's is
    /// 0.268 (15°).
    pub roll: f32,
    /// Highest edge that may be driven over, metres. Default: 0.07.
    pub step_m: f32,
}

impl Terrain {
    /// Table I, and the limits of a Pioneer 3-AT.
    pub const TABLE_I: Self = Self {
        mode: Mode::Both,
        obstacle_m: 0.30,
        near_m: 1.5,
        hole_m: -0.60,
        least_preference: -0.5,
        most_preference: 0.5,
        height_scale: 2.0,
        global_scale: 0.005,
        climb: 0.364,
        roll: 0.364,
        step_m: 0.07,
    };
}

impl Default for Terrain {
    fn default() -> Self {
        Self::TABLE_I
    }
}
