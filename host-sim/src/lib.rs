#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod baseline;
pub mod bringup;
pub mod campaign;
pub mod fence;
pub mod known_map;
pub mod link;
pub mod live;
pub mod metrics;
pub mod mission_file;
pub mod near;
pub mod network;
mod panics;
pub mod people;
pub mod picture;
pub mod radio;
#[cfg(feature = "record")]
pub mod recording;
pub mod replay;
pub mod report;
pub mod robot;
pub mod session;
pub mod sim;
pub mod slam;
pub mod solve;
pub mod spec;
pub mod state;
pub mod trial;
pub mod world;
