//! The Pioneer 3-AT: its footprint, its wheels on the ground, its drive, its lasers and its odometry.

mod contact;
mod drive;
mod footprint;
pub mod laser;
mod limits;
mod noise;
mod odometry;
mod pose;
mod stance;
mod traction;

pub use contact::{Contacts, Mishap};
pub(crate) use contact::{fall_along_m, is_aground, rise_along_m};
pub use drive::{Drive, DriveLimits};
pub use footprint::{FARTHEST_M, Footprint};
pub use laser::{LaserNoise, LaserScanner};
pub use limits::{Limits, LimitsError};
pub use noise::{Noise, Source};
pub use odometry::{Odometry, OdometryModel, OdometryNoise};
pub use pose::{Pose, Velocity, wrap};
pub use stance::stand;
pub(crate) use stance::{ground_m, resting, wheels};
pub use traction::{Shift, Traction};

/// Radius of the disc that the planner is told to keep clear and that coverage is judged by, metres.
pub const RADIUS_M: f64 = 0.30;
