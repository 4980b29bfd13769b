//! Looking: going to viewpoints once no frontier is within reach.
//!
//! A [`Viewpoint`] is a place from which the robot sees through a gap that it does not fit through.
//! It is given up if no path leads there, if a robot of the team that has finished is in the way,
//! or if the robot comes no nearer.
//!
//! Invariant: a run has at most `MOST_VIEWPOINTS` viewpoints, so it ends.
//! Units: map cells, coarse steps of 20 cm.

use crate::doing::Event;
use crate::field::local_grid::LocalGrid;
use crate::map::Class;
use crate::math;
use crate::path::context::STEP_M;
use crate::path::progress::Verdict;
use crate::path::search::path_to;
use crate::path::viewpoint::Viewpoint;
use crate::path::{Path, PlanningContext, PlanningScratch, RoundOutcome};
use crate::status::ResidualReason;
use crate::strategy::frontier::Frontier;

/// Maximum number of viewpoints in a run.
const MOST_VIEWPOINTS: u8 = 100;

impl Frontier {
    /// Returns true if another viewpoint may be searched for.
    pub(crate) fn may_look(&self) -> bool {
        self.viewpoints < MOST_VIEWPOINTS && !self.residual.is_full()
    }

    /// Goes to a viewpoint next.
    pub(crate) fn look_from(&mut self, viewpoint: Viewpoint) {
        (self.viewpoint, self.waits) = (Some(viewpoint), false);
        self.viewpoints = self.viewpoints.saturating_add(1);
        self.events.add(Event::FoundGap);
    }

    /// Goes to the viewpoint, as long as there is something to see from it, a path leads there, and
    /// no robot that has finished is in the way. `None` without such a viewpoint.
    ///
    /// Without the last condition searches for a way past the robot that has finished follow each
    /// other (measured: docs/MEASURED.md, "Viewpoints behind a robot that has finished").
    #[inline(never)]
    pub(super) fn look<const TILES: usize, const SLOTS: usize>(
        &mut self,
        context: &PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        let viewpoint = self.viewpoint.take()?;
        if context.tiles.class(viewpoint.beyond) != Class::Unknown {
            return None;
        }
        let along_centre = path_to(viewpoint.stand, context, scratch);
        let path = along_centre.map(|path| (path.steps(), path.leading_to(viewpoint.stand)));
        if path.is_none() {
            // The robot's place is cut off.
            self.progress.note_blocked(context.time_ms);
            self.blocked_here = true;
        }
        let Some((steps, path)) = path.filter(|(_, path)| !is_barred(path, context)) else {
            self.give_up(viewpoint.gap, ResidualReason::Unreachable);
            return self.stuck();
        };
        (self.viewpoint, self.path) = (Some(viewpoint), path);
        Some(self.go_and_look(viewpoint, steps, context, scratch.local_grid))
    }

    /// Goes on towards a viewpoint, which is `along_centre` steps away along centre cells, then
    /// straight on.
    fn go_and_look<const TILES: usize, const SLOTS: usize>(
        &mut self,
        viewpoint: Viewpoint,
        along_centre: u32,
        context: &PlanningContext<'_, TILES, SLOTS>,
        grid: &mut LocalGrid,
    ) -> RoundOutcome {
        let robot = context.pose.point();
        let straight_m = math::sqrt(viewpoint.stand.corner().distance2(robot));
        let steps = along_centre.max((straight_m / STEP_M) as u32);
        let verdict = self.progress.judge(viewpoint.stand, steps, context.time_ms);
        let reason = match verdict {
            Verdict::GoOn if !self.progress.is_stuck() => return RoundOutcome::Path,
            Verdict::GoOn => None,
            Verdict::Drop(reason) => Some(reason),
            Verdict::BlockAhead => Some(ResidualReason::Unreachable),
            // The stand can be reached, maybe by another way.
            Verdict::BlockUnreachable => None,
        };
        if let Some(reason) = reason {
            self.give_up(viewpoint.gap, reason);
            self.viewpoint = None;
        } else {
            self.block_passage(verdict, context, grid);
        }
        self.stuck().unwrap_or(RoundOutcome::Unsure)
    }

    /// Returns what follows if the robot is stuck.
    fn stuck(&mut self) -> Option<RoundOutcome> {
        self.progress
            .is_stuck()
            .then(|| match (self.only_looks, self.progress.moved()) {
                (true, false) => RoundOutcome::Stuck,
                _ => self.only_look(),
            })
    }
}

/// Returns true if a robot of the team that stands for good is in the way along a path.
fn is_barred<const TILES: usize, const SLOTS: usize>(
    path: &Path,
    context: &PlanningContext<'_, TILES, SLOTS>,
) -> bool {
    let places = path.cells().iter().map(|cell| cell.offset(1, 1).corner());
    let team = context.team;
    team.is_some_and(|team| team.bars(context.pose.point(), places))
}
