//! The robot: the shape of its hull, and the mounts of its lasers.
//!
//! Units: metres, radians; ranges in millimetres.

use crate::geometry::CELL_M;
use crate::math::PI;

/// The robot's hull: a box that stands on a rectangle around the robot's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotShape {
    /// Half the length, metres.
    pub half_length_m: f32,
    /// Half the width over the wheels, metres.
    pub half_width_m: f32,
    /// Height of the top above the ground, metres.
    pub height_m: f32,
    /// Distance from the centre to a corner of the rectangle, metres, to the nearest millimetre.
    pub half_diagonal_m: f32,
}

/// Margin of the planning radius over half the width, metres: half a map cell.
const PLANNING_MARGIN_M: f32 = 0.5 * CELL_M;

impl RobotShape {
    /// A Pioneer 3-AT: 0.508 m × 0.497 m, 0.277 m high.
    pub const PIONEER_3AT: Self = Self::rectangle(0.508, 0.497, 0.277);

    /// Returns the shape of a rectangular robot.
    #[must_use]
    pub const fn rectangle(length_m: f32, width_m: f32, height_m: f32) -> Self {
        let (half_length_m, half_width_m) = (0.5 * length_m, 0.5 * width_m);
        Self {
            half_length_m,
            half_width_m,
            height_m,
            half_diagonal_m: to_millimetre(hypotenuse(half_length_m, half_width_m)),
        }
    }

    /// Returns the radius of the disc that paths are planned for, metres: half the width plus half
    /// a map cell, rounded up to a centimetre.
    #[must_use]
    pub const fn planning_radius_m(&self) -> f32 {
        let centimetres = (self.half_width_m + PLANNING_MARGIN_M) * 100.0;
        // A cast rounds down. 0.999 leaves a whole number of centimetres as it is.
        (centimetres + 0.999) as u32 as f32 / 100.0
    }

    /// Returns the shape of a round robot: the square around its circle.
    #[must_use]
    pub const fn round(diameter_m: f32, height_m: f32) -> Self {
        Self::rectangle(diameter_m, diameter_m, height_m)
    }
}

/// Rounds a positive length to the nearest millimetre.
const fn to_millimetre(length_m: f32) -> f32 {
    (length_m * 1000.0 + 0.5) as u32 as f32 / 1000.0
}

/// Returns √(a² + b²) by Newton's iteration, which can run at compile time; 0 if both are 0.
const fn hypotenuse(a: f32, b: f32) -> f32 {
    let square = a * a + b * b;
    // The sum of the sides is at most √2 times the root, so four iterations are exact to f32.
    let mut root = a.abs() + b.abs();
    let mut left = 4;
    while left > 0 && root > 0.0 {
        root = 0.5 * (root + square / root);
        left -= 1;
    }
    root
}

/// Greatest number of beams in a scan.
pub const MAX_BEAMS: u16 = 181;

/// The place of a laser on the robot, and its sweep. A point of it is x forward, y left, z up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserMount {
    /// Metres ahead of the robot's centre.
    pub x_m: f32,
    /// Metres to the left of the robot's centre.
    pub y_m: f32,
    /// Metres above the ground under it.
    pub z_m: f32,
    /// Radians; positive looks down.
    pub pitch_rad: f32,
    /// Bearing of the first beam, radians; negative is to the right.
    pub first_bearing_rad: f32,
    /// Radians from one beam to the next.
    pub bearing_step_rad: f32,
    /// Number of beams in a sweep.
    pub beams: u16,
    /// Range limit, millimetres: a beam beyond it returned from nothing.
    pub range_limit_mm: u16,
    /// Time that the lidar takes from the first beam to the last one, milliseconds: at most
    /// [`MAX_TURN_MS`](Self::MAX_TURN_MS); 0 if all beams are of one instant. Only a level laser
    /// has one.
    pub turn_time_ms: u16,
    /// True if the first beam is the newest, false if it is the oldest.
    pub newest_first: bool,
}

impl LaserMount {
    /// A laser with less pitch than this is level, radians.
    pub const LEVEL_RAD: f32 = 0.05;
    /// Greatest turn time, milliseconds: 2 turns a second.
    pub const MAX_TURN_MS: u16 = 500;

    /// A level scanner on the robot's axis: 181 beams over 180° ahead, 12 m.
    #[must_use]
    pub const fn level(x_m: f32, z_m: f32) -> Self {
        Self::tilted(x_m, z_m, 0.0)
    }

    /// A scanner on the robot's axis that looks down by `pitch_rad`: 181 beams over 180°, 12 m.
    #[must_use]
    pub const fn tilted(x_m: f32, z_m: f32, pitch_rad: f32) -> Self {
        Self {
            x_m,
            y_m: 0.0,
            z_m,
            pitch_rad,
            first_bearing_rad: -0.5 * PI,
            bearing_step_rad: PI / 180.0,
            beams: MAX_BEAMS,
            range_limit_mm: 12_000,
            turn_time_ms: 0,
            newest_first: false,
        }
    }

    /// The same laser, which takes `turn_time_ms` from its first beam to its last one, the oldest
    /// first.
    #[must_use]
    pub const fn turning(self, turn_time_ms: u16) -> Self {
        Self {
            turn_time_ms,
            ..self
        }
    }

    /// Returns true if the laser sweeps the level plane.
    #[must_use]
    pub const fn is_level(&self) -> bool {
        self.pitch_rad.abs() < Self::LEVEL_RAD
    }
}

#[cfg(test)]
mod tests {
    use super::RobotShape;

    #[test]
    fn a_rectangle_has_the_diagonal_of_its_sides() {
        let shape = RobotShape::rectangle(0.6, 0.8, 0.3);
        assert!((shape.half_diagonal_m - 0.5).abs() < 1e-6, "{shape:?}");
        assert_eq!((shape.half_length_m, shape.half_width_m), (0.3, 0.4));
        assert_eq!(RobotShape::rectangle(0.0, 0.0, 0.0).half_diagonal_m, 0.0);
    }

    #[test]
    fn a_round_robot_is_the_square_around_it() {
        assert_eq!(RobotShape::PIONEER_3AT.planning_radius_m(), 0.30);
        assert_eq!(RobotShape::round(0.35, 0.3).planning_radius_m(), 0.23);
        let round = RobotShape::round(0.4, 0.3);
        assert_eq!(round, RobotShape::rectangle(0.4, 0.4, 0.3));
    }
}
