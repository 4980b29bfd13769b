//! The query of a search for a recovery: its surroundings, and the conditions on its end.
//!
//! Units: metres, radians; robot frame at the start.

use crate::drive::collision::{CollisionChecker, Place};
use crate::math;

/// Greatest angle to the field's heading at the end, radians.
const ALIGNED_RAD: f32 = 0.2;

/// Least factor by which q grows from the start to the end of a recovery. In a passage as wide as
/// the robot, q doubles in 0.1 m.
const PROGRESS: f32 = 1.3;

/// The conditions on a recovery.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Attempt {
    /// Clearance, metres.
    pub(super) margin_m: f32,
    /// Where it must lead.
    pub(super) leads: Leads,
}

/// The condition on the end of a recovery.
///
/// No value is zero: so a drive without a search is all zeros and takes no flash.
#[repr(u8)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Leads {
    /// Any other pose.
    #[default]
    Elsewhere = 1,
    /// A place farther along the field.
    Farther = 2,
}

/// The input of a search: the obstacles and the field around the robot.
#[allow(missing_debug_implementations, reason = "it lends closures")]
pub struct SearchQuery<'a, H> {
    /// The obstacles.
    pub checker: &'a CollisionChecker,
    /// The field's heading at a place, radians to the left of the robot's present heading; `None`
    /// where the field is flat.
    pub heading_at: H,
    /// q of a place's cell, which grows along the field; `None` if recoveries need no progress.
    pub potential_at: Option<&'a dyn Fn(Place) -> f32>,
}

impl<H: Fn(Place) -> Option<f32>> SearchQuery<'_, H> {
    /// Returns the turn of a robot at a place to the field's heading, radians.
    pub(super) fn misalignment(&self, place: Place) -> Option<f32> {
        (self.heading_at)(place).map(|heading| math::wrap(heading - place.yaw_rad))
    }

    /// Returns true if a place is farther along the field than the robot.
    fn is_progress(&self, place: Place) -> bool {
        self.potential_at
            .is_none_or(|q| q(place) > PROGRESS * q(Place::default()))
    }

    /// Returns true if the field leads `length_m` straight on from here: ahead, or backwards for a
    /// negative length.
    fn is_aligned(&self, place: Place, length_m: f32, attempt: Attempt) -> bool {
        let aligned = self.misalignment(place).is_some_and(|error| {
            let error = if length_m < 0.0 {
                math::wrap(error + math::PI)
            } else {
                error
            };
            error.abs() < ALIGNED_RAD
        });
        aligned
            && (attempt.leads == Leads::Elsewhere || self.is_progress(place.after(length_m, 0.0)))
    }

    /// Returns true if the field leads `length_m` straight on and the robot can follow. Adds to
    /// `points` the number of obstacle points for each checked place.
    pub(super) fn leads_on(
        &self,
        place: Place,
        length_m: f32,
        attempt: Attempt,
        points: &mut u32,
    ) -> bool {
        if !self.is_aligned(place, length_m, attempt) {
            return false;
        }
        *points += CollisionChecker::places_on(length_m) * self.checker.points();
        self.checker
            .is_arc_clear(place, length_m, 0.0, attempt.margin_m)
    }
}
