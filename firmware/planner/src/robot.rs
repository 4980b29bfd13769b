//! The robot: its hull, and where its lasers sit.
//!
//! Units: metres, radians; ranges in millimetres.

/// Half the 3-AT's length, metres.
pub const HALF_LENGTH_M: f32 = 0.254;
/// Half the 3-AT's width over its wheels, metres.
pub const HALF_WIDTH_M: f32 = 0.2485;
/// The 3-AT's height, metres.
pub const HEIGHT_M: f32 = 0.277;
/// Half the robot's diagonal, metres.
pub const HALF_DIAGONAL_M: f32 = 0.355;
/// A laser tilted less than this is level, radians.
const LEVEL_RAD: f32 = 0.05;

/// Where a laser sits and how it sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserMount {
    /// Metres ahead of the robot's centre.
    pub x_m: f32,
    /// Metres to its left.
    pub y_m: f32,
    /// Metres above the ground under it.
    pub z_m: f32,
    /// Radians; positive looks down.
    pub pitch_rad: f32,
    /// Bearing of the first beam, radians; negative is to the right.
    pub first_bearing_rad: f32,
    /// Radians from one beam to the next.
    pub bearing_step_rad: f32,
    /// Beams in a sweep.
    pub beams: u16,
    /// Range limit, millimetres: a beam beyond it returned from nothing.
    pub range_limit_mm: u16,
}

/// Whether the laser sweeps the level plane.
#[must_use]
pub fn is_level(laser: &LaserMount) -> bool {
    laser.pitch_rad.abs() < LEVEL_RAD
}
