//! Strategy *frontier*: go to the nearest unexplored centre cell along the skeleton, until none can be reached
//! [Jorge15, Algorithm 1 without loop closing: lines 3, 4, 23–28].
//!
//! The goal that the robot is on its way to has a head start in the wave, so that two equally near goals do not pull it to and
//! fro, and small frontiers start later than large ones. A goal that is reached and stays unexplored, or that comes no nearer, is dropped, with its reason; a way that cannot be
//! driven is barred (`ProgressChecker`); so no run hangs on a cell that cannot be seen. When nothing else is left, everything gets a
//! second chance, as for a robot that fits more narrowly: at 10 cm a cell, a gap that it just fits through may look closed.
//! Then what cannot be driven to is looked at from a [`Viewpoint`].
//!
//! Units: map cells, coarse steps of 20 cm, milliseconds.

mod bars;
mod leftovers;
mod paths;
mod starts;

use heapless::Vec;

use crate::field::local_grid::LocalGrid;
use crate::geometry::{CELL_M, Cell, Point};
use crate::map::Class;
use crate::math;
use crate::path::Path;
use crate::path::progress::{ProgressChecker, Verdict};
use crate::path::viewpoint::Viewpoint;
use crate::path::{PlanningContext, PlanningScratch, RoundOutcome};
use crate::roadmap::skeleton::Skeleton;
use crate::status::{Frontier as Leftover, Residue};
use crate::strategy::frontier::bars::{ahead, leak};
use crate::strategy::frontier::paths::path_to;

/// Goals dropped at the most; the list is the report's too.
pub const MOST_DROPPED: usize = 32;
/// GroundModel a dropped goal no other is taken, metres.
const DROP_RADIUS_M: f32 = 0.5;
/// Ways barred at the most; what would need one more is no goal any more.
const MOST_BARS: usize = 8;
/// GroundModel a bar the skeleton is cut, metres: the width of a door.
const BAR_RADIUS_M: f32 = 0.4;
/// A robot that goes its own way has come to a goal that is so many steps away.
const GLANCE_STEPS: u32 = 4;
/// Viewpoints of a run at the most.
const MOST_VIEWPOINTS: u8 = 100;
/// Rounds in a row that must find nothing before the exploration is over: noise may close a way for a moment.
const EMPTY_ROUNDS: u8 = 5;
/// Times that bars are lifted once more before that.
const MOST_LIFTED: u8 = 2;

/// What the strategy remembers.
#[derive(Debug)]
pub struct Frontier {
    path: Path,
    dropped: Vec<Leftover, MOST_DROPPED>,
    bars: Vec<Cell, MOST_BARS>,
    patience: ProgressChecker,
    empty_rounds: u8,
    second_chance: bool,
    /// Times that bars were lifted again since, on uneven ground.
    lifted: u8,
    /// It got wedged at both chances, and only looks any more.
    only_looks: bool,
    /// It had not moved before that since the second chance began.
    immobile: bool,
    /// Where the robot goes to see what it cannot drive to, and how many there were.
    viewpoint: Option<Viewpoint>,
    viewpoints: u8,
    /// It could not go on where it stood, and barred what lies ahead.
    stopped: bool,
    /// The storey from which the present goal is preferred most, of those that the robot was on since it took it, metres.
    storey_m: f32,
}

fn near(a: Cell, b: Cell, radius_m: f32) -> bool {
    let (dx, dy) = ((a.x - b.x) as f32 * CELL_M, (a.y - b.y) as f32 * CELL_M);
    dx * dx + dy * dy < radius_m * radius_m
}

impl Frontier {
    /// At the start.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            path: Path::new(),
            dropped: Vec::new(),
            bars: Vec::new(),
            patience: ProgressChecker::new(),
            empty_rounds: 0,
            second_chance: false,
            lifted: 0,
            only_looks: false,
            immobile: false,
            viewpoint: None,
            viewpoints: 0,
            stopped: false,
            storey_m: 0.0,
        }
    }

    /// Forget everything.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// The way to the present goal.
    #[must_use]
    pub const fn path(&self) -> &Path {
        &self.path
    }

    /// Goals that were given up, and why.
    #[must_use]
    pub fn dropped(&self) -> &[Leftover] {
        &self.dropped
    }

    /// A goal that was reached and stayed unexplored, taken off the list.
    pub fn take_unobserved(&mut self) -> Option<Cell> {
        let unobserved = |left: &Leftover| left.reason == Residue::Unobservable;
        let place = self.dropped.iter().position(unobserved)?;
        Some(self.dropped.remove(place).cell)
    }

    /// Whether the robot could not go on where it stands, since this was last asked.
    pub const fn take_stop(&mut self) -> bool {
        core::mem::replace(&mut self.stopped, false)
    }

    /// How long the robot has stood about where it stands, milliseconds.
    #[must_use]
    pub const fn standing_ms(&self, time_ms: u32) -> u32 {
        self.patience.standing_ms(time_ms)
    }

    /// What the last bar was put up for is gone.
    pub fn lift_bar(&mut self) {
        self.bars.pop();
    }

    /// Whether everything is tried a second time, more narrowly.
    #[must_use]
    pub const fn is_second_chance(&self) -> bool {
        self.second_chance
    }

    /// Cut the published skeleton where ways are barred.
    pub fn cut<const SLOTS: usize>(&self, topology: &mut Skeleton<SLOTS>) {
        for &bar in &self.bars {
            topology.cut(bar, BAR_RADIUS_M);
        }
    }

    /// A new skeleton is there: spread the wave from its frontier cells, move the robot to the skeleton, and walk down
    /// [Jorge15, Algorithm 1, lines 3, 4, 24]. It works in what is lent.
    pub fn replan<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &PlanningContext<'_, TILES, SLOTS>,
        robot: Point,
        time_ms: u32,
        mut lent: PlanningScratch<'_>,
    ) -> RoundOutcome {
        let path = self.find_path(known, robot, &mut lent);
        self.take(path, known, robot, time_ms, lent)
    }

    /// As [`Self::replan`], for a robot that goes its own way as long as something is left: nothing is dropped for want of progress,
    /// but what it has come to. Whether it may go its own way; not if it `is_late`.
    pub(super) fn glance<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &PlanningContext<'_, TILES, SLOTS>,
        robot: Point,
        time_ms: u32,
        mut lent: PlanningScratch<'_>,
        is_late: bool,
    ) -> (RoundOutcome, bool) {
        let path = self.find_path(known, robot, &mut lent);
        let is_far = |path: &Path| path.steps() > GLANCE_STEPS;
        match path {
            Some(path) if !is_late && is_far(&path) => {
                self.patience.note_motion(robot, time_ms);
                (self.viewpoint, self.empty_rounds) = (None, 0);
                self.note_storey(known, path.goal());
                self.path = path;
                (RoundOutcome::Path, true)
            }
            path => {
                let is_free = !is_late && path.is_some();
                (self.take(path, known, robot, time_ms, lent), is_free)
            }
        }
    }

    /// The exploration is over and the robot goes on: what it drives to needs no second chance.
    pub(super) fn go_on(&mut self) {
        (self.second_chance, self.lifted) = (false, 0);
        self.only_looks = false;
        self.patience.begin_next_try();
        self.path.clear();
    }

    /// Take the path, or do without.
    fn take<const TILES: usize, const SLOTS: usize>(
        &mut self,
        path: Option<Path>,
        known: &PlanningContext<'_, TILES, SLOTS>,
        robot: Point,
        time_ms: u32,
        mut lent: PlanningScratch<'_>,
    ) -> RoundOutcome {
        self.patience.note_motion(robot, time_ms);
        if let Some(path) = path {
            (self.viewpoint, self.empty_rounds) = (None, 0);
            self.note_storey(known, path.goal());
            self.path = path;
        } else if let Some((viewpoint, path)) = self.path_to_viewpoint(known, robot, &mut lent) {
            let along_centre = path.steps();
            self.path = path.leading_to(viewpoint.stand);
            return self.go_and_look(viewpoint, along_centre, robot, time_ms);
        } else {
            return self.do_without(known.levels.is_some());
        }
        match self
            .patience
            .judge(self.path.goal(), self.path.steps(), time_ms)
        {
            Verdict::GoOn => {}
            Verdict::Drop(reason) => self.drop_goal(reason),
            Verdict::BarLeak => self.bar(leak(&self.path, known, robot, lent.view)),
            Verdict::BarAhead => self.bar_ahead(robot),
        }
        let enough = self.patience.is_stuck() || self.dropped.is_full();
        match (enough, self.second_chance) {
            (false, _) => RoundOutcome::Path,
            (true, false) => self.begin_second_chance(),
            (true, true) => self.only_look(),
        }
    }

    /// What is left is behind gaps in which the robot cannot go on. Somewhere else there may be something to see.
    fn only_look(&mut self) -> RoundOutcome {
        self.only_looks = true;
        self.immobile = !self.patience.moved();
        self.patience.begin_next_try();
        self.path.clear();
        RoundOutcome::Nothing
    }

    /// Whether the robot could not move at any of its chances.
    #[must_use]
    pub const fn is_stuck(&self) -> bool {
        self.immobile
    }

    /// Whether it is worth while to search for another viewpoint.
    #[must_use]
    pub fn may_look(&self) -> bool {
        self.viewpoints < MOST_VIEWPOINTS && !self.dropped.is_full()
    }

    /// Whether a gap was looked through, or given up.
    #[must_use]
    pub fn is_gone(&self, gap: Cell) -> bool {
        self.dropped
            .iter()
            .any(|dropped| near(dropped.cell, gap, DROP_RADIUS_M))
    }

    /// See what is behind a gap.
    pub fn look_from(&mut self, viewpoint: Viewpoint) {
        self.viewpoint = Some(viewpoint);
        self.viewpoints = self.viewpoints.saturating_add(1);
    }

    /// On the way to a viewpoint, so many steps along centre cells and then straight, or at it.
    fn go_and_look(
        &mut self,
        viewpoint: Viewpoint,
        along_centre: u32,
        robot: Point,
        time_ms: u32,
    ) -> RoundOutcome {
        let stand = viewpoint.stand.corner();
        let (dx, dy) = (stand.x_m - robot.x_m, stand.y_m - robot.y_m);
        let straight = math::sqrt(dx * dx + dy * dy) / (2.0 * CELL_M);
        let steps = along_centre.max(straight as u32);
        let reason = match self.patience.judge(viewpoint.stand, steps, time_ms) {
            Verdict::GoOn => return RoundOutcome::Path,
            Verdict::Drop(reason) => reason,
            Verdict::BarLeak | Verdict::BarAhead => Residue::Unreachable,
        };
        self.give_up(viewpoint.gap, reason);
        self.viewpoint = None;
        match (self.patience.is_stuck(), self.only_looks) {
            (false, _) => RoundOutcome::Unsure,
            (true, false) => self.only_look(),
            (true, true) if self.patience.moved() => self.only_look(),
            (true, true) => RoundOutcome::Stuck,
        }
    }

    /// Follow a path to another goal in this round, one that does not become fewer steps away all the time. A way that
    /// cannot be driven is barred as on the path to a frontier; the goal is the caller's.
    pub(super) fn follow<const TILES: usize, const SLOTS: usize>(
        &mut self,
        path: Path,
        known: &PlanningContext<'_, TILES, SLOTS>,
        robot: Point,
        time_ms: u32,
        view: &mut LocalGrid,
    ) -> RoundOutcome {
        self.patience.note_motion(robot, time_ms);
        self.empty_rounds = 0;
        self.path = path;
        let (goal, steps) = (self.path.goal(), self.path.steps());
        match self.patience.judge(goal, steps, time_ms) {
            Verdict::GoOn | Verdict::Drop(_) => {}
            Verdict::BarLeak => self.bar(leak(&self.path, known, robot, view)),
            Verdict::BarAhead => self.bar_ahead(robot),
        }
        match (self.patience.is_stuck(), self.second_chance) {
            (false, _) => RoundOutcome::Path,
            (true, false) => self.begin_second_chance(),
            (true, true) => self.only_look(),
        }
    }

    /// The way to the viewpoint, as long as there is something to see from it.
    fn path_to_viewpoint<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &PlanningContext<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<(Viewpoint, Path)> {
        let viewpoint = self.viewpoint.take()?;
        if known.tiles.class(viewpoint.beyond) != Class::Unknown {
            return None;
        }
        let path = path_to(viewpoint.stand, known, robot, lent);
        if path.is_none() {
            self.give_up(viewpoint.gap, Residue::Unreachable);
        }
        self.viewpoint = path.is_some().then_some(viewpoint);
        Some((viewpoint, path?))
    }

    /// The robot cannot go on where it stands: what lies ahead is barred.
    fn bar_ahead(&mut self, robot: Point) {
        self.stopped = true;
        self.bar(ahead(&self.path, robot));
    }

    /// The window has no way from the robot to its local goal, though the skeleton, coarser, had one.
    pub fn note_flat(&mut self) {
        self.patience.note_flat();
    }

    /// No frontier is within reach.
    ///
    /// On uneven ground what is ahead is measured from near by, often from another side only, and a bar in the one way up shuts off everything
    /// above. So there bars are lifted some times more.
    fn do_without(&mut self, is_uneven: bool) -> RoundOutcome {
        self.path.clear();
        if !self.second_chance {
            return self.begin_second_chance();
        }
        if is_uneven && !self.bars.is_empty() && self.lifted < MOST_LIFTED {
            self.lifted += 1;
            return self.begin_second_chance();
        }
        self.empty_rounds = self.empty_rounds.saturating_add(1);
        if self.only_looks || self.empty_rounds >= EMPTY_ROUNDS {
            RoundOutcome::Nothing
        } else {
            RoundOutcome::Unsure
        }
    }

    fn begin_second_chance(&mut self) -> RoundOutcome {
        self.second_chance = true;
        self.patience.begin_next_try();
        self.bars.clear();
        self.dropped
            .retain(|dropped| dropped.reason != Residue::NoProgress);
        self.path.clear();
        RoundOutcome::Unsure
    }

    fn forget_path(&mut self) {
        self.patience.forget(self.path.goal());
        self.path.clear();
    }

    fn bar(&mut self, cell: Option<Cell>) {
        let cell = cell.unwrap_or(self.path.goal());
        match self.bars.push(cell) {
            Ok(()) => self.forget_path(),
            Err(_) => self.drop_goal(Residue::NoProgress),
        }
    }

    fn drop_goal(&mut self, reason: Residue) {
        self.give_up(self.path.goal(), reason);
    }

    /// Take nothing near this cell as a goal any more.
    fn give_up(&mut self, cell: Cell, reason: Residue) {
        if self.dropped.is_full() {
            self.dropped.remove(0);
        }
        // There is room now.
        let _ = self.dropped.push(Leftover {
            cell,
            cells: 1,
            reason,
        });
        self.forget_path();
    }
}

impl Default for Frontier {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
