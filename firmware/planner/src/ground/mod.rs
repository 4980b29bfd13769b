//! Uneven ground: heights around the robot, and the cells that the robot can drive on.
//! Source: \[Maffei20, III-B\].
//!
//! ```text
//! both scans + pose (z, roll, pitch, yaw) → elevation → classes → the map's tiles      each step
//! ```
//!
//! | room | what it holds |
//! | --- | --- |
//! | [`elevation`] | the mean height of every cell in a window of 64 × 64 cells around the robot |
//! | `heights` | read access to that window, and its layout in memory |
//! | `ray` | a beam in three dimensions, from the tilted robot |
//! | `attitude_filter` | the smoothed attitude, and how far it allows heights to be measured |
//! | `survey` | both scans into heights, obstacles and drops |
//! | `drop_inference` | drops near the robot that no beam saw |
//! | `low_confidence` | ground met from too far off to be measured |
//! | `steepness` | edges and slopes that are too steep |
//! | `classify` | heights and marks into the map's classes |
//! | `doorway_view` | the part of a room that level beams see through a doorway |
//!
//! Invariant: every decision compares the ground under the robot with ground measured beside it,
//! never with the height of the start. The room knows nothing of the map, which calls it.
//!
//! Words: a *drop* is a cell whose ground is gone; a *rim* is the border of a drop; a *brow* is the
//! upper end of a slope; the *climb* is the steepest slope that the robot drives on.
//!
//! The tuned constants are in [`GroundTuning`](crate::GroundTuning).
//!
//! Units: metres; slopes are tangents; heights count from the start.

mod attitude_filter;
pub(crate) mod classify;
pub(crate) mod doorway_view;
mod drop_inference;
pub mod elevation;
pub(crate) mod heights;
mod low_confidence;
pub(crate) mod ray;
mod steepness;
pub(crate) mod survey;

pub(crate) use attitude_filter::AttitudeFilter;
pub use elevation::{Elevation, Heights};
