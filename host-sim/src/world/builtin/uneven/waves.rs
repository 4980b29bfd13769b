//! A field of gentle waves: two swells that cross, 1 m from the lowest to the highest point,
//! nowhere steeper than 12.8°.
//!
//! A robot can drive everywhere in every direction, although much of the ground lies more than 0.6
//! m below the crests around it. 30 × 30 m.

use super::{Drawing, plan, raised};
use core::f64::consts::TAU;

/// Draws it.
pub(crate) fn draw() -> Drawing {
    let trees = [
        [6.0, 8.4, 0.25],
        [22.4, 6.2, 0.28],
        [14.2, 15.6, 0.22],
        [8.2, 23.0, 0.25],
        [24.6, 21.4, 0.30],
    ];
    raised(plan([30.0, 30.0], &trees, &[]), |x, y| {
        let first = libm::sin(TAU * (x + 0.3 * y) / 12.0);
        let second = libm::sin(TAU * (y - 0.2 * x) / 9.0 + 1.0);
        0.3 * first + 0.2 * second
    })
}
