//! When a goal is given up: the planner's own rule, for a strategy that has no goal but the one that its field leads to.
//!
//! A goal is dropped that is reached and stays unexplored for [`LOOK_MS`], or that comes no nearer for [`PATIENCE_MS`], or for
//! [`STANDING_MS`] while the robot stands and looks for a manoeuvre. Goals without progress get a second chance when nothing
//! else is left, once. After [`STUCK_DROPS`] goals dropped in a row without moving the robot is stuck.
//!
//! Units: milliseconds; cells of the map.

use fieldline_planner::geometry::{CELL_M, Cell, Point};
use fieldline_planner::status::{Frontier, Residue};

/// Time without progress after which a goal is dropped, milliseconds.
pub const PATIENCE_MS: u32 = 12_000;
/// The same for a robot that stands.
pub const STANDING_MS: u32 = 24_000;
/// Time at a reached goal after which it is dropped, milliseconds.
pub const LOOK_MS: u32 = 5_000;
/// Goals dropped in a row without moving after which the robot is stuck.
pub const STUCK_DROPS: u8 = 3;
/// Around a dropped goal no other is one, metres.
pub const DROP_RADIUS_M: f32 = 0.5;
/// Goals nearer to each other than this are the same goal, metres.
const SAME_GOAL_M: f32 = 1.0;
/// A goal this near is reached, steps: 0.6 m.
const REACHED_STEPS: u32 = 6;
/// A robot that moved less than this has not moved, metres.
const MOVED_M: f32 = 0.3;

/// The goal that the field leads to now.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pursuit {
    goal: Cell,
    /// Fewest steps to it so far, and when.
    fewest: u32,
    since_ms: u32,
}

/// What is remembered of goals.
#[derive(Clone, Debug, Default)]
pub(super) struct Patience {
    dropped: Vec<Frontier>,
    pursuit: Option<Pursuit>,
    /// Where the robot last moved from, when, and how many goals it dropped since.
    stood: Point,
    stood_ms: u32,
    stood_drops: u8,
    second_chance: bool,
}

fn near(a: Cell, b: Cell, radius_m: f32) -> bool {
    let (dx, dy) = ((a.x - b.x) as f32 * CELL_M, (a.y - b.y) as f32 * CELL_M);
    dx * dx + dy * dy < radius_m * radius_m
}

impl Patience {
    /// Goals that were given up, and why.
    pub(super) fn dropped(&self) -> &[Frontier] {
        &self.dropped
    }

    /// Whether an unexplored cell is one that was given up.
    pub(super) fn is_dropped(&self, cell: Cell) -> bool {
        self.dropped
            .iter()
            .any(|goal| near(goal.cell, cell, DROP_RADIUS_M))
    }

    /// Whether the robot cannot move, whatever the goal.
    pub(super) const fn is_stuck(&self) -> bool {
        self.stood_drops >= STUCK_DROPS
    }

    /// Nothing is left: take back, once, the goals that the robot could not get to. Whether there were any.
    pub(super) fn try_again(&mut self) -> bool {
        let before = self.dropped.len();
        if !self.second_chance {
            self.second_chance = true;
            self.dropped
                .retain(|goal| goal.reason != Residue::NoProgress);
        }
        self.dropped.len() < before
    }

    /// The robot is at `at`, and the field leads it to `goal`, so many steps away.
    pub(super) fn note(&mut self, at: Point, (goal, steps): (Cell, u32), time_ms: u32) {
        if (at.x_m - self.stood.x_m).hypot(at.y_m - self.stood.y_m) > MOVED_M {
            (self.stood, self.stood_ms, self.stood_drops) = (at, time_ms, 0);
        }
        let fresh = Pursuit {
            goal,
            fewest: steps,
            since_ms: time_ms,
        };
        let same = |old: &Pursuit| near(old.goal, goal, SAME_GOAL_M) && steps >= old.fewest;
        let pursuit = self.pursuit.filter(same).unwrap_or(fresh);
        self.pursuit = Some(pursuit);
        self.give_up_if_idle(pursuit, steps <= REACHED_STEPS, time_ms);
    }

    fn give_up_if_idle(&mut self, pursuit: Pursuit, reached: bool, time_ms: u32) {
        let stood_ms = time_ms.wrapping_sub(self.stood_ms);
        let patience_ms = match (reached, stood_ms > PATIENCE_MS / 2) {
            (true, _) => LOOK_MS,
            (false, false) => PATIENCE_MS,
            (false, true) => STANDING_MS,
        };
        if time_ms.wrapping_sub(pursuit.since_ms) <= patience_ms {
            return;
        }
        if !reached && stood_ms > STANDING_MS {
            self.stood_ms = time_ms;
            self.stood_drops += 1;
        }
        self.dropped.push(Frontier {
            cell: pursuit.goal,
            cells: 1,
            reason: if reached {
                Residue::Unobservable
            } else {
                Residue::NoProgress
            },
        });
        self.pursuit = None;
    }
}

#[cfg(test)]
mod tests {
    use super::Patience;
    use fieldline_planner::geometry::{Cell, Point};
    use fieldline_planner::status::Residue;

    const GOAL: Cell = Cell { x: 40, y: 0 };

    /// When the first goal is dropped, seconds, by a robot that at second t is at x(t) metres and `steps(t)` from its goal.
    fn dropped_s(x_m: impl Fn(u32) -> f32, steps: impl Fn(u32) -> u32) -> Option<(u32, Residue)> {
        let mut patience = Patience::default();
        (0..200).find_map(|t| {
            let at = Point {
                x_m: x_m(t),
                y_m: 0.0,
            };
            patience.note(at, (GOAL, steps(t)), t * 1000);
            patience.dropped().first().map(|goal| (t, goal.reason))
        })
    }

    #[test]
    fn goals_without_progress_are_dropped_sooner_by_a_robot_that_moves() {
        let circling = |t: u32| if t.is_multiple_of(2) { 0.0 } else { 1.0 };
        assert_eq!(dropped_s(circling, |_| 30), Some((13, Residue::NoProgress)));
        assert_eq!(dropped_s(|_| 0.0, |_| 30), Some((25, Residue::NoProgress)));
        assert_eq!(dropped_s(|_| 0.0, |_| 3), Some((6, Residue::Unobservable)));
        assert_eq!(dropped_s(|_| 0.0, |t| 1000 - t), None, "it comes nearer");
    }

    #[test]
    fn around_a_dropped_goal_there_is_none_and_it_gets_one_more_chance() {
        let mut patience = Patience::default();
        for t in 0..26 {
            patience.note(Point::default(), (GOAL, 30), t * 1000);
        }
        assert!(patience.is_dropped(Cell { x: 43, y: 2 }));
        assert!(!patience.is_dropped(Cell { x: 46, y: 0 }));
        assert!(patience.try_again() && !patience.is_dropped(GOAL));
        for t in 26..60 {
            patience.note(Point::default(), (GOAL, 30), t * 1000);
        }
        assert!(patience.is_dropped(GOAL) && !patience.try_again());
    }

    #[test]
    fn three_goals_dropped_on_the_spot_are_stuck() {
        let mut patience = Patience::default();
        let mut stuck = None;
        for t in 0..200 {
            let goal = Cell {
                x: 40 + 20 * patience.dropped().len() as i32,
                y: 0,
            };
            patience.note(Point::default(), (goal, 30), t * 1000);
            stuck = stuck.or(patience.is_stuck().then_some(t));
        }
        assert_eq!(stuck, Some(3 * 25 + 2));
    }
}
