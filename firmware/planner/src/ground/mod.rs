//! Uneven ground: how high it lies around the robot, what of it can be driven on, and what of it is preferred
//! [Maffei20, III-B and III-C].
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
//! | [`drop_inference`] | ground that is held to be gone because it was not measured on the way |
//! | [`doorway_view`] | what level beams say through a doorway |
//! | [`low_confidence`] | ground met from too far off to be measured, and when that is enough |
//! | [`classify`] | heights and marks into the map's classes |
//! | [`steepness`] | where the ground lies too high over that beside it: edges, and slopes in any direction |
//! | [`attitude_filter`] | what is believed of the attitude |
//!
//! Everything is judged against the ground that the robot stands on and against ground measured beside it, never against the height of the
//! start. Units: metres; slopes are tangents; heights count from the start.
//!
//! [Maffei20]: "Exploration of 3D terrains using potential fields with elevation-based local distortions".

pub mod attitude_filter;
pub mod classify;
pub mod doorway_view;
pub mod drop_inference;
pub mod elevation;
mod heights;
pub mod low_confidence;
pub mod ray;
pub mod steepness;
pub mod survey;

#[cfg(test)]
mod tests;

pub use attitude_filter::AttitudeFilter;
pub use elevation::{Elevation, Heights};
