//! What odometry says between two steps, and how far it may be wrong.
//!
//! ```text
//! x⁺ = x ⊕ (odom⁻¹ ⊕ odom′)        P⁺ = F P Fᵀ + Q
//! σ²(along) = along_by_distance d + along_by_turn |θ| + floor²
//! σ²(turn)  = turn_by_turn |θ| + turn_by_distance d + floor²
//! ```
//!
//! The variances grow with distance and turn, not with their squares, so that they do not depend on
//! the rate of the steps. They are larger than those of a good odometry by design: a scale error is
//! no white noise, and a step must be able to follow it.
//!
//! Units: metres, radians.

use crate::config::LocaliseTuning;
use crate::geometry::{OdomPose, Point, Pose};
use crate::localise::symmetric::Symmetric;
use crate::math;

/// Returns the covariance after the robot moved from one odometry pose to the next. `covariance`
/// and the result are about the robot's place in the map; `yaw_rad` is its new yaw there.
pub(super) fn spread(
    covariance: &Symmetric,
    (from, to): (&OdomPose, &OdomPose),
    yaw_rad: f32,
    tuning: &LocaliseTuning,
) -> Symmetric {
    let (from, to) = (&from.0, &to.0);
    let turn = math::wrap(to.yaw_rad - from.yaw_rad).abs();
    let shift = from.to_robot(to.point());
    let moved = Pose {
        yaw_rad: math::wrap(yaw_rad + from.yaw_rad - to.yaw_rad),
        ..Pose::default()
    }
    .to_map(shift);
    let distance = math::sqrt(shift.x_m * shift.x_m + shift.y_m * shift.y_m);
    let carried = carry(covariance, moved);
    let floor = tuning.floor_m * tuning.floor_m;
    let along = tuning.along_by_distance * distance + tuning.along_by_turn * turn + floor;
    let across = tuning.across_share * along;
    let angle = tuning.turn_by_turn * turn
        + tuning.turn_by_distance * distance
        + tuning.floor_rad * tuning.floor_rad;
    let (sin, cos) = math::sin_cos(yaw_rad);
    let mut noise = Symmetric::diagonal(0.0, 0.0, angle);
    noise.add_outer(along, [cos, sin, 0.0]);
    noise.add_outer(across, [-sin, cos, 0.0]);
    carried + noise
}

/// Returns `F P Fᵀ` of a shift in the map: an error of the yaw turns the shift.
pub(crate) fn carry(p: &Symmetric, shift: Point) -> Symmetric {
    let (a, b) = (-shift.y_m, shift.x_m);
    Symmetric {
        xx: p.xx + 2.0 * a * p.xt + a * a * p.tt,
        xy: p.xy + a * p.yt + b * p.xt + a * b * p.tt,
        yy: p.yy + 2.0 * b * p.yt + b * b * p.tt,
        xt: p.xt + a * p.tt,
        yt: p.yt + b * p.tt,
        tt: p.tt,
    }
}
