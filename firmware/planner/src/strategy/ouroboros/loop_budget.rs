//! How long a loop may be, and how long the robot may look for it.
//!
//! A loop road runs through the unexplored and may not exist. The paper leaves open how long to try: "utility metrics
//! to avoid undesired conditions, such as staying in a long loop for long time or taking too long to detect a
//! non-existent loop" [Jorge15, V]. Here a loop is *worth* closing if its expected length is within bounds that shrink with what
//! is left to explore, and it is given up when it is worth it no more, or when the robot has come farther since it began
//! than a multiple of the longest length that was expected of it meanwhile. So no loop, existing or not, holds the robot
//! for more than slack + detour · (most + most per frontier · frontier) metres.
//!
//! Units: metres.

use crate::config::LoopLimits;

/// The way since a loop was begun.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detour {
    /// Metres come.
    pub come_m: f32,
    /// Longest length expected of the loop since.
    pub expected_m: f32,
}

impl Detour {
    /// None yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            come_m: 0.0,
            expected_m: 0.0,
        }
    }

    /// The robot came on, and the loop is now expected to have this length.
    pub fn note(&mut self, stride_m: f32, loop_m: f32) {
        self.come_m += stride_m;
        self.expected_m = self.expected_m.max(loop_m);
    }

    /// Whether that is too far.
    #[must_use]
    pub fn is_over(&self, limits: &LoopLimits) -> bool {
        self.come_m > limits.slack_m + limits.detour * self.expected_m
    }
}

#[cfg(test)]
mod tests {
    use super::{Detour, LoopLimits};

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
        let mut detour = Detour::new();
        // The whole length of a loop of 72 m, which looked like 20 m at first.
        for step in 0..144 {
            detour.note(0.5, if step < 20 { 20.0 } else { 72.0 });
            assert!(!detour.is_over(&limits), "after {} m", detour.come_m);
        }
        while !detour.is_over(&limits) {
            detour.note(0.5, 30.0);
        }
        assert_eq!(detour.come_m, 164.5, "20 m + 2 · 72 m");
    }
}
