//! Faults of what a robot reports: teleports, dead beams, mirrored scans, clocks that stick or
//! jump.
//!
//! A fault lasts until another one changes the same thing, or until all is well again.

use fieldline_protocol::message::{INVALID_MM, NO_RETURN_MM, Observation, Scan, Twist};
use fixed::types::I16F16;

use super::quantities::{angle, narrow, wide, wide_within};
use super::scans::scan;
use crate::session::choices::Choices;

/// Farthest ordinary teleport, in the wire's bits: 3 m.
const TELEPORT: i64 = 200_000;

/// What happens to the beams of a laser.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Beams {
    #[default]
    Good,
    /// The beams from one to another carry this range.
    Dead(usize, usize, u16),
    /// The first beam is the last.
    Mirrored,
    /// All ranges are divided by this.
    Shrunken(u16),
}

/// The faults of a robot.
#[derive(Clone, Debug, Default)]
pub(super) struct Faults {
    shift: (I16F16, I16F16),
    turn: I16F16,
    /// Difference of the clock, milliseconds.
    ahead_ms: u32,
    /// The time at which the clock sticks.
    stuck_ms: Option<u32>,
    beams: Beams,
    /// The scans that come again and again.
    frozen: Option<heapless::Vec<Scan, 2>>,
    tilt: Option<[I16F16; 3]>,
}

/// What becomes of an observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// It is sent.
    Sent,
    /// It is not sent.
    Missing,
    /// It is sent twice.
    Twice,
    /// The session pauses before it is sent.
    Paused,
}

impl Faults {
    /// Draws a new fault, and what becomes of this observation.
    pub(super) fn strike(
        &mut self,
        choices: &mut impl Choices,
        observation: &mut Observation,
    ) -> Fate {
        match choices.below(22) {
            0 | 1 => self.shift.0 = wide_within(choices, -TELEPORT, TELEPORT),
            2 => self.shift.1 = wide_within(choices, -TELEPORT, TELEPORT),
            3 => self.turn = angle(choices),
            4 => self.shift.0 = wide(choices),
            5 => self.ahead_ms = choices.bits(32) as u32,
            6 => self.ahead_ms = self.ahead_ms.wrapping_sub(choices.below(10_000) as u32),
            7 => self.stuck_ms = Some(observation.time_ms),
            8 => self.beams = Beams::Mirrored,
            9 => self.beams = dead(choices),
            10 => self.beams = Beams::Shrunken(2 + choices.below(6) as u16),
            11 => self.frozen = Some(observation.scans.clone()),
            12 => self.tilt = Some([wide(choices), angle(choices), angle(choices)]),
            13 => observation.scans.iter_mut().for_each(|it| {
                let beams = it.ranges_mm.len() as u16;
                *it = scan(choices, beams);
            }),
            14 => {
                observation.velocity = Twist {
                    linear: narrow(choices),
                    angular: narrow(choices),
                }
            }
            15 => drop(observation.scans.pop()),
            16 => return Fate::Missing,
            17 => return Fate::Twice,
            18 => return Fate::Paused,
            _ => {
                *self = Self {
                    ahead_ms: self.ahead_ms,
                    ..Self::default()
                }
            }
        }
        Fate::Sent
    }

    /// Applies the faults that last.
    pub(super) fn spoil(&self, observation: &mut Observation) {
        let time_ms = self.stuck_ms.unwrap_or(observation.time_ms);
        observation.time_ms = time_ms.wrapping_add(self.ahead_ms);
        let pose = &mut observation.pose;
        pose.x = pose.x.wrapping_add(self.shift.0);
        pose.y = pose.y.wrapping_add(self.shift.1);
        pose.yaw = pose.yaw.wrapping_add(self.turn);
        if let Some(tilt) = self.tilt {
            [pose.z, pose.roll, pose.pitch] = tilt;
        }
        if let Some(frozen) = &self.frozen {
            observation.scans.clone_from(frozen);
        }
        observation
            .scans
            .iter_mut()
            .for_each(|it| self.beams.spoil(it));
    }
}

fn dead(choices: &mut impl Choices) -> Beams {
    let from = choices.below(181) as usize;
    let range = choices.pick(&[INVALID_MM, NO_RETURN_MM, 1, 200]);
    Beams::Dead(from, from + choices.below(181) as usize, range)
}

impl Beams {
    fn spoil(self, scan: &mut Scan) {
        let ranges = &mut scan.ranges_mm;
        match self {
            Self::Good => {}
            Self::Dead(from, to, dead) => {
                let count = to.saturating_sub(from);
                ranges
                    .iter_mut()
                    .skip(from)
                    .take(count)
                    .for_each(|range| *range = dead);
            }
            Self::Mirrored => ranges.reverse(),
            Self::Shrunken(by) => ranges.iter_mut().for_each(|range| *range /= by),
        }
    }
}
