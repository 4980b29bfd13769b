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

mod bars;
mod leftovers;
mod roads;
mod starts;

use heapless::Vec;

use crate::field::local_grid::View;
use crate::geometry::{CELL_M, Cell, Point};
use crate::map::{Class, Tiles};
use crate::math;
use crate::path::Road;
use crate::path::height_levels::Levels;
use crate::path::progress::{Patience, Verdict};
use crate::path::viewpoint::Lookout;
use crate::roadmap::configuration_space::Disc;
use crate::roadmap::skeleton::Topology;
use crate::status::{Frontier as Leftover, Residue};
use crate::strategy::frontier::bars::{ahead, leak};
use crate::strategy::frontier::roads::road_to;

/// Goals dropped at the most; the list is the report's too.
pub const MOST_DROPPED: usize = 32;
/// Around a dropped goal no other is taken, metres.
const DROP_RADIUS_M: f32 = 0.5;
/// Ways barred at the most; what would need one more is no goal any more.
const MOST_BARS: usize = 8;
/// Around a bar the skeleton is cut, metres: the width of a door.
const BAR_RADIUS_M: f32 = 0.4;
/// A robot that goes its own way has come to a goal that is so many steps away.
const GLANCE_STEPS: u32 = 4;
/// Lookouts of a run at the most.
const MOST_LOOKOUTS: u8 = 100;
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

#[cfg(test)]
mod tests;
