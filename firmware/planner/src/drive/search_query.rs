//! What a search for a manoeuvre runs on, and what it asks of the end of a way out.
//!
//! Units: metres, radians; robot frame at the start.

use crate::drive::collision::{CollisionChecker, Place};
use crate::math;

/// Alignment with the field at the end, radians.
const ALIGNED_RAD: f32 = 0.2;

/// What a search asks of a way out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attempt {
    /// The clearance kept, metres.
    pub margin_m: f32,
    /// Where it must lead.
    pub leads: Leads,
}

/// Where a way out must lead. No value is zero: so an idle drive is all zeros, and takes no place in the image's flash.
#[repr(u8)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Leads {
    /// Elsewhere.
    #[default]
    Elsewhere = 1,
    /// Farther along the field.
    Farther = 2,
}

/// What a search runs on: what stands around, and the field's heading at a place, radians left of the robot's present one, or
/// `None` where the field says nothing.
#[expect(missing_debug_implementations, reason = "it lends closures")]
pub struct Ground<'a, H> {
    /// What stands around.
    pub surround: &'a CollisionChecker,
    /// The field's heading.
    pub heading_at: H,
    /// How far along the field a place is (q of its cell); `None` where that is not asked for.
    pub potential_at: Option<&'a dyn Fn(Place) -> f32>,
}

/// By this factor q must grow from the start to the end of a manoeuvre. In a passage of the robot's width it doubles in 0.1 m.
const PROGRESS: f32 = 1.3;

impl<H: Fn(Place) -> Option<f32>> Ground<'_, H> {
    /// What the field asks a robot at a place to turn, radians.
    pub(super) fn misalignment(&self, place: Place) -> Option<f32> {
        (self.heading_at)(place).map(|heading| math::wrap(heading - place.yaw_rad))
    }

    /// Whether a place is farther along the field than the robot.
    fn is_progress(&self, place: Place) -> bool {
        self.potential_at
            .is_none_or(|q| q(place) > PROGRESS * q(Place::default()))
    }

    /// Whether the field asks for `length_m` straight on from here: forwards, or against the alignment backwards.
    fn asks_on(&self, place: Place, length_m: f32, attempt: Attempt) -> bool {
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

    /// Whether that can be followed. Looking costs as many points as there are, for each place on the way.
    pub(super) fn leads_on(
        &self,
        place: Place,
        length_m: f32,
        attempt: Attempt,
        points: &mut u32,
    ) -> bool {
        if !self.asks_on(place, length_m, attempt) {
            return false;
        }
        *points += CollisionChecker::places_on(length_m) * self.surround.points();
        self.surround
            .is_arc_clear(place, length_m, 0.0, attempt.margin_m)
    }
}
