//! Scenario 3: uneven ground, scattered trees and blocks, and a building with one entrance.
//!
//! The building stands at x 10 to 17 m and y 12 to 18 m. Its entrance is a gap of 1.6 m in its
//! south wall, around x = 13.5 m. Behind it the room widens at 45° to 5.4 m, up to y = 17.6 m, so a
//! robot before the entrance sees the whole room. 26 × 24 m.

use super::super::places::Place;
use super::{Drawing, bumps, plan, raised};
use crate::world::Class;

/// Middle of the entrance on the outer face of its wall, metres.
const ENTRANCE: [f64; 2] = [13.5, 12.0];
/// The building's outline, metres.
const OUTLINE: [f64; 4] = [10.0, 12.0, 17.0, 18.0];

/// The building, and its entrance with the middle of its outer edge as the reference point.
pub(crate) const PLACES: [Place; 2] = [
    Place::area("building", OUTLINE),
    Place {
        name: "entrance",
        point_m: ENTRANCE,
        extent_m: [
            ENTRANCE[0] - 0.8,
            ENTRANCE[1],
            ENTRANCE[0] + 0.8,
            ENTRANCE[1] + 0.3,
        ],
    },
];

/// Draws it.
pub(crate) fn draw() -> Drawing {
    let trees = [
        [4.0, 5.2, 0.25],
        [7.2, 10.4, 0.28],
        [3.2, 16.8, 0.25],
        [6.4, 20.4, 0.22],
        [19.8, 18.6, 0.30],
        [22.6, 11.2, 0.25],
        [18.4, 6.4, 0.22],
        [13.8, 20.8, 0.25],
        [9.6, 7.2, 0.22],
        [23.4, 4.2, 0.28],
    ];
    let blocks = [
        OUTLINE,
        [2.4, 11.0, 3.0, 13.0],
        [20.6, 14.0, 22.0, 14.6],
        [14.8, 3.2, 16.0, 4.4],
        [20.4, 21.0, 21.6, 21.5],
    ];
    let mut plan = plan([26.0, 24.0], &trees, &blocks);
    plan.fill(Class::Free, |x, y| {
        let (aside, inwards) = ((x - ENTRANCE[0]).abs(), y - ENTRANCE[1]);
        (-0.1..5.6).contains(&inwards) && aside < (0.8 + inwards.max(0.0)).min(2.7)
    });
    raised(plan, |x, y| {
        // The ground in the building and around it is level.
        let (dx, dy) = ((x - 13.5).abs() - 3.5, (y - 15.0).abs() - 3.0);
        let away = (dx.max(dy) / 2.0).clamp(0.0, 1.0);
        bumps(x, y, 0.15) * away
    })
}
