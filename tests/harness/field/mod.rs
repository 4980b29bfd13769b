//! The field's tests: seeded windows, their solution in f64, and angles.

pub mod floor;
pub mod scenes;
pub mod truth;
pub mod walk;

use fieldline_planner::field::SIDE;
use fieldline_planner::math;

/// Bit masks of the window's rows: bit x of row y is cell (x, y).
pub type Rows = [u64; SIDE];

/// Returns every cell of the window, row by row.
pub fn cells() -> impl Iterator<Item = (usize, usize)> {
    (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)))
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
