//! The query of a search for a recovery: its surroundings, and the conditions on its end.
//!
//! Units: metres, radians; robot frame at the start.

use crate::drive::collision::CollisionChecker;
use crate::drive::dead_ends::DeadEnds;
use crate::drive::hull::Place;
use crate::drive::lane::Lane;
use crate::drive::roll_out::{RollOut, roll_out};
use crate::drive::{CAREFUL_MARGINS_M, SEARCH_MARGINS_M};
use crate::geometry::Point;
use crate::math;

/// Greatest angle to the field's heading at the end, radians.
const ALIGNED_RAD: f32 = 0.2;
/// Least distance from the start of a place where the robot turns to the heading by a larger angle,
/// metres: nearer by there is hardly more room.
const ELSEWHERE_M: f32 = 0.3;
const START: Point = Point::ORIGIN;

/// Least factor by which q grows from the start to the end of a recovery. In a passage as wide as
/// the robot, q doubles in 0.1 m.
const PROGRESS: f32 = 1.3;

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
    /// The robot creeps on for a while where no search finds a way. Otherwise it leaves the
    /// passage at once.
    pub squeezes: bool,
    /// The robot goes through no gap that leaves it little clearance.
    pub is_careful: bool,
    /// The robot has just started, and a turn on the spot would sweep what it has not seen: it
    /// drives straight ahead if it can.
    pub is_surrounded: bool,
    /// The lane that the robot follows instead of the field.
    pub(super) lane: Option<Lane>,
}

impl<'a, H: Fn(Place) -> Option<f32>> SearchQuery<'a, H> {
    /// Returns a query without a lane.
    pub const fn new(
        checker: &'a CollisionChecker,
        heading_at: H,
        potential_at: Option<&'a dyn Fn(Place) -> f32>,
    ) -> Self {
        Self {
            checker,
            heading_at,
            potential_at,
            squeezes: true,
            is_careful: false,
            is_surrounded: false,
            lane: None,
        }
    }

    /// Returns the clearances of the searches, metres, the first one first.
    pub(super) const fn margins_m(&self) -> &'static [f32] {
        if self.is_careful {
            &CAREFUL_MARGINS_M
        } else {
            &SEARCH_MARGINS_M
        }
    }

    /// Returns the least clearance of the way ahead of a robot that creeps, metres.
    pub(super) fn least_margin_m(&self) -> f32 {
        self.margins_m().last().copied().unwrap_or_default()
    }

    /// Returns the turn of a robot at a place to the heading of the lane or the field, radians.
    pub(super) fn misalignment(&self, place: Place) -> Option<f32> {
        let lane = self.lane.as_ref().and_then(|lane| lane.heading_at(place));
        let heading = lane.or_else(|| (self.heading_at)(place))?;
        Some(math::wrap(heading - place.yaw_rad))
    }

    /// Returns true if a place is farther along the field than the robot.
    fn is_progress(&self, place: Place) -> bool {
        self.potential_at
            .is_none_or(|q| q(place) > PROGRESS * q(Place::default()))
    }

    /// Returns the way on along the field, if the robot's front or back points along it and there
    /// is room for the way; otherwise notes the places of the way as dead ends. Adds to `points`
    /// the number of obstacle points for each checked place.
    #[inline(never)]
    pub(super) fn leads_on(
        &self,
        place: Place,
        backwards: bool,
        margin_m: f32,
        points: &mut u32,
        dead_ends: &mut DeadEnds<'_>,
    ) -> Option<RollOut> {
        if dead_ends.has(place, backwards) {
            return None;
        }
        let error = self.misalignment(place)?;
        let error = if backwards {
            math::wrap(error + math::PI)
        } else {
            error
        };
        if error.abs() >= ALIGNED_RAD {
            let may_turn = !backwards && place.point().distance2(START) > ELSEWHERE_M * ELSEWHERE_M;
            if !may_turn {
                return None;
            }
            *points += self.checker.points();
            if !self.checker.has_room_to_turn(place, margin_m) {
                return None;
            }
        }
        let is_far = |place| self.is_progress(place);
        let is_dead_end = |place| dead_ends.has(place, backwards);
        let ends = (&is_far as _, &is_dead_end as _);
        match roll_out(self, (place, backwards), margin_m, points, ends) {
            Ok((motions, end)) if self.is_progress(end) => Some(motions),
            Ok((motions, _)) | Err(motions) => {
                dead_ends.note(place, &motions, backwards);
                None
            }
        }
    }
}
