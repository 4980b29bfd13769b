//! The choice of the next frontier by gain over cost.
//!
//! ```text
//! U = G^0.625 / (t + 1 m)      t = path + turn · (1 − cos θ) / 2 + 10 m · level
//! ```
//!
//! G is the unexplored area that may be seen from the goal ([`crate::path::gain`]). θ is the angle
//! from the robot's heading to the first metre of the path. The level is that of
//! [`crate::path::height_levels`] and of the user's own order. The present goal's gain counts more,
//! so the robot keeps it until another one is clearly better. What another robot claims counts less
//! ([`crate::path::claims`]). A goal is *worth* its trip if it is open, or G ≥ worth · max(t, 1 m).
//!
//! Frontier cells near each other are one *candidate*: the nearest by path stands for them. One
//! wave from the robot finds them all, the nearest first, with their paths
//! ([`crate::path::robot_wave`]). A round judges the nearest [`MOST_JUDGED`]. If none is worth its
//! trip, the next round judges the ones behind them.
//!
//! Units: metres, square metres; coarse steps of 20 cm.

use heapless::Vec;

use crate::config::OrderTuning;
use crate::geometry::{Cell, Point};
use crate::grid::{Plane, Site};
use crate::math;
use crate::path::claims::Claims;
use crate::path::context::STEP_M;
use crate::path::frontier_path::{cells_on_level, unexplored_beside};
use crate::path::gain::View;
use crate::path::goal_cost::{PresentGoal, goal_level};
use crate::path::height_levels::LEVEL_STEPS;
use crate::path::nearest::Centres;
use crate::path::residual_frontiers::ResidualFrontiers;
use crate::path::search::PathSearch;
use crate::path::{Path, PlanningContext, PlanningScratch};

/// Maximum number of candidates. Those farther off wait until the robot is nearer. A round that
/// finds so many that are not worth their trips does not judge the ones behind them.
const MOST_CANDIDATES: usize = 64;
/// Maximum number of candidates that a round judges: a gain costs about 0.1 million instructions.
pub(crate) const MOST_JUDGED: usize = 24;
/// A frontier cell at most this far from a candidate along either axis belongs to it, coarse cells.
const GROUP_CELLS: u16 = 5;
/// Distance from the robot at which the direction of a path is taken, metres.
const AHEAD_M: f32 = 1.0;
/// Length that is added to every trip, metres, so that a goal at the robot is worth no more than
/// its gain.
const NEAR_M: f32 = 1.0;

/// Frontier cells near each other.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// The nearest one, and the steps to it.
    site: Site,
    steps: u16,
    cells: u16,
}

/// The candidates, the nearest first.
type Candidates = Vec<Candidate, MOST_CANDIDATES>;

/// Returns the value of a gain.
pub(crate) fn value(tuning: &OrderTuning, gain_m2: f32) -> f32 {
    math::powf(gain_m2, tuning.power)
}

/// Returns the utility of a trip for a value.
pub(crate) fn utility(value: f32, trip_m: f32) -> f32 {
    value / (trip_m + NEAR_M)
}

/// Returns the greatest value that a goal can have: of the whole square within reach.
fn most_value(tuning: &OrderTuning) -> f32 {
    let side_m = 2.0 * tuning.gain_m;
    value(tuning, tuning.keep * side_m * side_m)
}

/// Returns true if a gain is worth a trip, at so many square metres for each metre.
pub(crate) fn is_worth(gain_m2: f32, trip_m: f32, worth: f32) -> bool {
    gain_m2 >= worth * trip_m.max(NEAR_M)
}

/// Returns the path to the frontier of the greatest utility; `None` if none that this round judges
/// is worth the trip: then it lists them. `judged` counts the candidates that the rounds before
/// judged in vain; it is 0 again after the last of them.
pub(crate) fn path_to_best<const TILES: usize, const SLOTS: usize>(
    context: &PlanningContext<'_, TILES, SLOTS>,
    residual: &mut ResidualFrontiers,
    present: Option<PresentGoal>,
    worth: f32,
    judged: &mut usize,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let mut search = PathSearch::open(context.centres()?, scratch)?;
    let best = best_candidate(&mut search, context, residual, (present, worth), judged)?;
    let mut path = search.path_from_robot(best.site, best.steps.into());
    stay_on_level(&mut path, best.site, context, scratch);
    path.extend(unexplored_beside(path.goal(), context.tiles));
    Some(path)
}

/// Returns the candidate of the greatest utility; as [`path_to_best`].
// A frame of its own: the candidates leave the stack before a way is planned.
#[inline(never)]
fn best_candidate<const TILES: usize, const SLOTS: usize>(
    search: &mut PathSearch<'_, TILES, SLOTS>,
    context: &PlanningContext<'_, TILES, SLOTS>,
    residual: &mut ResidualFrontiers,
    (present, worth): (Option<PresentGoal>, f32),
    judged: &mut usize,
) -> Option<Candidate> {
    if *judged == 0 {
        residual.forget_not_worth_it();
    }
    let before = core::mem::take(judged);
    let frontier = context.skeleton.frontier()?;
    let claims = Claims::find(search, context, frontier);
    let candidates = candidates(search, context, frontier, residual);
    let choice = Choice {
        context,
        frontier,
        present,
        worth,
        most_value: most_value(&context.tuning.order),
        claims: &claims,
        search,
        robot: Heading::of(context),
    };
    let (instalment, next) = instalment(&candidates, before);
    let best = choice.best(instalment);
    if best.is_none() {
        *judged = next;
        for candidate in instalment {
            residual.list_not_worth_it(search.centres.cell(candidate.site), candidate.cells);
        }
    }
    best
}

/// Returns the next [`MOST_JUDGED`] after those that were judged before, and how many are judged
/// then: 0 if these are the last.
fn instalment<T>(all: &[T], before: usize) -> (&[T], usize) {
    let rest = all.get(before..).unwrap_or(&[]);
    match rest.get(..MOST_JUDGED) {
        Some(next) if next.len() < rest.len() => (next, before + MOST_JUDGED),
        _ => (rest, 0),
    }
}

/// Finds the candidates, with a wave that stays for their paths.
fn candidates<const TILES: usize, const SLOTS: usize>(
    search: &mut PathSearch<'_, TILES, SLOTS>,
    context: &PlanningContext<'_, TILES, SLOTS>,
    frontier: Plane<'_>,
    residual: &ResidualFrontiers,
) -> Candidates {
    let mut candidates = Candidates::new();
    let centres = search.centres;
    let robot = context.pose.point().cell();
    search.spread_from(robot, frontier, |site, steps| {
        let is_near = |candidate: &&mut Candidate| {
            candidate.site.x.abs_diff(site.x) <= GROUP_CELLS
                && candidate.site.y.abs_diff(site.y) <= GROUP_CELLS
        };
        if residual.is_given_up(centres.cell(site)) {
            return;
        }
        if let Some(candidate) = candidates.iter_mut().find(is_near) {
            candidate.cells = candidate.cells.saturating_add(1);
        } else {
            // The farthest ones do not fit.
            let _ = candidates.push(Candidate {
                site,
                // The longest way in the map has fewer.
                steps: u16::try_from(steps).unwrap_or(u16::MAX),
                cells: 1,
            });
        }
    });
    candidates
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
    worth: f32,
    most_value: f32,
    claims: &'a Claims,
    search: &'a PathSearch<'a, TILES, SLOTS>,
    robot: Heading,
}

impl<const TILES: usize, const SLOTS: usize> Choice<'_, TILES, SLOTS> {
    /// Returns the candidate of the greatest utility that is worth its trip.
    fn best(&self, candidates: &[Candidate]) -> Option<Candidate> {
        let mut best: Option<(f32, Candidate)> = None;
        for &candidate in candidates {
            let least = best.map_or(0.0, |(utility, _)| utility);
            if let Some(utility) = self.utility_above(least, candidate) {
                best = Some((utility, candidate));
            }
        }
        best.map(|(_, candidate)| candidate)
    }

    /// Returns a candidate's utility if it is greater than `least` and worth the trip. What costs
    /// more to compute comes later: most candidates are too far off for any gain.
    fn utility_above(&self, least: f32, candidate: Candidate) -> Option<f32> {
        let tuning: &OrderTuning = &self.context.tuning.order;
        let cell = self.search.centres.cell(candidate.site);
        let level = goal_level(self.context, self.frontier, self.present, candidate.site);
        let path_m = (u32::from(candidate.steps) + LEVEL_STEPS * level) as f32 * STEP_M;
        if utility(self.most_value, path_m) <= least {
            return None;
        }
        let view = View::of(self.context.tiles, cell, tuning.gain_m);
        let is_present = self.present.is_some_and(|present| present.is_beside(cell));
        let kept = if is_present { tuning.keep } else { 1.0 };
        let gain_m2 = kept * view.gain_m2();
        let is_claimed = self
            .claims
            .hold(candidate.site, cell, candidate.steps, tuning.gain_m);
        let claimed = if is_claimed { tuning.claimed } else { 1.0 };
        let value = value(tuning, claimed * gain_m2);
        if utility(value, path_m) <= least {
            return None;
        }
        let ahead = self
            .search
            .first_cell_near(self.robot.cell, candidate.site, AHEAD_M);
        let trip_m = path_m + tuning.turn_m * self.robot.turn_to(ahead);
        let utility = utility(value, trip_m);
        let is_worth = || is_worth(gain_m2, trip_m, self.worth) || view.is_open(self.clearance());
        (utility > least && is_worth()).then_some(utility)
    }

    /// Returns the distance that the robot's centre keeps from obstacles, cells.
    fn clearance(&self) -> i32 {
        self.context.footprint.reach()
    }
}

/// Replaces a path that crosses other levels by one to the same goal that does not, if there is one
/// and it is not too long.
#[inline(never)]
fn stay_on_level<const TILES: usize, const SLOTS: usize>(
    path: &mut Path,
    goal: Site,
    context: &PlanningContext<'_, TILES, SLOTS>,
    scratch: &mut PlanningScratch<'_>,
) {
    if let Some(detour) = path_on_level(path, goal, context, scratch) {
        *path = detour;
    }
}

/// Returns the path to the same goal on its level.
fn path_on_level<const TILES: usize, const SLOTS: usize>(
    path: &Path,
    goal: Site,
    context: &PlanningContext<'_, TILES, SLOTS>,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let mut level = cells_on_level(path, context, scratch)?;
    let centres = Centres {
        cells: level.cells,
        ..context.centres()?
    };
    let mut search = PathSearch::open(centres, &mut level.scratch)?;
    let robot = context.pose.point().cell();
    let mut found = None;
    search.spread_from(robot, context.skeleton.frontier()?, |site, steps| {
        if site == goal {
            found.get_or_insert(steps);
        }
    });
    let steps = found.filter(|&steps| steps <= level.most_steps)?;
    Some(search.path_from_robot(goal, steps))
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
                let (part, next) = instalment(&all, judged);
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
        assert_eq!(instalment(&[7; 3], 2 * MOST_JUDGED), (&[][..], 0));
    }
}
