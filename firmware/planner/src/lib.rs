#![doc = include_str!("../README.md")]
// What a session or an observation says cannot make the planner panic: indices that depend on it
// go through `get`, in every room but the solver's own loops (`field`), whose bounds are the
// window's constant shape; each of those says so where it is declared.
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(feature = "internals"),
    allow(
        dead_code,
        unreachable_pub,
        unused_imports,
        reason = "some items are only for the simulator and the tests"
    )
)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing
    )
)]
#![allow(
    rustdoc::private_intra_doc_links,
    reason = "the documentation of a room names its private files too"
)]

#[cfg(test)]
extern crate std;

// The rooms, from low to high. Feature `internals` opens them to this project's simulator and
// tests; it promises nothing to others.
mod clock;
#[cfg(not(feature = "internals"))]
mod config;
#[cfg(not(feature = "internals"))]
mod doing;
#[cfg(not(feature = "internals"))]
mod drive;
#[cfg(not(feature = "internals"))]
mod fence;
#[cfg(not(feature = "internals"))]
mod field;
#[cfg(not(feature = "internals"))]
mod geometry;
#[cfg(not(feature = "internals"))]
mod grid;
#[cfg(not(feature = "internals"))]
mod ground;
#[cfg(not(feature = "internals"))]
mod input;
#[cfg(not(feature = "internals"))]
mod localise;
#[cfg(not(feature = "internals"))]
mod map;
#[cfg(not(feature = "internals"))]
mod math;
#[cfg(not(feature = "internals"))]
mod path;
#[cfg(not(feature = "internals"))]
mod planner;
#[cfg(not(feature = "internals"))]
mod profiling;
#[cfg(not(feature = "internals"))]
mod roadmap;
#[cfg(not(feature = "internals"))]
mod robot;
#[cfg(not(feature = "internals"))]
mod status;
#[cfg(not(feature = "internals"))]
mod strategy;
#[cfg(not(feature = "internals"))]
mod team;

#[cfg(feature = "internals")]
pub mod config;
#[cfg(feature = "internals")]
pub mod doing;
#[cfg(feature = "internals")]
pub mod drive;
#[cfg(feature = "internals")]
pub mod fence;
#[cfg(feature = "internals")]
pub mod field;
#[cfg(feature = "internals")]
pub mod geometry;
#[cfg(feature = "internals")]
pub mod grid;
#[cfg(feature = "internals")]
pub mod ground;
#[cfg(feature = "internals")]
pub mod input;
#[cfg(feature = "internals")]
pub mod localise;
#[cfg(feature = "internals")]
pub mod map;
#[cfg(feature = "internals")]
pub mod math;
#[cfg(feature = "internals")]
pub mod path;
#[cfg(feature = "internals")]
pub mod planner;
#[cfg(feature = "internals")]
pub mod profiling;
#[cfg(feature = "internals")]
pub mod roadmap;
#[cfg(feature = "internals")]
pub mod robot;
#[cfg(feature = "internals")]
pub mod status;
#[cfg(feature = "internals")]
pub mod strategy;
#[cfg(feature = "internals")]
pub mod team;

pub use config::{
    Area, Budget, Config, ConfigBuilder, ConfigError, FieldTuning, Goal, GoalLevel, GroundTuning,
    LocaliseTuning, LoopLimits, MapTuning, Member, Method, Order, OrderTuning, OuroborosTuning,
    Parameter, PreferenceMode, SbpfTuning, SolverConfig, SpaceField, Strategy, TdbvpTuning,
    TeamPlace, Tuned, Tuning, TuningError, UnevenGround,
};
pub use doing::{Doing, Event, Events};
pub use fence::Fence;
pub use field::SIDE as FIELD_SIDE;
pub use geometry::{CELL_M, Cell, MapPose, Point, Pose, Twist};
pub use input::{INVALID_MM, Input, InputError, InputFaults, NO_RETURN_MM};
pub use localise::{Location, Quality};
pub use planner::{
    Capacity, CellKind, CorrectedTile, Correction, CorrectionError, CorrectionProgress, F405,
    FieldRow, LoopCounts, Memory, Output, Planner, RECALLED_POINTS, RECALLED_TRACK, Recall,
    RecalledPoint, State, Task, TaskError, Workspace, step,
};
pub use profiling::{Stage, StageTimer};
pub use robot::{LaserMount, MAX_BEAMS, RobotShape};
pub use status::{Errand, Fault, Finish, Mistake, ResidualFrontier, ResidualReason, Status};
pub use team::packet::{
    Activity, Beacon, Body, DIGEST_TILES, Digest, Packet, ROAD_POINTS, TeamTile, TileVersion,
    WANTED_TILES, Wanted,
};
pub use team::peers::Peer;
