//! A host that sends well-formed requests with absurd content, in any order.

use std::collections::VecDeque;

use fieldline_protocol::message::{Observation, Pose, Scan, Start, Twist};
use fixed::types::I16F16;

use super::corrections::Corrections;
use super::fences;
use super::packets::Team;
use super::quantities::{angle, centimetres, narrow, origin_ms, wide, wide_within};
use super::scans::scan;
use super::{Host, starts};
use crate::session::ask::{Answer, Ask};
use crate::session::choices::Choices;

/// Longest stride between two observations, in the wire's bits: 15 cm.
const STRIDE: i64 = 10_000;

/// An absurd host.
pub(super) struct Absurd<C> {
    choices: C,
    /// Requests that are left.
    left: usize,
    /// True if the sessions are a Pioneer's.
    is_tame: bool,
    /// True if the robot turns a little at a time.
    turns_slowly: bool,
    start: Option<Start>,
    /// The session that was asked for last and not yet answered.
    asked: Option<Start>,
    time_ms: u32,
    pose: Pose,
    team: Team,
    corrections: Corrections,
    /// The rest of the requests of a correction.
    queue: VecDeque<Ask>,
}

impl<C: Choices> Absurd<C> {
    pub(super) fn new(mut choices: C, length: usize, is_tame: bool) -> Self {
        Self {
            left: length,
            is_tame,
            turns_slowly: choices.once_in(2),
            start: None,
            asked: None,
            time_ms: origin_ms(&mut choices),
            pose: Pose::default(),
            team: Team::default(),
            corrections: Corrections::default(),
            queue: VecDeque::new(),
            choices,
        }
    }

    fn ask_start(&mut self) -> Ask {
        let start = if self.is_tame {
            starts::pioneer(&mut self.choices)
        } else {
            starts::any(&mut self.choices)
        };
        self.asked = Some(start.clone());
        Ask::Start(Box::new(start))
    }

    /// Draws a step within 15 cm; rarely, any number.
    fn stride(&mut self) -> I16F16 {
        if self.choices.once_in(200) {
            wide(&mut self.choices)
        } else {
            wide_within(&mut self.choices, -STRIDE, STRIDE)
        }
    }

    /// Lets time pass: usually a period; sometimes none, back, or any.
    fn tick(&mut self) {
        let choices = &mut self.choices;
        let passed = match choices.below(60) {
            57 => choices.bits(32) as u32,
            58 => 0_u32.wrapping_sub(choices.below(5_000) as u32),
            59 => 0,
            _ => 200,
        };
        self.time_ms = self.time_ms.wrapping_add(passed);
    }

    fn moved(&mut self) -> Pose {
        let (dx, dy) = (self.stride(), self.stride());
        let mut pose = self.pose;
        pose.x = pose.x.wrapping_add(dx);
        pose.y = pose.y.wrapping_add(dy);
        let choices = &mut self.choices;
        pose.yaw = if self.turns_slowly {
            pose.yaw.wrapping_add(wide_within(choices, -STRIDE, STRIDE))
        } else {
            angle(choices)
        };
        match choices.below(40) {
            36 | 37 => {
                pose.z = wide(choices);
                (pose.roll, pose.pitch) = (angle(choices), angle(choices));
            }
            38 | 39 => (pose.z, pose.roll, pose.pitch) = Default::default(),
            _ => {}
        }
        if choices.once_in(300) {
            pose.x = choices.pick(&[I16F16::MAX, I16F16::MIN, I16F16::ZERO]);
        }
        pose
    }

    fn observation(&mut self) -> Observation {
        self.tick();
        self.pose = self.moved();
        let lasers = self.start.as_ref().map_or(&[][..], |start| &start.lasers);
        let choices = &mut self.choices;
        let scans: Vec<Scan> = lasers
            .iter()
            .map(|laser| {
                let is_wrong = choices.once_in(60);
                scan(
                    choices,
                    if is_wrong {
                        laser.beams / 2
                    } else {
                        laser.beams
                    },
                )
            })
            .collect();
        Observation {
            time_ms: self.time_ms,
            pose: self.pose,
            velocity: Twist {
                linear: narrow(choices),
                angular: narrow(choices),
            },
            scans: scans.into_iter().collect(),
        }
    }

    fn ask(&mut self) -> Ask {
        // Other requests come between those of a correction.
        if !self.queue.is_empty()
            && !self.choices.once_in(6)
            && let Some(ask) = self.queue.pop_front()
        {
            return ask;
        }
        let has_team = self.start.as_ref().is_some_and(|it| it.team.is_some());
        let choices = &mut self.choices;
        match choices.below(66) {
            // An ordinary observation is the smallest number, which a fuzzer's zeros are.
            0..31 => Ask::Observation(Box::new(self.observation())),
            31..42 if has_team => {
                self.team.near_cm = (centimetres(self.pose.x), centimetres(self.pose.y));
                Ask::Hear(Box::new(self.team.packet(choices)))
            }
            42..49 if has_team => Ask::Say,
            49 if choices.once_in(4) => self.ask_start(),
            50 => Ask::Pause,
            51..54 => Ask::Resume,
            54 if choices.once_in(8) => Ask::Stop,
            55 => Ask::Tile {
                x: choices.between(-8, 8) as i16,
                y: choices.between(-8, 8) as i16,
            },
            56 => Ask::Tile {
                x: choices.bits(16) as i16,
                y: choices.bits(16) as i16,
            },
            57 => Ask::FieldRow {
                row: choices.below(61) as u8,
            },
            58 => Ask::FieldRow {
                row: choices.bits(8) as u8,
            },
            59 => Ask::Frontiers,
            60 => Ask::Path {
                from: choices.bits(8) as u8,
            },
            61 => Ask::Hello,
            62 if choices.once_in(16) => Ask::Reset,
            62 => {
                self.queue.extend(self.corrections.requests(choices));
                self.queue.pop_front().unwrap_or(Ask::Say)
            }
            64 => fences::order(choices),
            63 if choices.once_in(4) => Ask::Hear(Box::new(self.team.packet(choices))),
            _ => Ask::Observation(Box::new(self.observation())),
        }
    }
}

impl<C: Choices> Host for Absurd<C> {
    fn next(&mut self, last: Option<&Answer>) -> Option<Ask> {
        let is_refused = matches!(last, Some(Answer::Refused(_)));
        if let Some(asked) = self.asked.take().filter(|_| !is_refused) {
            self.team.own = asked.team.map_or(0, |team| team.member.id);
            self.start = Some(asked);
        }
        // A host whose session was refused asks for another one.
        match self.start {
            _ if self.left == 0 => None,
            None => {
                self.left -= 1;
                Some(self.ask_start())
            }
            Some(_) if self.choices.is_over() => None,
            Some(_) => {
                self.left -= 1;
                Some(self.ask())
            }
        }
    }
}
