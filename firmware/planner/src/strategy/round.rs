//! A round of planning: the published skeleton, the map and the robot, with `moveToVoronoi` and
//! `propagatePotential`, which [Jorge15, Algorithm 1] uses again and again.
//!
//! Invariant: the skeleton is whole again after each wave.

use crate::config::LoopLimits;
use crate::geometry::{CELL_M, Cell, Pose};
use crate::grid::Site;
use crate::map::Tiles;
use crate::path::height_levels::LevelCost;
use crate::path::nearest::Centres;
use crate::path::{Path, PlanningContext, PlanningScratch};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::Skeleton;
use crate::roadmap::{Barrier, Residues, WaveSpace, Wavefront};

/// Length of a step along the skeleton, metres. A diagonal step counts the same.
pub(super) const STEP_M: f32 = 2.0 * CELL_M;
/// Cells that a blocker takes out of the skeleton at most: the robot's 3 × 3 surroundings. A shield
/// takes [`MOST_CUT`](crate::strategy::ouroboros::shield::MOST_CUT), which is fewer.
const MOST_BLOCKED: usize = 9;

/// The inputs of a round of planning on one published skeleton.
#[derive(Debug)]
pub(crate) struct Round<'a, const TILES: usize, const SLOTS: usize> {
    /// The published skeleton. A wave cuts it for a while and makes it whole again.
    pub(crate) skeleton: &'a mut Skeleton<SLOTS>,
    /// The map.
    pub(crate) tiles: &'a Tiles<TILES, SLOTS>,
    /// The footprint that paths are planned for.
    pub(crate) footprint: &'a Footprint,
    /// The robot's pose.
    pub(crate) pose: Pose,
    /// The host's clock, milliseconds.
    pub(crate) time_ms: u32,
    /// The limits of a loop's length.
    pub(crate) limits: &'a LoopLimits,
    /// The cost of goals by height, where a preference is on.
    pub(crate) levels: Option<LevelCost<'a, TILES>>,
}

impl<const TILES: usize, const SLOTS: usize> Round<'_, TILES, SLOTS> {
    /// Lends the inputs to a search along the skeleton.
    pub(super) fn context(&self) -> PlanningContext<'_, TILES, SLOTS> {
        PlanningContext {
            topology: self.skeleton,
            tiles: self.tiles,
            disc: self.footprint,
            levels: self.levels,
        }
    }

    /// Returns the centre cells; `None` before the first skeleton.
    pub(super) fn centres(&self) -> Option<Centres<'_, TILES, SLOTS>> {
        Centres::of(self.skeleton, self.tiles, self.footprint)
    }

    /// Returns the length of the frontier that is left, metres.
    pub(super) fn frontier_m(&self) -> Option<f32> {
        Some(self.skeleton.frontier()?.count() as f32 * STEP_M)
    }

    /// Returns the centre cell nearest to a map cell: `moveToVoronoi`.
    pub(super) fn nearest(&self, from: Cell, scratch: &mut PlanningScratch<'_>) -> Option<Site> {
        let centres = self.centres()?;
        let here = centres.frame.site(from);
        if let Some(site) = here.filter(|&site| centres.way.get(site)) {
            return Some(site);
        }
        let (site, _) = centres.nearest(from, scratch.view, |_| true)?;
        Some(site)
    }

    /// Spreads a wave from `goal` over the centre cells that are not blocked, as far as they go or
    /// to `until`: `propagatePotential`.
    pub(super) fn propagate(
        &mut self,
        goal: Site,
        blocked: impl Iterator<Item = Site>,
        until: Option<Site>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<()> {
        let mut plane = self.skeleton.skeleton_mut()?;
        let barrier = Barrier::<MOST_BLOCKED>::raise(&mut plane, blocked).ok()?;
        let shape = plane.shape();
        if let Ok(residues) = Residues::new(shape, &mut *scratch.residues) {
            let mut space = WaveSpace {
                way: plane.view(),
                residues,
                ring: &mut *scratch.ring,
            };
            let mut wave = Wavefront::new();
            wave.start(&mut space);
            wave.seed(&mut space, goal);
            // Without a budget it always comes to its end.
            let _ = wave.advance(&mut space, until, u32::MAX);
        }
        barrier.lower(&mut plane);
        Some(())
    }

    /// Returns the shortest path along the skeleton from the robot's centre cell to a goal, round
    /// the blocked cells.
    pub(super) fn path(
        &mut self,
        [robot, goal]: [Site; 2],
        blocked: impl Iterator<Item = Site>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<Path> {
        self.propagate(goal, blocked, Some(robot), scratch)?;
        let frame = self.skeleton.frame();
        let residues = Residues::new(frame.shape, scratch.residues).ok()?;
        residues.get(robot)?;
        Some(Path::down(core::iter::empty(), frame, &residues, robot))
    }
}
