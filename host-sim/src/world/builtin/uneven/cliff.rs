//! Scenario 4: scattered trees and blocks, one hole, one steep hill, and one cliff that is a
//! barrier from below and a drop from above.
//!
//! The east lies 1.5 m higher. The cliff between runs north to south, is sheer, and swings by 0.6
//! m. In the south a ramp of 0.26 (14.6°) and 6 m width joins both levels. The hill in the west is
//! a cone of 40°, 2.1 m high; the hole in the north-east is 1.3 m deep. 28 × 24 m.

use super::super::places::Place;
use super::{Drawing, bumps, plan, raised, ramp, within};
use crate::world::canvas::roughness;

/// The plateau over the low ground, metres.
const RISE_M: f64 = 1.5;
/// Northern edge of the ramp, metres.
const RAMP_M: f64 = 6.4;
/// The line that the cliff swings about, metres east, and how far it swings.
const CLIFF_M: [f64; 2] = [16.5, 0.6];
/// Middle of the hill, metres.
const HILL: [f64; 2] = [6.0, 14.8];
/// The hole, metres.
const HOLE: [f64; 4] = [20.6, 14.6, 24.0, 18.0];

/// The hole, the hill, and an area around the cliff's face that is clear of the ramp and the fence.
pub(crate) const PLACES: [Place; 3] = [
    Place::area("hole", HOLE),
    Place::area(
        "hill",
        [HILL[0] - 2.5, HILL[1] - 2.5, HILL[0] + 2.5, HILL[1] + 2.5],
    ),
    Place {
        name: "cliff",
        point_m: [CLIFF_M[0], 15.25],
        extent_m: [CLIFF_M[0] - 2.0, RAMP_M + 0.6, CLIFF_M[0] + 2.5, 23.5],
    },
];

/// Draws it.
pub(crate) fn draw() -> Drawing {
    let trees = [
        [3.6, 3.4, 0.25],
        [9.6, 12.2, 0.28],
        [3.2, 19.8, 0.25],
        [11.8, 20.6, 0.22],
        [13.2, 16.0, 0.25],
        [21.0, 9.6, 0.30],
        [25.4, 4.0, 0.25],
        [24.6, 12.4, 0.22],
        [19.8, 21.2, 0.25],
    ];
    let blocks = [
        [6.4, 4.6, 7.8, 5.2],
        [10.8, 9.0, 11.4, 10.2],
        [22.6, 6.4, 24.0, 6.9],
    ];
    raised(plan([28.0, 24.0], &trees, &blocks), |x, y| {
        let plateau = if y < RAMP_M {
            ramp(x - 11.6, 6.8, 1.0)
        } else {
            f64::from(u8::from(
                x > CLIFF_M[0] + CLIFF_M[1] * roughness(0.4 * y, 3.0),
            ))
        };
        let (dx, dy) = (x - HILL[0], y - HILL[1]);
        let hill = (2.1 - (dx * dx + dy * dy).sqrt() * 0.84).max(0.0);
        let hole = within([x, y], HOLE);
        bumps(x, y, 0.06) + RISE_M * plateau + hill - 1.3 * hole
    })
}
