//! From the field's heading to a velocity of a skid-steer robot that touches nothing.
//!
//! The wish is: turn towards the heading with rate `k·error`, go forward with `v_max·cos(error)`, brake for it. The wish is then
//! tried against the near field: a candidate (v, ω) is admissible if the robot's rectangle, moved along its arc for one
//! period and its braking distance v²/2a, stays clear of every point (a dynamic window over a handful of candidates).
//! The first admissible one, in order of distance from the wish, is driven.
//!
//! Invariant: a command is admissible under the near field, or zero.
//! Units: metres, seconds, radians; robot frame, x forward.

use heapless::Vec;

use crate::config::Config;
use crate::geometry::{Point, Pose, Twist};
use crate::math;
use crate::near::MOST_POINTS;

/// Half the 3-AT's length and width, metres.
pub const HALF_LENGTH_M: f32 = 0.254;
/// Half the 3-AT's width over its wheels, metres.
pub const HALF_WIDTH_M: f32 = 0.2485;
/// Clearance kept at speed, metres: three sigma of a range and one of the odometry between two scans.
const MARGIN_M: f32 = 0.06;
/// Clearance kept when creeping through a narrow place, metres: two sigma of a range.
const CREEP_MARGIN_M: f32 = 0.025;
/// Speed at and below which the robot creeps, metres a second.
const CREEP_MPS: f32 = 0.15;
/// Turn rate wished for a radian of error, 1/s.
const TURN_GAIN: f32 = 2.0;
/// Beyond this error the robot turns on the spot, radians.
const TURN_FIRST_RAD: f32 = 0.9;
/// A near point in the robot's frame, with the clearance asked of it.
#[derive(Clone, Copy, Debug)]
struct Threat {
    at: Point,
    clearance_m: f32,
}

/// Distance of a point from the robot's rectangle, by the larger overhang; negative inside.
fn overhang(x_m: f32, y_m: f32) -> f32 {
    let (along, across) = (x_m.abs() - HALF_LENGTH_M, y_m.abs() - HALF_WIDTH_M);
    if along > across { along } else { across }
}

/// The near field seen from the robot.
#[derive(Debug)]
pub struct Surround {
    threats: Vec<Threat, MOST_POINTS>,
}

impl Surround {
    /// The points as seen from `pose`.
    #[must_use]
    pub fn new(pose: &Pose, points: &[Point]) -> Self {
        let (sin, cos) = math::sin_cos(pose.yaw_rad);
        let threats = points
            .iter()
            .take(MOST_POINTS)
            .map(|point| {
                let (dx, dy) = (point.x_m - pose.x_m, point.y_m - pose.y_m);
                let at = Point {
                    x_m: dx * cos + dy * sin,
                    y_m: dy * cos - dx * sin,
                };
                Threat {
                    at,
                    clearance_m: overhang(at.x_m, at.y_m),
                }
            })
            // A point inside the robot is a false echo or a passing hand; it cannot be avoided any more.
            .filter(|threat| threat.clearance_m > -0.02)
            .collect();
        Self { threats }
    }

    /// Whether the rectangle at this place of the robot's frame keeps `margin_m` from every point. A point that is already
    /// nearer than the margin may not come nearer.
    fn clear(&self, x_m: f32, y_m: f32, yaw_rad: f32, margin_m: f32) -> bool {
        let (sin, cos) = math::sin_cos(yaw_rad);
        self.threats.iter().all(|threat| {
            let (dx, dy) = (threat.at.x_m - x_m, threat.at.y_m - y_m);
            let now = overhang(dx * cos + dy * sin, dy * cos - dx * sin);
            let least = threat.clearance_m - 0.004;
            now >= if margin_m < least { margin_m } else { least }
        })
    }

    /// Whether the arc of `twist`, for one period and the braking after it, is clear.
    fn admissible(&self, twist: Twist, config: &Config) -> bool {
        let (v, w) = (twist.linear_mps, twist.angular_radps);
        let margin = if v.abs() > CREEP_MPS {
            MARGIN_M
        } else {
            CREEP_MARGIN_M
        };
        let period = config.period_s;
        let (length, turn) = if v.abs() < 1e-3 {
            (
                0.0,
                w * period + w * w.abs() / (2.0 * config.angular_accel_radps2),
            )
        } else {
            let length = v * period + v * v.abs() / (2.0 * config.linear_accel_mps2);
            (length, w * length / v)
        };
        let samples = math::floor((length.abs() / 0.08).max(turn.abs() / 0.12)) + 1;
        (1..=samples).all(|i| {
            let part = i as f32 / samples as f32;
            let (along, yaw) = (length * part, turn * part);
            let (sin, cos) = math::sin_cos(yaw * 0.5);
            // The chord of an arc points along its mean heading and is shorter than it by sinc(yaw/2) ≈ 1 − yaw²/24.
            let chord = along * (1.0 - yaw * yaw / 24.0);
            self.clear(chord * cos, chord * sin, yaw, margin)
        })
    }
}

/// The velocity for `heading_rad` (odometry frame), or zero where nothing is admissible.
#[must_use]
pub fn drive(config: &Config, pose: &Pose, heading_rad: f32, surround: &Surround) -> Twist {
    let error = math::wrap(heading_rad - pose.yaw_rad);
    let wish = wish(config, error);
    for v_part in [1.0, 0.6, 0.3] {
        for w_offset in [0.0, 0.25, -0.25, 0.6, -0.6] {
            let twist = Twist {
                linear_mps: wish.linear_mps * v_part,
                angular_radps: clamp(wish.angular_radps + w_offset, config.max_angular_radps),
            };
            if twist.linear_mps > 0.02 && surround.admissible(twist, config) {
                return twist;
            }
        }
    }
    evade(config, wish, surround)
}

/// What the robot would do in the open.
fn wish(config: &Config, error: f32) -> Twist {
    let angular_radps = clamp(TURN_GAIN * error, config.max_angular_radps * 0.6);
    let linear_mps = if error.abs() > TURN_FIRST_RAD {
        0.0
    } else {
        let (_, cos) = math::sin_cos(error);
        config.max_linear_mps * cos * cos
    };
    Twist {
        linear_mps,
        angular_radps,
    }
}

/// Where the way ahead is taken: turn on the spot, creep, or back out.
fn evade(config: &Config, wish: Twist, surround: &Surround) -> Twist {
    let turn = wish.angular_radps;
    let least_turn = if turn < 0.0 { -0.3 } else { 0.3 };
    let turn = if turn.abs() < 0.3 { least_turn } else { turn };
    let candidates = [
        (0.0, turn),
        (0.0, turn * 0.4),
        (0.1, 0.0),
        (0.1, 0.3),
        (0.1, -0.3),
        (-0.12, 0.0),
        (-0.12, 0.3),
        (-0.12, -0.3),
        (0.0, -turn),
    ];
    candidates
        .iter()
        .map(|&(linear_mps, angular_radps)| Twist {
            linear_mps,
            angular_radps,
        })
        .find(|&twist| surround.admissible(twist, config))
        .unwrap_or_default()
}

fn clamp(value: f32, most: f32) -> f32 {
    value.clamp(-most, most)
}
