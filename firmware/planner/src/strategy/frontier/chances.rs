//! Chances: what a robot tries that is stuck, or that no path leads on for.
//!
//! At the *second chance* all blocked passages are open again, and so are the goals that came no
//! nearer. The robot may enter a gap that is hardly wider than its hull. After the second chance
//! and its repetitions it only looks from viewpoints.

use crate::doing::Event;
use crate::path::RoundOutcome;
use crate::strategy::frontier::Frontier;

/// Maximum number of further second chances.
const MOST_RETRIES: u8 = 2;

impl Frontier {
    /// Goes on along the path, or begins the next try if the robot is stuck or `has_enough` goals
    /// were given up.
    pub(super) fn go_on_or_retry(&mut self, has_enough: bool) -> RoundOutcome {
        if self.progress.is_stuck() || has_enough {
            self.try_again().unwrap_or_else(|| self.only_look())
        } else {
            RoundOutcome::Path
        }
    }

    /// Begins the second chance, or one of the further ones; `None` if there is none left. A robot
    /// that did not move since the last one began would meet the same closed ways.
    fn try_again(&mut self) -> Option<RoundOutcome> {
        let is_first = !self.second_chance;
        let has_more = self.retries < MOST_RETRIES;
        if !is_first && (self.blocked.is_empty() || !has_more || !self.progress.moved()) {
            return None;
        }
        self.retries += u8::from(!is_first);
        Some(self.begin_second_chance())
    }

    /// Drives to no frontier any more: what is left lies behind gaps in which the robot stalls.
    pub(super) fn only_look(&mut self) -> RoundOutcome {
        self.only_looks = true;
        self.immobile = !self.progress.moved();
        self.progress.begin_next_try();
        self.events.add(Event::OnlyLooks);
        self.path.clear();
        RoundOutcome::Nothing
    }

    /// Returns true if the robot could not move at any of its chances.
    pub(crate) const fn is_stuck(&self) -> bool {
        self.immobile
    }

    /// Returns true if the goals that were given up are tried again.
    pub(crate) const fn has_second_chance(&self) -> bool {
        self.second_chance
    }

    /// Returns true if this is one of the further second chances.
    pub(crate) const fn has_further_chance(&self) -> bool {
        self.retries > 0
    }

    /// Decides what to try when no frontier is within reach.
    ///
    /// One blocked passage may close the only way: a narrow one that the robot came through, or
    /// ground that was measured from one side only. So the passages are opened again up to
    /// [`MOST_RETRIES`] times. Every opening was tried by then, so it alone is worth no trip any
    /// more. One such round is enough: noise may close a way for a moment, but to wait until it
    /// opens again buys nothing.
    ///
    /// Measured: docs/MEASURED.md, "Passages that are opened again", "Openings at a further
    /// chance", "Wait for a way that noise closed".
    pub(super) fn do_without(&mut self) -> RoundOutcome {
        self.path.clear();
        self.try_again().unwrap_or(RoundOutcome::Nothing)
    }

    fn begin_second_chance(&mut self) -> RoundOutcome {
        self.second_chance = true;
        self.events.add(Event::TriesAgain);
        self.progress.begin_next_try();
        self.blocked.open_all();
        self.residual.retry_without_progress();
        self.path.clear();
        RoundOutcome::Unsure
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Cell, Point};

    /// Every chance opens the passages, so each one is blocked again.
    #[test]
    fn a_further_chance_needs_a_move_since_the_last_one() {
        let mut frontier = Frontier::new();
        let mut tries = |x_m: f32| {
            frontier.blocked.block(Cell { x: 10, y: 0 });
            frontier
                .progress
                .note_motion(Point { x_m, y_m: 0.0 }, 1_000);
            let is_taken = frontier.try_again().is_some();
            (is_taken, frontier.has_further_chance())
        };
        assert_eq!(tries(0.0), (true, false), "the second chance needs no move");
        assert_eq!([tries(0.0), tries(0.1)], [(false, false); 2]);
        assert_eq!([tries(1.0), tries(1.0)], [(true, true), (false, true)]);
        assert_eq!(tries(2.0), (true, true));
        assert_eq!(tries(3.0), (false, true), "all are spent");
    }
}
