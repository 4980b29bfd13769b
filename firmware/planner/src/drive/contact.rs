//! Contact: the robot does not do what it was told, so something holds it that no laser saw.
//!
//! ```text
//! due  = towards(measured a period ago, told, acceleration · period)
//! held = |told| > standing   and   due > 0   and   measured < due / 3, towards the side told
//! ```
//!
//! After [`HELD_PERIODS`] held periods in a row the robot feels a contact at the edge with which it
//! leads. Nothing says where along the edge, so all of it counts.
//!
//! Units: metres, metres per second, radians per second; robot frame, x forward.

use crate::config::Config;
use crate::drive::collision::towards;
use crate::drive::{STANDING_MPS, STANDING_RADPS};
use crate::geometry::{Point, Twist};
use crate::robot::RobotShape;

/// Held periods in a row that make a contact: one may be a command that came late.
const HELD_PERIODS: u8 = 3;
/// A robot that has less than this part of its due speed is held.
const HELD_PART: f32 = 1.0 / 3.0;
/// Distance of a felt point from the hull, metres: what the drive may still approach.
const AWAY_M: f32 = 0.01;

/// A contact, by the side with which the robot led.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contact {
    /// It drove ahead.
    Front,
    /// It drove back.
    Back,
    /// It turned to the left on the spot.
    TurnLeft,
    /// It turned to the right on the spot.
    TurnRight,
}

/// Compares what the robot was told with what it did.
#[derive(Debug)]
pub(crate) struct ContactSense {
    told: Twist,
    /// The measured velocity when it was told.
    measured: Twist,
    held_periods: u8,
}

impl ContactSense {
    /// Returns the sense of a robot that was told nothing yet.
    pub(crate) const fn new() -> Self {
        Self {
            told: Twist::STILL,
            measured: Twist::STILL,
            held_periods: 0,
        }
    }

    /// Notes the velocity that the robot is told to drive for the next period.
    pub(crate) const fn tell(&mut self, told: Twist) {
        self.told = told;
    }

    /// Compares the measured velocity with what was told a period ago.
    pub(crate) fn feel(&mut self, config: &Config, measured: Twist) -> Option<Contact> {
        let leading = self.leading(config, measured);
        self.measured = measured;
        let Some((contact, is_held)) = leading else {
            self.held_periods = 0;
            return None;
        };
        self.held_periods = if is_held { self.held_periods + 1 } else { 0 };
        if self.held_periods < HELD_PERIODS {
            return None;
        }
        self.held_periods = 0;
        Some(contact)
    }

    /// Returns the side with which the told velocity leads, and true if the robot is held; `None`
    /// if it was told to stand.
    fn leading(&self, config: &Config, measured: Twist) -> Option<(Contact, bool)> {
        let is_held = |told: f32, [before, now]: [f32; 2], accel: f32| {
            let due = towards(before, told, accel * config.period_s) * told.signum();
            due > 0.0 && now * told.signum() < HELD_PART * due
        };
        let (v, w) = (self.told.linear_mps, self.told.angular_radps);
        if v.abs() > STANDING_MPS {
            let side = if v > 0.0 {
                Contact::Front
            } else {
                Contact::Back
            };
            let speeds = [self.measured, measured].map(|twist| twist.linear_mps);
            let is_held = is_held(v, speeds, config.linear_accel_mps2);
            return Some((side, is_held));
        }
        (w.abs() > STANDING_RADPS).then(|| {
            let side = if w > 0.0 {
                Contact::TurnLeft
            } else {
                Contact::TurnRight
            };
            let rates = [self.measured, measured].map(|twist| twist.angular_radps);
            let is_held = is_held(w, rates, config.angular_accel_radps2);
            (side, is_held)
        })
    }
}

impl Contact {
    /// Returns true for a turn on the spot.
    pub(crate) const fn is_turn(self) -> bool {
        matches!(self, Self::TurnLeft | Self::TurnRight)
    }

    /// Returns where the hull may have touched, in the robot's frame: all along the edge ahead or
    /// behind, or along the half of each edge with which a turn leads.
    pub(crate) fn points(self, robot: &RobotShape) -> impl Iterator<Item = Point> {
        let (length_m, width_m) = (robot.half_length_m, robot.half_width_m);
        let beyond = |half_m: f32| half_m + AWAY_M;
        // From right to left, as parts of half the width.
        let edge = [-0.9, -0.6, -0.3, -0.1, 0.1, 0.3, 0.6, 0.9];
        // From the middle of an edge towards its leading corner.
        let parts = [0.4, 0.8];
        (0..8_usize).filter_map(move |k| {
            let part = *parts.get(k % 2)?;
            let (x_m, y_m) = match (self, k / 2) {
                (Self::Front, _) => (beyond(length_m), edge.get(k)? * width_m),
                (Self::Back, _) => (-beyond(length_m), edge.get(k)? * width_m),
                (_, 0) => (beyond(length_m), -part * width_m),
                (_, 1) => (part * length_m, beyond(width_m)),
                (_, 2) => (-beyond(length_m), part * width_m),
                (_, _) => (-part * length_m, -beyond(width_m)),
            };
            // A turn to the right is the mirror image.
            let y_m = if self == Self::TurnRight { -y_m } else { y_m };
            Some(Point { x_m, y_m })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::CollisionChecker;
    use crate::geometry::Pose;

    const ROBOT: RobotShape = RobotShape::PIONEER_3AT;

    fn twist(linear_mps: f32, angular_radps: f32) -> Twist {
        Twist {
            linear_mps,
            angular_radps,
        }
    }

    /// Returns the contacts that a robot feels which is told the same for ten periods.
    fn felt(told: Twist, measured: impl Fn(u8) -> Twist) -> std::vec::Vec<(u8, Contact)> {
        let config = Config::pioneer_3at(heapless::Vec::new());
        let mut sense = ContactSense::new();
        let mut felt = std::vec::Vec::new();
        for period in 0..10 {
            felt.extend(
                sense
                    .feel(&config, measured(period))
                    .map(|side| (period, side)),
            );
            sense.tell(told);
        }
        felt
    }

    #[test]
    fn a_held_robot_feels_the_edge_with_which_it_leads() {
        let held = |_| Twist::default();
        for (told, side) in [
            (twist(0.7, 0.2), Contact::Front),
            (twist(-0.15, 0.0), Contact::Back),
            (twist(0.0, 0.6), Contact::TurnLeft),
            (twist(0.0, -0.6), Contact::TurnRight),
        ] {
            let expected = [(3, side), (6, side), (9, side)];
            assert_eq!(felt(told, held), expected);
        }
    }

    #[test]
    fn a_robot_that_reverses_its_turn_feels_nothing() {
        let reverses = |period| twist(0.0, (0.35 * f32::from(period) - 1.4).min(1.4));
        assert_eq!(felt(twist(0.0, 1.4), reverses), []);
    }

    #[test]
    fn a_robot_that_accelerates_stands_or_brakes_feels_nothing() {
        let starts = |period| twist((0.06 * f32::from(period) - 0.06).clamp(0.0, 0.7), 0.0);
        assert_eq!(felt(twist(0.7, 0.0), starts), []);
        assert_eq!(felt(Twist::default(), |_| Twist::default()), []);
        assert_eq!(felt(Twist::default(), |_| twist(0.5, 0.0)), []);
        assert_eq!(felt(twist(0.1, 0.0), |_| twist(0.6, 0.0)), []);
    }

    /// A command that arrives a period late is no contact.
    #[test]
    fn two_held_periods_are_no_contact() {
        let late = |period| twist(if period % 3 == 0 { 0.1 } else { 0.0 }, 0.0);
        assert_eq!(felt(twist(0.1, 0.0), late), []);
    }

    #[test]
    fn the_robot_may_go_back_from_what_it_felt_and_not_on() {
        let config = Config::pioneer_3at(heapless::Vec::new());
        for (contact, on) in [
            (Contact::Front, twist(0.1, 0.0)),
            (Contact::Back, twist(-0.1, 0.0)),
            (Contact::TurnLeft, twist(0.0, 0.4)),
            (Contact::TurnRight, twist(0.0, -0.4)),
        ] {
            let points: std::vec::Vec<_> = contact.points(&ROBOT).collect();
            let checker = CollisionChecker::new(&ROBOT, &Pose::default(), &points);
            let back = twist(-on.linear_mps, -on.angular_radps);
            let admits = |told| checker.admits(told, Twist::default(), &config, 0.02);
            assert!(admits(back) && !admits(on), "{contact:?}");
        }
    }
}
