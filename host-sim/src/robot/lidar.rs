//! A lidar as its maker built it and as somebody mounted it: which way it turns, where it begins.
//!
//! Beam i of m leaves the lidar at the angle `first ± i·step`, minus for one that turns clockwise.
//! Upside down, every angle changes its sign. The yaw of the mount is added last:
//!
//! ```text
//! bearing(i) = yaw + u (first + c i step)      u = −1 upside down, c = −1 clockwise, else 1
//! ```
//!
//! A lidar takes its turn time T from the first beam to the last one. With the newest beam last,
//! beam i of m is by `T (m − 1 − i) / (m − 1)` older than the scan; a driver that turned the scan
//! round may tell the newest one first.
//!
//! Bearings of the wire grow with the beam's number. Where u·c = −1 they fall, and the host turns
//! the scan round: [`Lidar::is_reversed`]. Position p counts the beams as the robot sees them, from
//! right to left.
//!
//! Metres, radians, seconds; x ahead, y to the left, z up; bearings counter-clockwise from ahead.

use core::f64::consts::TAU;

use fieldline_protocol::message;

use super::laser::LaserNoise;

/// Angles within which a lidar sees the robot itself: from, to, counter-clockwise, radians.
pub type Span = [f64; 2];

/// By how much a mask is wider on each side, radians: the wire rounds bearings.
const SLACK_RAD: f64 = 0.002;

/// A lidar on a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Lidar {
    /// Place on the robot: metres ahead of its centre, to the left, above the ground.
    pub position_m: [f64; 3],
    /// Turn of the mount, radians counter-clockwise; 0 unless the lidar is level.
    pub yaw_rad: f64,
    /// Radians; positive looks down.
    pub pitch_rad: f64,
    /// The lidar hangs upside down.
    pub upside_down: bool,
    /// The lidar turns clockwise, seen from its own top.
    pub clockwise: bool,
    /// Angle of its first beam in its own frame, radians.
    pub first_rad: f64,
    /// Angle from one beam to the next, radians, above 0.
    pub step_rad: f64,
    /// Beams that it promises a sweep.
    pub beams: usize,
    /// Time from its first beam to its last one, seconds; 0 if all are of one instant.
    pub turn_time_s: f64,
    /// The beam that it tells first is the newest, not the oldest.
    pub newest_first: bool,
    /// Least range, metres: a lesser reading carries no information.
    pub least_m: f64,
    /// Greatest range, metres: a reading of it or more met nothing.
    pub most_m: f64,
    /// Errors of the ranges, in the simulator.
    pub noise: LaserNoise,
    /// Bearings on the robot at which something of the robot is in the way.
    pub mask: Vec<Span>,
    /// Returns from within the robot's hull carry no information.
    pub ignores_hull: bool,
}

impl Lidar {
    /// A lidar with the mount and the sweep of one on the wire.
    #[must_use]
    pub fn announced(laser: &message::Laser, noise: LaserNoise) -> Self {
        Self {
            position_m: [laser.x.to_num(), laser.y.to_num(), laser.z.to_num()],
            yaw_rad: 0.0,
            pitch_rad: laser.pitch.to_num(),
            upside_down: false,
            clockwise: false,
            first_rad: laser.first_bearing.to_num(),
            step_rad: laser.bearing_step.to_num(),
            beams: usize::from(laser.beams),
            turn_time_s: f64::from(laser.turn_time_ms) / 1000.0,
            newest_first: laser.newest_first,
            least_m: super::laser::NEAREST_M,
            most_m: f64::from(laser.range_limit_mm) / 1000.0,
            noise,
            mask: Vec::new(),
            ignores_hull: false,
        }
    }

    /// Returns true if the beams come from left to right.
    #[must_use]
    pub const fn is_reversed(&self) -> bool {
        self.upside_down != self.clockwise
    }

    /// Bearing on the robot of position 0, radians. The middle of the sweep is within half a turn
    /// of straight ahead.
    #[must_use]
    pub fn rightmost_rad(&self) -> f64 {
        let sweep = self.step_rad * self.beams.saturating_sub(1) as f64;
        let own = if self.upside_down {
            -self.first_rad
        } else {
            self.first_rad
        };
        let first = self.yaw_rad + own;
        let right = if self.is_reversed() {
            first - sweep
        } else {
            first
        };
        right - TAU * ((right + 0.5 * sweep) / TAU).round()
    }

    /// Returns true if the rightmost beam is the newest.
    #[must_use]
    pub const fn is_newest_right(&self) -> bool {
        self.newest_first != self.is_reversed()
    }

    /// Returns by how much the beam at a position is older than the newest one, seconds.
    #[must_use]
    pub fn age_s(&self, position: usize) -> f64 {
        let last = self.beams.saturating_sub(1).max(1);
        let later = if self.is_newest_right() {
            position
        } else {
            last.saturating_sub(position)
        };
        self.turn_time_s * later as f64 / last as f64
    }

    /// Returns true if something of the robot is in the way at a bearing, radians.
    #[must_use]
    pub fn is_masked(&self, bearing_rad: f64) -> bool {
        let within = |[from, to]: &Span| {
            let width = (to - from).rem_euclid(TAU) + 2.0 * SLACK_RAD;
            (bearing_rad - from + SLACK_RAD).rem_euclid(TAU) <= width
        };
        self.mask.iter().any(within)
    }
}

#[cfg(test)]
mod tests {
    use super::super::laser;
    use super::*;

    fn lidar(first_deg: f64, step_deg: f64, beams: usize) -> Lidar {
        Lidar {
            first_rad: first_deg.to_radians(),
            step_rad: step_deg.to_radians(),
            beams,
            ..Lidar::announced(&laser::level(), LaserNoise::NONE)
        }
    }

    fn right_deg(lidar: &Lidar) -> f64 {
        lidar.rightmost_rad().to_degrees()
    }

    #[test]
    fn a_sweep_turned_either_way_has_its_rightmost_bearing() {
        let plain = lidar(-90.0, 1.0, 181);
        assert!((right_deg(&plain) + 90.0).abs() < 1e-9 && !plain.is_reversed());
        // Clockwise from 10° to the left of ahead: 10, 9, … −89.
        let clockwise = Lidar {
            clockwise: true,
            ..lidar(10.0, 1.0, 100)
        };
        assert!((right_deg(&clockwise) + 89.0).abs() < 1e-9 && clockwise.is_reversed());
        // Upside down its own 10, 11, … 109 are −10, −11, … −109.
        let hanging = Lidar {
            upside_down: true,
            ..lidar(10.0, 1.0, 100)
        };
        assert!((right_deg(&hanging) + 109.0).abs() < 1e-9 && hanging.is_reversed());
        let both = Lidar {
            clockwise: true,
            ..hanging
        };
        assert!((right_deg(&both) + 10.0).abs() < 1e-9 && !both.is_reversed());
        let turned = Lidar {
            yaw_rad: core::f64::consts::PI,
            ..lidar(-90.0, 1.0, 181)
        };
        assert!((right_deg(&turned).rem_euclid(360.0) - 90.0).abs() < 1e-9);
    }

    #[test]
    fn a_full_turn_with_its_seam_ahead_stays_within_a_turn() {
        for first_deg in [-720.0, -360.0, 0.0, 45.0, 360.0, 3600.0] {
            let right = right_deg(&lidar(first_deg, 0.8, 450));
            assert!((-360.0..=1.0).contains(&right), "{first_deg}: {right}");
        }
    }

    /// A lidar tells its oldest beam first, unless its driver turned the scan round.
    #[test]
    fn the_oldest_beam_is_where_the_lidar_begins() {
        for (clockwise, newest_first) in [(false, false), (true, false), (false, true)] {
            let lidar = Lidar {
                turn_time_s: 0.2,
                clockwise,
                newest_first,
                ..lidar(0.0, 2.0, 5)
            };
            let ages = [0, 1, 4].map(|position| lidar.age_s(position));
            let expected = if clockwise || newest_first {
                [0.0, 0.05, 0.2]
            } else {
                [0.2, 0.15, 0.0]
            };
            let off = |(age, expected): (&f64, &f64)| (age - expected).abs();
            let worst = ages.iter().zip(&expected).map(off).fold(0.0, f64::max);
            assert!(worst < 1e-12, "{ages:?}");
            assert_eq!(lidar.is_newest_right(), clockwise || newest_first);
        }
    }

    #[test]
    fn a_mask_may_cross_the_back() {
        let lidar = Lidar {
            mask: vec![[170.0_f64.to_radians(), -170.0_f64.to_radians()]],
            ..lidar(0.0, 1.0, 360)
        };
        for (deg, masked) in [(180.0, true), (-175.0, true), (531.0, true), (160.0, false)] {
            assert_eq!(lidar.is_masked(f64::to_radians(deg)), masked, "{deg}");
        }
    }
}
