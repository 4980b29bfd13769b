//! The robot: its file, footprint, wheels on the ground, drive, lasers and odometry. The usual one
//! is a Pioneer 3-AT.

mod contact;
mod disturbance;
mod drive;
mod file;
mod footprint;
pub mod laser;
pub mod lidar;
mod limits;
mod miswiring;
mod noise;
mod odometry;
mod other;
mod pose;
pub mod presets;
pub mod sectors;
mod spec;
mod stance;
mod traction;

pub use contact::{Contacts, Mishap};
pub(crate) use contact::{fall_along_m, is_aground, rise_along_m};
pub use disturbance::{Disturbances, Span};
pub use drive::{Drive, DriveLimits};
pub use file::RobotError;
pub use footprint::{FARTHEST_M, Footprint};
pub use laser::{LaserNoise, LaserScanner};
pub use lidar::Lidar;
pub use limits::Limits;
pub use miswiring::Miswiring;
pub use noise::{Noise, Source};
pub use odometry::{Odometry, OdometryModel, OdometryNoise};
pub use other::{MAST_M, OtherRobot, nearest_m};
pub(crate) use pose::distance_m;
pub use pose::{Pose, Velocity, wrap};
pub use sectors::Sectors;
pub use spec::{RobotSpec, Sweep, usual_lidars};
pub use stance::stand;
pub(crate) use stance::{ground_m, resting, wheels};
pub use traction::{Shift, Traction};

/// Radius of the robot's disc, metres: the planner keeps it clear, and coverage counts with it.
pub const RADIUS_M: f64 = 0.30;
