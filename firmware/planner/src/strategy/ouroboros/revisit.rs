//! Revisits: when nothing is left to explore, drive into the stretch of a loop that was not closed.
//!
//! A tractor point is only made where the robot drives. The last part of a loop may be a stretch
//! that the robot saw from afar, and the exploration would end with that loop open. So the robot
//! drives to the middle of the stretch, and a tractor point is made behind it as anywhere else.
//!
//! Departs from \[Jorge15, Algorithm 1, line 25\], where the exploration is complete; \[Jorge15,
//! V\] names "revisiting in fully explored maps" as open. Whatever the result of a revisit is, its
//! stretch becomes a closed region, so there is an end of revisits; and a revisit has the budget of
//! a loop. With 0 `most_branches` there are none.
//!
//! Units: metres; map cells; steps along the skeleton, 20 cm each.

use crate::config::LoopLimits;
use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::map::neighbourhood::Neighbourhood;
use crate::path::context::STEP_M;
use crate::path::nearest::Centres;
use crate::path::{PlanningContext, PlanningScratch};
use crate::roadmap::Residues;
use crate::roadmap::branches::{Branch, Kind, kind, surroundings, ways};
use crate::strategy::ouroboros::closed_regions::{Closed, ClosedRegions};
use crate::strategy::ouroboros::loop_budget::LoopBudget;

/// Number of centre cells after which a call looks for no further branch. It bounds the time: each
/// branch is looked for from the first cell on.
const MOST_LOOKED: usize = 3_000;

/// A drive to an open loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Revisit {
    /// The middle of the stretch, a centre cell when it was found.
    pub(super) goal: Cell,
    /// The drive so far.
    pub(super) budget: LoopBudget,
}

/// The outcome of a search for an open loop.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    /// The middle of a stretch.
    Place(Cell),
    /// None on the branches of this call, which are closed regions now.
    NotHere,
    /// No branch is left.
    None,
}

/// Looks for an open loop on the next branches with cells outside closed regions, with one wave at
/// most.
pub(super) fn find<const TILES: usize, const SLOTS: usize>(
    round: &mut PlanningContext<'_, TILES, SLOTS>,
    regions: &mut ClosedRegions<SLOTS>,
    scratch: &mut PlanningScratch<'_>,
) -> Found {
    let most_branches = round.tuning.ouroboros.most_branches;
    if most_branches == 0 {
        return Found::None;
    }
    let mut looked = 0;
    for _ in 0..most_branches {
        let Some(site) = first_open(round, regions, &mut looked) else {
            return Found::None;
        };
        let goal = middle_of_stretch(round, regions, site);
        let loop_m = goal.and_then(|goal| loop_m(round, goal, scratch));
        match goal.zip(loop_m) {
            Some((goal, loop_m)) if round.limits.is_worth(loop_m, 0.0) => {
                return Found::Place(round.skeleton.frame().cell(goal));
            }
            _ => settle(round, regions, round.skeleton.frame().cell(site)),
        }
        if goal.is_some() || looked > MOST_LOOKED {
            break;
        }
    }
    Found::NotHere
}

/// Closes the regions of a place and of its branch, so that neither is looked at again.
pub(super) fn settle<const TILES: usize, const SLOTS: usize>(
    round: &PlanningContext<'_, TILES, SLOTS>,
    regions: &mut ClosedRegions<SLOTS>,
    place: Cell,
) {
    let near_cells = round.tuning.ouroboros.near_cells;
    regions.drop_pending();
    // The skeleton may have left the place, or the walk along the branch may miss it.
    regions.add_pending(place, near_cells);
    if let Some(centres) = round.centres()
        && let Some(site) = centres.frame.site(place)
        && let Some((end, before)) = end_of_branch(centres.cells, site)
    {
        for site in core::iter::once(end).chain(Branch::new(centres.cells, end, before)) {
            regions.add_pending(centres.cell(site), near_cells);
        }
    }
    regions.close_pending(Closed::GivenUp);
}

/// Returns the first open cell of a branch. Adds to `looked` how many cells it looked at.
fn first_open<const TILES: usize, const SLOTS: usize>(
    round: &PlanningContext<'_, TILES, SLOTS>,
    regions: &ClosedRegions<SLOTS>,
    looked: &mut usize,
) -> Option<Site> {
    let centres = round.centres()?;
    let is_passage = |site| kind(centres.cells, site) == Some(Kind::Passage);
    let mut near = Neighbourhood::of(centres.tiles);
    let mut sites = centres.cells.sites().inspect(|_| *looked += 1);
    sites.find(|&site| is_open((&centres, &mut near), regions, site) && is_passage(site))
}

/// Returns the middle of the longest stretch of open cells in a branch; `None` if all are too
/// short: up to the middle there must be room for a tractor point behind the robot, and as much
/// again.
fn middle_of_stretch<const TILES: usize, const SLOTS: usize>(
    round: &PlanningContext<'_, TILES, SLOTS>,
    regions: &ClosedRegions<SLOTS>,
    site: Site,
) -> Option<Site> {
    let centres = round.centres()?;
    let (end, before) = end_of_branch(centres.cells, site)?;
    // The stretch so far, cells; then length and last cell of the longest one.
    let (mut cells, mut longest) = (0, (0, 0));
    let mut near = Neighbourhood::of(centres.tiles);
    for (k, site) in Branch::new(centres.cells, end, before).enumerate() {
        let is_open = is_open((&centres, &mut near), regions, site);
        cells = if is_open { cells + 1 } else { 0 };
        longest = longest.max((cells, k));
    }
    let (cells, last) = longest;
    let least_m = 4.0 * round.tuning.ouroboros.least_behind_m;
    let is_long = cells as f32 * STEP_M >= least_m;
    let middle = || Branch::new(centres.cells, end, before).nth(last - cells / 2);
    is_long.then(middle).flatten()
}

/// Returns true if a centre cell is explored and in no closed region.
fn is_open<const TILES: usize, const SLOTS: usize>(
    (centres, near): (
        &Centres<'_, TILES, SLOTS>,
        &mut Neighbourhood<'_, TILES, SLOTS>,
    ),
    regions: &ClosedRegions<SLOTS>,
    site: Site,
) -> bool {
    let cell = centres.cell(site);
    !regions.is_closed(cell) && near.is_explored(cell)
}

/// Returns an end of the branch that a cell is in, and the cell before it.
fn end_of_branch(skeleton: Plane<'_>, site: Site) -> Option<(Site, Site)> {
    let next = skeleton.neighbours(site).next()?;
    let mut last = (next, site);
    for cell in Branch::new(skeleton, site, next) {
        last = (cell, last.0);
    }
    // A branch of one more cell ends where it began.
    Some(if last.0 == next { (next, site) } else { last })
}

/// Returns the length of the shortest loop through a cell, metres; `None` if there is no loop.
fn loop_m<const TILES: usize, const SLOTS: usize>(
    round: &mut PlanningContext<'_, TILES, SLOTS>,
    at: Site,
    scratch: &mut PlanningScratch<'_>,
) -> Option<f32> {
    let heads = ways(round.skeleton.skeleton()?, at);
    let (&from, others) = heads.split_first()?;
    round.propagate(from, surroundings(at), None, scratch)?;
    let residues = Residues::new(round.skeleton.tiling(), scratch.residues).ok()?;
    let reached = others.iter().filter(|head| residues.get(**head).is_some());
    let steps = reached.map(|&head| residues.descent(head).count()).min()?;
    // From one head through the cell to the other are four steps more.
    Some((steps + 4) as f32 * STEP_M)
}

impl Revisit {
    /// A revisit that has just begun.
    pub(super) const fn to(goal: Cell) -> Self {
        Self {
            goal,
            budget: LoopBudget::NEW,
        }
    }

    /// Returns true if the budget is spent, now that the goal is `steps` away.
    pub(super) fn is_over(&mut self, steps: u32, limits: &LoopLimits) -> bool {
        self.budget.note(0.0, steps as f32 * STEP_M);
        self.budget.is_spent(limits)
    }
}
