//! When to give up a goal, and when the way to it.
//!
//! A *goal* is given up that was reached and stays unexplored, or to which a robot that moves comes no nearer. A *way* is barred
//! where the window is closed although the coarser skeleton is not, and where the robot stands and cannot go on: its goals stay
//! goals and may be reached otherwise, and those behind it need not be tried one by one.
//!
//! Units: coarse steps of 20 cm, milliseconds.

use crate::geometry::Point;
use crate::status::Residue;

/// Time without progress after which a goal is dropped, milliseconds.
const PATIENCE_MS: u32 = 12_000;
/// A goal this near is reached, coarse steps.
const REACHED_STEPS: u32 = 3;
/// Time at a reached goal after which it is dropped, milliseconds: half a turn on the spot, with a scanner that sees a half.
const LOOK_MS: u32 = 5_000;
/// Time without moving after which the way is barred, milliseconds: a search for a manoeuvre may take half of it.
const STANDING_MS: u32 = 14_000;
/// A robot that moved less than this has not moved, metres.
const MOVED_M: f32 = 0.3;
/// Ways barred in a row without moving after which the robot is stuck.
const STUCK_BARS: u8 = 4;
/// Rounds in a row without a field at the robot after which the way is barred.
const FLAT_ROUNDS: u8 = 4;

/// What is to be done about the present goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Go on.
    GoOn,
    /// Give it up.
    Drop(Residue),
    /// The window has no way along the road.
    BarLeak,
    /// The robot cannot go on along the road.
    BarAhead,
}

/// What is remembered of the way to the present goal.
#[derive(Debug, Default)]
pub(super) struct Patience {
    /// Fewest steps so far, if any, and when.
    fewest: Option<u32>,
    since_ms: u32,
    /// Where the robot last moved from, when, and how many ways were barred since.
    stood: Point,
    stood_ms: u32,
    stood_bars: u8,
    /// It moved since the second chance began.
    moved: bool,
    /// The window had no way to the local goal since the last round, and in how many rounds before.
    flat: bool,
    flat_rounds: u8,
}

impl Patience {
    pub(super) const fn new() -> Self {
        Self {
            fewest: None,
            since_ms: 0,
            stood: Point { x_m: 0.0, y_m: 0.0 },
            stood_ms: 0,
            stood_bars: 0,
            moved: false,
            flat: false,
            flat_rounds: 0,
        }
    }

    /// The window has no way from the robot to its local goal.
    pub(super) fn note_flat(&mut self) {
        self.flat = true;
    }

    pub(super) fn note_motion(&mut self, robot: Point, time_ms: u32) {
        let (dx, dy) = (robot.x_m - self.stood.x_m, robot.y_m - self.stood.y_m);
        if dx * dx + dy * dy > MOVED_M * MOVED_M {
            (self.stood, self.stood_ms, self.stood_bars) = (robot, time_ms, 0);
            self.moved = true;
        }
    }

    /// Another goal, or none: nothing is known of the way there.
    pub(super) fn begin_anew(&mut self) {
        self.fewest = None;
    }

    /// Something else is tried from here.
    pub(super) fn begin_next_try(&mut self) {
        (self.stood_bars, self.moved) = (0, false);
    }

    /// Whether the robot moved since the last such beginning.
    pub(super) const fn moved(&self) -> bool {
        self.moved
    }

    /// Whether so many ways were barred where the robot stands that it is the robot that cannot move.
    pub(super) const fn is_stuck(&self) -> bool {
        self.stood_bars >= STUCK_BARS
    }

    /// Judge the way to the present goal, which is `steps` away.
    pub(super) fn judge(&mut self, steps: u32, time_ms: u32) -> Verdict {
        if self.fewest.is_none_or(|fewest| steps < fewest) {
            self.fewest = Some(steps);
            self.since_ms = time_ms;
        }
        self.flat_rounds = if self.flat { self.flat_rounds + 1 } else { 0 };
        self.flat = false;
        if self.flat_rounds >= FLAT_ROUNDS {
            self.flat_rounds = 0;
            return Verdict::BarLeak;
        }
        let reached = steps <= REACHED_STEPS;
        let stood_ms = time_ms.wrapping_sub(self.stood_ms);
        // Whatever goals come and go meanwhile.
        if stood_ms > STANDING_MS {
            self.stood_ms = time_ms;
            self.stood_bars += u8::from(!reached);
            return if reached {
                Verdict::Drop(Residue::Unobservable)
            } else {
                Verdict::BarAhead
            };
        }
        let idle_ms = time_ms.wrapping_sub(self.since_ms);
        let moves = stood_ms <= PATIENCE_MS / 2;
        if reached && idle_ms > LOOK_MS {
            Verdict::Drop(Residue::Unobservable)
        } else if moves && idle_ms > PATIENCE_MS {
            Verdict::Drop(Residue::NoProgress)
        } else {
            Verdict::GoOn
        }
    }
}
