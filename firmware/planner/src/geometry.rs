//! Poses, cells and the only conversions between them.
//!
//! Units: metres and radians; x east, y north, angles counter-clockwise from x. A [`Cell`] is a square of side
//! [`CELL_M`]; cell (i, j) covers [i, i+1) × [j, j+1) times that side, in the odometry frame.

use crate::math;

/// Side of a map cell, metres [Maffei20, Table I].
pub const CELL_M: f32 = 0.1;

/// A planar point, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Metres.
    pub x_m: f32,
    /// Metres.
    pub y_m: f32,
}

/// The robot's pose in the odometry frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Metres.
    pub x_m: f32,
    /// Metres.
    pub y_m: f32,
    /// Metres above the start.
    pub z_m: f32,
    /// Radians about the forward axis.
    pub roll_rad: f32,
    /// Radians about the left axis; positive is nose down.
    pub pitch_rad: f32,
    /// Radians about the up axis.
    pub yaw_rad: f32,
}

/// A planar velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Metres a second, forward.
    pub linear_mps: f32,
    /// Radians a second, counter-clockwise.
    pub angular_radps: f32,
}

/// A cell of the map, by column and row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Column, grows with x.
    pub x: i32,
    /// Row, grows with y.
    pub y: i32,
}

impl Point {
    /// The map cell that holds this point.
    #[must_use]
    pub fn cell(self) -> Cell {
        Cell {
            x: math::floor(self.x_m / CELL_M),
            y: math::floor(self.y_m / CELL_M),
        }
    }
}

impl Pose {
    /// The planar position.
    #[must_use]
    pub fn point(&self) -> Point {
        Point {
            x_m: self.x_m,
            y_m: self.y_m,
        }
    }
}

impl Cell {
    /// The corner of this cell with the least coordinates.
    #[must_use]
    pub fn corner(self) -> Point {
        Point {
            x_m: self.x as f32 * CELL_M,
            y_m: self.y as f32 * CELL_M,
        }
    }

    /// The centre of this cell.
    #[must_use]
    pub fn centre(self) -> Point {
        Point {
            x_m: (self.x as f32 + 0.5) * CELL_M,
            y_m: (self.y as f32 + 0.5) * CELL_M,
        }
    }
}
