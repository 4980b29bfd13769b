//! A ridge across the whole world, crossed by one pass.
//!
//! The ridge is 2.4 m high with sides of 44°. The pass is a saddle 3 m wide and 0.6 m high around
//! y = 6 m, no steeper than 0.20 (11.3°). 26 × 20 m.

use super::super::places::Place;
use super::{Drawing, bumps, plan, raised};

/// Height of the ridge, metres.
const RIDGE_M: f64 = 2.4;
/// Height of the pass, metres.
const PASS_M: f64 = 0.6;
/// Distance from the ridge's middle to its foot, metres.
const FOOT_M: f64 = 4.5;
/// Where the pass crosses the ridge, metres.
const SADDLE: [f64; 2] = [13.0, 6.0];
/// Half the width of the pass, metres.
const HALF_M: f64 = 1.5;

/// The pass.
pub(crate) const PLACES: [Place; 1] = [Place {
    name: "pass",
    point_m: SADDLE,
    extent_m: [
        SADDLE[0] - FOOT_M,
        SADDLE[1] - HALF_M,
        SADDLE[0] + FOOT_M,
        SADDLE[1] + HALF_M,
    ],
}];

/// Draws it.
pub(crate) fn draw() -> Drawing {
    let trees = [
        [4.2, 14.6, 0.25],
        [6.0, 3.8, 0.22],
        [3.0, 8.6, 0.28],
        [21.8, 15.2, 0.25],
        [22.4, 5.0, 0.30],
        [20.0, 10.4, 0.22],
    ];
    let blocks = [[4.6, 17.0, 6.0, 17.5], [23.4, 11.4, 24.0, 12.8]];
    raised(plan([26.0, 20.0], &trees, &blocks), |x, y| {
        let away = (x - SADDLE[0]).abs();
        let ridge = RIDGE_M * ((FOOT_M - away) / 2.5).clamp(0.0, 1.0);
        let t = (1.0 - away / FOOT_M).clamp(0.0, 1.0);
        let saddle = PASS_M * t * t * (3.0 - 2.0 * t);
        // The walls of the pass rise within 0.8 m.
        let aside = (((y - SADDLE[1]).abs() - HALF_M) / 0.8).clamp(0.0, 1.0);
        saddle + (ridge - saddle) * aside + bumps(x, y, 0.04)
    })
}
