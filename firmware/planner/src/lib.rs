//! Exploration by harmonic potential in a skeleton-charged window: a pure planner without heap, clock, I/O or log.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod bits;
pub mod clearance;
pub mod config;
pub mod drive;
pub mod field;
pub mod geometry;
pub mod grid;
pub mod laps;
pub mod map;
pub mod math;
pub mod near;
pub mod planner;
pub mod skeleton;
pub mod status;
pub mod strategy;
pub mod topology;
pub mod view;

pub use config::Config;
pub use laps::{Laps, Stage};
pub use planner::{Input, Output, State, Workspace, step};
