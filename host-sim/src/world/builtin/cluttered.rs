//! A room of 15 × 15 m with scattered small boxes and posts, at least 0.9 m from each other.

use super::super::canvas::{Canvas, hash};
use super::super::occupancy::{Class, Occupancy};

/// Inner side of the room, metres.
const SIDE_M: f64 = 15.0;
/// Thickness of its walls, metres.
const WALL_M: f64 = 0.2;
/// Least gap between two obstacles, and between an obstacle and a wall, metres.
const GAP_M: f64 = 0.9;
/// Number of places that are tried; most have no room.
const TRIALS: u32 = 900;
/// Clearings around the starts: centre and radius.
const CLEARINGS: [[f64; 3]; 2] = [[1.0, 1.0, 0.6], [7.5, 7.5, 0.6]];

/// Draws it.
pub(super) fn plan() -> Occupancy {
    let side = SIDE_M + 2.0 * WALL_M;
    let mut plan = Canvas::new(side, side, Class::Wall);
    plan.floor([WALL_M, WALL_M, side - WALL_M, side - WALL_M]);
    // Centre and radius of the circle around each obstacle.
    let mut placed = CLEARINGS.to_vec();
    for trial in 0..TRIALS {
        let random = |what: u32| f64::from(hash(trial, what) >> 8) / f64::from(1_u32 << 24);
        let radius = 0.12 + 0.28 * random(2);
        let margin = WALL_M + GAP_M + radius;
        let x = margin + random(0) * (side - 2.0 * margin);
        let y = margin + random(1) * (side - 2.0 * margin);
        let clear = placed.iter().all(|[ox, oy, other]| {
            let apart = GAP_M + radius + other;
            (x - ox) * (x - ox) + (y - oy) * (y - oy) > apart * apart
        });
        if !clear {
            continue;
        }
        placed.push([x, y, radius]);
        if hash(trial, 3).is_multiple_of(3) {
            plan.disc(Class::Wall, [x, y], radius);
        } else {
            // A box whose corner lies on the circle.
            let (a, b) = if hash(trial, 4).is_multiple_of(2) {
                (0.8, 0.6)
            } else {
                (0.6, 0.8)
            };
            plan.block([
                x - a * radius,
                y - b * radius,
                x + a * radius,
                y + b * radius,
            ]);
        }
    }
    plan.finish()
}
