//! The Pioneer 3-AT: its footprint, its drive, its lasers and its odometry.

mod drive;
mod footprint;
pub mod laser;
mod noise;
mod odometry;
mod pose;
mod stance;

pub use drive::{Drive, DriveLimits};
pub use footprint::{FARTHEST_M, Footprint};
pub use laser::{LaserNoise, LaserScanner};
pub use noise::{Noise, Source};
pub use odometry::{Odometry, OdometryModel, OdometryNoise};
pub use pose::{Pose, Velocity, wrap};
pub use stance::stand;

/// Radius of the disc that the planner is told to keep clear and that coverage is judged by, metres.
pub const RADIUS_M: f64 = 0.30;
