//! The progress checker: when to give up a goal, and when to block the passage to it.
//!
//! A *goal* is given up if it is reached and stays unexplored, or if a robot that moves comes no
//! nearer to it. A *passage* is blocked where the local grid is closed although the coarser
//! skeleton is not, and where the robot stands and cannot go on. The goals behind it stay goals,
//! and need not be tried one by one: another path may lead to them.
//!
//! The checker remembers several goals, so that a robot drawn to and fro between two of them gives
//! up both. Once the map has grown it forgets them: the robot had something to do elsewhere.
//! Otherwise a goal of which it came near before would be given up on the way back to it, and a
//! wing with it (measured: docs/MEASURED.md, "Goals of the progress checker when the map has
//! grown").
//!
//! Units: coarse steps of 20 cm, milliseconds, map cells.

use heapless::Vec;

use crate::clock::since;
use crate::geometry::{Cell, Point};
use crate::status::ResidualReason;

/// Time without progress after which a goal is given up, milliseconds.
const NO_PROGRESS_MS: u32 = 12_000;
/// A goal this near is reached, coarse steps.
const REACHED_STEPS: u32 = 3;
/// Time at a reached goal without a move after which it is given up, milliseconds: half a turn on
/// the spot, with a scanner that sees the half in front. A robot that moves may drive after a
/// frontier that recedes.
const LOOK_MS: u32 = 5_000;
/// Time without a move after which the passage is blocked, milliseconds: a recovery, and the start
/// of a way through a narrow place. Searches do not count.
const STANDING_MS: u32 = 14_000;
/// A robot that moved less than this stands, metres.
const MOVED_M: f32 = 0.3;
/// Passages blocked in a row without a move after which the robot is stuck.
const STUCK_PASSAGES: u8 = 3;
/// Time without a move after which a robot that begins the next try, or to look, may fail only once
/// more, milliseconds. A passage takes 12 s in a large map, and within a minute the robot is to say
/// that it is stuck (measured: docs/MEASURED.md, "Failures of a robot that begins to look").
const LONG_STANDING_MS: u32 = 30_000;
/// Time with a closed path after which the passage is blocked, milliseconds: noise may close a way
/// for a moment.
const CLOSED_MS: u16 = 4_000;

/// Cells that must become known for the goals to be forgotten: 1 m², as in
/// [`crate::path::second_look`].
const GROWTH_CELLS: u32 = 100;
/// Maximum number of goals that are remembered.
const MOST_GOALS: usize = 8;
/// Goals nearer to each other than this count as one, metres.
const SAME_GOAL_M: f32 = 1.0;
/// Maximum time that one round adds to a goal's, milliseconds.
const MOST_ROUND_MS: u32 = 2_000;

/// The progress towards a goal.
#[derive(Clone, Copy, Debug)]
struct Attempt {
    goal: Cell,
    /// The fewest steps so far, and the time as the present goal since then, milliseconds.
    fewest: u32,
    idle_ms: u32,
}

impl Attempt {
    fn leads_to(&self, goal: Cell) -> bool {
        self.goal.distance2(goal) < SAME_GOAL_M * SAME_GOAL_M
    }
}

/// What to do about the present goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Go on.
    GoOn,
    /// Give it up.
    Drop(ResidualReason),
    /// Block the first cell of the path that the local grid has no way to.
    BlockUnreachable,
    /// Block the path ahead of the robot.
    BlockAhead,
}

/// The checker's memory.
#[derive(Debug, Default)]
pub(crate) struct ProgressChecker {
    /// The last goals, the oldest first.
    attempts: Vec<Attempt, MOST_GOALS>,
    /// Time of the last judgement.
    judged_ms: u32,
    /// Where the robot stands, since when, and the number of passages blocked there.
    stood: Point,
    stood_ms: u32,
    stood_passages: u8,
    /// Time of the last move, whatever was blocked since.
    moved_ms: u32,
    /// The robot moved since the present try began.
    moved: bool,
    /// The path was closed since the last round, and the time of such rounds so far.
    closed: bool,
    closed_ms: u16,
    /// Known cells when the goals were forgotten.
    known_cells: u32,
}

impl ProgressChecker {
    pub(crate) const fn new() -> Self {
        Self {
            attempts: Vec::new(),
            judged_ms: 0,
            stood: Point::ORIGIN,
            stood_ms: 0,
            stood_passages: 0,
            moved_ms: 0,
            moved: false,
            closed: false,
            closed_ms: 0,
            known_cells: 0,
        }
    }

    /// Notes how many cells are known.
    pub(crate) fn note_known(&mut self, known_cells: u32) {
        if known_cells >= self.known_cells.saturating_add(GROWTH_CELLS) {
            self.known_cells = known_cells;
            self.attempts.clear();
        }
    }

    /// Notes that the local grid has no way along the path, or that the field is flat at the robot.
    pub(crate) fn note_closed(&mut self) {
        self.closed = true;
    }

    /// Notes where the robot is.
    pub(crate) fn note_motion(&mut self, robot: Point, time_ms: u32) {
        if robot.distance2(self.stood) > MOVED_M * MOVED_M {
            (self.stood, self.stood_ms, self.stood_passages) = (robot, time_ms, 0);
            (self.moved, self.moved_ms) = (true, time_ms);
        }
    }

    /// Notes that a passage was blocked where the robot stands. The clocks begin anew: the way that
    /// is left has not failed yet.
    pub(crate) const fn note_blocked(&mut self, time_ms: u32) {
        self.stood_passages = self.stood_passages.saturating_add(1);
        self.stood_ms = time_ms;
        (self.closed, self.closed_ms) = (false, 0);
    }

    /// Returns the number of passages that were blocked where the robot stands.
    pub(crate) const fn passages_here(&self) -> u8 {
        self.stood_passages
    }

    /// Returns the time since the robot last moved, milliseconds.
    pub(crate) const fn standing_ms(&self, time_ms: u32) -> u32 {
        since(time_ms, self.moved_ms)
    }

    /// Notes that the robot waits for another one. The wait does not count.
    pub(crate) fn pause(&mut self, time_ms: u32) {
        (self.judged_ms, self.stood_ms, self.moved_ms) = (time_ms, time_ms, time_ms);
        self.closed = false;
    }

    /// Notes that in this period the robot was not asked to move, because it searches. The period
    /// does not count.
    pub(crate) const fn hold(&mut self, period_ms: u32) {
        self.judged_ms = self.judged_ms.wrapping_add(period_ms);
        self.stood_ms = self.stood_ms.wrapping_add(period_ms);
    }

    /// Forgets the progress towards a goal.
    pub(crate) fn forget(&mut self, goal: Cell) {
        self.attempts.retain(|attempt| !attempt.leads_to(goal));
    }

    /// Goes on after a correction that put the robot at `robot`: it has not moved, and the progress
    /// towards every goal begins anew.
    pub(crate) fn correct(&mut self, robot: Point) {
        self.stood = robot;
        self.attempts.clear();
        self.closed = false;
    }

    /// Begins with another aim: a patrol, or an order to drive.
    pub(crate) fn begin_anew(&mut self) {
        (self.stood_passages, self.moved) = (0, false);
        self.attempts.clear();
    }

    /// Begins the next try from where the robot stands: the second chance, or to look. If it has
    /// stood for long, one more passage that is blocked tells that it is stuck.
    pub(crate) fn begin_next_try(&mut self) {
        let has_stood = self.standing_ms(self.judged_ms) > LONG_STANDING_MS;
        self.begin_anew();
        if has_stood {
            self.stood_passages = STUCK_PASSAGES - 1;
        }
    }

    /// Returns true if the robot moved since the present try began.
    pub(crate) const fn moved(&self) -> bool {
        self.moved
    }

    /// Returns true if the robot cannot move, whatever the goal: so many passages were blocked
    /// where it stands.
    pub(crate) const fn is_stuck(&self) -> bool {
        self.stood_passages >= STUCK_PASSAGES
    }

    /// Judges the progress towards the present goal, which is `steps` away.
    pub(crate) fn judge(&mut self, goal: Cell, steps: u32, time_ms: u32) -> Verdict {
        let round_ms = since(time_ms, self.judged_ms).min(MOST_ROUND_MS);
        self.judged_ms = time_ms;
        let idle_ms = self.note_goal(goal, steps, round_ms);
        self.closed_ms = if self.closed {
            // At most `MOST_ROUND_MS`.
            self.closed_ms.saturating_add(round_ms as u16)
        } else {
            0
        };
        self.closed = false;
        if self.closed_ms >= CLOSED_MS {
            self.note_blocked(time_ms);
            return Verdict::BlockUnreachable;
        }
        let reached = steps <= REACHED_STEPS;
        let stood_ms = since(time_ms, self.stood_ms);
        // The goal may have changed meanwhile.
        if stood_ms > STANDING_MS {
            if reached {
                self.stood_ms = time_ms;
                return Verdict::Drop(ResidualReason::Unobservable);
            }
            self.note_blocked(time_ms);
            return Verdict::BlockAhead;
        }
        let moves = stood_ms <= NO_PROGRESS_MS / 2;
        if reached && idle_ms.min(stood_ms) > LOOK_MS {
            Verdict::Drop(ResidualReason::Unobservable)
        } else if moves && idle_ms > NO_PROGRESS_MS {
            Verdict::Drop(ResidualReason::NoProgress)
        } else {
            Verdict::GoOn
        }
    }

    /// Notes the steps to the present goal. Returns the time for which it came no nearer,
    /// milliseconds.
    fn note_goal(&mut self, goal: Cell, steps: u32, round_ms: u32) -> u32 {
        let mut attempts = self.attempts.iter_mut();
        if let Some(attempt) = attempts.find(|attempt| attempt.leads_to(goal)) {
            attempt.idle_ms = attempt.idle_ms.saturating_add(round_ms);
            if steps < attempt.fewest {
                (attempt.fewest, attempt.idle_ms) = (steps, 0);
            }
            return attempt.idle_ms;
        }
        if self.attempts.is_full() {
            self.attempts.remove(0);
        }
        // There is room now.
        let _ = self.attempts.push(Attempt {
            goal,
            fewest: steps,
            idle_ms: 0,
        });
        0
    }
}

#[cfg(test)]
mod tests;
