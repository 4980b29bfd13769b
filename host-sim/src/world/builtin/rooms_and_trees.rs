//! Two worlds without loops of corridors, of published sizes \[Jorge15, IV\]: C has rooms along
//! corridors that close no loop, D is a square with small round obstacles like trees.
//!
//! The paper gives their sizes and describes them; this file chooses the rest.

use super::super::canvas::{Canvas, hash};
use super::super::occupancy::{Class, Occupancy};

/// Thickness of the outer wall, metres.
const WALL_M: f64 = 0.2;

/// Rooms of C, by their inner corners.
const ROOMS: [[f64; 4]; 11] = [
    [0.0, 0.0, 4.8, 5.7],
    [5.1, 0.0, 10.2, 5.7],
    [0.0, 8.3, 4.8, 12.4],
    [5.1, 8.3, 10.2, 12.4],
    [0.0, 12.7, 10.2, 18.4],
    [0.0, 18.7, 10.2, 25.0],
    [12.8, 0.0, 23.0, 6.4],
    [12.8, 6.7, 17.6, 13.4],
    [17.9, 6.7, 23.0, 13.4],
    [12.8, 16.0, 17.6, 25.0],
    [17.9, 16.0, 23.0, 25.0],
];
/// Corridors of C, 2 m wide: one along the whole height, one to each side of it.
const CORRIDORS: [[f64; 4]; 3] = [
    [10.5, 0.0, 12.5, 25.0],
    [0.0, 6.0, 10.6, 8.0],
    [12.4, 13.7, 23.0, 15.7],
];
/// Doors of C, 1 m wide and deeper than a wall: one for each room.
const DOORS: [[f64; 4]; 11] = [
    [2.0, 5.6, 3.0, 6.1],
    [7.2, 5.6, 8.2, 6.1],
    [1.2, 7.9, 2.2, 8.4],
    [8.4, 7.9, 9.4, 8.4],
    [10.1, 15.0, 10.6, 16.0],
    [10.1, 21.4, 10.6, 22.4],
    [12.4, 2.6, 12.9, 3.6],
    [14.8, 13.3, 15.8, 13.8],
    [20.4, 13.3, 21.4, 13.8],
    [13.4, 15.6, 14.4, 16.1],
    [21.0, 15.6, 22.0, 16.1],
];

/// Draws Ouroboros C.
pub(super) fn c() -> Occupancy {
    let mut plan = Canvas::new(23.0 + 2.0 * WALL_M, 25.0 + 2.0 * WALL_M, Class::Wall);
    for corners in ROOMS.iter().chain(&CORRIDORS).chain(&DOORS) {
        plan.floor(corners.map(|m| m + WALL_M));
    }
    plan.finish()
}

/// Inner side of D, metres.
const SIDE_M: f64 = 20.0;
/// Least gap between two trees, and between a tree and a wall, metres.
const GAP_M: f64 = 1.4;
/// Number of places that are tried; most have no room.
const TRIALS: u32 = 400;

/// Draws Ouroboros D.
pub(super) fn d() -> Occupancy {
    let side = SIDE_M + 2.0 * WALL_M;
    let mut plan = Canvas::new(side, side, Class::Wall);
    plan.floor([WALL_M, WALL_M, side - WALL_M, side - WALL_M]);
    // Centre and radius of each tree.
    let mut trees: Vec<[f64; 3]> = Vec::new();
    for trial in 0..TRIALS {
        let random = |what: u32| f64::from(hash(trial + 7_000, what) >> 8) / f64::from(1_u32 << 24);
        let radius = 0.1 + 0.25 * random(2);
        let margin = WALL_M + GAP_M + radius;
        let place = |at: f64| margin + at * (side - 2.0 * margin);
        let (x, y) = (place(random(0)), place(random(1)));
        let clear = trees.iter().all(|[other_x, other_y, other]| {
            let apart = GAP_M + radius + other;
            (x - other_x) * (x - other_x) + (y - other_y) * (y - other_y) > apart * apart
        });
        if clear {
            trees.push([x, y, radius]);
            plan.disc(Class::Wall, [x, y], radius);
        }
    }
    plan.finish()
}
