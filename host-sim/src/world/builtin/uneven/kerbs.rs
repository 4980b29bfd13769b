//! A kerb course: four islands in a street, with kerbs of 5, 10, 20 and 40 cm.
//!
//! The first kerb is within the working limits, the second is what the robot can take at the most, the others are not to be driven over.
//! Ramps of 0.125 and 0.17 lead onto the two highest islands from the south, so that their kerbs are met from above as
//! well. 24 × 12 m.

use super::{Drawing, plan, raised, within};

/// Left edge and height of each island, metres.
const ISLANDS: [[f64; 2]; 4] = [[2.4, 0.05], [7.6, 0.10], [12.8, 0.20], [18.0, 0.40]];
/// Size of an island, metres.
const ISLAND_M: [f64; 2] = [3.6, 4.6];
/// Where islands begin, metres north.
const SOUTH_M: f64 = 4.6;
/// Width of a ramp, metres.
const RAMP_M: f64 = 1.8;

/// Draws it.
pub(crate) fn draw() -> Drawing {
    raised(plan([24.0, 12.0], &[], &[]), |x, y| {
        let island = |[west, height_m]: [f64; 2]| {
            let east = west + ISLAND_M[0];
            let top = height_m * within([x, y], [west, SOUTH_M, east, SOUTH_M + ISLAND_M[1]]);
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
        ISLANDS.into_iter().map(island).sum()
    })
}
