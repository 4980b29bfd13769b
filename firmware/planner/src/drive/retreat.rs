//! The retreat: back along the robot's own track, to a place where it can turn, or from which a
//! path leads on.
//!
//! Units: metres, seconds, radians.

use crate::config::Config;
use crate::drive::collision::LEAST_MARGIN_M;
use crate::drive::direct::CREEP_MARGIN_M;
use crate::drive::{CollisionChecker, Drive, Place, is_moving};
use crate::geometry::{MapPose, Twist};

/// Speeds of a retreat, as parts of the one that the track asks for, and its clearances, metres.
/// There is room on the track, but noise brings the points of its walls nearer as time goes by. So
/// the last one needs none, unless another robot may be in the way.
const RETREATS: [(f32, f32); 3] = [(1.0, LEAST_MARGIN_M), (0.5, LEAST_MARGIN_M), (0.25, 0.0)];

impl Drive {
    /// Begins a retreat if the robot cannot turn where it is, or if it `must` go away.
    pub(crate) fn begin_retreat(&mut self, checker: &CollisionChecker, must: bool) {
        if self.track.is_empty() || self.retreats {
            return;
        }
        if must || !can_turn_about(checker) {
            self.retreats = true;
            self.track.begin_retreat();
            self.recovery.clear();
            self.search = None;
        }
    }

    /// Returns the velocity back along the track; zero at its end. `checker` has the obstacle
    /// points that the robot has measured, and no cells of the map: there is room on the track. A
    /// slower robot stops within a shorter way, so it may go on where a faster one may not.
    pub(crate) fn retreat(
        &mut self,
        config: &Config,
        MapPose(pose): &MapPose,
        checker: &CollisionChecker,
        now: Twist,
    ) -> Twist {
        // A wish that hardly moves the robot ends the retreat: nothing would tell that it is held.
        let wish = self.track.back(pose, config.period_s);
        let wish = wish.filter(|&wish| is_moving(wish));
        let least_m = if checker.has_robots() {
            LEAST_MARGIN_M
        } else {
            0.0
        };
        let twist = wish.and_then(|wish| {
            let slower = |(part, margin_m): (f32, f32)| {
                let margin_m = margin_m.max(least_m);
                let twist = Twist {
                    linear_mps: part * wish.linear_mps,
                    angular_radps: part * wish.angular_radps,
                };
                checker
                    .admits(twist, now, config, margin_m)
                    .then_some(twist)
            };
            RETREATS.into_iter().find_map(slower)
        });
        self.retreats = wish.is_some() && (twist.is_some() || is_moving(now));
        if !self.retreats {
            self.track.clear();
        }
        twist.unwrap_or_default()
    }

    /// Ends the retreat of a robot whose plan `leads_on`, once it has gone far enough and can turn.
    /// `checker` has all obstacles.
    pub(crate) fn end_retreat(&mut self, checker: &CollisionChecker, leads_on: bool) {
        self.retreats &= !(leads_on && self.track.has_left() && can_turn_about(checker));
    }
}

/// Returns true if the robot has room for every turn on the spot where it stands.
fn can_turn_about(checker: &CollisionChecker) -> bool {
    checker.has_room_to_turn(Place::default(), CREEP_MARGIN_M)
}
