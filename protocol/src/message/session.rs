//! What a session is begun with, and what else may be done to it.
//!
//! Units: metres, radians, seconds.

use fixed::types::{I4F12, I16F16};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::MAX_SCANS;
#[cfg(doc)]
use super::{MAX_BEAMS, Status};

/// Where a laser sits and how it sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Laser {
    /// Metres ahead of the robot's centre.
    pub x: I4F12,
    /// Metres to its left.
    pub y: I4F12,
    /// Metres above the ground under it.
    pub z: I4F12,
    /// Radians; positive looks down.
    pub pitch: I4F12,
    /// Radians, bearing of the first beam (negative is to the right).
    pub first_bearing: I16F16,
    /// Radians from one beam to the next.
    pub bearing_step: I16F16,
    /// Beams in a sweep, at most [`MAX_BEAMS`].
    pub beams: u16,
    /// Nothing farther than this is reported.
    pub range_limit_mm: u16,
}

/// Which strategy plans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Strategy {
    /// Nearest unexplored centre cell.
    #[default]
    Frontier,
    /// The same, closing loops on the way.
    Ouroboros,
    /// Rails by the time of their visit, and a patrol on them.
    Tdbvp {
        /// How long to patrol when all is explored, seconds. The status stays [`Status::Exploring`] meanwhile.
        patrol_s: u16,
    },
}

/// Which preferences shape the field on uneven ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Preference {
    /// None.
    Off,
    /// Ground at the robot's own height.
    Height,
    /// The whole window, against a field that grows flat.
    Global,
    /// Both.
    #[default]
    Both,
}

/// Parameters of uneven ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Terrain {
    /// Which preferences are used.
    pub preference: Preference,
    /// What stands higher than this over the ground around it is an obstacle, metres.
    pub obstacle: I4F12,
    /// What the level laser meets nearer than this over ground not yet measured is an obstacle, metres.
    pub near: I4F12,
    /// Ground lower than this under what is beside it is a negative obstacle, metres; negative.
    pub hole: I4F12,
    /// Least preference, from −2 to 0.
    pub least: I4F12,
    /// Greatest preference, from 0 to 2.
    pub most: I4F12,
    /// Preference lost a metre of height, at least 0.
    pub height_scale: I4F12,
    /// Preference gained an e-th part of the field's steepness, at least 0.
    pub global_scale: I16F16,
    /// Steepest slope that may be driven on, radians.
    pub climb: I4F12,
    /// Steepest slope that may be driven across, radians; as large as `climb`, there is no such limit.
    pub roll: I4F12,
    /// Highest edge that may be driven over, metres.
    pub step: I4F12,
}

/// The session's parameters.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Start {
    /// Which strategy plans.
    pub strategy: Strategy,
    /// The map's box in tiles of 3.2 m, across (an even number) and up, both at least 4; their product is at most the device's tile
    /// slots.
    pub box_tiles: (u8, u8),
    /// The laser scanners.
    pub lasers: Vec<Laser, MAX_SCANS>,
    /// Radius that the planner keeps clear, millimetres.
    pub robot_radius_mm: u16,
    /// Greatest speed, metres a second.
    pub max_linear: I4F12,
    /// Greatest turn rate, radians a second.
    pub max_angular: I4F12,
    /// Acceleration and braking that the robot can be relied on for, metres a second squared.
    pub linear_accel: I4F12,
    /// The same of its turn rate, radians a second squared.
    pub angular_accel: I4F12,
    /// Time from one observation to the next, milliseconds; a command is driven for so long.
    pub period_ms: u16,
    /// How to go about uneven ground: heights are measured, holes and edges kept off, level ground preferred. Nothing on flat
    /// ground, where the lasers see only what stands.
    pub terrain: Option<Terrain>,
}

/// What the host wants of the session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Control {
    /// Forget the map and begin.
    Start(Start),
    /// Hold still until resumed.
    Pause,
    /// Go on after a pause.
    Resume,
    /// End the session; the map stays readable.
    Stop,
    /// Reboot the device.
    Reset,
}
