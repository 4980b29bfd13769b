//! The host's copy of a device's map, as a corrector of the map sees it.
//!
//! Of a robot alone it is the [`Mirror`]. A robot of a team also has what its peers said, and its
//! copy knows which tiles those are (`team/copy.rs`).
//!
//! Units: metres, radians; tiles of 32 × 32 map cells.

use std::collections::BTreeMap;

use fieldline_planner::geometry::Pose;
use fieldline_protocol::message::Observation;

use super::mirror::Mirror;
use crate::link::correction::{Classes, MapCorrection, Motion};

/// Column and row of a tile.
pub type Key = (i16, i16);

/// A copy of a device's map.
pub trait MapCopy {
    /// Returns the robot's pose in the map after the last step or correction.
    fn pose(&self) -> Pose;

    /// Returns the last correction; 0 if there was none.
    fn epoch(&self) -> u16;

    /// Returns the tiles in which something was measured.
    fn tiles(&self) -> BTreeMap<Key, Classes>;

    /// Corrects the copy, as the device does.
    fn correct(&mut self, correction: &MapCorrection);

    /// Returns the last step's observation with the beams that measured the map.
    fn measured(&self, observation: &Observation) -> Observation {
        observation.clone()
    }

    /// Returns the last step's observation with the beams that end at what stands: they end there
    /// from other places, too.
    fn standing(&self, observation: &Observation) -> Observation {
        self.measured(observation)
    }

    /// Returns true if other robots measure the map too.
    fn is_shared(&self) -> bool {
        false
    }

    /// Returns true if another robot measured a tile before this one did.
    fn is_of_peer(&self, _tile: Key) -> bool {
        false
    }

    /// Returns the motion of the whole map in the last step, into the team's coordinates; `None` if
    /// it stayed. The device entered no scan then.
    fn moved(&self) -> Option<Motion> {
        None
    }
}

impl MapCopy for Mirror {
    fn pose(&self) -> Pose {
        Self::pose(self)
    }

    fn epoch(&self) -> u16 {
        Self::epoch(self)
    }

    fn tiles(&self) -> BTreeMap<Key, Classes> {
        Self::tiles(self).collect()
    }

    fn correct(&mut self, correction: &MapCorrection) {
        Self::correct(self, correction);
    }

    fn measured(&self, observation: &Observation) -> Observation {
        Self::measured(self, observation)
    }

    fn standing(&self, observation: &Observation) -> Observation {
        Self::standing(self, observation)
    }
}
