//! One substep of the robot's motion: what is in its way, and what becomes of its contacts.
//!
//! A wall, another robot, a person, or ground too high to climb stops the drive; a lost ground
//! contact or a slope too steep ends it for good. Units: metres, seconds.

use super::{Loss, Simulator};
use crate::robot::{Mishap, Pose, Velocity};

/// Clearance at which a contact with a wall ends, metres.
pub(super) const CONTACT_OVER_M: f64 = 0.01;
/// Distance from its beginning at which a contact with the ground ends, metres.
const EDGE_OVER_M: f64 = 0.05;

impl Simulator<'_> {
    /// Moves if nothing is in the way, and returns true if it did. A robot that fell or tipped
    /// stays where it is.
    pub(super) fn substep(&mut self, velocity: Velocity, seconds: f64) -> bool {
        if self.loss.is_some() {
            self.drive.halt();
            return false;
        }
        let shift = self.config.traction.shift(&self.pose, velocity, seconds);
        let next = shift.applied(&self.pose);
        self.bumped = self.bumps(&next);
        if self.bumped.is_some() || self.runs_into_somebody(&next) {
            self.drive.halt();
            return false;
        }
        let next = match self.try_move(&next) {
            Ok(next) => next,
            Err(mishap) => {
                self.record(mishap);
                return false;
            }
        };
        self.path_length_m += shift.driven_m.abs();
        self.pose = next;
        if self
            .stopped_at
            .is_some_and(|at| at.distance_m(&next) >= EDGE_OVER_M)
        {
            self.stopped_at = None;
        }
        self.track_clearance();
        true
    }

    /// Returns the stance at a planar pose near by, or why the robot cannot go there.
    fn try_move(&mut self, next: &Pose) -> Result<Pose, Mishap> {
        let walled = |pose: &Pose| self.config.footprint.overlaps(self.world, pose);
        if walled(next) {
            return self.hit_wall();
        }
        let Some(mut contacts) = self.contacts else {
            return Ok(*next);
        };
        let stance = contacts.go(self.world, &self.pose, next, &self.config.failing);
        match stance {
            Ok(stance) if walled(&stance) => self.hit_wall(),
            Ok(stance) => {
                self.contacts = Some(contacts);
                Ok(stance)
            }
            Err(Mishap::Blocked) => {
                let again = self.stopped_at.is_some();
                self.safety.collisions += u32::from(!again);
                self.stopped_at.get_or_insert(self.pose);
                Err(Mishap::Blocked)
            }
            Err(mishap) => Err(mishap),
        }
    }

    /// Returns the other robot that is in the way to a pose. Robots that overlap already, because
    /// one leaned over, may part.
    fn bumps(&self, next: &Pose) -> Option<usize> {
        let footprint = &self.config.footprint;
        self.others.iter().position(|other| {
            let parts = || {
                let [now_m, then_m] = [&self.pose, next].map(|pose| pose.distance_m(other.pose()));
                footprint.touches(&self.pose, other) && then_m > now_m
            };
            footprint.touches(next, other) && !parts()
        })
    }

    /// Returns true if a person is in the way to a pose; counts contacts with people.
    fn runs_into_somebody(&mut self, next: &Pose) -> bool {
        let footprint = &self.config.footprint;
        let gap_m = self.people.gap_m(footprint, next);
        let safety = &mut self.safety;
        safety.min_person_gap_m = safety.min_person_gap_m.min(gap_m);
        let touches = gap_m == 0.0;
        safety.person_contacts += u32::from(touches && !self.touches_person);
        self.touches_person = touches || (self.touches_person && gap_m < CONTACT_OVER_M);
        touches
    }

    /// Counts a contact with a wall.
    fn hit_wall(&mut self) -> Result<Pose, Mishap> {
        self.safety.collisions += u32::from(!self.in_contact);
        self.in_contact = true;
        Err(Mishap::Blocked)
    }

    /// Stops the drive and records the mishap.
    fn record(&mut self, mishap: Mishap) {
        self.drive.halt();
        match mishap {
            Mishap::Blocked => self.safety.min_clearance_m = 0.0,
            Mishap::Fallen => {
                self.safety.falls += 1;
                self.loss = Some(Loss::Fell);
            }
            Mishap::Tipped => {
                self.safety.tips += 1;
                self.loss = Some(Loss::Tipped);
            }
        }
    }

    /// Measures how deep the hull lies in what is forbidden, and the clearance if it may be a new
    /// least value or end a contact.
    pub(super) fn track_clearance(&mut self) {
        let (fence, hull) = (&self.config.fence, &self.config.footprint);
        let depth_m = fence.hull_depth_m(hull, &self.pose);
        self.safety.deepest_forbidden_m = self.safety.deepest_forbidden_m.max(depth_m);
        let needed_m = if self.in_contact {
            CONTACT_OVER_M
        } else {
            self.safety.min_clearance_m
        };
        if self
            .config
            .footprint
            .clearance_bound_m(self.world, &self.pose)
            >= needed_m
        {
            self.in_contact = false;
            return;
        }
        let clearance_m = self.config.footprint.clearance_m(self.world, &self.pose);
        self.in_contact &= clearance_m < CONTACT_OVER_M;
        self.safety.min_clearance_m = self.safety.min_clearance_m.min(clearance_m);
    }
}
