//! What a round of the strategy works on: skeleton, map and robot, and the two things that Algorithm 1 does with them again and
//! again, `moveToVoronoi` and `propagatePotential`.
//!
//! Invariant: the skeleton is whole again after each wave.

use crate::config::LoopLimits;
use crate::geometry::{Cell, Pose};
use crate::grid::Site;
use crate::map::Tiles;
use crate::path::height_levels::LevelCost;
use crate::path::nearest::Centres;
use crate::path::{PlanningContext, PlanningScratch};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::Skeleton;
use crate::roadmap::{Barrier, Residues, WaveSpace, Wavefront};
use crate::strategy::ouroboros::ground::Ground;

/// Metres along a step of the skeleton.
pub(super) const STEP_M: f32 = 2.0 * crate::geometry::CELL_M;
/// Cells that a blocker takes out of the skeleton at the most: the robot's surroundings.
const BLOCKED: usize = 9;

/// What a round works on.
#[derive(Debug)]
pub struct Round<'a, const TILES: usize, const SLOTS: usize> {
    /// The published skeleton, of [`crate::roadmap::skeleton::Space::AnchoredNotObstacle`]; whole again after each call.
    pub topology: &'a mut Skeleton<SLOTS>,
    /// The map.
    pub tiles: &'a Tiles<TILES, SLOTS>,
    /// The robot's disc.
    pub disc: &'a Footprint,
    /// Where the robot is.
    pub pose: Pose,
    /// The host's clock, milliseconds.
    pub time_ms: u32,
    /// Bounds of a loop.
    pub limits: &'a LoopLimits,
    /// Which goals are preferred for their height, where any are.
    pub levels: Option<LevelCost<'a, TILES>>,
}

impl<const TILES: usize, const SLOTS: usize> Round<'_, TILES, SLOTS> {
    pub(in crate::strategy) fn known(&self) -> PlanningContext<'_, TILES, SLOTS> {
        PlanningContext {
            topology: self.topology,
            tiles: self.tiles,
            disc: self.disc,
            levels: self.levels,
        }
    }

    pub(super) fn ground(&self) -> Option<Ground<'_, TILES, SLOTS>> {
        Some(Ground {
            tiles: self.tiles,
            disc: self.disc,
            frame: self.topology.frame(),
            way: self.topology.skeleton()?,
        })
    }

    /// Metres of frontier that are left.
    pub(super) fn frontier_m(&self) -> Option<f32> {
        Some(self.topology.frontier()?.count() as f32 * STEP_M)
    }

    /// `moveToVoronoi`: the centre cell nearest to a map cell.
    pub(super) fn nearest(&self, from: Cell, lent: &mut PlanningScratch<'_>) -> Option<Site> {
        let ground = self.ground()?;
        let here = ground.frame.site(from);
        if let Some(site) = here.filter(|&site| ground.way.get(site)) {
            return Some(site);
        }
        let centres = Centres {
            tiles: self.tiles,
            disc: self.disc,
            frame: ground.frame,
            way: ground.way,
        };
        let (site, _) = centres.nearest(from, lent.view, |_| true)?;
        Some(site)
    }

    /// `propagatePotential`: a wave from `goal` over the centre cells, without the blocked ones, everywhere or until it comes to
    /// a cell.
    pub(super) fn propagate(
        &mut self,
        goal: Site,
        blocked: impl Iterator<Item = Site>,
        until: Option<Site>,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<()> {
        let mut plane = self.topology.skeleton_mut()?;
        // A shield that cuts one branch has fewer centre cells than the robot's surroundings may have.
        let barrier = Barrier::<BLOCKED>::raise(&mut plane, blocked).ok()?;
        let shape = plane.shape();
        if let Ok(residues) = Residues::new(shape, &mut *lent.residues) {
            let mut space = WaveSpace {
                way: plane.view(),
                residues,
                ring: &mut *lent.ring,
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
}
