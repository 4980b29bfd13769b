//! Strategy *frontier*: drive to a frontier along the skeleton, until none is left that can be
//! reached and is worth its trip \[Jorge15, Algorithm 1 without loop closing: lines 3, 4, 22–28\].
//!
//! Goals are chosen by gain over cost ([`crate::path::goal_choice`]); *nearest first*, the paper's
//! order, is the one with power 0. The progress checker gives up a goal that is reached and stays
//! unexplored, or that comes no nearer, and blocks a passage that cannot be driven; so no run hangs
//! on a cell that cannot be seen. A robot that blocked what it came through goes back along its
//! track if no other path is left. When no goal is left, everything that failed gets a *second
//! chance*. After that the robot looks from [`Viewpoint`]s at what it cannot drive to. At the end a
//! second look ([`SecondLook`]) tries what came in the way in the meantime.
//!
//! Units: map cells, coarse steps of 20 cm, milliseconds.

mod blocking;
mod chances;
mod correcting;
mod going;
mod looking;

use crate::doing::{Event, Events};
use crate::field::local_grid::LocalGrid;
use crate::geometry::Cell;
use crate::path::blocked_passages::BlockedPassages;
use crate::path::goal_choice::path_to_best;
use crate::path::goal_level::{PresentGoal, level};
use crate::path::progress::{ProgressChecker, Verdict};
use crate::path::residual_frontiers::ResidualFrontiers;
use crate::path::second_look::SecondLook;
use crate::path::viewpoint::Viewpoint;
use crate::path::{Path, PlanningContext, PlanningScratch, RoundOutcome};
use crate::roadmap::skeleton::Skeleton;
use crate::status::{ResidualFrontier, ResidualReason};

/// A robot that follows its own potential has reached a goal that is at most this many steps away.
const REACHED_STEPS: u32 = 4;

/// The state of the strategy.
#[derive(Debug)]
pub(crate) struct Frontier {
    path: Path,
    residual: ResidualFrontiers,
    blocked: BlockedPassages,
    progress: ProgressChecker,
    /// Goals that the last rounds judged in vain; more are left.
    judged: usize,
    second_chance: bool,
    /// Further second chances so far.
    retries: u8,
    /// The robot got stuck at both chances. It only looks from viewpoints until it has moved
    /// (measured: docs/MEASURED.md, "A robot that got stuck at both chances").
    only_looks: bool,
    /// The robot waits that what is in the way goes.
    waits: bool,
    /// The robot did not move during the second chance.
    immobile: bool,
    /// The present viewpoint, and the number of viewpoints so far.
    viewpoint: Option<Viewpoint>,
    viewpoints: u8,
    /// The robot stalled, and the passage ahead was blocked.
    stalled: bool,
    /// A passage was blocked from where the robot stands.
    blocked_here: bool,
    /// No path leads anywhere, and the robot goes back through a blocked passage.
    goes_back: bool,
    /// See [`PresentGoal::reference_m`].
    reference_m: f32,
    second_look: SecondLook,
    /// What happened since the last call of [`Self::take_events`].
    events: Events,
}

impl Frontier {
    /// Makes the state at the start.
    pub(crate) const fn new() -> Self {
        Self {
            path: Path::new(),
            residual: ResidualFrontiers::new(),
            blocked: BlockedPassages::new(),
            progress: ProgressChecker::new(),
            judged: 0,
            second_chance: false,
            retries: 0,
            only_looks: false,
            waits: false,
            immobile: false,
            viewpoint: None,
            viewpoints: 0,
            stalled: false,
            blocked_here: false,
            goes_back: false,
            reference_m: 0.0,
            second_look: SecondLook::new(),
            events: Events::NONE,
        }
    }

    /// Forgets everything.
    pub(crate) fn reset(&mut self) {
        *self = Self::new();
    }

    /// Returns the path to the present goal; empty if there is none.
    pub(crate) const fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the goals that were given up, with the reasons.
    pub(crate) fn residual_frontiers(&self) -> &[ResidualFrontier] {
        self.residual.as_slice()
    }

    /// Takes a goal that was reached and stayed unexplored off the list of those given up.
    pub(crate) fn take_unobservable(&mut self) -> Option<Cell> {
        self.residual.take_unobservable()
    }

    /// Returns what happened since the last call.
    pub(crate) const fn take_events(&mut self) -> Events {
        self.events.take()
    }

    /// Returns true if the path leads to a viewpoint.
    pub(crate) const fn goes_to_look(&self) -> bool {
        self.viewpoint.is_some()
    }

    /// Returns true if the robot stalled since the last call.
    pub(crate) const fn take_stalled(&mut self) -> bool {
        core::mem::replace(&mut self.stalled, false)
    }

    /// Returns the time since the robot last moved, milliseconds.
    pub(crate) const fn standing_ms(&self, time_ms: u32) -> u32 {
        self.progress.standing_ms(time_ms)
    }

    /// Returns true if the last round judged some goals in vain, and more are left.
    pub(crate) const fn judges_on(&self) -> bool {
        self.judged > 0
    }

    /// Notes that the robot waits for another one, which is not its failure.
    pub(crate) fn pause(&mut self, time_ms: u32) {
        self.progress.pause(time_ms);
    }

    /// Notes that in this period the robot was not asked to move.
    pub(crate) const fn hold(&mut self, period_ms: u32) {
        self.progress.hold(period_ms);
    }

    /// Plans a round on a new skeleton: takes the path to the frontier of the least cost \[Jorge15,
    /// Algorithm 1, lines 3, 4, 23\].
    pub(crate) fn replan<const TILES: usize, const SLOTS: usize>(
        &mut self,
        context: &PlanningContext<'_, TILES, SLOTS>,
        mut scratch: PlanningScratch<'_>,
    ) -> RoundOutcome {
        let path = self.find_path(context, &mut scratch);
        self.take(path, context, scratch)
    }

    /// Plans a round for a robot that follows its own potential while a frontier is left. Only a
    /// goal that the robot has reached is given up. Returns true as well if the robot may follow
    /// its own potential; false if it `is_late`.
    pub(super) fn replan_freely<const TILES: usize, const SLOTS: usize>(
        &mut self,
        context: &PlanningContext<'_, TILES, SLOTS>,
        mut scratch: PlanningScratch<'_>,
        is_late: bool,
    ) -> (RoundOutcome, bool) {
        let path = self.find_path(context, &mut scratch);
        let is_far = |path: &Path| path.steps() > REACHED_STEPS;
        match path {
            Some(path) if !is_late && is_far(&path) => {
                self.progress
                    .note_motion(context.pose.point(), context.time_ms);
                self.goes_back = false;
                self.choose(path, context);
                (RoundOutcome::Path, true)
            }
            path => {
                let is_free = !is_late && path.is_some();
                (self.take(path, context, scratch), is_free)
            }
        }
    }

    /// Continues after the end of the exploration, without a second chance.
    pub(super) fn go_on(&mut self) {
        (self.second_chance, self.retries) = (false, 0);
        (self.only_looks, self.waits) = (false, false);
        self.progress.begin_anew();
        self.path.clear();
    }

    /// Returns true if no path leads to some frontiers, and a second look may help.
    pub(crate) fn may_look_again(&mut self, known_cells: u32, time_ms: u32) -> bool {
        self.residual.has_unreachable() && self.second_look.begins(known_cells, time_ms)
    }

    /// Tries the frontiers again that no path led to.
    pub(crate) fn look_again(&mut self) {
        self.residual.retry_unreachable();
        self.waits = true;
        self.path.clear();
        self.events.add(Event::SecondLook);
    }

    /// Returns true if the robot waits that what is in the way goes.
    pub(crate) const fn is_waiting(&self) -> bool {
        self.waits
    }

    fn present_goal(&self) -> Option<PresentGoal> {
        (!self.path.is_empty()).then(|| PresentGoal {
            cell: self.path.goal(),
            reference_m: self.reference_m,
            shares_trip: self.path.shares_trip(),
        })
    }

    fn find_path<const TILES: usize, const SLOTS: usize>(
        &mut self,
        context: &PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<Path> {
        if self.only_looks && self.progress.moved() {
            (self.only_looks, self.immobile) = (false, false);
        }
        if self.only_looks {
            self.judged = 0;
            return None;
        }
        let present = self.present_goal();
        let (residual, judged) = (&mut self.residual, &mut self.judged);
        path_to_best(context, residual, present, judged, scratch)
    }

    /// Follows a path to a frontier. The present height becomes the goal's reference if the goal is
    /// a new one, or its level is no higher from here.
    fn choose<const TILES: usize, const SLOTS: usize>(
        &mut self,
        path: Path,
        context: &PlanningContext<'_, TILES, SLOTS>,
    ) {
        (self.viewpoint, self.waits) = (None, false);
        let goal = path.goal();
        if let Some(levels) = &context.levels
            && levels.of(context.tiles, goal) <= level(context, self.present_goal(), goal)
        {
            self.reference_m = levels.reference_m;
        }
        self.path = path;
    }

    /// Takes the path to a frontier and judges its progress. Without a path, goes to the viewpoint,
    /// or decides what to try next.
    fn take<const TILES: usize, const SLOTS: usize>(
        &mut self,
        path: Option<Path>,
        context: &PlanningContext<'_, TILES, SLOTS>,
        mut scratch: PlanningScratch<'_>,
    ) -> RoundOutcome {
        self.progress.note_known(context.known_cells);
        self.progress
            .note_motion(context.pose.point(), context.time_ms);
        self.goes_back = false;
        if let Some(path) = path {
            self.choose(path, context);
        } else if let Some(outcome) = self.look(context, &mut scratch) {
            return outcome;
        } else if context.must_wait || self.judged > 0 {
            self.path.clear();
            return RoundOutcome::Unsure;
        } else if context.came_through_blocked {
            return self.go_back_through_blocked();
        } else {
            return self.do_without();
        }
        let (goal, steps) = (self.path.goal(), self.path.steps());
        let verdict = self.progress.judge(goal, steps, context.time_ms);
        if let Verdict::Drop(reason) = verdict {
            self.give_up(goal, reason);
        }
        self.block_passage(verdict, context, scratch.local_grid);
        self.go_on_or_retry(self.residual.is_full())
    }

    /// Follows a path to another goal than a frontier in this round. The goal need not come nearer
    /// all the time. A passage that cannot be driven is blocked.
    pub(super) fn follow<const TILES: usize, const SLOTS: usize>(
        &mut self,
        path: Path,
        context: &PlanningContext<'_, TILES, SLOTS>,
        grid: &mut LocalGrid,
    ) -> RoundOutcome {
        self.progress
            .note_motion(context.pose.point(), context.time_ms);
        self.goes_back = false;
        self.path = path;
        let (goal, steps) = (self.path.goal(), self.path.steps());
        let verdict = self.progress.judge(goal, steps, context.time_ms);
        self.block_passage(verdict, context, grid);
        self.go_on_or_retry(false)
    }

    /// Returns the goals that were given up, for a search to add to, and the blocked passages.
    pub(crate) const fn given_up_mut(&mut self) -> (&mut ResidualFrontiers, &BlockedPassages) {
        (&mut self.residual, &self.blocked)
    }

    /// Notes that the local grid has no way along the path, although the coarser skeleton has one.
    pub(crate) fn note_closed(&mut self) {
        self.progress.note_closed();
    }

    /// Goes back through a passage that was blocked, along the track.
    fn go_back_through_blocked(&mut self) -> RoundOutcome {
        self.goes_back = true;
        self.path.clear();
        self.events.add(Event::BackThroughBlocked);
        RoundOutcome::Unsure
    }

    #[inline(never)]
    fn forget_path(&mut self) {
        self.progress.forget(self.path.goal());
        self.path.clear();
    }

    /// Gives up a goal: no other one is taken near it.
    fn give_up(&mut self, goal: Cell, reason: ResidualReason) {
        self.events.add(match reason {
            ResidualReason::Unobservable => Event::GoalSaysNothing,
            ResidualReason::NoProgress => Event::GoalNoNearer,
            _ => Event::NoPathToLook,
        });
        self.residual.give_up(goal, reason);
        self.forget_path();
    }

    /// Lists the frontier cells that no path leads to, in groups, after the goals given up.
    pub(crate) fn list_unreachable<const SLOTS: usize>(&mut self, skeleton: &Skeleton<SLOTS>) {
        self.residual.list_unreachable(skeleton);
    }

    /// Lists a cell beyond which the map has no room.
    pub(crate) fn list_map_exit(&mut self, cell: Cell) {
        self.residual.list_map_exit(cell);
    }
}

impl Default for Frontier {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
