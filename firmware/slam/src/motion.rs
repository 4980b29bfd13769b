//! What odometry may err: the information of a motion that it measured.
//!
//! ```text
//! along²  = along_by_way s + along_by_turn φ + (scale s)²      across² = along² / 10
//! turn²   = turn_by_turn φ + turn_by_way s + (turn_scale φ)²
//! ```
//!
//! s is the way and φ the turn of the motion. Errors of scale repeat, so that a graph that trusts
//! them as independent bends: the variances are taken [`Motion::SAFETY`] times.
//!
//! Units: metres, radians.

use crate::matrix::{Matrix, diagonal};
use crate::pose::Pose;

/// Noise of wheel odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Variance of the turn by the turn, rad²/rad.
    pub turn_by_turn: f32,
    /// Variance of the turn by the way, rad²/m.
    pub turn_by_way: f32,
    /// Variance of the way by the way, m²/m.
    pub along_by_way: f32,
    /// Variance of the way by the turn, m²/rad.
    pub along_by_turn: f32,
    /// Standard deviation of the scale of the way.
    pub scale: f32,
    /// Standard deviation of the scale of the turn.
    pub turn_scale: f32,
}

/// Variances of a robot that did not move, m² and rad².
const STILL: (f32, f32) = (1e-6, 1e-7);

impl Motion {
    /// How many times the variances are taken.
    pub const SAFETY: f32 = 10.0;

    /// A robot with two driven wheels on a level floor.
    pub const WHEELS: Self = Self {
        turn_by_turn: 4.4e-4,
        turn_by_way: 1.2e-4,
        along_by_way: 2.5e-4,
        along_by_turn: 1.4e-4,
        scale: 0.01,
        turn_scale: 0.02,
    };

    /// Returns the noise with the variances of its random walk times a factor.
    #[must_use]
    pub fn times(self, factor: f32) -> Self {
        Self {
            turn_by_turn: factor * self.turn_by_turn,
            turn_by_way: factor * self.turn_by_way,
            along_by_way: factor * self.along_by_way,
            along_by_turn: factor * self.along_by_turn,
            ..self
        }
    }

    /// Returns the variances along, across and of the turn for a motion.
    #[must_use]
    pub fn variances(&self, motion: &Pose) -> [f32; 3] {
        let (way, turn) = (motion.length_m(), motion.yaw_rad.abs());
        let square = |x: f32| x * x;
        let along = self.along_by_way * way + self.along_by_turn * turn + square(self.scale * way);
        let turn =
            self.turn_by_turn * turn + self.turn_by_way * way + square(self.turn_scale * turn);
        [
            Self::SAFETY * along + STILL.0,
            0.1 * Self::SAFETY * along + STILL.0,
            Self::SAFETY * turn + STILL.1,
        ]
    }

    /// Returns the information of a motion, in the frame in which it ends.
    pub(crate) fn information(&self, motion: &Pose) -> Matrix {
        diagonal(self.variances(motion).map(|variance| 1.0 / variance))
    }
}
