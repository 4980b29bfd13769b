//! Blocking: closing passages that the robot could not drive on through.
//!
//! A passage is blocked by a verdict of the progress checker, or because the drive is wedged. If
//! the goal is nearer than the passage would be, the goal itself is blocked (measured:
//! docs/MEASURED.md, "A wedged robot whose goal is near").
//!
//! Units: map cells, milliseconds.

use crate::doing::Event;
use crate::field::local_grid::LocalGrid;
use crate::geometry::{Cell, Point};
use crate::path::PlanningContext;
use crate::path::blocked_passages::{BlockedPassages, ahead, first_unreachable};
use crate::path::progress::Verdict;
use crate::roadmap::skeleton::Skeleton;
use crate::strategy::frontier::Frontier;

impl Frontier {
    /// Returns true if a passage was blocked since the last call.
    pub(crate) const fn take_blocked(&mut self) -> bool {
        core::mem::replace(&mut self.blocked_here, false)
    }

    /// Returns true if the robot blocked more than one passage from where it stands.
    pub(crate) const fn failed_before_here(&self) -> bool {
        self.progress.passages_here() > 1
    }

    /// Returns true if no path leads anywhere, and the robot goes back through a blocked passage.
    pub(crate) const fn goes_back(&self) -> bool {
        self.goes_back
    }

    /// Returns the blocked passages.
    pub(crate) const fn blocked(&self) -> &BlockedPassages {
        &self.blocked
    }

    /// Opens the passage that was blocked last.
    pub(crate) fn open_last_passage(&mut self) {
        self.blocked.open_last();
    }

    /// Cuts the published skeleton at the blocked passages.
    pub(crate) fn cut<const SLOTS: usize>(&self, skeleton: &mut Skeleton<SLOTS>) {
        self.blocked.cut(skeleton);
    }

    /// Blocks the passage that a verdict names, if it names one.
    pub(super) fn block_passage<const TILES: usize, const SLOTS: usize>(
        &mut self,
        verdict: Verdict,
        context: &PlanningContext<'_, TILES, SLOTS>,
        grid: &mut LocalGrid,
    ) {
        let passage = match verdict {
            Verdict::GoOn | Verdict::Drop(_) => return,
            Verdict::BlockUnreachable => {
                self.events.add(Event::PathClosed);
                first_unreachable(&self.path, context, grid)
            }
            Verdict::BlockAhead => {
                self.stalled = true;
                self.events.add(Event::Stalled);
                ahead(&self.path, context.pose.point())
            }
        };
        self.block_from(passage);
    }

    /// Blocks a passage on the path from where the robot stands; the goal, if the path is shorter.
    /// Otherwise the robot would come back to such a goal without end.
    fn block_from(&mut self, passage: Option<Cell>) {
        self.blocked_here = true;
        if !self.path.is_empty() {
            self.blocked.block(passage.unwrap_or(self.path.goal()));
        }
        self.forget_path();
    }

    /// Notes that the drive found no way on. The passage ahead is blocked.
    pub(crate) fn note_wedged(&mut self, robot: Point, time_ms: u32) {
        self.progress.note_blocked(time_ms);
        self.stalled = true;
        self.events.add(Event::Wedged);
        self.block_from(ahead(&self.path, robot));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Path;

    /// Returns true if a robot at the origin that is wedged, with a goal so many cells ahead,
    /// blocks something.
    fn blocks(goal: Option<i32>) -> bool {
        let mut frontier = Frontier::new();
        if let Some(x) = goal {
            let cells = (0..=x).rev().map(|x| Cell { x, y: 0 });
            frontier.path = Path::back(cells, x as usize + 1, x as u32 + 1);
        }
        frontier.note_wedged(Point::default(), 1_000);
        assert!(frontier.path.is_empty() && frontier.take_blocked());
        !frontier.blocked.is_empty()
    }

    #[test]
    fn a_wedged_robot_blocks_the_way_ahead_or_a_goal_that_is_nearer() {
        assert!(blocks(Some(40)) && blocks(Some(2)));
        assert!(!blocks(None));
    }
}
