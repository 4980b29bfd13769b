//! When to give up a goal, and when the way to it.
//!
//! A *goal* is given up that was reached and stays unexplored, or to which a robot that moves comes no nearer. A *way* is barred
//! where the window is closed although the coarser skeleton is not, and where the robot stands and cannot go on: its goals stay
//! goals and may be reached otherwise, and those behind it need not be tried one by one.
//!
//! What was tried lately is remembered for several goals, so that a robot drawn to and fro between two of them loses its patience
//! with both.
//!
//! Units: coarse steps of 20 cm, milliseconds.

use heapless::Vec;

use crate::geometry::{CELL_M, Cell, Point};
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

/// Goals remembered.
const MOST_WAYS: usize = 8;
/// Goals this near are the same, metres.
const SAME_GOAL_M: f32 = 1.0;
/// Time that a round may add to a goal's, milliseconds.
const MOST_ROUND_MS: u32 = 2_000;

/// The way to a goal, as it went so far.
#[derive(Clone, Copy, Debug)]
struct Way {
    goal: Cell,
    /// Fewest steps so far, and how long it was the goal since, milliseconds.
    fewest: u32,
    idle_ms: u32,
}

impl Way {
    fn leads_to(&self, goal: Cell) -> bool {
        let (dx, dy) = (self.goal.x - goal.x, self.goal.y - goal.y);
        let most = SAME_GOAL_M / CELL_M;
        ((dx * dx + dy * dy) as f32) < most * most
    }
}

/// What is to be done about the present goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Go on.
    GoOn,
    /// Give it up.
    Drop(Residue),
    /// The window has no way along the path.
    BlockUnreachable,
    /// The robot cannot go on along the path.
    BlockAhead,
}

/// What is remembered of the ways to the goals.
#[derive(Debug, Default)]
pub(crate) struct ProgressChecker {
    /// Of late, the oldest first.
    ways: Vec<Way, MOST_WAYS>,
    /// When a way was last judged.
    judged_ms: u32,
    /// Where the robot last moved from, when, and how many ways were barred since.
    stood: Point,
    stood_ms: u32,
    stood_bars: u8,
    /// When it last moved, whatever was barred since.
    moved_ms: u32,
    /// It moved since the second chance began.
    moved: bool,
    /// The window had no way to the local goal since the last round, and in how many rounds before.
    flat: bool,
    flat_rounds: u8,
}

impl ProgressChecker {
    pub(crate) const fn new() -> Self {
        Self {
            ways: Vec::new(),
            judged_ms: 0,
            stood: Point { x_m: 0.0, y_m: 0.0 },
            stood_ms: 0,
            stood_bars: 0,
            moved_ms: 0,
            moved: false,
            flat: false,
            flat_rounds: 0,
        }
    }

    /// The window has no way from the robot to its local goal.
    pub(crate) fn note_flat(&mut self) {
        self.flat = true;
    }

    pub(crate) fn note_motion(&mut self, robot: Point, time_ms: u32) {
        let (dx, dy) = (robot.x_m - self.stood.x_m, robot.y_m - self.stood.y_m);
        if dx * dx + dy * dy > MOVED_M * MOVED_M {
            (self.stood, self.stood_ms, self.stood_bars) = (robot, time_ms, 0);
            (self.moved, self.moved_ms) = (true, time_ms);
        }
    }

    /// How long the robot has stood about where it stands, milliseconds.
    pub(crate) const fn standing_ms(&self, time_ms: u32) -> u32 {
        time_ms.saturating_sub(self.moved_ms)
    }

    /// Nothing is known of the way to this goal any more.
    pub(crate) fn forget(&mut self, goal: Cell) {
        self.ways.retain(|way| !way.leads_to(goal));
    }

    /// Something else is tried from here.
    pub(crate) fn begin_next_try(&mut self) {
        (self.stood_bars, self.moved) = (0, false);
        self.ways.clear();
    }

    /// Whether the robot moved since the last such beginning.
    pub(crate) const fn moved(&self) -> bool {
        self.moved
    }

    /// Whether so many ways were barred where the robot stands that it is the robot that cannot move.
    pub(crate) const fn is_stuck(&self) -> bool {
        self.stood_bars >= STUCK_BARS
    }

    /// Judge the way to the present goal, which is `steps` away.
    pub(crate) fn judge(&mut self, goal: Cell, steps: u32, time_ms: u32) -> Verdict {
        let idle_ms = self.note_way(goal, steps, time_ms);
        self.flat_rounds = if self.flat { self.flat_rounds + 1 } else { 0 };
        self.flat = false;
        if self.flat_rounds >= FLAT_ROUNDS {
            self.flat_rounds = 0;
            return Verdict::BlockUnreachable;
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
                Verdict::BlockAhead
            };
        }
        let moves = stood_ms <= PATIENCE_MS / 2;
        if reached && idle_ms > LOOK_MS {
            Verdict::Drop(Residue::Unobservable)
        } else if moves && idle_ms > PATIENCE_MS {
            Verdict::Drop(Residue::NoProgress)
        } else {
            Verdict::GoOn
        }
    }

    /// How long the present goal has come no nearer.
    fn note_way(&mut self, goal: Cell, steps: u32, time_ms: u32) -> u32 {
        let round_ms = time_ms.wrapping_sub(self.judged_ms).min(MOST_ROUND_MS);
        self.judged_ms = time_ms;
        if let Some(way) = self.ways.iter_mut().find(|way| way.leads_to(goal)) {
            way.idle_ms += round_ms;
            if steps < way.fewest {
                (way.fewest, way.idle_ms) = (steps, 0);
            }
            return way.idle_ms;
        }
        if self.ways.is_full() {
            self.ways.remove(0);
        }
        // There is room now.
        let _ = self.ways.push(Way {
            goal,
            fewest: steps,
            idle_ms: 0,
        });
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEAR: Cell = Cell { x: 10, y: 0 };
    const FAR: Cell = Cell { x: 90, y: 0 };

    /// A robot that moves 0.5 m in a round of half a second, and what is judged in each until it is not "go on".
    fn verdict(mut round: impl FnMut(u32) -> (Cell, u32)) -> (u32, Verdict) {
        let mut patience = ProgressChecker::new();
        for k in 0..1_000 {
            let at = Point {
                x_m: 0.5 * k as f32,
                y_m: 0.0,
            };
            patience.note_motion(at, 500 * k);
            let (goal, steps) = round(k);
            let verdict = patience.judge(goal, steps, 500 * k);
            if verdict != Verdict::GoOn {
                return (500 * k, verdict);
            }
        }
        (u32::MAX, Verdict::GoOn)
    }

    #[test]
    fn a_goal_that_comes_nearer_is_followed_for_ever() {
        let (_, last) = verdict(|k| (FAR, 2_000 - k));
        assert_eq!(last, Verdict::GoOn);
    }

    #[test]
    fn a_goal_that_comes_no_nearer_is_dropped() {
        let (when_ms, last) = verdict(|_| (FAR, 40));
        assert_eq!(last, Verdict::Drop(Residue::NoProgress));
        assert_eq!(when_ms, PATIENCE_MS + 500);
    }

    #[test]
    fn a_goal_that_is_reached_is_looked_at_and_dropped() {
        let (when_ms, last) = verdict(|_| (NEAR, 2));
        assert_eq!(last, Verdict::Drop(Residue::Unobservable));
        assert_eq!(when_ms, LOOK_MS + 500);
    }

    /// Neither comes nearer than it was the first time.
    #[test]
    fn a_robot_drawn_to_and_fro_loses_its_patience_with_both() {
        let (when_ms, last) = verdict(|k| match k / 4 % 2 {
            0 => (NEAR, 30 - k % 4),
            _ => (FAR, 30 - k % 4),
        });
        assert_eq!(last, Verdict::Drop(Residue::NoProgress));
        assert!(when_ms < 3 * PATIENCE_MS, "{when_ms} ms");
    }

    #[test]
    fn a_goal_whose_way_was_barred_is_begun_anew() {
        let mut patience = ProgressChecker::new();
        for k in 0..20 {
            patience.judge(FAR, 40, 500 * k);
        }
        patience.forget(FAR);
        for k in 20..40 {
            patience.stood_ms = 500 * k;
            assert_eq!(patience.judge(FAR, 60, 500 * k), Verdict::GoOn);
        }
    }

    #[test]
    fn a_robot_stands_from_its_last_move_on_whatever_is_barred() {
        let mut patience = ProgressChecker::new();
        let here = Point { x_m: 1.0, y_m: 0.0 };
        let mut barred = 0;
        for k in 1..=100 {
            patience.note_motion(here, 500 * k);
            barred += u32::from(patience.judge(FAR, 40, 500 * k) == Verdict::BlockAhead);
            assert_eq!(patience.standing_ms(500 * k), 500 * (k - 1));
        }
        assert_eq!(barred, 3, "one in 14 s");
        patience.note_motion(Point { x_m: 1.4, y_m: 0.0 }, 60_000);
        assert_eq!(patience.standing_ms(61_000), 1_000);
    }
}
