//! Starts that are known only roughly: somebody put the robot there by hand.
//!
//! The first robot's start defines the team's coordinates. Each other robot is told where its
//! odometry begins as if it stood beside its true start:
//!
//! ```text
//! told ∘ start = start + (N(0, σ²), N(0, σ²)),  yaw + N(0, σ_yaw²)
//! ```
//!
//! Metres, radians.

use core::fmt;
use core::str::FromStr;

use fieldline_protocol::message as wire;
use fixed::types::I16F16;

use crate::robot::{Noise, Source};
use crate::spec::{self, SpecError};
use crate::world::Start;

/// Standard deviations of the starts that the robots are told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartError {
    /// Along each axis, metres.
    pub sd_m: f64,
    /// Of the yaw, radians.
    pub sd_rad: f64,
}

impl StartError {
    /// Returns the team of a robot that is told a wrong start. The first robot's is right.
    pub(super) fn tell(&self, team: wire::Team, seed: u64, start: &Start) -> wire::Team {
        let is_known = self.sd_m <= 0.0 || self.sd_rad <= 0.0;
        if is_known || team.member.id == 0 {
            return team;
        }
        let mut noise = Noise::new(seed, Source::Start);
        let off_m = [noise.normal() * self.sd_m, noise.normal() * self.sd_m];
        let yaw = noise.normal() * self.sd_rad;
        let (sin, cos) = (libm::sin(yaw), libm::cos(yaw));
        // The motion turns about the start and shifts it.
        let x_m = start.x_m + off_m[0] - (cos * start.x_m - sin * start.y_m);
        let y_m = start.y_m + off_m[1] - (sin * start.x_m + cos * start.y_m);
        wire::Team {
            origin: (
                I16F16::saturating_from_num(x_m),
                I16F16::saturating_from_num(y_m),
            ),
            yaw: I16F16::saturating_from_num(yaw),
            sd_mm: (self.sd_m * 1e3).round() as u16,
            sd_mrad: (self.sd_rad * 1e3).round() as u16,
            ..team
        }
    }
}

impl FromStr for StartError {
    type Err = SpecError;

    /// Parses metres and degrees, as in `0.3,5`.
    fn from_str(text: &str) -> Result<Self, SpecError> {
        match spec::numbers(text).as_deref() {
            Some(&[sd_m, deg]) if (0.001..=2.0).contains(&sd_m) && (0.1..=20.0).contains(&deg) => {
                let sd_rad = deg.to_radians();
                Ok(Self { sd_m, sd_rad })
            }
            _ => Err(SpecError::new(
                "give metres, 0.001 to 2, and degrees, 0.1 to 20, as in 0.3,5",
            )),
        }
    }
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{:.3}", self.sd_m, self.sd_rad.to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::team::member::Member;

    #[test]
    fn the_told_start_is_beside_the_true_one_and_the_first_robots_is_right() {
        let error: StartError = "0.3,5".parse().expect("two numbers");
        let start = Start {
            x_m: 17.0,
            y_m: -9.0,
            yaw_rad: 1.0,
        };
        assert_eq!(
            error.tell(Member::of_wire(0), 1, &start),
            Member::of_wire(0)
        );
        let (mut sum, seeds) = ([0.0; 3], 400);
        for seed in 0..seeds {
            let told = error.tell(Member::of_wire(1), seed, &start);
            let yaw: f64 = told.yaw.to_num();
            let origin: [f64; 2] = [told.origin.0.to_num(), told.origin.1.to_num()];
            let (sin, cos) = yaw.sin_cos();
            let off = [
                origin[0] + cos * start.x_m - sin * start.y_m - start.x_m,
                origin[1] + sin * start.x_m + cos * start.y_m - start.y_m,
                yaw,
            ];
            for (sum, off) in sum.iter_mut().zip(off) {
                *sum += off * off / f64::from(seeds as u32);
            }
        }
        let sd = sum.map(f64::sqrt);
        // Four standard errors.
        assert!(
            (sd[0] - 0.3).abs() < 0.043 && (sd[1] - 0.3).abs() < 0.043,
            "{sd:?}"
        );
        assert!((sd[2].to_degrees() - 5.0).abs() < 0.71, "{sd:?}");
    }

    #[test]
    fn what_is_no_error_of_a_start_is_refused() {
        for text in ["", "0.3", "0,5", "0.3,0", "3,5", "0.3,50", "a,b", "0.3;5"] {
            assert!(text.parse::<StartError>().is_err(), "{text}");
        }
    }
}
