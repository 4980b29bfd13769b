#![doc = include_str!("../README.md")]
// What a session or an observation says cannot make the planner panic: indices that depend on it
// go through `get`, in every room but the solver's own loops (`field`), whose bounds are the
// window's constant shape; each of those says so where it is declared.
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing
    )
)]

#[cfg(test)]
extern crate std;

pub mod config;
pub mod drive;
pub mod field;
pub mod geometry;
pub mod grid;
pub mod ground;
pub mod input;
pub mod map;
pub mod math;
pub mod path;
pub mod planner;
pub mod profiling;
pub mod roadmap;
pub mod robot;
pub mod status;
pub mod strategy;

pub use config::{
    BoxTooLarge, Config, ConfigBuilder, ConfigError, LoopLimits, Method, OuroborosTuning,
    Parameter, PreferenceMode, SolverConfig, Strategy, Tuned, Tuning, TuningError, UnevenGround,
};
pub use geometry::{Cell, Point, Pose, Twist};
pub use input::{INVALID_MM, Input, NO_RETURN_MM};
pub use planner::{
    Capacity, CellKind, F405, FieldRow, Memory, Output, Planner, State, Workspace, step,
};
pub use profiling::{Stage, StageTimer};
pub use robot::{LaserMount, MAX_BEAMS, RobotShape};
pub use status::{Fault, Finish, Frontier, Residue, Status};
