//! Collisions, falls and clearance of the true footprint in the true world.

use crate::robot::FARTHEST_M;

/// Safety counts of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Safety {
    /// Contacts with something solid; a contact lasts until the robot is 1 cm clear.
    pub collisions: u32,
    /// Falls into holes.
    pub falls: u32,
    /// Number of times that the robot tipped over.
    pub tips: u32,
    /// Least distance between the footprint's outline and anything solid, metres: 0 after a
    /// collision, and at most [`FARTHEST_M`].
    pub min_clearance_m: f64,
    /// Contacts with people; a contact lasts until the robot is 1 cm clear.
    pub person_contacts: u32,
    /// Least distance between the footprint and a person, metres, at most [`FARTHEST_M`].
    pub min_person_gap_m: f64,
    /// Greatest depth of the true hull in what the fence forbids, metres.
    pub deepest_forbidden_m: f64,
}

impl Default for Safety {
    fn default() -> Self {
        Self {
            collisions: 0,
            falls: 0,
            tips: 0,
            min_clearance_m: FARTHEST_M,
            person_contacts: 0,
            min_person_gap_m: FARTHEST_M,
            deepest_forbidden_m: 0.0,
        }
    }
}
