//! The choice of the next frontier by gain over cost.
//!
//! ```text
//! t = path + turn · (1 − cos θ) / 2 + 10 m · level
//! ```
//!
//! A goal's utility follows from its gain and this length of the trip ([`crate::path::utility`]).
//! The gain is the unexplored area that may be seen from it ([`crate::path::gain`]). θ is the angle
//! from the robot's heading to the first metre of the path. The level is that of
//! [`crate::path::goal_level`]. The present goal's gain counts more, so the robot keeps it until
//! another one is clearly better. What another robot claims counts less ([`crate::path::claims`]).
//! A goal with an *opening* that was not tried counts as if it gained at least 4.5 m²
//! ([`View::is_open`]): it will be visited anyway, and later that may cost a trip of its own. A
//! goal is *worth* its trip for its gain, if it has an opening, or together with others
//! ([`crate::path::shared_trip`]).
//!
//! Frontier cells near each other are one *candidate*: the nearest by path stands for them. A wave
//! from the robot finds them, the nearest first, with their paths ([`crate::path::robot_wave`],
//! [`crate::path::candidates`]). A round judges the nearest [`MOST_JUDGED`], and its wave breaks
//! off when it has met one more. If none is worth its trip, the next round judges the ones behind
//! them, and so on until none is left.
//!
//! Units: metres, square metres; coarse steps of 20 cm.

use core::ops::{ControlFlow, Range};

use crate::geometry::{Cell, Point};
use crate::grid::Plane;
use crate::map::Tiles;
use crate::math;
use crate::path::candidates::{self, Candidate, Candidates};
use crate::path::claims::Claims;
use crate::path::context::STEP_M;
use crate::path::gain::View;
use crate::path::goal_level::{PresentGoal, goal_level};
use crate::path::height_levels::LEVEL_STEPS;
use crate::path::level_path::stay_on_level;
use crate::path::residual_frontiers::ResidualFrontiers;
use crate::path::search::PathSearch;
use crate::path::shared_trip::{AllJudged, Judged, begin_of_trip};
use crate::path::utility::utility;
use crate::path::ways_back::WaysBack;
use crate::path::{Path, PlanningContext, PlanningScratch};

/// Maximum number of candidates that a round judges: a gain costs about 50,000 instructions.
pub(crate) const MOST_JUDGED: usize = 24;
/// Distance from the robot at which the direction of a path is taken, metres.
const AHEAD_M: f32 = 1.0;
/// Returns the path to the frontier of the greatest utility; `None` if none that this round judges
/// is worth the trip: then it lists them. `judged` counts the candidates that the rounds before
/// judged in vain; it is 0 again after the last of them.
#[inline(never)]
pub(crate) fn path_to_best<const TILES: usize, const SLOTS: usize>(
    context: &PlanningContext<'_, TILES, SLOTS>,
    residual: &mut ResidualFrontiers,
    present: Option<PresentGoal>,
    judged: &mut usize,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let entries = scratch.queue.len().checked_sub(candidates::WORDS)?;
    let (queue, words) = scratch.queue.split_at_mut(entries);
    let mut rest = PlanningScratch {
        residues: &mut *scratch.residues,
        queue,
        local_grid: &mut *scratch.local_grid,
    };
    let mut search = PathSearch::open(context.centres()?, &mut rest)?;
    let judging = (present, words);
    let (best, shares_trip) = best_candidate(&mut search, context, residual, judging, judged)?;
    let mut path = search.path_from_robot(best.site, best.steps.into());
    path.set_shares_trip(shares_trip);
    stay_on_level(&mut path, best.site, context, scratch);
    path.extend(unexplored_beside(path.goal(), context.tiles));
    Some(path)
}

/// Returns the candidate of the greatest utility, and true if it is worth its trip only together
/// with others; as [`path_to_best`].
#[inline(never)]
fn best_candidate<const TILES: usize, const SLOTS: usize>(
    search: &mut PathSearch<'_, TILES, SLOTS>,
    context: &PlanningContext<'_, TILES, SLOTS>,
    residual: &mut ResidualFrontiers,
    (present, words): (Option<PresentGoal>, &mut [u32]),
    judged: &mut usize,
) -> Option<(Candidate, bool)> {
    if *judged == 0 {
        residual.forget_not_worth_it();
    }
    let before = core::mem::take(judged);
    let frontier = context.skeleton.frontier()?;
    let claims = Claims::find(search, context, frontier);
    let mut candidates = Candidates::new(words);
    let (centres, robot) = (search.centres, context.pose.point().cell());
    let shared = present.filter(|present| present.shares_trip);
    // The goal of a shared trip may be far behind those that are not worth theirs.
    let mut awaited = shared;
    search.spread_from(robot, frontier, |site, steps| {
        let cell = centres.cell(site);
        if !residual.is_given_up(cell) && candidates.add(site, steps) {
            awaited = awaited.filter(|present| !present.is_beside(cell));
        }
        if awaited.is_none() && candidates.len() > before + MOST_JUDGED {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    let (instalment, next) = instalment(candidates.len(), before);
    let choice = Choice {
        context,
        frontier,
        present,
        most_value: context.order.most_value(),
        claims: &claims,
        search,
        robot: Heading::of(context),
    };
    let is_present =
        |it: &Candidate| shared.is_some_and(|present| present.is_beside(centres.cell(it.site)));
    let beyond = candidates
        .range(instalment.end..candidates.len())
        .find(is_present);
    let best = choice.best(candidates.range(instalment.clone()).chain(beyond));
    if best.is_none() {
        *judged = next;
        for candidate in candidates.range(instalment) {
            residual.list_not_worth_it(search.centres.cell(candidate.site), candidate.cells);
        }
    }
    best
}

/// Returns the places of the next [`MOST_JUDGED`] of `all` candidates after those that were judged
/// before, and how many are judged then: 0 if these are the last.
fn instalment(all: usize, before: usize) -> (Range<usize>, usize) {
    let next = before + MOST_JUDGED;
    if next < all {
        (before..next, next)
    } else {
        (before.min(all)..all, 0)
    }
}

/// The robot's cell, and a unit vector along its heading.
#[derive(Clone, Copy, Debug)]
struct Heading {
    cell: Cell,
    along: Point,
}

impl Heading {
    fn of<const TILES: usize, const SLOTS: usize>(
        context: &PlanningContext<'_, TILES, SLOTS>,
    ) -> Self {
        let (sin, cos) = math::sin_cos(context.pose.yaw_rad);
        Self {
            cell: context.pose.point().cell(),
            along: Point { x_m: cos, y_m: sin },
        }
    }

    /// Returns (1 − cos θ) / 2 for the angle θ from the heading to the direction of a cell: the
    /// part of turning about.
    fn turn_to(self, cell: Cell) -> f32 {
        let (dx, dy) = ((cell.x - self.cell.x) as f32, (cell.y - self.cell.y) as f32);
        let length = math::sqrt(dx * dx + dy * dy);
        if length < 1.0 {
            return 0.0;
        }
        0.5 - 0.5 * (dx * self.along.x_m + dy * self.along.y_m) / length
    }
}

/// What the candidates are judged by.
struct Choice<'a, const TILES: usize, const SLOTS: usize> {
    context: &'a PlanningContext<'a, TILES, SLOTS>,
    frontier: Plane<'a>,
    present: Option<PresentGoal>,
    most_value: f32,
    claims: &'a Claims,
    search: &'a PathSearch<'a, TILES, SLOTS>,
    robot: Heading,
}

impl<const TILES: usize, const SLOTS: usize> Choice<'_, TILES, SLOTS> {
    /// Returns the candidate of the greatest utility that is worth its trip, or else the one with
    /// which a shared trip begins, and true.
    #[inline(never)]
    fn best(&self, candidates: impl Iterator<Item = Candidate>) -> Option<(Candidate, bool)> {
        let mut best: Option<(f32, Candidate, bool)> = None;
        let (mut judged, mut ways_back) = (AllJudged::new(), WaysBack::NONE);
        for candidate in candidates {
            let least = best.map_or(0.0, |(utility, ..)| utility);
            let lent = (&mut judged, &mut ways_back);
            if let Some((utility, shares)) = self.utility_above(least, candidate, lent) {
                best = Some((utility, candidate, shares));
            }
        }
        let alone = best.map(|(_, candidate, shares)| (candidate, shares));
        alone.or_else(|| Some((begin_of_trip(&judged, &self.context.order)?, true)))
    }

    /// Returns a candidate's utility if it is greater than `least` and worth the trip, and true if
    /// it is so as the present goal of a shared trip. What costs more to compute comes later: most
    /// candidates are too far off for any gain. One that is not worth the trip is added to
    /// `judged`. It is not inlined, so that the search for claims does not pay for its view.
    #[inline(never)]
    fn utility_above(
        &self,
        least: f32,
        candidate: Candidate,
        (judged, ways_back): (&mut AllJudged, &mut WaysBack),
    ) -> Option<(f32, bool)> {
        let order = &self.context.order;
        let tuning = order.tuning;
        let cell = self.search.centres.cell(candidate.site);
        let level = goal_level(self.context, self.frontier, self.present, candidate.site);
        let path_m = (u32::from(candidate.steps) + LEVEL_STEPS * level) as f32 * STEP_M;
        if utility(self.most_value, path_m) <= least {
            return None;
        }
        let view = View::of(self.context.tiles, cell, tuning.gain_m, self.clearance());
        let is_present = self.present.is_some_and(|present| present.is_beside(cell));
        let kept = if is_present { tuning.keep } else { 1.0 };
        let gain_m2 = kept * view.gain_m2();
        let is_claimed = self.claims.hold(candidate.site, candidate.steps);
        let claimed = if is_claimed { tuning.claimed } else { 1.0 };
        let counted = |gain_m2| order.value(claimed * gain_m2);
        let promised = gain_m2.max(tuning.opening_m2);
        if utility(counted(promised), path_m) <= least {
            return None;
        }
        let tried = self.context.openings_were_tried;
        let is_open = || !tried && view.is_open(self.context.disc);
        let counts_more = gain_m2 < promised && is_open();
        let value = counted(if counts_more { promised } else { gain_m2 });
        let goal = (candidate.site, candidate.steps.into());
        let near = (self.robot.cell, AHEAD_M);
        let ahead = self.search.first_cell_near(near, goal, ways_back);
        let trip_m = path_m + tuning.turn_m * self.robot.turn_to(ahead);
        let utility = utility(value, trip_m);
        if utility <= least {
            return None;
        }
        let shares_trip = self.present.is_some_and(|present| present.shares_trip);
        let promises = || counts_more || (gain_m2 >= promised && is_open());
        if order.is_worth(gain_m2, trip_m) || promises() {
            return Some((utility, false));
        }
        // A trip that was worth it goes on as long as there is something to see at its goal.
        if is_present && shares_trip && order.is_worth(gain_m2, 0.0) {
            return Some((utility, true));
        }
        // There is room for all of a round.
        let _ = judged.push(Judged {
            candidate,
            cell,
            gain_m2,
            trip_m,
        });
        None
    }

    /// Returns the distance that the robot's centre keeps from obstacles, cells.
    fn clearance(&self) -> i32 {
        self.context.footprint.reach()
    }
}

/// Returns the coarse cell at a side of `cell` that holds the most unexplored map cells, if any.
/// What the map has no room for does not count.
fn unexplored_beside<const TILES: usize, const SLOTS: usize>(
    cell: Cell,
    tiles: &Tiles<TILES, SLOTS>,
) -> Option<Cell> {
    let row = |x, y| tiles.reader(x).of_room(true).row(y);
    let unknown = |cell: Cell| {
        (0..2)
            .map(|dy| (row(cell.x, cell.y + dy).unknown() & 3).count_ones())
            .sum::<u32>()
    };
    [(2, 0), (-2, 0), (0, 2), (0, -2)]
        .into_iter()
        .map(|(dx, dy)| cell.offset(dx, dy))
        .max_by_key(|&beside| unknown(beside))
        .filter(|&beside| unknown(beside) > 0)
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{MOST_JUDGED, instalment};

    #[test]
    fn instalments_judge_every_candidate_once_and_begin_anew() {
        for count in [0, 1, MOST_JUDGED, MOST_JUDGED + 1, 2 * MOST_JUDGED, 64] {
            let all: Vec<usize> = (0..count).collect();
            let (mut seen, mut judged) = (Vec::<usize>::new(), 0);
            loop {
                let (part, next) = instalment(count, judged);
                assert!(part.len() <= MOST_JUDGED);
                seen.extend(part);
                judged = next;
                if judged == 0 {
                    break;
                }
            }
            assert_eq!(seen, all);
        }
        // Candidates may become fewer between two rounds.
        assert_eq!(instalment(3, 2 * MOST_JUDGED), (3..3, 0));
    }
}
