//! Short motions, and the recovery made of them.
//!
//! Units: metres, radians; a motion takes [`PERIODS`] periods.

use heapless::Vec;

use crate::drive::hull::Place;
use crate::geometry::Twist;
use crate::math;

/// Capacity of a recovery, motions; of a longer one the robot drives the beginning.
const MOST_MOTIONS: usize = 64;
/// Periods that a motion takes.
const PERIODS: u8 = 2;
/// Length of a straight or curved motion, metres.
pub(super) const LENGTH_M: f32 = 0.03;
/// Turn of a motion on the spot, radians: 7.5°.
pub(super) const TURN_RAD: f32 = math::PI / 24.0;
/// Headings that are distinguished: a full turn in steps of [`TURN_RAD`].
pub(super) const DIRECTIONS: i32 = 48;
/// Turn of a curved motion, radians.
const CURVE_RAD: f32 = 0.1;

/// A short motion: its length, its turn and its cost. Backward motions cost more: they are blind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    pub(super) length_m: f32,
    pub(super) turn_rad: f32,
    pub(super) cost: f32,
}

const fn motion(length_m: f32, turn_rad: f32, cost: f32) -> Motion {
    Motion {
        length_m,
        turn_rad,
        cost,
    }
}

impl Motion {
    fn velocity(self, period_s: f32) -> Twist {
        let seconds = f32::from(PERIODS) * period_s;
        Twist {
            linear_mps: self.length_m / seconds,
            angular_radps: self.turn_rad / seconds,
        }
    }
}

/// All motions; a motion's number is its index here.
pub(super) const MOTIONS: [Motion; 8] = [
    motion(0.0, TURN_RAD, 1.0),
    motion(0.0, -TURN_RAD, 1.0),
    motion(LENGTH_M, 0.0, 1.0),
    motion(LENGTH_M, CURVE_RAD, 1.2),
    motion(LENGTH_M, -CURVE_RAD, 1.2),
    motion(-LENGTH_M, 0.0, 1.3),
    motion(-LENGTH_M, CURVE_RAD, 1.5),
    motion(-LENGTH_M, -CURVE_RAD, 1.5),
];

/// Number of the turn to the left; that to the right comes next.
pub(super) const TURN_LEFT: u8 = 0;
/// Number of the straight motion forwards; those in a curve to the left and to the right come next.
pub(super) const FORWARD: u8 = 2;
/// Number of the straight motion backwards; the curves come next.
pub(super) const BACKWARD: u8 = 5;

/// Returns the cell of a pose: its column, its row and its direction.
#[inline(never)]
pub(super) fn cell_of(place: Place) -> [i32; 3] {
    let nearest = |at: f32| math::floor(at + 0.5);
    [
        nearest(place.x_m / LENGTH_M),
        nearest(place.y_m / LENGTH_M),
        nearest(place.yaw_rad / TURN_RAD).rem_euclid(DIRECTIONS),
    ]
}

/// A set of motions: bit k is motion k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct MotionSet(u8);

impl MotionSet {
    /// Every motion.
    #[cfg(test)]
    pub(super) const ALL: Self = Self(u8::MAX);

    /// Returns the motions whose velocity is admitted.
    pub(super) fn of(period_s: f32, admits: impl Fn(Twist) -> bool) -> Self {
        let bit = |(number, motion): (usize, &Motion)| {
            u8::from(admits(motion.velocity(period_s))) << number
        };
        let bits = MOTIONS.iter().enumerate().map(bit);
        Self(bits.fold(0, |set, bit| set | bit))
    }

    pub(super) const fn has(self, number: usize) -> bool {
        self.0 >> number & 1 == 1
    }
}

/// A recovery in progress: motions by number, the next one last.
#[derive(Clone, Debug, Default)]
pub(super) struct Recovery {
    pub(super) motions: Vec<u8, MOST_MOTIONS>,
    /// Driven periods of the present motion.
    periods: u8,
}

impl Recovery {
    /// Returns a recovery without motions.
    pub(super) const fn new() -> Self {
        Self {
            motions: Vec::new(),
            periods: 0,
        }
    }

    /// Returns true if no motion is left.
    pub(super) fn is_empty(&self) -> bool {
        self.motions.is_empty()
    }

    /// Drops all motions.
    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// Returns the velocity of the next period; `None` at the end.
    pub(super) fn next(&mut self, period_s: f32) -> Option<Twist> {
        let motion = MOTIONS.get(usize::from(*self.motions.last()?))?;
        self.periods += 1;
        if self.periods >= PERIODS {
            self.periods = 0;
            self.motions.pop();
        }
        Some(motion.velocity(period_s))
    }
}
