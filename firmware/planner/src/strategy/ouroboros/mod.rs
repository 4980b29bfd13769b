//! Strategy *ouroboros*: explore, and close every loop on the way \[Jorge15, Algorithm 1\].
//!
//! | lines | what they do | where |
//! | --- | --- | --- |
//! | 3 | update the Voronoi cells | [`roadmap`](crate::roadmap), the space without obstacles |
//! | 4 | move the robot to the Voronoi | `PlanningContext::nearest` |
//! | 5–10 | move, disable or generate the tractor point | `tractor`, `closed_regions` |
//! | 12 | propagate from it, the robot as a blocker | `PlanningContext::propagate` |
//! | 13–16 | the loop road, past the previous shield if there is one | `loop_road` |
//! | 18 | the shield | `shield` |
//! | 20 | propagate from the tractor point, the shield as a blocker | `PlanningContext::path` |
//! | 23 | else propagate from the unexplored | `Frontier::replan` |
//! | 25 | none is left: complete, unless a loop is open | `revisit` |
//! | 26–28 | local goal, local potential, drive | [`planner`](crate::planner) |
//!
//! A round takes up to three calls of `advance` (more for line 25), each with one wave at most, all
//! on the same published skeleton. Between two calls nothing of the wave is needed, so its memory
//! is free for other uses.
//!
//! What is kept from round to round lies in cells of the map and not of the skeleton: tractor
//! point, shield, closed regions and path outlast any number of skeletons.
//!
//! Departs from \[Jorge15, Algorithm 1, line 17\], where a missing loop road ends the loop at once:
//! a loop is lost only after `lost_rounds` rounds in a row without loop road or shield, since a
//! skeleton may grow a spur under the robot for a moment. After as many lost loops the
//! next one is given up, or the robot might begin and lose the same loop for ever.
//!
//! Units: map cells, metres, milliseconds.

mod closed_regions;
mod closing;
mod loop_budget;
mod loop_road;
mod revisit;
mod shield;
mod tractor;

#[cfg(test)]
mod exploring;
#[cfg(test)]
mod scenes;

pub(crate) use closed_regions::{Closed, ClosedRegions, REGION_CELLS};
pub(crate) use shield::Shield;

use crate::config::OuroborosTuning;
use crate::geometry::{Cell, Pose};
use crate::grid::{Shifts, Site};
use crate::path::breadcrumbs::Crumbs;
use crate::path::context::STEP_M;
use crate::path::{PlanningContext, PlanningScratch, RoundOutcome};
use crate::strategy::Frontier;
use crate::strategy::ouroboros::loop_budget::LoopBudget;
use crate::strategy::ouroboros::revisit::Revisit;

/// The next part of Algorithm 1 in a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Lines 3 to 18.
    Look,
    /// Line 20, from the robot's centre cell.
    Close(Site),
    /// Line 23, or the drive of a revisit.
    Explore,
    /// Line 25: the search for an open loop.
    Search,
}

/// The state of the strategy. `SLOTS` as the map's.
#[derive(Debug)]
pub(crate) struct Ouroboros<const SLOTS: usize> {
    /// `previousTractorPoint`, a coarse cell.
    tractor: Option<Cell>,
    /// `previousShield`: a loop is being closed.
    shield: Option<Shield>,
    regions: ClosedRegions<SLOTS>,
    crumbs: Crumbs,
    budget: LoopBudget,
    /// Nothing is left to explore, and a loop may be open here.
    revisit: Option<Revisit>,
    /// Expected length of the loop, and of the back when it was begun, metres.
    loop_m: f32,
    back_m: f32,
    lost_rounds: u8,
    lost_loops: u8,
    stage: Stage,
    /// The robot's cell in the last step.
    robot: Option<Cell>,
    tally: Tally,
}

/// The numbers of loops that are over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    /// Loops closed: the robot reached the tractor point by the front.
    pub(crate) closed: u16,
    /// Loops given up: not worth closing any more, too long without an end, or lost too often.
    pub(crate) given_up: u16,
}

impl<const SLOTS: usize> Ouroboros<SLOTS> {
    /// The state at the start [line 1].
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self {
            tractor: None,
            shield: None,
            regions: ClosedRegions::new(),
            crumbs: Crumbs::new(),
            budget: LoopBudget::NEW,
            revisit: None,
            loop_m: 0.0,
            back_m: 0.0,
            lost_rounds: 0,
            lost_loops: 0,
            stage: Stage::Look,
            robot: None,
            tally: Tally {
                closed: 0,
                given_up: 0,
            },
        }
    }

    /// Returns the tractor point, a coarse cell.
    #[must_use]
    pub(crate) const fn tractor(&self) -> Option<Cell> {
        self.tractor
    }

    /// Returns the shield behind the robot. There is one while a loop is being closed, and its
    /// cells are obstacles of the window.
    #[must_use]
    pub(crate) const fn shield(&self) -> Option<&Shield> {
        self.shield.as_ref()
    }

    /// Returns the regions in which no new loop starts.
    #[must_use]
    pub(crate) const fn closed_regions(&self) -> &ClosedRegions<SLOTS> {
        &self.regions
    }

    /// Returns the numbers of loops that are over.
    #[must_use]
    pub(crate) const fn tally(&self) -> Tally {
        self.tally
    }

    /// Moves what lies in the map with its tiles. The round begins anew.
    pub(crate) fn correct(&mut self, shifts: Shifts<'_>, spare: &mut [u32]) {
        self.tractor = self.tractor.map(|at| shifts.moved_coarse(at));
        if let Some(shield) = &mut self.shield {
            shield.shift(shifts);
        }
        if let Some(revisit) = &mut self.revisit {
            revisit.goal = shifts.moved_coarse(revisit.goal);
        }
        self.regions.shift(shifts, spare);
        self.crumbs.shift(shifts);
        (self.robot, self.stage) = (None, Stage::Look);
    }

    /// Records the robot's pose; called in every step.
    pub(crate) fn note_pose(&mut self, pose: &Pose, tuning: &OuroborosTuning) {
        let robot = pose.point().cell();
        self.crumbs.note(robot);
        let last = self.robot.replace(robot);
        let stride_m = last.map_or(0.0, |last| last.distance_m(robot));
        if self.shield.is_some() {
            self.regions.add_pending(robot, tuning.near_cells);
            self.budget.note(stride_m, self.loop_m);
        } else if let Some(revisit) = &mut self.revisit {
            revisit.budget.note(stride_m, 0.0);
        }
    }

    /// Continues the round on the published skeleton; `None` if it needs another call on it.
    ///
    /// The first call of a round follows a new skeleton and [`Frontier::cut`]. The path, to the
    /// tractor point or to the unexplored, becomes that of `frontier`, which blocks passages and
    /// drops goals.
    ///
    /// It is not inlined, so that other strategies do not pay for its stack.
    #[inline(never)]
    pub(crate) fn advance<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        mut round: PlanningContext<'_, TILES, SLOTS>,
        mut scratch: PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        match core::mem::replace(&mut self.stage, Stage::Look) {
            Stage::Look => self.look(&mut round, &mut scratch),
            Stage::Close(robot) => self.close(frontier, &mut round, &mut scratch, robot),
            Stage::Explore if self.revisit.is_some() => {
                self.drive_to_revisit(frontier, &mut round, &mut scratch)
            }
            Stage::Explore => {
                let outcome = frontier.replan(&round, scratch);
                if outcome == RoundOutcome::Nothing {
                    self.stage = Stage::Search;
                    return None;
                }
                Some(outcome)
            }
            Stage::Search => self.search(&mut round, &mut scratch),
        }
    }

    /// Looks for an open loop on some branches, after line 25.
    #[inline(never)]
    fn search<const TILES: usize>(
        &mut self,
        round: &mut PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        self.stage = match revisit::find(round, &mut self.regions, scratch) {
            revisit::Found::None => return Some(RoundOutcome::Nothing),
            revisit::Found::NotHere => Stage::Search,
            revisit::Found::Place(goal) => {
                self.revisit = Some(Revisit::to(goal));
                Stage::Explore
            }
        };
        None
    }

    /// Follows the path to an open loop, on which a tractor point is made as anywhere else.
    #[inline(never)]
    fn drive_to_revisit<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        round: &mut PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        let mut revisit = self.revisit.take()?;
        let robot = round.nearest(round.pose.point().cell(), scratch);
        let goal = robot.and_then(|_| round.nearest(revisit.goal, scratch));
        let path = robot
            .zip(goal)
            .and_then(|(robot, goal)| round.path([robot, goal], core::iter::empty(), scratch));
        let path = path.filter(|path| {
            let is_over = revisit.is_over(path.steps(), round.limits);
            path.steps() as f32 * STEP_M > round.tuning.ouroboros.reached_m && !is_over
        });
        if let Some(path) = path {
            self.revisit = Some(revisit);
            return Some(frontier.follow(path, round, scratch.local_grid));
        }
        // No loop began on the drive here.
        revisit::settle(round, &mut self.regions, revisit.goal);
        self.stage = Stage::Search;
        None
    }
}
