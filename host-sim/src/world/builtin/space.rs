//! Worlds of \[Kenealy15, 4\]: two rooms, a C-shaped room, and a small room with a partition.
//!
//! The paper gives the size of the last one, and draws the other two without a scale. Here both
//! halls are 10 m wide, which is the coverage of the paper's 250 to 280 steps at 0.3 m a step.
//! This file chooses the places of walls and doors: the paper's text names two rooms, their narrow
//! entrances, and a C in the middle.

use super::super::canvas::Canvas;
use super::super::occupancy::{Class, Occupancy};

/// Thickness of the walls, metres.
const WALL_M: f64 = 0.2;

/// Two rooms of 4 x 3.8 m with doors of 1 m on a corridor of 2 m, which leaves a hall of 10 x 4 m.
pub(super) fn two_rooms() -> Occupancy {
    let mut plan = hall([10.0, 8.0]);
    for [x0, y0, x1, y1] in [
        [0.0, 4.0, 4.0, 4.2],
        [3.8, 4.0, 4.0, 8.0],
        [6.0, 4.0, 10.0, 4.2],
        [6.0, 4.0, 6.2, 8.0],
    ] {
        plan.block([x0, y0, x1, y1].map(inside));
    }
    for [x0, x1] in [[3.8, 4.0], [6.0, 6.2]] {
        plan.floor([x0, 5.5, x1, 6.5].map(inside));
    }
    plan.finish()
}

/// A room of 4 x 4 m without its west wall, in the middle of a hall of 10 x 10 m.
pub(super) fn c_room() -> Occupancy {
    let mut plan = hall([10.0, 10.0]);
    plan.block([3.0, 3.0, 7.0, 7.0].map(inside));
    plan.floor([3.0, 3.2, 6.8, 6.8].map(inside));
    plan.finish()
}

/// A room of 4 x 3.5 m, and a wall of 1 m that leaves a starting room 1.9 m wide.
pub(super) fn partition() -> Occupancy {
    let mut plan = hall([4.0, 3.5]);
    plan.block([1.9, 0.0, 2.1, 1.0].map(inside));
    plan.finish()
}

/// An empty hall of this inner size.
fn hall([width, height]: [f64; 2]) -> Canvas {
    let around = 2.0 * WALL_M;
    let mut plan = Canvas::new(width + around, height + around, Class::Wall);
    plan.floor([0.0, 0.0, width, height].map(inside));
    plan
}

/// Returns the coordinate of a distance from the inside of the outer wall.
fn inside(metres: f64) -> f64 {
    metres + WALL_M
}
