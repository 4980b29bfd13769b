//! Strategy *tdbvp*: time-driven rails \[Maffei14, IV and V\].
//!
//! The robot follows −∇p in a window in which every centre cell is charged: with the time since its
//! last visit (eq. 3), or as the best goal if it was never visited. So the robot prefers the
//! unexplored to the visited and the oldest visit to the newest, turns to the side where it passed
//! openings, and never comes to rest: when all is explored it patrols, for as long as the session
//! asks.
//!
//! If a rail ends in the window, or none attracts the robot, it follows a *path*: to the nearest
//! unexplored cell along the skeleton, on patrol to the oldest rail, and to the skeleton itself if
//! the robot is off it \[Maffei14, VII: the nearest rail, else the unexplored, else the skeleton\].
//!
//! Departs from the paper:
//! - (IV) The unexplored is a goal only until [`Frontier`] drops it, and a robot that lingers
//!   follows a path for a while. The paper has no rule for what cannot be seen: the robot would
//!   stand before it.
//! - (IV) A robot that has visited no new place for the session's `impatience_s`, while something
//!   is left to explore, follows a path. The paper relies on its rails to lead there in the end; so
//!   does a session without `impatience_s`.
//! - (IV) On patrol the robot follows a path to a rail that is overdue. The rails lead to the
//!   oldest one in the window, and one beyond may wait for ever. With paths the age of the oldest
//!   is bounded by a tour of everything and the way there.
//!
//! Units: map cells, metres, milliseconds.

mod charges;
mod pending_visits;
mod rails;
mod sides;

#[cfg(test)]
mod scenes;

pub(crate) use rails::{PLACE_CELLS, Rails};

use crate::clock::since;
use crate::config::TdbvpTuning;
use crate::field::local_grid::LocalGrid;
use crate::field::{Preference, SIDE, Window};
use crate::geometry::{CELL_M, Cell, Point, Pose};
use crate::grid::Shifts;
use crate::path::nearest::Centres;
use crate::path::search::PathSearch;
use crate::path::{Path, PlanningContext, PlanningScratch, RoundOutcome};
use crate::robot::LaserMount;
use crate::strategy::Frontier;
use crate::strategy::tdbvp::charges::{charge_rails, distance_m, has_fork, prefer, unexplored};
use crate::strategy::tdbvp::pending_visits::PendingVisits;
use crate::strategy::tdbvp::sides::SideVotes;

/// The state of the strategy. `SLOTS` as the map's.
#[derive(Debug)]
pub(crate) struct Tdbvp<const SLOTS: usize> {
    rails: Rails<SLOTS>,
    pending: PendingVisits,
    votes: SideVotes,
    /// The robot follows a path and not the rails.
    on_path: bool,
    now_ms: u32,
    /// Time of the last first visit to a place.
    new_place_ms: u32,
    /// Where and when the robot began to stay.
    stay: Point,
    stay_ms: u32,
    lingers: bool,
    /// The robot has lingered since the last first visit to a place.
    has_lingered: bool,
    /// Time without a new place after which the robot follows a path; `None` for never.
    impatience_ms: Option<u32>,
    /// Time from one step to the next.
    period_ms: u32,
    /// Length of the patrol, and its begin.
    patrol_ms: u32,
    patrol_since_ms: Option<u32>,
}

impl<const SLOTS: usize> Tdbvp<SLOTS> {
    /// The state at the start, for steps of `period_ms`, a patrol of `patrol_s` seconds, and a path
    /// after `impatience_s` seconds without a new place.
    #[must_use]
    pub(crate) const fn new(
        period_ms: u32,
        patrol_s: u16,
        impatience_s: Option<u16>,
        tuning: &TdbvpTuning,
    ) -> Self {
        Self {
            rails: Rails::new(tuning.first_tick_ms, period_ms),
            pending: PendingVisits::new(),
            votes: SideVotes::NEW,
            on_path: false,
            now_ms: 0,
            new_place_ms: 0,
            stay: Point::ORIGIN,
            stay_ms: 0,
            lingers: false,
            has_lingered: false,
            impatience_ms: match impatience_s {
                Some(seconds) => Some(seconds as u32 * 1000),
                None => None,
            },
            period_ms,
            patrol_ms: patrol_s as u32 * 1000,
            patrol_since_ms: None,
        }
    }

    /// Returns the stamps of the last visits.
    #[must_use]
    pub(crate) const fn rails(&self) -> &Rails<SLOTS> {
        &self.rails
    }

    /// Moves what lies in the map with its tiles.
    pub(super) fn correct(&mut self, shifts: Shifts<'_>, spare: &mut [u32]) {
        self.pending.correct(shifts, &mut self.rails);
        self.rails.shift(shifts, spare);
    }

    /// Returns true if the exploration is over and the robot patrols.
    pub(super) const fn is_patrolling(&self) -> bool {
        self.patrol_since_ms.is_some()
    }

    /// Ends the exploration. Returns true if a patrol begins.
    pub(super) fn begin_patrol(&mut self) -> bool {
        let begins = self.patrol_ms > 0 && !self.is_patrolling();
        if begins {
            self.patrol_since_ms = Some(self.now_ms);
            // The robot stood for the last search: that is not lingering.
            (self.stay_ms, self.lingers) = (self.now_ms, false);
            self.pending.begin_patrol(&mut self.rails);
        }
        begins
    }

    /// Records the robot's pose, and the scan of the level laser; called in every step.
    pub(super) fn note(
        &mut self,
        pose: &Pose,
        time_ms: u32,
        scan: Option<(&LaserMount, &[u16])>,
        tuning: &TdbvpTuning,
    ) {
        self.now_ms = time_ms;
        self.rails.step();
        if let Some((laser, ranges_mm)) = scan {
            self.votes.note(laser, ranges_mm, tuning);
        }
        let here = pose.point();
        self.pending.note(here.cell());
        if here.distance2(self.stay) > tuning.linger_m * tuning.linger_m {
            (self.stay, self.stay_ms) = (here, time_ms);
        } else if since(time_ms, self.stay_ms) > tuning.linger_ms {
            self.stay_ms = time_ms;
            self.lingers = true;
        }
    }

    /// Charges the window with the rails. Returns false if the robot follows a path instead, or the
    /// rails lead it nowhere.
    pub(super) fn charge<const TILES: usize>(
        &mut self,
        frontier: &Frontier,
        centres: &Centres<'_, TILES, SLOTS>,
        robot: Point,
        (window, grid): (&mut Window, &LocalGrid),
        tuning: &TdbvpTuning,
    ) -> bool {
        self.visit(centres, robot, tuning);
        window.set_preferences(|_, _| Preference::NONE);
        if self.on_path {
            return false;
        }
        let (free_m, goals) = if self.is_patrolling() {
            (tuning.visit_m, [0; SIDE])
        } else {
            let dropped = frontier.residual_frontiers().iter().map(|goal| goal.cell);
            let goals = unexplored(grid, centres.tiles, dropped, tuning.dropped_cells);
            (tuning.free_m, goals)
        };
        let visits = (&self.rails, &self.pending);
        charge_rails(window, grid, visits, centres, (robot, free_m), &goals);
        let ahead = self.pending.ahead(robot.cell(), tuning.disc_m);
        let preferred = self.votes.preferred().zip(ahead);
        if let Some(preferred) = preferred.filter(|_| has_fork(centres, robot, tuning.disc_m)) {
            prefer(window, grid, robot, preferred, tuning);
        }
        grid.place(robot.cell())
            .is_some_and(|(x, y)| window.is_reached(x, y))
    }

    /// Visits the centre cells beside the robot.
    fn visit<const TILES: usize>(
        &mut self,
        centres: &Centres<'_, TILES, SLOTS>,
        robot: Point,
        tuning: &TdbvpTuning,
    ) {
        let radius_m = if self.lingers {
            tuning.linger_visit_m
        } else {
            tuning.visit_m
        };
        let is_patrolling = self.is_patrolling();
        let (rails, pending) = (&mut self.rails, &mut self.pending);
        let robot_away = (robot.cell(), tuning.away_m);
        pending.leave(robot_away, rails, is_patrolling, |middle, half, visit| {
            centres.for_each_in_square(middle, half, |_, cell| visit(cell));
        });
        let mut is_new = false;
        let half = (radius_m / CELL_M) as i32 + 2;
        centres.for_each_in_square(robot.cell(), half, |_, cell| {
            if distance_m(cell, robot) <= radius_m {
                is_new |= pending.visit(cell, rails);
            }
        });
        if self.lingers {
            pending.write_all(rails);
            (self.lingers, self.has_lingered) = (false, true);
        } else if is_new {
            (self.new_place_ms, self.has_lingered) = (self.now_ms, false);
        }
    }

    /// Plans a round on a new skeleton: finds out if anything is left, and the path to it in case
    /// the rails lead nowhere.
    ///
    /// It is not inlined, so that other strategies do not pay for its stack.
    #[inline(never)]
    pub(super) fn advance<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        mut round: PlanningContext<'_, TILES, SLOTS>,
        mut scratch: PlanningScratch<'_>,
    ) -> RoundOutcome {
        let visits = self.stamps(&round).filter(|&stamp| stamp > 0);
        self.rails.set_oldest(visits.min());
        if let Some(since_ms) = self.patrol_since_ms {
            let patrolled_ms = since(round.time_ms, since_ms);
            if patrolled_ms >= self.patrol_ms {
                return RoundOutcome::Nothing;
            }
            return self.patrol(frontier, &mut round, &mut scratch, patrolled_ms);
        }
        let is_late = self.is_late(round.time_ms);
        let (outcome, is_free) = frontier.replan_freely(&round, scratch, is_late);
        // What remains for the second chance is where the robot only just fits through.
        self.on_path = !is_free || frontier.has_second_chance();
        outcome
    }

    /// Returns the stamps of all centre cells.
    fn stamps<const TILES: usize>(
        &self,
        round: &PlanningContext<'_, TILES, SLOTS>,
    ) -> impl Iterator<Item = u8> {
        let centres = round.centres();
        let sites = centres
            .into_iter()
            .flat_map(|centres| centres.cells.sites());
        sites.map(|site| self.stamp(round.skeleton.frame().cell(site)))
    }

    /// Returns true if the robot follows a path rather than the rails: it lingered, or has visited
    /// no new place for too long.
    fn is_late(&self, time_ms: u32) -> bool {
        let waited_ms = since(time_ms, self.new_place_ms);
        self.has_lingered
            || self
                .impatience_ms
                .is_some_and(|most_ms| waited_ms >= most_ms)
    }

    /// Plans a round of the patrol: the path to the oldest rail, which the robot follows if the
    /// rail is overdue or the rails lead nowhere.
    #[inline(never)]
    fn patrol<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        round: &mut PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
        patrolled_ms: u32,
    ) -> RoundOutcome {
        let oldest = self.oldest(round, patrolled_ms);
        let path = oldest.and_then(|(oldest, _)| self.path_to(oldest, round, scratch));
        self.on_path = path.is_some() && oldest.is_some_and(|(_, is_overdue)| is_overdue);
        let Some(path) = path else {
            return RoundOutcome::Unsure;
        };
        match frontier.follow(path, round, scratch.local_grid) {
            RoundOutcome::Path => RoundOutcome::Path,
            // There is always another rail.
            _ => {
                frontier.go_on();
                RoundOutcome::Unsure
            }
        }
    }

    /// Returns the stamp of the oldest rails, and true if they are overdue: not visited for as long
    /// as a tour of all takes at least.
    fn oldest<const TILES: usize>(
        &self,
        round: &PlanningContext<'_, TILES, SLOTS>,
        patrolled_ms: u32,
    ) -> Option<(u8, bool)> {
        let cell_ms = round.tuning.tdbvp.tour_cell_ms;
        let tour_ms = cell_ms.saturating_mul(self.stamps(round).count() as u32);
        // The never visited come first. Those not visited in a whole tour cannot be reached.
        let is_first_tour = patrolled_ms < tour_ms;
        let stamps = self.stamps(round);
        let oldest = stamps.filter(|&stamp| is_first_tour || stamp > 0).min()?;
        Some((oldest, self.is_overdue(oldest, tour_ms)))
    }

    /// Returns true if rails with a stamp were not visited for as long as a tour of all takes.
    fn is_overdue(&self, stamp: u8, tour_ms: u32) -> bool {
        stamp == 0 || self.rails.age_steps(stamp) > tour_ms / self.period_ms
    }

    /// Returns the stamp of a centre cell; the newest for one that the robot is visiting.
    fn stamp(&self, cell: Cell) -> u8 {
        if self.pending.holds(cell) {
            u8::MAX
        } else {
            self.rails.stamp(cell)
        }
    }

    /// Returns the path along the skeleton to the nearest centre cell with a stamp.
    fn path_to<const TILES: usize>(
        &self,
        stamp: u8,
        round: &PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<Path> {
        let centres = round.centres()?;
        let has_stamp = |site: &_| self.stamp(centres.cell(*site)) == stamp;
        let mut search = PathSearch::open(centres, scratch)?;
        search.spread(centres.cells.sites().filter(has_stamp));
        search.path(round.pose.point().cell())
    }
}
