//! Short motions, and a manoeuvre made of them.
//!
//! Units: metres, radians; a motion takes a fixed number of periods.

use heapless::Vec;

use crate::geometry::Twist;
use crate::math;

/// Motions of a plan at the most; of a longer way the beginning is driven.
pub const MOST_MOTIONS: usize = 64;
/// Periods that a motion takes.
const PERIODS: u8 = 2;
/// Length of a straight or curved motion, metres.
pub(super) const LENGTH_M: f32 = 0.03;
/// Turn of a motion on the spot, radians: 7.5°.
pub(super) const TURN_RAD: f32 = math::PI / 24.0;
/// Turn of a curved motion, radians.
const CURVE_RAD: f32 = 0.1;

/// A short motion: its length, its turn and what it costs; driving backwards is blind.
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

/// By number.
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

/// The straight ones, by number.
pub(super) const FORWARD: u8 = 2;
pub(super) const BACKWARD: u8 = 5;

/// A set of motions, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choice(u8);

impl Choice {
    /// The motions whose velocity, driven for `period_s` and more, is admitted.
    pub fn of(period_s: f32, admits: impl Fn(Twist) -> bool) -> Self {
        let bit = |(number, motion): (usize, &Motion)| {
            u8::from(admits(motion.velocity(period_s))) << number
        };
        Self(
            MOTIONS
                .iter()
                .enumerate()
                .map(bit)
                .fold(0, |set, bit| set | bit),
        )
    }

    /// Every motion.
    pub const ALL: Self = Self(u8::MAX);

    pub(super) const fn has(self, number: usize) -> bool {
        self.0 >> number & 1 == 1
    }
}

/// A manoeuvre in progress: motions by number, the next one last.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    pub(super) motions: Vec<u8, MOST_MOTIONS>,
    /// Periods of the present motion already driven.
    periods: u8,
}

impl Plan {
    /// No manoeuvre.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            motions: Vec::new(),
            periods: 0,
        }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.motions.is_empty()
    }

    /// Forget it.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// The velocity of the next period, if the manoeuvre goes on.
    pub fn next(&mut self, period_s: f32) -> Option<Twist> {
        let motion = MOTIONS.get(usize::from(*self.motions.last()?))?;
        self.periods += 1;
        if self.periods >= PERIODS {
            self.periods = 0;
            self.motions.pop();
        }
        Some(motion.velocity(period_s))
    }
}
