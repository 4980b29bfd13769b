//! Scenario 1: almost level ground at two heights, one big slope across the whole world, and
//! scattered trees and blocks.
//!
//! The west lies 1.8 m higher. The slope between is 7 m long with a grade of up to 0.30 (16.7°).
//! Within the working limits a robot can climb it and cannot cross it sideways. 30 × 24 m.

use super::{Drawing, bumps, plan, raised, ramp};

/// Height of the upper level over the lower one, metres.
const RISE_M: f64 = 1.8;

/// Draws it.
pub(crate) fn draw() -> Drawing {
    let trees = [
        [3.2, 4.0, 0.25],
        [6.1, 9.4, 0.30],
        [2.8, 14.2, 0.22],
        [7.4, 17.2, 0.28],
        [4.6, 20.6, 0.25],
        [9.2, 3.4, 0.22],
        [14.6, 8.6, 0.25],
        [15.8, 18.4, 0.25],
        [21.4, 4.2, 0.30],
        [24.8, 8.8, 0.25],
        [22.6, 13.8, 0.22],
        [27.2, 17.0, 0.30],
        [21.8, 20.4, 0.25],
    ];
    let blocks = [
        [4.6, 12.0, 6.2, 12.5],
        [8.6, 12.6, 9.1, 14.4],
        [1.8, 8.2, 2.9, 9.0],
        [23.6, 17.0, 25.2, 17.5],
        [26.4, 4.6, 26.9, 6.6],
        [19.8, 9.8, 20.9, 10.7],
    ];
    raised(plan([30.0, 24.0], &trees, &blocks), |x, y| {
        // The slope is turned a little, so that it lies along no axis of the grid.
        let along = x + 0.18 * (y - 12.0) - 11.2;
        // Its grade is along a direction that leans by 0.18.
        let stretch = (1.0_f64 + 0.18 * 0.18).sqrt();
        RISE_M * (1.0 - ramp(along / stretch, 7.0, 1.0)) + bumps(x, y, 0.04)
    })
}
