//! A corridor 1.8 m wide that closes a ring, with niches along it and one dead end inwards.

use super::super::canvas::Canvas;
use super::super::occupancy::{Class, Occupancy};

/// Draws it.
pub(super) fn plan() -> Occupancy {
    let mut plan = Canvas::new(20.4, 16.4, Class::Wall);
    plan.floor([0.2, 0.2, 20.2, 16.2]);
    plan.block([2.0, 2.0, 18.4, 14.4]);
    // Niches into the block, and a dead end with a bend.
    plan.floor([5.0, 1.8, 6.4, 3.2]);
    plan.floor([10.0, 13.0, 11.4, 14.6]);
    plan.floor([17.0, 10.0, 18.6, 11.6]);
    plan.floor([1.8, 8.0, 7.0, 9.4]);
    plan.floor([5.6, 6.0, 7.0, 9.4]);
    // Obstacles in the corridor.
    plan.block([13.0, 0.2, 14.2, 0.6]);
    plan.block([0.2, 11.0, 0.6, 12.4]);
    plan.disc(Class::Wall, [19.3, 5.4], 0.15);
    plan.block([7.6, 15.8, 9.0, 16.2]);
    plan.finish()
}
