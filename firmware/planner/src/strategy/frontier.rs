//! Strategy *frontier*: go to the nearest unexplored centre cell along the skeleton, until none can be reached
//! [Ouroboros, Algorithm 1 without loop closing: lines 3, 4, 23–28].
//!
//! The goal that the robot is on its way to has a head start in the wave, so that two equally near goals do not pull it to and
//! fro, and small frontiers start later than large ones. A goal that is reached and stays unexplored, or that comes no nearer, is dropped, with its reason; a way that cannot be
//! driven is barred (`Patience`); so no run hangs on a cell that cannot be seen. When nothing else is left, everything gets a
//! second chance, as for a robot that fits more narrowly: at 10 cm a cell, a gap that it just fits through may look closed.
//! Then what cannot be driven to is looked at from a [`Lookout`].
//!
//! Units: map cells, coarse steps of 20 cm, milliseconds.

use heapless::Vec;

use super::Road;
use super::lookout::Lookout;
use super::nearest::Centres;
use super::patience::{Patience, Verdict};
use crate::bits::{Adjacency, flood};
use crate::clearance::Disc;
use crate::field::SIDE;
use crate::geometry::{CELL_M, Cell, Point};
use crate::grid::{Plane, PlaneMut, Site};
use crate::map::{Class, Tiles};
use crate::math;
use crate::skeleton::{Residues, WaveSpace, Wavefront};
use crate::status::{Frontier as Leftover, Residue};
use crate::terrain::Levels;
use crate::terrain::storeys::{LATER_STEPS, MOST_LEVEL};
use crate::topology::{Frame, Topology};
use crate::view::{Rows, View};

/// Goals dropped at the most; the list is the report's too.
pub const MOST_DROPPED: usize = 32;
/// A road that leaves the storey by so many levels more than its goal does goes by another storey: 1 m with Table I's parameters.
const OTHER_STOREY: u32 = 4;
/// Around a dropped goal no other is taken, metres.
const DROP_RADIUS_M: f32 = 0.5;
/// Leftover cells this near are one group, metres.
const GROUP_RADIUS_M: f32 = 2.0;
/// Ways barred at the most; what would need one more is no goal any more.
const MOST_BARS: usize = 8;
/// Around a bar the skeleton is cut, metres: the width of a door.
const BAR_RADIUS_M: f32 = 0.4;
/// A robot that cannot go on is barred from its road this far ahead, metres: where its front meets what stops it.
const BAR_AHEAD_M: f32 = 0.5;
/// Head start of the present goal, coarse steps: what turning about costs.
const HEAD_START: u32 = 10;
/// A robot that goes its own way has come to a goal that is so many steps away.
const GLANCE_STEPS: u32 = 4;
/// Lookouts of a run at the most.
const MOST_LOOKOUTS: u8 = 100;
/// A frontier cell with fewer around it, within 2 cells and with itself, is a small one's: a corner, the foot of a wall.
const SMALL_COMPANY: u32 = 4;
/// By so many coarse steps a small frontier is as if farther away. The papers have all unexplored cells start at once; on the
/// built-in worlds, three seeds, the mean time to 99 % is thereby (seconds; 30 steps in the last column):
///
/// | | at once | 12 steps | 30 steps |
/// | --- | --- | --- | --- |
/// | office | 264 | 262 | 282 |
/// | cave | 99 | 98 | 98 |
/// | loop | 112 | 108 | 108 |
/// | cluttered | 67 | 61 | 61 |
/// | hall | 67 | 64 | 64 |
/// | narrow-doors | 83 | 78 | 78 |
const SMALL_LATER: u32 = 12;
/// How much later frontier cells start by their rank: beside the present goal, large, small.
const RANKS_LATER: [u32; 3] = [0, HEAD_START, HEAD_START + SMALL_LATER];
const _CHECKS: () = assert!(
    LATER_STEPS > HEAD_START + SMALL_LATER,
    "the ranks of a level start before the next level"
);
/// Rounds in a row that must find nothing before the exploration is over: noise may close a way for a moment.
const EMPTY_ROUNDS: u8 = 5;
/// Times that bars are lifted once more before that.
const MOST_LIFTED: u8 = 2;

/// What the strategy remembers.
#[derive(Debug)]
pub struct Frontier {
    road: Road,
    dropped: Vec<Leftover, MOST_DROPPED>,
    bars: Vec<Cell, MOST_BARS>,
    patience: Patience,
    empty_rounds: u8,
    second_chance: bool,
    /// Times that bars were lifted again since, on uneven ground.
    lifted: u8,
    /// It got wedged at both chances, and only looks any more.
    only_looks: bool,
    /// It had not moved before that since the second chance began.
    immobile: bool,
    /// Where the robot goes to see what it cannot drive to, and how many there were.
    lookout: Option<Lookout>,
    lookouts: u8,
    /// It could not go on where it stood, and barred what lies ahead.
    stopped: bool,
    /// The storey from which the present goal is preferred most, of those that the robot was on since it took it, metres.
    storey_m: f32,
}

/// What is known of the space, for a round of planning.
#[derive(Debug)]
pub struct Known<'a, const TILES: usize, const SLOTS: usize> {
    /// The published skeleton and its frontier.
    pub topology: &'a Topology<SLOTS>,
    /// The map.
    pub tiles: &'a Tiles<TILES, SLOTS>,
    /// The robot's disc.
    pub disc: &'a Disc,
    /// Which goals are preferred for their height, where any are.
    pub levels: Option<Levels<'a, TILES>>,
}

/// Scratch of a round of planning.
#[derive(Debug)]
pub struct Lent<'a> {
    /// The wave's distances, a pair for each word of the plane.
    pub residues: &'a mut [[u32; 2]],
    /// The wave's queue.
    pub ring: &'a mut [u32],
    /// The window in which the robot finds its centre cell.
    pub view: &'a mut View,
}

/// What a new round says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outlook {
    /// There is a way to a frontier.
    Road,
    /// None was found; the next round decides.
    Unsure,
    /// No frontier can be reached, and the last lookout is done with.
    Nothing,
    /// The robot cannot move, whatever the goal.
    Stuck,
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
            road: Road::new(),
            dropped: Vec::new(),
            bars: Vec::new(),
            patience: Patience::new(),
            empty_rounds: 0,
            second_chance: false,
            lifted: 0,
            only_looks: false,
            immobile: false,
            lookout: None,
            lookouts: 0,
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
    pub const fn road(&self) -> &Road {
        &self.road
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
    pub fn cut<const SLOTS: usize>(&self, topology: &mut Topology<SLOTS>) {
        for &bar in &self.bars {
            topology.cut(bar, BAR_RADIUS_M);
        }
    }

    /// A new skeleton is there: spread the wave from its frontier cells, move the robot to the skeleton, and walk down
    /// [Ouroboros, Algorithm 1, lines 3, 4, 24]. It works in what is lent.
    pub fn replan<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        time_ms: u32,
        mut lent: Lent<'_>,
    ) -> Outlook {
        let road = self.find_road(known, robot, &mut lent);
        self.take(road, known, robot, time_ms, lent)
    }

    /// As [`Self::replan`], for a robot that goes its own way as long as something is left: nothing is dropped for want of progress,
    /// but what it has come to. Whether it may go its own way; not if it `is_late`.
    pub(super) fn glance<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        time_ms: u32,
        mut lent: Lent<'_>,
        is_late: bool,
    ) -> (Outlook, bool) {
        let road = self.find_road(known, robot, &mut lent);
        let is_far = |road: &Road| road.steps() > GLANCE_STEPS;
        match road {
            Some(road) if !is_late && is_far(&road) => {
                self.patience.note_motion(robot, time_ms);
                (self.lookout, self.empty_rounds) = (None, 0);
                self.note_storey(known, road.goal());
                self.road = road;
                (Outlook::Road, true)
            }
            road => {
                let is_free = !is_late && road.is_some();
                (self.take(road, known, robot, time_ms, lent), is_free)
            }
        }
    }

    /// The exploration is over and the robot goes on: what it drives to needs no second chance.
    pub(super) fn go_on(&mut self) {
        (self.second_chance, self.lifted) = (false, 0);
        self.only_looks = false;
        self.patience.begin_next_try();
        self.road.clear();
    }

    /// Take the road, or do without.
    fn take<const TILES: usize, const SLOTS: usize>(
        &mut self,
        road: Option<Road>,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        time_ms: u32,
        mut lent: Lent<'_>,
    ) -> Outlook {
        self.patience.note_motion(robot, time_ms);
        if let Some(road) = road {
            (self.lookout, self.empty_rounds) = (None, 0);
            self.note_storey(known, road.goal());
            self.road = road;
        } else if let Some((lookout, road)) = self.road_to_lookout(known, robot, &mut lent) {
            let along_centre = road.steps();
            self.road = road.leading_to(lookout.stand);
            return self.go_and_look(lookout, along_centre, robot, time_ms);
        } else {
            return self.do_without(known.levels.is_some());
        }
        match self
            .patience
            .judge(self.road.goal(), self.road.steps(), time_ms)
        {
            Verdict::GoOn => {}
            Verdict::Drop(reason) => self.drop_goal(reason),
            Verdict::BarLeak => self.bar(leak(&self.road, known, robot, lent.view)),
            Verdict::BarAhead => self.bar_ahead(robot),
        }
        let enough = self.patience.is_stuck() || self.dropped.is_full();
        match (enough, self.second_chance) {
            (false, _) => Outlook::Road,
            (true, false) => self.begin_second_chance(),
            (true, true) => self.only_look(),
        }
    }

    /// What is left is behind gaps in which the robot cannot go on. Somewhere else there may be something to see.
    fn only_look(&mut self) -> Outlook {
        self.only_looks = true;
        self.immobile = !self.patience.moved();
        self.patience.begin_next_try();
        self.road.clear();
        Outlook::Nothing
    }

    /// Whether the robot could not move at any of its chances.
    #[must_use]
    pub const fn is_stuck(&self) -> bool {
        self.immobile
    }

    /// Whether it is worth while to search for another lookout.
    #[must_use]
    pub fn may_look(&self) -> bool {
        self.lookouts < MOST_LOOKOUTS && !self.dropped.is_full()
    }

    /// Whether a gap was looked through, or given up.
    #[must_use]
    pub fn is_gone(&self, gap: Cell) -> bool {
        self.dropped
            .iter()
            .any(|dropped| near(dropped.cell, gap, DROP_RADIUS_M))
    }

    /// See what is behind a gap.
    pub fn look_from(&mut self, lookout: Lookout) {
        self.lookout = Some(lookout);
        self.lookouts = self.lookouts.saturating_add(1);
    }

    /// On the way to a lookout, so many steps along centre cells and then straight, or at it.
    fn go_and_look(
        &mut self,
        lookout: Lookout,
        along_centre: u32,
        robot: Point,
        time_ms: u32,
    ) -> Outlook {
        let stand = lookout.stand.corner();
        let (dx, dy) = (stand.x_m - robot.x_m, stand.y_m - robot.y_m);
        let straight = math::sqrt(dx * dx + dy * dy) / (2.0 * CELL_M);
        let steps = along_centre.max(straight as u32);
        let reason = match self.patience.judge(lookout.stand, steps, time_ms) {
            Verdict::GoOn => return Outlook::Road,
            Verdict::Drop(reason) => reason,
            Verdict::BarLeak | Verdict::BarAhead => Residue::Unreachable,
        };
        self.give_up(lookout.gap, reason);
        self.lookout = None;
        match (self.patience.is_stuck(), self.only_looks) {
            (false, _) => Outlook::Unsure,
            (true, false) => self.only_look(),
            (true, true) if self.patience.moved() => self.only_look(),
            (true, true) => Outlook::Stuck,
        }
    }

    /// Follow a road to another goal in this round, one that does not become fewer steps away all the time. A way that
    /// cannot be driven is barred as on the road to a frontier; the goal is the caller's.
    pub(super) fn follow<const TILES: usize, const SLOTS: usize>(
        &mut self,
        road: Road,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        time_ms: u32,
        view: &mut View,
    ) -> Outlook {
        self.patience.note_motion(robot, time_ms);
        self.empty_rounds = 0;
        self.road = road;
        let (goal, steps) = (self.road.goal(), self.road.steps());
        match self.patience.judge(goal, steps, time_ms) {
            Verdict::GoOn | Verdict::Drop(_) => {}
            Verdict::BarLeak => self.bar(leak(&self.road, known, robot, view)),
            Verdict::BarAhead => self.bar_ahead(robot),
        }
        match (self.patience.is_stuck(), self.second_chance) {
            (false, _) => Outlook::Road,
            (true, false) => self.begin_second_chance(),
            (true, true) => self.only_look(),
        }
    }

    /// List the frontier cells that were never within reach, in groups, behind the goals that were dropped.
    pub fn list_leftovers<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &Known<'_, TILES, SLOTS>,
    ) {
        let Some(goals) = known.topology.frontier() else {
            return;
        };
        for site in goals.sites() {
            let cell = known.topology.frame().cell(site);
            self.list(cell, Residue::Unreachable);
        }
    }

    /// List a cell beyond which the map has no room; a goal dropped beside it was dropped for that.
    pub fn list_way_out(&mut self, cell: Cell) {
        if let Some(left) = self.list(cell, Residue::OutOfBounds) {
            left.reason = Residue::OutOfBounds;
        }
    }

    /// Count a cell to the group it is near to, or begin one.
    fn list(&mut self, cell: Cell, reason: Residue) -> Option<&mut Leftover> {
        let group = |left: &Leftover| near(left.cell, cell, GROUP_RADIUS_M);
        if let Some(k) = self.dropped.iter().position(group) {
            let left = self.dropped.get_mut(k)?;
            left.cells = left.cells.saturating_add(1);
            return Some(left);
        }
        let left = Leftover {
            cell,
            cells: 1,
            reason,
        };
        // A full list names enough of them.
        self.dropped.push(left).ok()?;
        self.dropped.last_mut()
    }

    /// The way to a goal; where heights are preferred, one that keeps to the storey if it is not much longer.
    fn find_road<const TILES: usize, const SLOTS: usize>(
        &self,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut Lent<'_>,
    ) -> Option<Road> {
        if self.only_looks {
            return None;
        }
        let way = known.topology.skeleton()?;
        let road = self.find_road_on(way, known, robot, lent)?;
        Some(
            self.keep_to_storey(&road, known, robot, lent)
                .unwrap_or(road),
        )
    }

    /// A way to a goal that leaves the storey no farther than the robot and the goal do, for a road that leaves it farther; if there is one
    /// that is no longer than what goals so far off the storey are put back by.
    fn keep_to_storey<const TILES: usize, const SLOTS: usize>(
        &self,
        road: &Road,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut Lent<'_>,
    ) -> Option<Road> {
        let levels = known.levels.as_ref()?;
        let level = |cell: Cell| levels.of(known.tiles, cell);
        let least = level(road.goal()).max(1);
        let most = road.cells().iter().copied().map(level).max()?;
        let excess = most
            .checked_sub(least)
            .filter(|&excess| excess >= OTHER_STOREY)?;
        let frame = known.topology.frame();
        // A map so large that the way does not fit behind the wave has to do with the shortest road.
        let (residues, spare) = lent.residues.split_at_mut_checked(frame.shape.words())?;
        let mut on_storey = PlaneMut::new(frame.shape, spare.as_flattened_mut()).ok()?;
        on_storey.fill(0);
        for site in known.topology.skeleton()?.sites() {
            if level(frame.cell(site)) <= least {
                on_storey.set(site);
            }
        }
        let mut lent = Lent {
            residues,
            ring: &mut *lent.ring,
            view: &mut *lent.view,
        };
        let detour = self.find_road_on(on_storey.view(), known, robot, &mut lent)?;
        (detour.steps() <= road.steps() + LATER_STEPS * excess).then_some(detour)
    }

    /// The way to a goal along these centre cells.
    fn find_road_on<const TILES: usize, const SLOTS: usize>(
        &self,
        way: Plane<'_>,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut Lent<'_>,
    ) -> Option<Road> {
        let frame = known.topology.frame();
        let goals = known.topology.frontier()?;
        let residues = Residues::new(frame.shape, &mut *lent.residues).ok()?;
        let mut space = WaveSpace {
            way,
            residues,
            ring: &mut *lent.ring,
        };
        if !self.spread(&mut space, goals, known) {
            return None;
        }
        let centres = Centres {
            tiles: known.tiles,
            disc: known.disc,
            frame,
            way,
        };
        let is_reached = |site| space.residues.get(site).is_some();
        let robot = robot.cell();
        let Some((entry, steps)) = centres.nearest(robot, lent.view, is_reached) else {
            // With a centre cell near by that no wave reached, there is no way.
            if centres.nearest(robot, lent.view, |_| true).is_some() {
                return None;
            }
            let (entry, line) = centres.nearest_by_air(robot, is_reached)?;
            return Some(walk_down(&space, frame, known.tiles, line, entry));
        };
        let at_once = core::iter::empty();
        Some(walk_down(&space, frame, known.tiles, at_once, entry).after(steps))
    }

    /// The way to the lookout, as long as there is something to see from it.
    fn road_to_lookout<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut Lent<'_>,
    ) -> Option<(Lookout, Road)> {
        let lookout = self.lookout.take()?;
        if known.tiles.class(lookout.beyond) != Class::Unknown {
            return None;
        }
        let road = road_to(lookout.stand, known, robot, lent);
        if road.is_none() {
            self.give_up(lookout.gap, Residue::Unreachable);
        }
        self.lookout = road.is_some().then_some(lookout);
        Some((lookout, road?))
    }

    /// Wave from every frontier cell that was not dropped; those beside the present goal first, and those on another storey last. Whether
    /// there are any.
    fn spread<const TILES: usize, const SLOTS: usize>(
        &self,
        space: &mut WaveSpace<'_>,
        goals: Plane<'_>,
        known: &Known<'_, TILES, SLOTS>,
    ) -> bool {
        let mut any = false;
        let mut wave = Wavefront::new();
        wave.start(space);
        let level = |cell| self.level_of(known, cell);
        let frame = known.topology.frame();
        let present = goals
            .sites()
            .fold(0_u32, |levels, site| levels | 1 << level(frame.cell(site)));
        let mut now = 0;
        for turn in (0..=MOST_LEVEL).filter(|turn| present >> turn & 1 == 1) {
            // Ranks that were met; the first is gone through in any case.
            let mut ranks = 1;
            for (rank, later) in RANKS_LATER.into_iter().enumerate() {
                if ranks >> rank & 1 == 0 {
                    continue;
                }
                let start = turn * LATER_STEPS + later;
                wave.advance_levels(space, start - now);
                now = start;
                for site in goals.sites() {
                    let cell = frame.cell(site);
                    if level(cell) == turn
                        && let Some(its_rank) = self.rank(goals, site, cell)
                    {
                        ranks |= 1 << its_rank;
                        any |= its_rank == rank && wave.seed(space, site);
                    }
                }
            }
        }
        // Without a budget it always comes to its end.
        let _ = wave.advance(space, None, u32::MAX);
        any
    }

    /// How much later a frontier cell starts for its height. The present goal counts by the storey from which it is preferred most, of those
    /// that the robot was on since it took it: on its way it crosses others, and what is preferred from there would turn it about, and from beyond them
    /// again. So steps and level of the present goal together only become fewer, and no two goals draw the robot to and fro. A goal that recedes up or
    /// down a slope is judged by its height where it is now.
    fn level_of<const TILES: usize, const SLOTS: usize>(
        &self,
        known: &Known<'_, TILES, SLOTS>,
        cell: Cell,
    ) -> u32 {
        let Some(levels) = &known.levels else {
            return 0;
        };
        let level = levels.of(known.tiles, cell);
        if level > 0 && self.is_present(cell) {
            level.min(levels.from(self.storey_m).of(known.tiles, cell))
        } else {
            level
        }
    }

    /// A goal is taken, or kept: from here if it is another one, or no less preferred from here.
    fn note_storey<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &Known<'_, TILES, SLOTS>,
        goal: Cell,
    ) {
        let Some(levels) = &known.levels else {
            return;
        };
        if !self.is_present(goal) || levels.of(known.tiles, goal) <= self.level_of(known, goal) {
            self.storey_m = levels.storey_m;
        }
    }

    /// Whether a cell is beside the present goal.
    fn is_present(&self, cell: Cell) -> bool {
        !self.road.is_empty() && near(self.road.goal(), cell, 2.0 * DROP_RADIUS_M)
    }

    /// In which order frontier cells of one storey start; `None` for one that was dropped.
    fn rank(&self, goals: Plane<'_>, site: Site, cell: Cell) -> Option<usize> {
        if self.is_gone(cell) {
            None
        } else if self.is_present(cell) {
            Some(0)
        } else {
            Some(1 + usize::from(company(goals, site) < SMALL_COMPANY))
        }
    }

    /// The robot cannot go on where it stands: what lies ahead is barred.
    fn bar_ahead(&mut self, robot: Point) {
        self.stopped = true;
        self.bar(ahead(&self.road, robot));
    }

    /// The window has no way from the robot to its local goal, though the skeleton, coarser, had one.
    pub fn note_flat(&mut self) {
        self.patience.note_flat();
    }

    /// No frontier is within reach.
    ///
    /// On uneven ground what is ahead is measured from near by, often from another side only, and a bar in the one way up shuts off everything
    /// above. So there bars are lifted some times more.
    fn do_without(&mut self, is_uneven: bool) -> Outlook {
        self.road.clear();
        if !self.second_chance {
            return self.begin_second_chance();
        }
        if is_uneven && !self.bars.is_empty() && self.lifted < MOST_LIFTED {
            self.lifted += 1;
            return self.begin_second_chance();
        }
        self.empty_rounds = self.empty_rounds.saturating_add(1);
        if self.only_looks || self.empty_rounds >= EMPTY_ROUNDS {
            Outlook::Nothing
        } else {
            Outlook::Unsure
        }
    }

    fn begin_second_chance(&mut self) -> Outlook {
        self.second_chance = true;
        self.patience.begin_next_try();
        self.bars.clear();
        self.dropped
            .retain(|dropped| dropped.reason != Residue::NoProgress);
        self.road.clear();
        Outlook::Unsure
    }

    fn forget_road(&mut self) {
        self.patience.forget(self.road.goal());
        self.road.clear();
    }

    fn bar(&mut self, cell: Option<Cell>) {
        let cell = cell.unwrap_or(self.road.goal());
        match self.bars.push(cell) {
            Ok(()) => self.forget_road(),
            Err(_) => self.drop_goal(Residue::NoProgress),
        }
    }

    fn drop_goal(&mut self, reason: Residue) {
        self.give_up(self.road.goal(), reason);
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
        self.forget_road();
    }
}

impl Default for Frontier {
    fn default() -> Self {
        Self::new()
    }
}

/// Frontier cells in the square of five by five around one.
fn company(goals: Plane<'_>, site: Site) -> u32 {
    let (word, bit) = (usize::from(site.x / 32), site.x % 32);
    (0..5)
        .filter_map(|dy| (usize::from(site.y) + dy).checked_sub(2))
        .map(|row| {
            let before = word.checked_sub(1).map_or(0, |word| goals.word(row, word));
            let after = goals.word(row, word + 1);
            let wide = u64::from(before >> 30)
                | u64::from(goals.word(row, word)) << 2
                | u64::from(after & 3) << 34;
            (wide >> bit & 0x1f).count_ones()
        })
        .sum()
}

/// The first cell of the road that the window's passable cells do not lead to.
fn leak<const TILES: usize, const SLOTS: usize>(
    road: &Road,
    known: &Known<'_, TILES, SLOTS>,
    robot: Point,
    view: &mut View,
) -> Option<Cell> {
    view.look_around(known.tiles, known.disc, robot.cell(), 1);
    view.free_robot(robot.cell());
    let mut reached: Rows = [0; SIDE];
    View::put(&mut reached, view.place(robot.cell())?);
    // With no target it floods everything.
    let _ = flood(&view.passable, &mut reached, &[0; SIDE], Adjacency::Four);
    let mut wet: Rows = [0; SIDE];
    road.cells().iter().copied().find(|&cell| {
        wet.fill(0);
        view.mark(&mut wet, cell);
        wet.iter()
            .zip(&reached)
            .all(|(cell, reached)| cell & reached == 0)
    })
}

/// The first cell of the road that is as far ahead of the robot as what stops it.
fn ahead(road: &Road, robot: Point) -> Option<Cell> {
    let robot = robot.cell();
    road.cells()
        .iter()
        .copied()
        .find(|&cell| !near(cell, robot, BAR_AHEAD_M))
}

/// The road to the centre cell nearest to a place.
fn road_to<const TILES: usize, const SLOTS: usize>(
    place: Cell,
    known: &Known<'_, TILES, SLOTS>,
    robot: Point,
    lent: &mut Lent<'_>,
) -> Option<Road> {
    let frame = known.topology.frame();
    let way = known.topology.skeleton()?;
    let residues = Residues::new(frame.shape, &mut *lent.residues).ok()?;
    let mut space = WaveSpace {
        way,
        residues,
        ring: &mut *lent.ring,
    };
    let centres = Centres {
        tiles: known.tiles,
        disc: known.disc,
        frame,
        way,
    };
    let (nearest, _) = centres.nearest(place, lent.view, |_| true)?;
    let mut wave = Wavefront::new();
    wave.start(&mut space);
    wave.seed(&mut space, nearest);
    // Without a budget it always comes to its end.
    let _ = wave.advance(&mut space, None, u32::MAX);
    let is_reached = |site| space.residues.get(site).is_some();
    let (entry, steps) = centres.nearest(robot.cell(), lent.view, is_reached)?;
    let way = core::iter::once(entry).chain(space.residues.descent(entry));
    Some(Road::along(way.map(|site| frame.cell(site))).after(steps))
}

/// The road from the cells before the entry to the frontier, and one cell into the unexplored beyond it.
fn walk_down<const TILES: usize, const SLOTS: usize>(
    space: &WaveSpace<'_>,
    frame: Frame,
    tiles: &Tiles<TILES, SLOTS>,
    before: impl Iterator<Item = Cell>,
    entry: Site,
) -> Road {
    let way = core::iter::once(entry).chain(space.residues.descent(entry));
    let mut last = entry;
    let cells = way.map(|site| {
        last = site;
        frame.cell(site)
    });
    let mut road = Road::along(before.chain(cells));
    road.extend(unexplored_beside(frame.cell(last), tiles));
    road
}

/// The coarse cell beside `cell` in which most was never measured.
fn unexplored_beside<const TILES: usize, const SLOTS: usize>(
    cell: Cell,
    tiles: &Tiles<TILES, SLOTS>,
) -> Option<Cell> {
    let unknown = |cell: Cell| {
        (0..2)
            .map(|dy| (tiles.row(cell.x, cell.y + dy).unknown() & 3).count_ones())
            .sum::<u32>()
    };
    [(2, 0), (-2, 0), (0, 2), (0, -2)]
        .into_iter()
        .map(|(dx, dy)| Cell {
            x: cell.x + dx,
            y: cell.y + dy,
        })
        .max_by_key(|&beside| unknown(beside))
        .filter(|&beside| unknown(beside) > 0)
}

#[cfg(test)]
mod tests;
