//! Paths on a goal's level: where goals have height levels, a path that crosses other levels gives
//! way to one that stays on the goal's, if that is longer by no more than the delay of a goal so
//! many levels off.
//!
//! Units: map cells, coarse steps of 20 cm.

use core::ops::ControlFlow;

use crate::geometry::Cell;
use crate::grid::{Plane, PlaneMut, Site};
use crate::path::height_levels::LEVEL_STEPS;
use crate::path::nearest::Centres;
use crate::path::search::PathSearch;
use crate::path::{Path, PlanningContext, PlanningScratch};

/// A path crosses other levels if it lies this many levels farther off than its goal: 1 m with the
/// parameters of \[Maffei20, Table I\].
const OTHER_LEVELS: u32 = 4;

/// Replaces a path that crosses other levels by one to the same goal that does not, if there is one
/// and it is not too long.
#[inline(never)]
pub(crate) fn stay_on_level<const TILES: usize, const SLOTS: usize>(
    path: &mut Path,
    goal: Site,
    context: &PlanningContext<'_, TILES, SLOTS>,
    scratch: &mut PlanningScratch<'_>,
) {
    if let Some(mut detour) = path_on_level(path, goal, context, scratch) {
        detour.set_shares_trip(path.shares_trip());
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
        if site != goal {
            return ControlFlow::Continue(());
        }
        found = Some(steps);
        ControlFlow::Break(())
    });
    let steps = found.filter(|&steps| steps <= level.most_steps)?;
    Some(search.path_from_robot(goal, steps))
}

/// The centre cells on the level of a goal.
struct OnLevel<'s> {
    /// Those that are no farther off than the goal, or one level.
    cells: Plane<'s>,
    /// Greatest number of steps of a path along them.
    most_steps: u32,
    /// The scratch memory that they leave.
    scratch: PlanningScratch<'s>,
}

/// Returns the centre cells on the level of a path's goal; `None` if the path crosses no other
/// level.
fn cells_on_level<'s, const TILES: usize, const SLOTS: usize>(
    path: &Path,
    context: &'s PlanningContext<'_, TILES, SLOTS>,
    scratch: &'s mut PlanningScratch<'_>,
) -> Option<OnLevel<'s>> {
    let levels = context.levels.as_ref()?;
    let level = |cell: Cell| levels.of(context.tiles, cell);
    let least = level(path.goal()).max(1);
    let most = path.cells().iter().copied().map(level).max()?;
    let excess = most
        .checked_sub(least)
        .filter(|&excess| excess >= OTHER_LEVELS)?;
    let frame = context.skeleton.frame();
    // On a map so large that the plane does not fit behind the wave, the shortest path is taken.
    let tiling = context.skeleton.tiling();
    let (residues, spare) = scratch.residues.split_at_mut_checked(tiling.words())?;
    let spare = spare.as_flattened_mut();
    let mut on_level = PlaneMut::new(tiling, &mut *spare).ok()?;
    on_level.fill(0);
    for site in context.skeleton.skeleton()?.sites() {
        if level(frame.cell(site)) <= least {
            on_level.set(site);
        }
    }
    let scratch = PlanningScratch {
        residues,
        queue: &mut *scratch.queue,
        local_grid: &mut *scratch.local_grid,
    };
    Some(OnLevel {
        cells: Plane::new(tiling, spare).ok()?,
        most_steps: path.steps() + LEVEL_STEPS * excess,
        scratch,
    })
}
