//! A spiral ramp: a road 2.2 m wide that winds up a hill in two and a quarter turns to a flat top
//! 4.5 m up.
//!
//! In polar coordinates around the middle, with u the number of turns inwards from the outer edge,
//!
//! ```text
//! u = (R − r) / pitch − θ / 2π      height of the road of turn n:  rise (n + θ / 2π)
//! ```
//!
//! Beside the road the ground falls on the outer side and rises on the inner side, by 2 m within
//! 1 m. The grade of the road is 0.03 at the foot and 0.09 at the top. 26 × 26 m.

use super::{Drawing, bumps, plan, raised};

/// Distance of the road's beginning from the middle, metres.
const RADIUS_M: f64 = 11.0;
/// Distance from one turn to the next, metres.
const PITCH_M: f64 = 3.2;
/// Share of the pitch that is road.
const ROAD: f64 = 2.2 / 3.2;
/// Height gained per turn, metres.
const RISE_M: f64 = 2.0;
/// Number of turns up to the top.
const TURNS: f64 = 2.25;

/// Draws it.
pub(crate) fn draw() -> Drawing {
    raised(plan([26.0, 26.0], &[], &[]), |x, y| {
        let (dx, dy) = (x - 13.0, y - 13.0);
        let angle = libm::atan2(dy, dx) / core::f64::consts::TAU;
        let angle = angle - angle.floor();
        let turns = (RADIUS_M - (dx * dx + dy * dy).sqrt()) / PITCH_M - angle;
        let turn = turns.floor();
        let road = |turn: f64| RISE_M * (turn + angle).clamp(0.0, TURNS);
        // Within a turn's band the road comes first, then the face up to the next turn.
        let face = ((turns - turn - ROAD) / (1.0 - ROAD)).max(0.0);
        road(turn) + face * (road(turn + 1.0) - road(turn)) + bumps(x, y, 0.02)
    })
}
