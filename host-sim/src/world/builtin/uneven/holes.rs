//! Scenario 2: uneven ground, a slope in a corner, and two large holes with sheer sides.
//!
//! The holes are 1.6 m deep, in the north-east and in the south-west. The slope of 0.27 (15°) in
//! the south-east leads to a shelf 1.3 m up. 26 × 26 m.

use super::super::places::Place;
use super::{Drawing, bumps, plan, raised, ramp, within};

/// Depth of the holes, metres.
const DEPTH_M: f64 = 1.6;
/// Height of the shelf, metres.
const SHELF_M: f64 = 1.3;
/// The two holes.
pub(crate) const PLACES: [Place; 2] = [
    Place::area("north-east hole", [16.4, 16.8, 22.2, 21.6]),
    Place::area("south-west hole", [3.8, 4.4, 8.4, 8.0]),
];

/// Draws it.
pub(crate) fn draw() -> Drawing {
    let trees = [
        [5.2, 12.4, 0.25],
        [9.8, 20.8, 0.30],
        [3.4, 18.6, 0.25],
        [13.6, 6.0, 0.22],
        [10.2, 3.0, 0.28],
        [22.8, 13.0, 0.25],
        [13.0, 22.4, 0.25],
        [9.4, 15.8, 0.22],
    ];
    let blocks = [
        [6.4, 22.4, 7.6, 23.2],
        [12.2, 11.0, 13.6, 11.5],
        [2.0, 14.6, 2.6, 15.8],
    ];
    raised(plan([26.0, 26.0], &trees, &blocks), |x, y| {
        let holes = PLACES.iter().map(|hole| within([x, y], hole.extent_m));
        let hole = holes.sum::<f64>();
        // Distance from the corner's diagonal; it grows towards the corner.
        let inwards = (x - y - 11.0) * core::f64::consts::FRAC_1_SQRT_2;
        bumps(x, y, 0.12) + SHELF_M * ramp(inwards, 5.8, 1.0) - DEPTH_M * hole
    })
}
