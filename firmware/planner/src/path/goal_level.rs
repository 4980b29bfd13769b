//! The level of a goal: a goal on another level counts as farther away.
//!
//! ```text
//! level = height's level + user's level, at most MOST_LEVEL
//! ```
//!
//! The height's level is that of [`crate::path::height_levels`], the user's that of
//! [`Config::goal_level`](crate::Config::goal_level).
//!
//! Units: levels; sites of the skeleton's plane.

use heapless::Vec;

use crate::config::Goal;
use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::path::PlanningContext;
use crate::path::height_levels::MOST_LEVEL;
use crate::path::residual_frontiers::is_near;

/// A goal this near the present one is the present one, metres.
const PRESENT_RADIUS_M: f32 = 1.0;

/// The goal that the robot is on its way to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PresentGoal {
    /// The goal.
    pub(crate) cell: Cell,
    /// The height from which its level is the least, of those that the robot visited since the goal
    /// was chosen, metres.
    pub(crate) reference_m: f32,
    /// It is worth its trip only together with other goals.
    pub(crate) shares_trip: bool,
}

impl PresentGoal {
    pub(crate) fn is_beside(self, cell: Cell) -> bool {
        is_near(self.cell, cell, PRESENT_RADIUS_M)
    }
}

/// Returns the level of a frontier cell: its height's, and that of the user's own order.
pub(crate) fn goal_level<const TILES: usize, const SLOTS: usize>(
    context: &PlanningContext<'_, TILES, SLOTS>,
    frontier: Plane<'_>,
    present: Option<PresentGoal>,
    site: Site,
) -> u32 {
    let cell = context.skeleton.frame().cell(site);
    let user_level = context.goal_level.map_or(0, |level| {
        let cells = connected_cells(frontier, site);
        level(&Goal { cell, cells }).into()
    });
    (level(context, present, cell) + user_level).min(MOST_LEVEL)
}

/// Returns the height level of a goal.
///
/// The present goal has the least level of all heights visited since it was chosen; re-scoring it
/// on the way made the robot oscillate. So steps and level of the present goal together only fall.
/// A goal that moves up or down a slope is scored by its present height.
pub(crate) fn level<const TILES: usize, const SLOTS: usize>(
    context: &PlanningContext<'_, TILES, SLOTS>,
    present: Option<PresentGoal>,
    cell: Cell,
) -> u32 {
    let Some(levels) = &context.levels else {
        return 0;
    };
    let level = levels.of(context.tiles, cell);
    match present.filter(|present| level > 0 && present.is_beside(cell)) {
        Some(present) => {
            let from_best = levels.from(present.reference_m);
            level.min(from_best.of(context.tiles, cell))
        }
        None => level,
    }
}

/// Returns the number of frontier cells that are connected with one, counted up to
/// [`Goal::MAX_CELLS`].
fn connected_cells(frontier: Plane<'_>, first: Site) -> u16 {
    let mut found: Vec<Site, { Goal::MAX_CELLS as usize }> = Vec::new();
    let _ = found.push(first);
    let mut next = 0;
    while let Some(&site) = found.get(next) {
        next += 1;
        for beside in frontier.neighbours(site) {
            if !found.contains(&beside) && found.push(beside).is_err() {
                return Goal::MAX_CELLS;
            }
        }
    }
    found.len() as u16
}
