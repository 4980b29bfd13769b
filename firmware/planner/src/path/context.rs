//! The inputs of a planning round, with `moveToVoronoi` and `propagatePotential`, which \[Jorge15,
//! Algorithm 1\] uses again and again; its scratch memory, and its outcome.
//!
//! Invariant: the skeleton is whole again after each wave.
//!
//! Units: map cells, metres; steps along the skeleton.

use crate::config::{GoalLevel, LoopLimits, Tuning};
use crate::field::local_grid::LocalGrid;
use crate::geometry::{CELL_M, Cell, Pose};
use crate::grid::Site;
use crate::map::Tiles;
use crate::path::Path;
use crate::path::blocked_passages::BlockedPassages;
use crate::path::height_levels::LevelCost;
use crate::path::nearest::Centres;
use crate::path::utility::GoalOrder;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::Skeleton;
use crate::roadmap::{Barrier, Residues, WaveSpace, Wavefront};
use crate::team::Team;

/// Length of a step along the skeleton, metres. A diagonal step counts the same.
pub(crate) const STEP_M: f32 = 2.0 * CELL_M;
/// Maximum number of cells that a blocker takes out of the skeleton: the robot's 3 × 3
/// surroundings, and the cells behind a shield. A shield (\[Jorge15, step 5\]) takes fewer.
const MOST_BLOCKED: usize = 9 + 9;

/// The inputs of a planning round on one published skeleton.
#[derive(Debug)]
pub(crate) struct PlanningContext<'a, const TILES: usize, const SLOTS: usize> {
    /// The published skeleton. A wave cuts it for a while and makes it whole again.
    pub(crate) skeleton: &'a mut Skeleton<SLOTS>,
    /// The map.
    pub(crate) tiles: &'a Tiles<TILES, SLOTS>,
    /// The footprint that paths are planned for.
    pub(crate) footprint: &'a Footprint,
    /// The robot's disc, which surely fits through what it passes.
    pub(crate) disc: &'a Footprint,
    /// The passages that were blocked before this round.
    pub(crate) blocked: &'a BlockedPassages,
    /// The robot's pose.
    pub(crate) pose: Pose,
    /// The host's clock, milliseconds.
    pub(crate) time_ms: u32,
    /// The limits of a loop's length.
    pub(crate) limits: &'a LoopLimits,
    /// The user's own order of goals.
    pub(crate) goal_level: Option<GoalLevel>,
    /// The order in which goals are taken.
    pub(crate) order: GoalOrder<'a>,
    /// The tuned constants.
    pub(crate) tuning: &'a Tuning,
    /// The cost of goals by height, where height levels are on.
    pub(crate) levels: Option<LevelCost<'a, TILES>>,
    /// The team; `None` for a robot alone.
    pub(crate) team: Option<&'a Team>,
    /// True if a peer stands in the way that may drive on, or the robot still goes back out of a
    /// passage: without a path nothing is decided yet.
    pub(crate) must_wait: bool,
    /// True if the robot can go back along its track through a blocked passage.
    pub(crate) came_through_blocked: bool,
    /// Number of known cells of the map.
    pub(crate) known_cells: u32,
    /// True if every opening was tried before: it is worth no more than what it shows.
    pub(crate) openings_were_tried: bool,
}

#[cfg(test)]
impl<'a, const TILES: usize, const SLOTS: usize> PlanningContext<'a, TILES, SLOTS> {
    /// Returns the inputs of a robot alone at the origin, for tests.
    pub(crate) fn on(
        skeleton: &'a mut Skeleton<SLOTS>,
        tiles: &'a Tiles<TILES, SLOTS>,
        footprint: &'a Footprint,
        limits: &'a LoopLimits,
    ) -> Self {
        Self {
            skeleton,
            tiles,
            footprint,
            disc: footprint,
            blocked: &crate::path::blocked_passages::NONE,
            pose: Pose::ORIGIN,
            time_ms: 0,
            limits,
            goal_level: None,
            order: GoalOrder::new(crate::config::Order::ALL, &Tuning::DEFAULT.order),
            tuning: &Tuning::DEFAULT,
            levels: None,
            team: None,
            must_wait: false,
            came_through_blocked: false,
            known_cells: 0,
            openings_were_tried: false,
        }
    }
}

impl<const TILES: usize, const SLOTS: usize> PlanningContext<'_, TILES, SLOTS> {
    /// Returns the centre cells; `None` before the first skeleton.
    pub(crate) fn centres(&self) -> Option<Centres<'_, TILES, SLOTS>> {
        Centres::of(self.skeleton, self.tiles, self.footprint, self.blocked)
    }

    /// Returns the length of the frontier that is left, metres.
    pub(crate) fn frontier_m(&self) -> Option<f32> {
        Some(self.skeleton.frontier()?.count() as f32 * STEP_M)
    }

    /// Returns the centre cell nearest to a map cell: `moveToVoronoi`.
    pub(crate) fn nearest(&self, from: Cell, scratch: &mut PlanningScratch<'_>) -> Option<Site> {
        let centres = self.centres()?;
        let here = centres.frame.site(from);
        if let Some(site) = here.filter(|&site| centres.cells.get(site)) {
            return Some(site);
        }
        let (site, _) = centres.nearest(from, scratch.local_grid, |_| u32::MAX)?;
        Some(site)
    }

    /// Spreads a wave from `goal` over the centre cells that are not blocked, as far as they go or
    /// to `until`: `propagatePotential`.
    pub(crate) fn propagate(
        &mut self,
        goal: Site,
        blocked: impl Iterator<Item = Site>,
        until: Option<Site>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<()> {
        let mut plane = self.skeleton.skeleton_mut()?;
        let barrier = Barrier::<MOST_BLOCKED>::raise(&mut plane, blocked).ok()?;
        if let Ok(residues) = Residues::new(plane.tiling(), &mut *scratch.residues) {
            let mut space = WaveSpace {
                cells: plane.view(),
                residues,
                ring: &mut *scratch.queue,
            };
            let mut wave = Wavefront::new();
            wave.start(&mut space);
            wave.seed(&mut space, goal);
            wave.run(&mut space, until);
        }
        barrier.lower(&mut plane);
        Some(())
    }

    /// Returns the shortest path along the skeleton from the robot's centre cell to a goal, round
    /// the blocked cells.
    pub(crate) fn path(
        &mut self,
        [robot, goal]: [Site; 2],
        blocked: impl Iterator<Item = Site>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<Path> {
        self.propagate(goal, blocked, Some(robot), scratch)?;
        let frame = self.skeleton.frame();
        let residues = Residues::new(self.skeleton.tiling(), scratch.residues).ok()?;
        residues.get(robot)?;
        Some(Path::down(core::iter::empty(), frame, &residues, robot))
    }
}

/// The scratch memory of a planning round.
#[derive(Debug)]
pub(crate) struct PlanningScratch<'a> {
    /// The wave's distances, a pair for each word of the skeleton's plane.
    pub(crate) residues: &'a mut [[u32; 2]],
    /// The wave's queue.
    pub(crate) queue: &'a mut [u32],
    /// The grid in which the nearest centre cell is searched for.
    pub(crate) local_grid: &'a mut LocalGrid,
}

/// The outcome of a planning round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RoundOutcome {
    /// There is a path to a goal.
    Path,
    /// No path was found; the next round decides.
    Unsure,
    /// No frontier can be reached, and there is nothing to see from the last viewpoint.
    Nothing,
    /// The robot cannot move, whatever the goal.
    Stuck,
}
