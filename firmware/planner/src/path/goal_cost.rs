//! Goal cost: the delay after which the wave of a frontier cell starts. A goal with a delay counts
//! as that much farther away.
//!
//! ```text
//! delay = 0 beside the present goal | 10 at a large frontier | 22 at a small one     + 50 · level
//! ```
//!
//! in coarse steps of 20 cm, with the level of [`crate::path::height_levels`]. Frontier cells with
//! the same delay form a *cost class*. Computing a cell's class is expensive and each search asks
//! for it once per class, so it is cached once per planning round, in 5 bits. Cells for which the
//! cache has no room count as a large frontier on the robot's level, so that a frontier of any
//! length takes a bounded time.
//!
//! Units: coarse steps of 20 cm; sites of the skeleton's plane.

use heapless::Vec;

use crate::config::Goal;
use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::path::PlanningContext;
use crate::path::height_levels::{LEVEL_STEPS, MOST_LEVEL};
use crate::path::residual_frontiers::{ResidualFrontiers, is_near};

/// Radius around the present goal in which a frontier cell has its head start, metres.
const PRESENT_RADIUS_M: f32 = 1.0;
/// Head start of the present goal, coarse steps: the cost of turning about. It keeps two equally
/// near goals from drawing the robot to and fro.
const HEAD_START_STEPS: u32 = 10;
/// A frontier cell belongs to a large frontier if the 5 × 5 cells around it hold at least this many
/// frontier cells, itself included. Small ones are corners and the feet of walls.
const LARGE_CELLS: u32 = 4;
/// Delay of a small frontier against a large one, coarse steps. In the papers all unexplored cells
/// start at once. Mean time to 99 % on the built-in worlds, three seeds, seconds:
///
/// | | at once | 12 steps | 30 steps |
/// | --- | --- | --- | --- |
/// | office | 264 | 262 | 282 |
/// | cave | 99 | 98 | 98 |
/// | loop | 112 | 108 | 108 |
/// | cluttered | 67 | 61 | 61 |
/// | hall | 67 | 64 | 64 |
/// | narrow-doors | 83 | 78 | 78 |
const SMALL_STEPS: u32 = 12;
/// Delays by rank, coarse steps: beside the present goal, large, small.
const RANK_STEPS: [u32; 3] = [0, HEAD_START_STEPS, HEAD_START_STEPS + SMALL_STEPS];
const RANKS: u32 = RANK_STEPS.len() as u32;
/// Bits of a cost class, and classes in a word.
const BITS: usize = 5;
const PER_WORD: usize = u32::BITS as usize / BITS;
/// The class of a large frontier on the robot's level.
const LARGE: u32 = 1;
/// The class of a frontier cell that was given up.
const GIVEN_UP: u32 = (1 << BITS) - 1;
const _CHECKS: () = assert!(
    LEVEL_STEPS > HEAD_START_STEPS + SMALL_STEPS && RANKS * (MOST_LEVEL + 1) <= GIVEN_UP,
    "the ranks of a level start before the next level, and each has a class"
);

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

/// The cost of the frontier cells in a planning round.
#[derive(Debug)]
pub(crate) struct GoalCost<'a, const TILES: usize, const SLOTS: usize> {
    pub(crate) context: &'a PlanningContext<'a, TILES, SLOTS>,
    frontier: Plane<'a>,
    given_up: &'a ResidualFrontiers,
    present: Option<PresentGoal>,
    /// The classes of the frontier's cells, in its order.
    classes: &'a [u32],
    /// The classes that occur, a bit each.
    occurring: u32,
}

impl<'a, const TILES: usize, const SLOTS: usize> GoalCost<'a, TILES, SLOTS> {
    /// Computes the classes of all frontier cells and caches them in `memory`, 6 a word. `None`
    /// while the skeleton has no frontier.
    pub(crate) fn new(
        context: &'a PlanningContext<'a, TILES, SLOTS>,
        given_up: &'a ResidualFrontiers,
        present: Option<PresentGoal>,
        memory: &'a mut [u32],
    ) -> Option<Self> {
        let mut cost = Self {
            context,
            frontier: context.skeleton.frontier()?,
            given_up,
            present,
            classes: &[],
            occurring: 0,
        };
        memory.fill(0);
        for (k, site) in cost.frontier.sites().enumerate() {
            let class = match memory.get_mut(k / PER_WORD) {
                Some(word) => {
                    let class = cost.class(site);
                    *word |= class << (k % PER_WORD * BITS);
                    class
                }
                None => cost.class_without_room(site),
            };
            if class != GIVEN_UP {
                cost.occurring |= 1 << class;
            }
        }
        cost.classes = memory;
        Some(cost)
    }

    /// Returns the classes that occur with their delays, the least first.
    pub(crate) fn delays(&self) -> impl Iterator<Item = (u32, u32)> + use<TILES, SLOTS> {
        let occurring = self.occurring;
        let classes = (0..GIVEN_UP).filter(move |class| occurring >> class & 1 == 1);
        classes.map(|class| {
            let rank_steps = RANK_STEPS.get((class % RANKS) as usize).copied();
            let delay = class / RANKS * LEVEL_STEPS + rank_steps.unwrap_or_default();
            (class, delay)
        })
    }

    /// Returns the frontier cells of a class.
    pub(crate) fn sites(&self, class: u32) -> impl Iterator<Item = Site> {
        let class_of = move |(k, site): (usize, Site)| match self.classes.get(k / PER_WORD) {
            Some(&word) => word >> (k % PER_WORD * BITS) & GIVEN_UP,
            None if class != LARGE => GIVEN_UP,
            None => self.class_without_room(site),
        };
        let all = self.frontier.sites().enumerate();
        all.filter_map(move |of| (class_of(of) == class).then_some(of.1))
    }

    /// Returns the class of a cell that the cache has no room for.
    #[inline(never)]
    fn class_without_room(&self, site: Site) -> u32 {
        let cell = self.context.skeleton.frame().cell(site);
        if self.given_up.is_given_up(cell) {
            GIVEN_UP
        } else {
            LARGE
        }
    }

    /// Returns the class of a cell.
    #[inline(never)]
    fn class(&self, site: Site) -> u32 {
        let cell = self.context.skeleton.frame().cell(site);
        if self.given_up.is_given_up(cell) {
            return GIVEN_UP;
        }
        let rank = if self.present.is_some_and(|present| present.is_beside(cell)) {
            0
        } else {
            1 + u32::from(!is_large(self.frontier, site))
        };
        goal_level(self.context, self.frontier, self.present, site) * RANKS + rank
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

/// Returns true if the 5 × 5 cells around a frontier cell hold at least [`LARGE_CELLS`] others.
fn is_large(frontier: Plane<'_>, site: Site) -> bool {
    let mut is_set = frontier.query();
    let mut count = 0;
    // Most have enough in their own row and the next.
    [0, 1, -1, 2, -2].into_iter().any(|dy| {
        let near = (-2..=2).filter_map(|dx| site.offset(dx, dy));
        count += near.filter(|&near| is_set(near)).count() as u32;
        count >= LARGE_CELLS
    })
}
