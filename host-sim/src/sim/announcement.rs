//! The announcement: the start message, which tells a planner what is simulated.
//!
//! Lengths are rounded to the wire's numbers. A round hull is told as the square around it, since
//! the wire knows boxes only: the planner then counts on more room than the robot needs.
//! Accelerations are rounded down, so that the planner never counts on more than there is.

use fieldline_protocol::message::{Hull, Laser, Start, Strategy};
use fixed::types::I4F12;

use super::Simulator;
use crate::robot::{DriveLimits, Footprint, LaserScanner};

/// The greatest number of the wire that is at most `quantity`.
fn at_most(quantity: f64) -> I4F12 {
    let least_step = f64::from(1_u32 << I4F12::FRAC_NBITS);
    I4F12::saturating_from_num((quantity * least_step).floor() / least_step)
}

/// The nearest whole millimetre of a length.
fn millimetres(length_m: f64) -> u16 {
    (length_m * 1000.0).round() as u16
}

fn hull(footprint: &Footprint) -> Hull {
    Hull {
        length_mm: millimetres(2.0 * footprint.half_length_m),
        width_mm: millimetres(2.0 * footprint.half_width_m),
        height_mm: millimetres(footprint.height_m),
    }
}

/// Returns what a start message tells of a robot's body; the rest has its defaults.
pub(crate) fn of_robot(footprint: &Footprint, radius_m: f64, limits: &DriveLimits) -> Start {
    Start {
        hull: hull(footprint),
        robot_radius_mm: millimetres(radius_m),
        max_linear: I4F12::saturating_from_num(limits.linear_mps),
        max_angular: I4F12::saturating_from_num(limits.angular_radps),
        linear_accel: at_most(limits.acceleration_mps2.min(limits.braking_mps2)),
        angular_accel: at_most(limits.angular_radps2),
        ..Start::default()
    }
}

impl Simulator<'_> {
    /// The start message for the planner.
    #[must_use]
    pub fn start_message(&self, strategy: Strategy) -> Start {
        let config = &self.config;
        Start {
            strategy,
            lasers: self
                .lasers
                .iter()
                .map(LaserScanner::announced)
                .map(|laser| self.told(laser))
                .collect(),
            period_ms: u16::try_from(config.period_ms).unwrap_or(u16::MAX),
            order: strategy.order(),
            ..of_robot(&config.footprint, config.radius_m, &config.limits)
        }
    }

    /// Returns what the start message says of a laser.
    fn told(&self, laser: &Laser) -> Laser {
        let mut laser = *laser;
        if self.config.miswiring.turn_time_untold {
            laser.turn_time_ms = 0;
        }
        laser
    }
}
