//! A causeway like a bridge, 2.4 m wide and 8 m long, between two drops: one 3 m deep, one without
//! a floor.
//!
//! It rises by 0.35 m to its middle, with at most 7.9°. 26 × 14 m.

use super::super::places::Place;
use super::{Drawing, bumps, plan, raised};

/// West and east edge of the gorge, metres.
const GORGE_M: [f64; 2] = [9.0, 17.0];
/// The causeway's middle and half its width, metres.
const CAUSEWAY_M: [f64; 2] = [7.2, 1.2];

/// The causeway, and the drops beside it.
pub(crate) const PLACES: [Place; 3] = [
    Place::area(
        "causeway",
        [
            GORGE_M[0],
            CAUSEWAY_M[0] - CAUSEWAY_M[1],
            GORGE_M[1],
            CAUSEWAY_M[0] + CAUSEWAY_M[1],
        ],
    ),
    Place::area(
        "north drop",
        [GORGE_M[0], CAUSEWAY_M[0] + CAUSEWAY_M[1], GORGE_M[1], 14.0],
    ),
    Place::area(
        "south drop",
        [GORGE_M[0], 0.0, GORGE_M[1], CAUSEWAY_M[0] - CAUSEWAY_M[1]],
    ),
];

/// Draws it.
pub(crate) fn draw() -> Drawing {
    let trees = [
        [3.4, 3.2, 0.25],
        [5.8, 10.4, 0.28],
        [21.4, 11.0, 0.25],
        [22.8, 3.6, 0.22],
    ];
    let blocks = [[2.2, 7.0, 3.2, 8.2], [19.2, 5.0, 19.8, 6.4]];
    raised(plan([26.0, 14.0], &trees, &blocks), |x, y| {
        let [west, east] = GORGE_M;
        if x < west || x > east {
            return bumps(x, y, 0.03);
        }
        let aside = y - CAUSEWAY_M[0];
        if aside.abs() < CAUSEWAY_M[1] {
            // One wave of a cosine, so that the causeway is level where it joins the ground.
            let along = (x - west) / (east - west);
            let arch = 0.5 - 0.5 * libm::cos(core::f64::consts::TAU * along);
            bumps(x, y, 0.03) + 0.35 * arch
        } else if aside > 0.0 {
            -3.0
        } else {
            f64::NAN
        }
    })
}
