//! What went wrong, judged by the true footprint on the true world.

use crate::robot::FARTHEST_M;

/// Counts of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Safety {
    /// Contacts with something solid; one lasts until the robot got clear by a centimetre.
    pub collisions: u32,
    /// Falls into holes.
    pub falls: u32,
    /// Times the robot tipped over.
    pub tips: u32,
    /// Least distance between the footprint's outline and anything solid, metres: 0 after a collision, and at
    /// most [`FARTHEST_M`].
    pub min_clearance_m: f64,
}

impl Default for Safety {
    fn default() -> Self {
        Self {
            collisions: 0,
            falls: 0,
            tips: 0,
            min_clearance_m: FARTHEST_M,
        }
    }
}
