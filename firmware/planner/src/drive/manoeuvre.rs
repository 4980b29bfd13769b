//! A manoeuvre out of a narrow place: a short leg forwards or backwards, then a turn on the spot, then on.
//!
//! In a passage narrower than the robot's diagonal it cannot turn everywhere. The search tries legs of growing length,
//! straight and curved, and takes the first at whose end the robot can turn to the field's heading *there* and go on for
//! [`GO_ON_M`]. The leg is driven to its end, so that the robot does not waver between two equally good ones.
//!
//! Units: metres, radians; robot frame.

use super::surround::{Place, Surround};
use crate::geometry::Twist;
use crate::math;

/// Speed of a leg, metres a second.
const LEG_MPS: f32 = 0.12;
/// Lengths of a leg go up by this much, metres.
const STEP_M: f32 = 0.06;
/// Number of lengths tried.
const LENGTHS: i32 = 9;
/// Curvatures tried, 1/m.
const CURVATURES: [f32; 5] = [0.0, 1.2, -1.2, 2.5, -2.5];
/// What must be free ahead after the turn, metres.
const GO_ON_M: f32 = 0.25;

/// A leg in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// What is driven.
    pub twist: Twist,
    /// How many more periods.
    pub periods: u16,
}

/// The shortest leg after which the robot can turn to `heading_at` its end (radians left of its present heading; `None`
/// where the field says nothing) and go on, keeping `margin_m`.
pub fn find(
    surround: &Surround,
    heading_at: impl Fn(Place) -> Option<f32>,
    period_s: f32,
    margin_m: f32,
) -> Option<Leg> {
    (1..=LENGTHS).find_map(|k| {
        CURVATURES.iter().find_map(|&curvature| {
            [-1.0, 1.0].into_iter().find_map(|sign| {
                let length = sign * k as f32 * STEP_M;
                let turn = length * curvature;
                let leads_on = surround.is_arc_clear(Place::default(), length, turn, margin_m)
                    && can_go_on(
                        surround,
                        Place::default().after(length, turn),
                        &heading_at,
                        margin_m,
                    );
                leads_on.then(|| leg(length, curvature, period_s))
            })
        })
    })
}

/// Whether the robot can turn from `end` to the field's heading there, the short way or the long, and go on.
fn can_go_on(
    surround: &Surround,
    end: Place,
    heading_at: &impl Fn(Place) -> Option<f32>,
    margin_m: f32,
) -> bool {
    let Some(heading) = heading_at(end) else {
        return false;
    };
    let turn = math::wrap(heading - end.yaw_rad);
    let turned = Place {
        yaw_rad: heading,
        ..end
    };
    surround.is_arc_clear(turned, GO_ON_M, 0.0, margin_m)
        && surround.is_arc_clear(end, 0.0, turn, margin_m)
}

fn leg(length: f32, curvature: f32, period_s: f32) -> Leg {
    let linear_mps = if length < 0.0 { -LEG_MPS } else { LEG_MPS };
    let periods = math::floor(length.abs() / (LEG_MPS * period_s)) + 1;
    Leg {
        twist: Twist {
            linear_mps,
            angular_radps: linear_mps * curvature,
        },
        periods: periods as u16,
    }
}
