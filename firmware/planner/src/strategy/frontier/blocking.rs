//! Blocking: closing passages that the robot could not drive on through.
//!
//! A passage is blocked by a verdict of the progress checker, or because the drive is wedged.
//!
//! Units: map cells, milliseconds.

use crate::field::local_grid::LocalGrid;
use crate::geometry::Point;
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
            Verdict::BlockUnreachable => first_unreachable(&self.path, context, grid),
            Verdict::BlockAhead => {
                self.stalled = true;
                ahead(&self.path, context.pose.point())
            }
        };
        let goal = self.path.goal();
        self.blocked_here = true;
        self.blocked.block(passage.unwrap_or(goal));
        self.forget_path();
    }

    /// Notes that the drive found no way on. The passage ahead is blocked.
    pub(crate) fn note_wedged(&mut self, robot: Point, time_ms: u32) {
        self.progress.note_blocked(time_ms);
        (self.stalled, self.blocked_here) = (true, true);
        if let Some(passage) = ahead(&self.path, robot) {
            self.blocked.block(passage);
        }
        self.forget_path();
    }
}
