//! Everything the robot is not: worlds, the 3-AT, its lasers and odometry, links, trials, metrics, pictures.
#![forbid(unsafe_code)]

pub mod baseline;
pub mod link;
pub mod metrics;
pub mod picture;
pub mod report;
pub mod robot;
pub mod sim;
pub mod solve;
pub mod trial;
pub mod world;
