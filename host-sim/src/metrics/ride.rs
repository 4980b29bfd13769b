//! The ride: the steepest attitudes of the robot, and its time beyond the limits.
//!
//! Computed from the true stance in every substep. Radians, seconds.

use crate::robot::{Limits, Pose};

/// The ride so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ride {
    /// Steepest pitch, up or down, radians.
    pub max_pitch_rad: f64,
    /// Steepest roll, to either side, radians.
    pub max_roll_rad: f64,
    /// Time spent beyond the limits, seconds.
    pub over_limits_s: f64,
}

impl Ride {
    /// Adds an attitude that lasted for some seconds.
    pub fn add(&mut self, pose: &Pose, limits: &Limits, seconds: f64) {
        self.max_pitch_rad = self.max_pitch_rad.max(pose.pitch_rad.abs());
        self.max_roll_rad = self.max_roll_rad.max(pose.roll_rad.abs());
        if !limits.holds_attitude(pose.pitch_rad, pose.roll_rad) {
            self.over_limits_s += seconds;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_the_steepest_and_the_time_beyond_the_limits() {
        let mut ride = Ride::default();
        for (pitch_deg, roll_deg) in [(-18.0, 3.0), (21.0, 0.0), (2.0, -16.0), (0.0, 0.0_f64)] {
            let pose = Pose {
                pitch_rad: f64::to_radians(pitch_deg),
                roll_rad: roll_deg.to_radians(),
                ..Pose::default()
            };
            ride.add(&pose, &Limits::WORKING, 0.5);
        }
        assert_eq!(ride.max_pitch_rad, 21.0_f64.to_radians());
        assert_eq!(ride.max_roll_rad, 16.0_f64.to_radians());
        assert_eq!(ride.over_limits_s, 1.0);
    }
}
