//! The path to a frontier: a wave from every frontier cell, each delayed by its cost
//! ([`crate::path::goal_cost`]), and the way down it from the robot \[Jorge15, Algorithm 1, lines
//! 3, 4, 23\].
//!
//! Where goals have height levels, a path that crosses other levels gives way to one that stays on
//! the goal's, if that is longer by no more than the delay of a goal so many levels off.
//!
//! Units: map cells, coarse steps of 20 cm.

use crate::config::Order;
use crate::geometry::Cell;
use crate::grid::{Plane, PlaneMut};
use crate::map::Tiles;
use crate::path::goal_choice::path_to_best;
use crate::path::goal_cost::{GoalCost, PresentGoal};
use crate::path::height_levels::LEVEL_STEPS;
use crate::path::nearest::Centres;
use crate::path::residual_frontiers::ResidualFrontiers;
use crate::path::search::PathSearch;
use crate::path::{Path, PlanningContext, PlanningScratch};
use crate::roadmap::{WaveSpace, Wavefront};

/// A path crosses other levels if it lies this many levels farther off than its goal: 1 m with the
/// parameters of \[Maffei20, Table I\].
const OTHER_LEVELS: u32 = 4;
/// Words at the end of the wave's queue that cache cost classes. A wave rarely has so many cells
/// waiting.
const CLASS_WORDS: usize = 170;

/// Returns the path to the next frontier in the session's order; `None` if none is within reach or
/// worth the trip. `judged` is as for [`path_to_best`].
pub(crate) fn path_to_next<const TILES: usize, const SLOTS: usize>(
    context: &PlanningContext<'_, TILES, SLOTS>,
    residual: &mut ResidualFrontiers,
    present: Option<PresentGoal>,
    judged: &mut usize,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    match context.order {
        Order::Gain { worth } => path_to_best(context, residual, present, worth, judged, scratch),
        Order::Nearest => path_to_frontier(context, residual, present, scratch),
    }
}

/// Returns the path to the frontier cell of the least cost, which is on the same level as far as
/// possible. `None` if no frontier is within reach.
#[inline(never)]
fn path_to_frontier<const TILES: usize, const SLOTS: usize>(
    context: &PlanningContext<'_, TILES, SLOTS>,
    given_up: &ResidualFrontiers,
    present: Option<PresentGoal>,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let cells = context.skeleton.skeleton()?;
    let entries = scratch.queue.len().saturating_sub(CLASS_WORDS);
    let (queue, memory) = scratch.queue.split_at_mut(entries);
    let cost = GoalCost::new(context, given_up, present, memory)?;
    let mut scratch = PlanningScratch {
        residues: &mut *scratch.residues,
        queue,
        local_grid: &mut *scratch.local_grid,
    };
    let path = path_along(cells, &cost, &mut scratch)?;
    let level_path = path_on_level(&path, &cost, &mut scratch);
    level_path.or(Some(path))
}

/// For a path that crosses other levels, returns one along centre cells that are no farther off
/// than the goal, or one level; `None` if there is none, or it is too long.
fn path_on_level<const TILES: usize, const SLOTS: usize>(
    path: &Path,
    cost: &GoalCost<'_, TILES, SLOTS>,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let mut level = cells_on_level(path, cost.context, scratch)?;
    let detour = path_along(level.cells, cost, &mut level.scratch)?;
    (detour.steps() <= level.most_steps).then_some(detour)
}

/// The centre cells on the level of a goal.
pub(crate) struct OnLevel<'s> {
    /// Those that are no farther off than the goal, or one level.
    pub(crate) cells: Plane<'s>,
    /// Greatest number of steps of a path along them.
    pub(crate) most_steps: u32,
    /// The scratch memory that they leave.
    pub(crate) scratch: PlanningScratch<'s>,
}

/// Returns the centre cells on the level of a path's goal; `None` if the path crosses no other
/// level.
pub(crate) fn cells_on_level<'s, const TILES: usize, const SLOTS: usize>(
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

/// Returns the path to the frontier cell of the least cost along these centre cells.
fn path_along<const TILES: usize, const SLOTS: usize>(
    cells: Plane<'_>,
    cost: &GoalCost<'_, TILES, SLOTS>,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let centres = Centres {
        cells,
        ..cost.context.centres()?
    };
    let mut search = PathSearch::open(centres, scratch)?;
    if !spread(&mut search.space, cost) {
        return None;
    }
    let robot = cost.context.pose.point().cell();
    let found = search.entry(robot);
    let PathSearch {
        centres,
        space,
        local_grid,
    } = search;
    let mut path = if let Some((entry, steps)) = found {
        let line = core::iter::empty();
        Path::down(line, centres.frame, &space.residues, entry).after(steps)
    } else if centres.nearest(robot, local_grid, |_| true).is_some() {
        // No wave reached the centre cells near the robot.
        return None;
    } else {
        let is_reached = |site| space.residues.get(site).is_some();
        let (entry, line) = centres.nearest_in_line(robot, is_reached)?;
        Path::down(line, centres.frame, &space.residues, entry)
    };
    // Nearest first, a robot that may not look beyond the map stands at such a goal for good.
    path.extend(unexplored_beside(path.goal(), centres.tiles, true));
    Some(path)
}

/// Spreads a wave from every frontier cell that was not given up, each after its delay. Returns
/// true if there is one.
fn spread<const TILES: usize, const SLOTS: usize>(
    space: &mut WaveSpace<'_>,
    cost: &GoalCost<'_, TILES, SLOTS>,
) -> bool {
    let mut any = false;
    let mut wave = Wavefront::new();
    wave.start(space);
    let mut now = 0;
    for (class, delay) in cost.delays() {
        wave.run_levels(space, delay - now);
        now = delay;
        for site in cost.sites(class) {
            any |= wave.seed(space, site);
        }
    }
    wave.run(space, None);
    any
}

/// Returns the coarse cell at a side of `cell` that holds the most unexplored map cells, if any.
/// What the map has no room for counts only if it `may_leave_map`.
pub(crate) fn unexplored_beside<const TILES: usize, const SLOTS: usize>(
    cell: Cell,
    tiles: &Tiles<TILES, SLOTS>,
    may_leave_map: bool,
) -> Option<Cell> {
    let row = |x, y| tiles.reader(x).of_room(!may_leave_map).row(y);
    let unknown = |cell: Cell| {
        (0..2)
            .map(|dy| (row(cell.x, cell.y + dy).unknown() & 3).count_ones())
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
