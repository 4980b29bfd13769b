//! Errands: when nothing is left to explore, to a stretch of a loop that was not closed.
//!
//! A tractor point is made where the robot comes by. What it only saw from afar may be the last part of a loop; the exploration
//! would end with that loop open. So the robot is sent into the stretch, where a tractor point is made behind it as anywhere.
//!
//! Departs from [Jorge15, Algorithm 1, line 26], where the exploration is complete: "revisiting in fully explored maps" is named as open.
//! Whatever becomes of an errand, its stretch is marked in the end, so errands come to an end too; and an errand is given up as a loop is,
//! when the robot has come too far on it.
//!
//! Units: metres; map cells; steps along the skeleton, 20 cm and a little more.

use crate::config::LoopLimits;
use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::path::PlanningScratch;
use crate::roadmap::Residues;
use crate::roadmap::branches::{Branch, Kind, kind, surroundings, ways};
use crate::strategy::ouroboros::closed_regions::Marks;
use crate::strategy::ouroboros::ground::Ground;
use crate::strategy::ouroboros::loop_budget::Detour;
use crate::strategy::ouroboros::round::{Round, STEP_M};
use crate::strategy::ouroboros::tractor::LEAST_BEHIND_M;

/// A robot this near to the middle of the stretch has done its errand, steps.
pub(super) const DONE_STEPS: u32 = 4;
/// Metres of a stretch: to its middle there is room for a tractor point behind the robot, and as much again.
const LEAST_M: f32 = 4.0 * LEAST_BEHIND_M;

/// Branches that a call looks at: those with a stretch that is too short cost no wave.
const MOST_BRANCHES: usize = 12;

/// An errand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errand {
    /// The middle of the stretch, a centre cell when it was found.
    pub(super) goal: Cell,
    /// The way since.
    pub(super) detour: Detour,
}

/// Whether there is an errand.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    /// To this place.
    Place(Cell),
    /// Not on the branches that were looked at, which are marked now.
    NotHere,
    /// No branch is left to look at.
    None,
}

/// Look at the next branches that are not marked all along, with one wave at the most.
pub(super) fn find<const TILES: usize, const SLOTS: usize>(
    round: &mut Round<'_, TILES, SLOTS>,
    marks: &mut Marks<SLOTS>,
    lent: &mut PlanningScratch<'_>,
) -> Found {
    for _ in 0..MOST_BRANCHES {
        let Some(site) = first_open(round, marks) else {
            return Found::None;
        };
        let goal = middle_of_stretch(round, marks, site);
        let loop_m = goal.and_then(|goal| loop_m(round, goal, lent));
        match goal.zip(loop_m) {
            Some((goal, loop_m)) if round.limits.is_worth(loop_m, 0.0) => {
                return Found::Place(round.topology.frame().cell(goal));
            }
            _ => settle(round, marks, round.topology.frame().cell(site)),
        }
        if goal.is_some() {
            break;
        }
    }
    Found::NotHere
}

/// A place and its branch are not looked at again.
pub(super) fn settle<const TILES: usize, const SLOTS: usize>(
    round: &Round<'_, TILES, SLOTS>,
    marks: &mut Marks<SLOTS>,
    place: Cell,
) {
    marks.forget();
    // Also where the skeleton has left the place, or the walk along its branch goes another way.
    marks.note(place);
    let frame = round.topology.frame();
    if let Some(way) = round.topology.skeleton()
        && let Some((end, before)) = frame.site(place).and_then(|site| end_of_branch(way, site))
    {
        for site in core::iter::once(end).chain(Branch::new(way, end, before)) {
            marks.note(frame.cell(site));
        }
    }
    marks.keep();
}

/// The end of a branch, with the cell before that.
type End = (Site, Site);

/// The first cell of a branch that is explored and not marked.
fn first_open<const TILES: usize, const SLOTS: usize>(
    round: &Round<'_, TILES, SLOTS>,
    marks: &Marks<SLOTS>,
) -> Option<Site> {
    let ground = round.ground()?;
    let is_passage = |site| kind(ground.way, site) == Some(Kind::Passage);
    let mut sites = ground.way.sites();
    sites.find(|&site| is_open(&ground, marks, site) && is_passage(site))
}

/// The middle of the longest stretch of such cells in a branch, if that is long enough.
fn middle_of_stretch<const TILES: usize, const SLOTS: usize>(
    round: &Round<'_, TILES, SLOTS>,
    marks: &Marks<SLOTS>,
    site: Site,
) -> Option<Site> {
    let ground = round.ground()?;
    let (end, before) = end_of_branch(ground.way, site)?;
    // Cells of the stretch so far, and the longest one: how long, and where it ends.
    let (mut cells, mut longest) = (0, (0, 0));
    for (k, site) in Branch::new(ground.way, end, before).enumerate() {
        cells = if is_open(&ground, marks, site) {
            cells + 1
        } else {
            0
        };
        longest = longest.max((cells, k));
    }
    let (cells, last) = longest;
    let is_long = cells as f32 * STEP_M >= LEAST_M;
    let middle = || Branch::new(ground.way, end, before).nth(last - cells / 2);
    is_long.then(middle).flatten()
}

fn is_open<const TILES: usize, const SLOTS: usize>(
    ground: &Ground<'_, TILES, SLOTS>,
    marks: &Marks<SLOTS>,
    site: Site,
) -> bool {
    let cell = ground.cell(site);
    !marks.is_marked(cell) && ground.is_explored(cell)
}

/// The end of the branch that a cell is in.
fn end_of_branch(way: Plane<'_>, site: Site) -> Option<End> {
    let next = way.neighbours(site).next()?;
    let mut last = (next, site);
    for cell in Branch::new(way, site, next) {
        last = (cell, last.0);
    }
    // A branch of one cell more ends where it began.
    Some(if last.0 == next { (next, site) } else { last })
}

/// Length of the shortest loop through a cell, metres.
fn loop_m<const TILES: usize, const SLOTS: usize>(
    round: &mut Round<'_, TILES, SLOTS>,
    at: Site,
    lent: &mut PlanningScratch<'_>,
) -> Option<f32> {
    let heads = ways(round.topology.skeleton()?, at);
    let (&from, others) = heads.split_first()?;
    round.propagate(from, surroundings(at), None, lent)?;
    let residues = Residues::new(round.topology.frame().shape, lent.residues).ok()?;
    let reached = others.iter().filter(|head| residues.get(**head).is_some());
    let steps = reached.map(|&head| residues.descent(head).count()).min()?;
    Some((steps + 4) as f32 * STEP_M)
}

impl Errand {
    pub(super) const fn to(goal: Cell) -> Self {
        Self {
            goal,
            detour: Detour::new(),
        }
    }

    /// Whether the robot has come too far on it, now that so many steps are left.
    pub(super) fn is_over(&mut self, steps: u32, limits: &LoopLimits) -> bool {
        self.detour.note(0.0, steps as f32 * STEP_M);
        self.detour.is_over(limits)
    }
}
