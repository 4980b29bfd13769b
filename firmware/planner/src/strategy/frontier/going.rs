//! Going: driving to a place by order, with the paths, passages and chances of the way to a
//! frontier.
//!
//! Units: map cells, milliseconds.

use crate::field::local_grid::LocalGrid;
use crate::geometry::Cell;
use crate::map::Class;
use crate::path::progress::Verdict;
use crate::path::search::path_to;
use crate::path::{Path, PlanningContext, PlanningScratch, RoundOutcome};
use crate::roadmap::configuration_space::is_passable;
use crate::strategy::frontier::Frontier;

impl Frontier {
    /// Plans a round to a place. Without a path or progress the robot tries again what failed
    /// before, as often as for frontiers; then there is no way.
    #[inline(never)]
    pub(crate) fn go_to<const TILES: usize, const SLOTS: usize>(
        &mut self,
        place: Cell,
        context: &PlanningContext<'_, TILES, SLOTS>,
        mut scratch: PlanningScratch<'_>,
    ) -> RoundOutcome {
        self.progress
            .note_motion(context.pose.point(), context.time_ms);
        (self.viewpoint, self.waits, self.goes_back) = (None, false, false);
        let may_stand = context.tiles.planned_class(place) == Class::Free
            && is_passable(context.tiles, context.footprint, place);
        let path = may_stand.then(|| path_to(place, context, &mut scratch));
        match path.flatten() {
            Some(path) => self.set_out(path.leading_to(place), context, scratch.local_grid),
            None if context.must_wait => {
                self.path.clear();
                RoundOutcome::Unsure
            }
            None if context.came_through_blocked => self.go_back_through_blocked(),
            None => self.do_without(),
        }
    }

    /// Follows the path to a place and judges the progress.
    fn set_out<const TILES: usize, const SLOTS: usize>(
        &mut self,
        path: Path,
        context: &PlanningContext<'_, TILES, SLOTS>,
        grid: &mut LocalGrid,
    ) -> RoundOutcome {
        self.path = path;
        let (goal, steps) = (self.path.goal(), self.path.steps());
        let verdict = self.progress.judge(goal, steps, context.time_ms);
        if matches!(verdict, Verdict::Drop(_)) {
            self.forget_path();
            return self.do_without();
        }
        self.block_passage(verdict, context, grid);
        self.go_on_or_retry(false)
    }
}
