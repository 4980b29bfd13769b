//! A kerb course: four islands in a street, with kerbs of 5, 10, 20 and 40 cm.
//!
//! The first kerb is within the working limits, the second is the highest that the robot can take,
//! and the others are too high. Ramps of 0.125 and 0.17 lead onto the two highest islands from the
//! south, so the robot meets their kerbs from above as well. 24 × 12 m.

use super::super::places::Place;
use super::{Drawing, plan, raised, within};

/// Left edge and height of each island, metres.
const ISLANDS: [[f64; 2]; 4] = [[2.4, 0.05], [7.6, 0.10], [12.8, 0.20], [18.0, 0.40]];
/// Size of an island, metres.
const ISLAND_M: [f64; 2] = [3.6, 4.6];
/// Southern edge of the islands, metres.
const SOUTH_M: f64 = 4.6;
/// Width of a ramp, metres.
const RAMP_M: f64 = 1.8;

/// An island, from west to east.
const fn island(name: &'static str, [west, _]: [f64; 2]) -> Place {
    let east = west + ISLAND_M[0];
    Place::area(name, [west, SOUTH_M, east, SOUTH_M + ISLAND_M[1]])
}

/// The islands.
pub(crate) const PLACES: [Place; 4] = [
    island("island of 5 cm", ISLANDS[0]),
    island("island of 10 cm", ISLANDS[1]),
    island("island of 20 cm", ISLANDS[2]),
    island("island of 40 cm", ISLANDS[3]),
];

/// Draws it.
pub(crate) fn draw() -> Drawing {
    raised(plan([24.0, 12.0], &[], &[]), |x, y| {
        let island = |(place, [west, height_m]): (Place, [f64; 2])| {
            let top = height_m * within([x, y], place.extent_m);
            let length_m = match height_m {
                0.20 => 1.6,
                0.40 => 2.4,
                _ => return top,
            };
            let middle = west + 0.5 * ISLAND_M[0];
            let aside = within(
                [x, 0.0],
                [middle - 0.5 * RAMP_M, -1.0, middle + 0.5 * RAMP_M, 1.0],
            );
            let up = ((y - SOUTH_M + length_m) / length_m).clamp(0.0, 1.0);
            let on_ramp = f64::from(u8::from(y < SOUTH_M));
            top + height_m * up * aside * on_ramp
        };
        PLACES.into_iter().zip(ISLANDS).map(island).sum()
    })
}
