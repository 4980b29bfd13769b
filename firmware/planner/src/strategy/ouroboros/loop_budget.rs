//! The loop budget: how far the robot may drive to close a loop.
//!
//! ```text
//! driven ≤ slack + detour · longest expected length
//! ```
//!
//! Departs from \[Jorge15, V\], which leaves open how long to try ("utility metrics to avoid …
//! staying in a long loop for long time or taking too long to detect a non-existent loop"): a loop
//! road through the unexplored may not exist. A loop is worth closing while its expected length is
//! within [`LoopLimits`], whose upper limit shrinks with the frontier that is left. The robot gives
//! a loop up when it is not worth closing any more, or when the budget is spent. So no loop holds
//! the robot for more than slack + detour · (most + most per frontier · frontier) metres.
//!
//! Units: metres.

use crate::config::LoopLimits;

/// The distance driven since a loop was begun, and the length expected of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LoopBudget {
    driven_m: f32,
    /// The longest length expected so far.
    expected_m: f32,
}

impl LoopBudget {
    /// Nothing driven, nothing expected.
    pub(super) const NEW: Self = Self {
        driven_m: 0.0,
        expected_m: 0.0,
    };

    /// Records a stride of the robot, and the length now expected of the loop.
    pub(super) fn note(&mut self, stride_m: f32, loop_m: f32) {
        self.driven_m += stride_m;
        self.expected_m = self.expected_m.max(loop_m);
    }

    /// Returns true if the budget is spent.
    pub(super) fn is_spent(&self, limits: &LoopLimits) -> bool {
        self.driven_m > limits.slack_m + limits.detour * self.expected_m
    }
}

#[cfg(test)]
mod tests {
    use super::{LoopBudget, LoopLimits};

    #[test]
    fn long_loops_are_worth_closing_while_much_is_left() {
        let limits = LoopLimits::default();
        assert!(!limits.is_worth(19.0, 100.0), "too short");
        assert!(limits.is_worth(90.0, 0.0));
        assert!(!limits.is_worth(150.0, 2.0));
        assert!(limits.is_worth(150.0, 4.0));
    }

    #[test]
    fn a_robot_that_wanders_gives_up_and_one_that_goes_round_does_not() {
        let limits = LoopLimits::default();
        let mut budget = LoopBudget::NEW;
        // The whole length of a loop of 72 m, of which 20 m were expected at first.
        for step in 0..144 {
            budget.note(0.5, if step < 20 { 20.0 } else { 72.0 });
            assert!(!budget.is_spent(&limits), "after {} m", budget.driven_m);
        }
        while !budget.is_spent(&limits) {
            budget.note(0.5, 30.0);
        }
        assert_eq!(budget.driven_m, 164.5, "20 m + 2 · 72 m");
    }
}
