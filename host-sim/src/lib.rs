//! Simulator of a Pioneer 3-AT for the Fieldline planner: worlds, the robot with lasers and
//! odometry, links to the planner, runs, metrics, reports, pictures.
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
