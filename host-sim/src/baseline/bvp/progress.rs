//! The progress checker of the baseline: decides when to give up a goal.
//!
//! A goal is dropped in three cases:
//! - the robot reached it, and it stays unexplored for [`LOOK_MS`];
//! - the robot moves and comes no nearer to it for [`PROGRESS_MS`];
//! - the robot stands and comes no nearer to it for [`STANDING_MS`].
//!
//! With an endless patience only the first case counts.
//!
//! Goals dropped without progress become goals again, once, when no other goal is left. After
//! [`STUCK_DROPS`] goals dropped in a row without motion the robot is stuck.
//!
//! The planner's progress checker ([`fieldline_planner::path`]) has another rule for a robot that
//! stands. After 14 s it blocks the *path* and keeps the goal; after 4 blocked paths in a row the
//! robot is stuck. The baseline follows a field and has no path to block, so it drops the goal
//! itself: later, after 24 s, because that is final, and it is stuck after 3 such goals. The
//! planner also times up to 8 goals at once, the baseline only the present one. The other numbers
//! are the planner's.
//!
//! Units: milliseconds; map cells.

use fieldline_planner::geometry::{CELL_M, Cell, Point};
use fieldline_planner::status::{ResidualFrontier, ResidualReason};

/// Time without progress after which a robot that moves drops its goal, milliseconds.
pub const PROGRESS_MS: u32 = 12_000;
/// Time without progress after which a robot that stands drops its goal, milliseconds.
pub const STANDING_MS: u32 = 24_000;
/// Time at a reached goal after which it is dropped, milliseconds.
pub const LOOK_MS: u32 = 5_000;
/// Number of goals dropped in a row without motion after which the robot is stuck.
pub const STUCK_DROPS: u8 = 3;
/// No cell within this distance of a dropped goal is a goal, metres.
pub const DROP_RADIUS_M: f32 = 0.5;
/// Two goals nearer than this are the same goal, metres.
const SAME_GOAL_M: f32 = 1.0;
/// A goal within this distance is reached, steps of one cell: 0.6 m.
const REACHED_STEPS: u32 = 6;
/// Least distance that counts as motion, metres.
const MOVED_M: f32 = 0.3;

/// When a goal that comes no nearer is dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::baseline) enum Patience {
    /// After [`PROGRESS_MS`] or [`STANDING_MS`].
    #[default]
    Limited,
    /// Never.
    Endless,
}

/// The goal that the field leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pursuit {
    goal: Cell,
    /// Fewest steps to it so far, and the time of that, milliseconds.
    fewest: u32,
    since_ms: u32,
}

/// The progress checker.
#[derive(Clone, Debug, Default)]
pub(in crate::baseline) struct ProgressChecker {
    patience: Patience,
    dropped: Vec<ResidualFrontier>,
    pursuit: Option<Pursuit>,
    /// Place and time of the last motion, and the number of goals dropped since.
    stood: Point,
    stood_ms: u32,
    stood_drops: u8,
    second_chance: bool,
}

/// Returns true if two cells are less than a distance apart.
fn near(a: Cell, b: Cell, radius_m: f32) -> bool {
    let (dx, dy) = ((a.x - b.x) as f32 * CELL_M, (a.y - b.y) as f32 * CELL_M);
    dx * dx + dy * dy < radius_m * radius_m
}

impl ProgressChecker {
    /// Makes a checker without a goal.
    pub(in crate::baseline) fn new(patience: Patience) -> Self {
        Self {
            patience,
            ..Self::default()
        }
    }

    /// Returns the dropped goals, each with its reason.
    pub(in crate::baseline) fn dropped(&self) -> &[ResidualFrontier] {
        &self.dropped
    }

    /// Returns true if an unexplored cell lies near a dropped goal.
    pub(in crate::baseline) fn is_dropped(&self, cell: Cell) -> bool {
        self.dropped
            .iter()
            .any(|goal| near(goal.cell, cell, DROP_RADIUS_M))
    }

    /// Returns true if the robot cannot move, whatever its goal.
    pub(super) const fn is_stuck(&self) -> bool {
        self.stood_drops >= STUCK_DROPS
    }

    /// Makes the goals dropped without progress goals again, once. Returns true if there were any.
    pub(super) fn try_again(&mut self) -> bool {
        let before = self.dropped.len();
        if !self.second_chance {
            self.second_chance = true;
            self.dropped
                .retain(|goal| goal.reason != ResidualReason::NoProgress);
        }
        self.dropped.len() < before
    }

    /// Notes that the robot is at `at` and that the field leads it to `goal`, `steps` cells away.
    pub(in crate::baseline) fn note(
        &mut self,
        at: Point,
        (goal, steps): (Cell, u32),
        time_ms: u32,
    ) {
        if (at.x_m - self.stood.x_m).hypot(at.y_m - self.stood.y_m) > MOVED_M {
            (self.stood, self.stood_ms, self.stood_drops) = (at, time_ms, 0);
        }
        let new = Pursuit {
            goal,
            fewest: steps,
            since_ms: time_ms,
        };
        let same = |old: &Pursuit| near(old.goal, goal, SAME_GOAL_M) && steps >= old.fewest;
        let pursuit = self.pursuit.filter(same).unwrap_or(new);
        self.pursuit = Some(pursuit);
        self.drop_if_idle(pursuit, steps <= REACHED_STEPS, time_ms);
    }

    /// Drops the goal if its time is over.
    fn drop_if_idle(&mut self, pursuit: Pursuit, reached: bool, time_ms: u32) {
        let stood_ms = time_ms.wrapping_sub(self.stood_ms);
        let limit_ms = match (reached, stood_ms > PROGRESS_MS / 2) {
            (true, _) => LOOK_MS,
            (false, false) => PROGRESS_MS,
            (false, true) => STANDING_MS,
        };
        if time_ms.wrapping_sub(pursuit.since_ms) <= limit_ms {
            return;
        }
        if !reached && self.patience == Patience::Endless {
            return;
        }
        if !reached && stood_ms > STANDING_MS {
            self.stood_ms = time_ms;
            self.stood_drops += 1;
        }
        self.dropped.push(ResidualFrontier {
            cell: pursuit.goal,
            cells: 1,
            reason: if reached {
                ResidualReason::Unobservable
            } else {
                ResidualReason::NoProgress
            },
        });
        self.pursuit = None;
    }
}

#[cfg(test)]
mod tests {
    use super::{Patience, ProgressChecker};
    use fieldline_planner::geometry::{Cell, Point};
    use fieldline_planner::status::ResidualReason;

    const GOAL: Cell = Cell { x: 40, y: 0 };

    /// Returns the second in which the first goal is dropped, and the reason. In second t the robot
    /// is at x = `x_m(t)`, `steps(t)` cells from its goal.
    fn dropped_s(
        x_m: impl Fn(u32) -> f32,
        steps: impl Fn(u32) -> u32,
    ) -> Option<(u32, ResidualReason)> {
        let mut checker = ProgressChecker::default();
        (0..200).find_map(|t| {
            let at = Point {
                x_m: x_m(t),
                y_m: 0.0,
            };
            checker.note(at, (GOAL, steps(t)), t * 1000);
            checker.dropped().first().map(|goal| (t, goal.reason))
        })
    }

    #[test]
    fn goals_without_progress_are_dropped_sooner_by_a_robot_that_moves() {
        let circling = |t: u32| if t.is_multiple_of(2) { 0.0 } else { 1.0 };
        assert_eq!(
            dropped_s(circling, |_| 30),
            Some((13, ResidualReason::NoProgress))
        );
        assert_eq!(
            dropped_s(|_| 0.0, |_| 30),
            Some((25, ResidualReason::NoProgress))
        );
        assert_eq!(
            dropped_s(|_| 0.0, |_| 3),
            Some((6, ResidualReason::Unobservable))
        );
        assert_eq!(dropped_s(|_| 0.0, |t| 1000 - t), None, "it comes nearer");
    }

    #[test]
    fn endless_patience_drops_only_what_was_reached() {
        let dropped = |steps: u32| {
            let mut checker = ProgressChecker::new(Patience::Endless);
            for t in 0..200 {
                checker.note(Point::default(), (GOAL, steps), t * 1000);
            }
            assert!(!checker.is_stuck());
            checker.dropped().first().map(|goal| goal.reason)
        };
        assert_eq!(dropped(30), None);
        assert_eq!(dropped(3), Some(ResidualReason::Unobservable));
    }

    #[test]
    fn a_dropped_goal_hides_its_surroundings_and_gets_one_more_chance() {
        let mut checker = ProgressChecker::default();
        for t in 0..26 {
            checker.note(Point::default(), (GOAL, 30), t * 1000);
        }
        assert!(checker.is_dropped(Cell { x: 43, y: 2 }));
        assert!(!checker.is_dropped(Cell { x: 46, y: 0 }));
        assert!(checker.try_again() && !checker.is_dropped(GOAL));
        for t in 26..60 {
            checker.note(Point::default(), (GOAL, 30), t * 1000);
        }
        assert!(checker.is_dropped(GOAL) && !checker.try_again());
    }

    #[test]
    fn three_goals_dropped_on_the_spot_are_stuck() {
        let mut checker = ProgressChecker::default();
        let mut stuck = None;
        for t in 0..200 {
            let goal = Cell {
                x: 40 + 20 * checker.dropped().len() as i32,
                y: 0,
            };
            checker.note(Point::default(), (goal, 30), t * 1000);
            stuck = stuck.or(checker.is_stuck().then_some(t));
        }
        assert_eq!(stuck, Some(3 * 25 + 2));
    }
}
