//! What a round of planning reads, the scratch that it works in, and what it says.
//!
//! Units: map cells.

use crate::field::local_grid::LocalGrid;
use crate::grid::Plane;
use crate::map::Tiles;
use crate::path::height_levels::LevelCost;
use crate::path::nearest::Centres;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::Skeleton;

/// What is known of the space, for a round of planning.
#[derive(Debug)]
pub struct PlanningContext<'a, const TILES: usize, const SLOTS: usize> {
    /// The published skeleton and its frontier.
    pub topology: &'a Skeleton<SLOTS>,
    /// The map.
    pub tiles: &'a Tiles<TILES, SLOTS>,
    /// The robot's disc.
    pub disc: &'a Footprint,
    /// Which goals are preferred for their height, where any are.
    pub levels: Option<LevelCost<'a, TILES>>,
}

impl<const TILES: usize, const SLOTS: usize> PlanningContext<'_, TILES, SLOTS> {
    /// Returns these centre cells, to search for the nearest one.
    pub(crate) fn centres<'a>(&'a self, way: Plane<'a>) -> Centres<'a, TILES, SLOTS> {
        Centres {
            tiles: self.tiles,
            disc: self.disc,
            frame: self.topology.frame(),
            way,
        }
    }
}

/// Scratch of a round of planning.
#[derive(Debug)]
pub struct PlanningScratch<'a> {
    /// The wave's distances, a pair for each word of the plane.
    pub residues: &'a mut [[u32; 2]],
    /// The wave's queue.
    pub ring: &'a mut [u32],
    /// The window in which the robot finds its centre cell.
    pub view: &'a mut LocalGrid,
}

/// What a new round says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundOutcome {
    /// There is a way to a frontier.
    Path,
    /// None was found; the next round decides.
    Unsure,
    /// No frontier can be reached, and the last viewpoint is done with.
    Nothing,
    /// The robot cannot move, whatever the goal.
    Stuck,
}
