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
            stood: Point { x_m: 0.0, y_m: 0.0 },
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
mod tests {
    use super::*;

    const NEAR: Cell = Cell { x: 10, y: 0 };
    const FAR: Cell = Cell { x: 90, y: 0 };

    /// Returns the first verdict other than "go on", and its time, for a robot that moves 0.5 m in
    /// a round of half a second.
    fn verdict(mut round: impl FnMut(u32) -> (Cell, u32)) -> (u32, Verdict) {
        let mut progress = ProgressChecker::new();
        for k in 0..1_000 {
            let at = Point {
                x_m: 0.5 * k as f32,
                y_m: 0.0,
            };
            progress.note_motion(at, 500 * k);
            let (goal, steps) = round(k);
            let verdict = progress.judge(goal, steps, 500 * k);
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
        assert_eq!(last, Verdict::Drop(ResidualReason::NoProgress));
        assert_eq!(when_ms, NO_PROGRESS_MS + 500);
    }

    /// Returns the first verdict other than "go on", and its time, for a robot at a reached goal
    /// that moves so far in a round of half a second.
    fn at_goal(moves_m: f32) -> (u32, Verdict) {
        let mut progress = ProgressChecker::new();
        let verdicts = (0..100).map(|k| {
            let at = Point {
                x_m: moves_m * k as f32,
                y_m: 0.0,
            };
            progress.note_motion(at, 500 * k);
            (500 * k, progress.judge(NEAR, 2, 500 * k))
        });
        let mut other = verdicts.filter(|&(_, verdict)| verdict != Verdict::GoOn);
        other.next().expect("a verdict")
    }

    #[test]
    fn a_goal_that_is_reached_is_looked_at_and_dropped() {
        let (when_ms, last) = at_goal(0.0);
        assert_eq!(last, Verdict::Drop(ResidualReason::Unobservable));
        assert_eq!(when_ms, LOOK_MS + 500);
    }

    #[test]
    fn a_frontier_that_recedes_before_the_robot_is_followed_for_longer() {
        let (when_ms, last) = at_goal(0.5);
        assert_eq!(last, Verdict::Drop(ResidualReason::NoProgress));
        assert_eq!(when_ms, NO_PROGRESS_MS + 500);
    }

    /// Neither comes nearer than it was the first time.
    #[test]
    fn a_robot_drawn_to_and_fro_gives_up_both_goals() {
        let (when_ms, last) = verdict(|k| match k / 4 % 2 {
            0 => (NEAR, 30 - k % 4),
            _ => (FAR, 30 - k % 4),
        });
        assert_eq!(last, Verdict::Drop(ResidualReason::NoProgress));
        assert!(when_ms < 3 * NO_PROGRESS_MS, "{when_ms} ms");
    }

    /// It came near a goal, did something else, and has to come from farther off now.
    #[test]
    fn a_goal_is_begun_anew_once_the_map_has_grown() {
        let gives_up = |grown_cells: u32| {
            let mut progress = ProgressChecker::new();
            progress.note_known(5_000);
            progress.judge(FAR, 10, 0);
            progress.note_known(5_000 + grown_cells);
            let mut verdicts = (1..40).map(|k| {
                let x_m = 0.5 * k as f32;
                progress.note_motion(Point { x_m, y_m: 0.0 }, 500 * k);
                progress.judge(FAR, 90 - k, 500 * k)
            });
            verdicts.any(|verdict| verdict == Verdict::Drop(ResidualReason::NoProgress))
        };
        assert!(gives_up(GROWTH_CELLS - 1));
        assert!(!gives_up(GROWTH_CELLS));
    }

    /// A pose, and so a goal, may be anywhere that a message can say.
    #[test]
    fn goals_are_apart_however_far_they_are() {
        let far = |x: i32| Cell { x, y: -x };
        let mut progress = ProgressChecker::new();
        progress.judge(far(327_679), 40, 500);
        progress.forget(far(-327_680));
        assert_eq!(progress.attempts.len(), 1);
        progress.forget(far(327_675));
        assert!(progress.attempts.is_empty());
    }

    /// The way that is left is not blamed for the time that the blocked one took.
    #[test]
    fn after_a_passage_the_way_back_has_all_its_time() {
        let mut progress = ProgressChecker::new();
        for time_ms in [STANDING_MS - 300, STANDING_MS] {
            progress.note_closed();
            assert_eq!(progress.judge(FAR, 40, time_ms), Verdict::GoOn);
        }
        progress.note_closed();
        progress.note_blocked(STANDING_MS);
        assert_eq!(progress.passages_here(), 1);
        let blocked_again_ms = STANDING_MS + u32::from(CLOSED_MS);
        for time_ms in [blocked_again_ms - 500, blocked_again_ms - 1] {
            progress.note_closed();
            assert_eq!(progress.judge(FAR, 90, time_ms), Verdict::GoOn);
        }
        assert_eq!(progress.judge(FAR, 90, 2 * STANDING_MS), Verdict::GoOn);
        let late_ms = 2 * STANDING_MS + 1;
        assert_eq!(progress.judge(FAR, 90, late_ms), Verdict::BlockAhead);
    }

    #[test]
    fn a_robot_that_has_stood_for_long_may_fail_once_more_at_its_next_try() {
        let fails = |stood_ms: u32, moves_m: f32| {
            let mut progress = ProgressChecker::new();
            progress.judge(FAR, 40, stood_ms);
            progress.begin_next_try();
            let at = Point {
                x_m: moves_m,
                y_m: 0.0,
            };
            progress.note_motion(at, stood_ms);
            let failures = (1..=STUCK_PASSAGES).find(|_| {
                progress.note_blocked(stood_ms);
                progress.is_stuck()
            });
            failures.expect("it is stuck at last")
        };
        assert_eq!(fails(LONG_STANDING_MS, 0.0), 3);
        assert_eq!(fails(LONG_STANDING_MS + 1, 0.0), 1);
        assert_eq!(fails(LONG_STANDING_MS + 1, 2.0 * MOVED_M), 3, "it can move");
    }

    #[test]
    fn a_closed_path_is_blocked_in_time_however_long_a_round_takes() {
        for round_ms in [400, 1_000, MOST_ROUND_MS] {
            let mut progress = ProgressChecker::new();
            let rounds = u32::from(CLOSED_MS).div_ceil(round_ms);
            for k in 1..=rounds {
                progress.note_closed();
                let verdict = progress.judge(FAR, 40, k * round_ms);
                assert_eq!(verdict == Verdict::BlockUnreachable, k == rounds, "{k}");
            }
        }
    }

    #[test]
    fn a_goal_behind_a_blocked_passage_is_begun_anew() {
        let mut progress = ProgressChecker::new();
        for k in 0..20 {
            progress.judge(FAR, 40, 500 * k);
        }
        progress.forget(FAR);
        for k in 20..40 {
            progress.stood_ms = 500 * k;
            assert_eq!(progress.judge(FAR, 60, 500 * k), Verdict::GoOn);
        }
    }

    #[test]
    fn a_robot_stands_since_its_last_move_whatever_is_blocked() {
        let mut progress = ProgressChecker::new();
        let here = Point { x_m: 1.0, y_m: 0.0 };
        let mut blocked = 0;
        for k in 1..=100 {
            progress.note_motion(here, 500 * k);
            blocked += u32::from(progress.judge(FAR, 40, 500 * k) == Verdict::BlockAhead);
            assert_eq!(progress.standing_ms(500 * k), 500 * (k - 1));
        }
        assert_eq!(blocked, 3, "one in 14 s");
        progress.note_motion(Point { x_m: 1.4, y_m: 0.0 }, 60_000);
        assert_eq!(progress.standing_ms(61_000), 1_000);
    }
}
