//! The field's tests: seeded windows, their solution in f64, and angles.

pub mod floor;
pub mod scenes;
pub mod truth;
pub mod walk;

use fieldline_planner::field::{SIDE, Window};
use fieldline_planner::math;

pub use fieldline_planner::field::Rows;

/// Returns every cell of the window, row by row.
pub fn cells() -> impl Iterator<Item = (usize, usize)> {
    (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)))
}

/// Takes one step of the steepest ascent of q: to a neighbouring goal, or else to the neighbour
/// with the greatest q if that is greater than q here. From any reachable cell of a solved window
/// these steps lead to a goal.
pub fn ascend(window: &Window, x: usize, y: usize) -> Option<(usize, usize)> {
    if !window.is_reached(x, y) {
        return None;
    }
    let mut best = (window.q(x, y), None);
    for (x, y) in [
        (x.wrapping_sub(1), y),
        (x + 1, y),
        (x, y.wrapping_sub(1)),
        (x, y + 1),
    ] {
        // Beside nothing but goals, q may have rounded to a goal's own value.
        if window.is_goal(x, y) {
            return Some((x, y));
        }
        if window.q(x, y) > best.0 {
            best = (window.q(x, y), Some((x, y)));
        }
    }
    best.1
}

/// Returns sine and cosine, the same on every host.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = math::sin_cos(math::wrap(angle as f32));
    (f64::from(sin), f64::from(cos))
}

/// Returns the degrees between two angles in radians, from 0 to 180.
pub fn degrees_between(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(core::f64::consts::TAU);
    turn.min(core::f64::consts::TAU - turn).to_degrees()
}
