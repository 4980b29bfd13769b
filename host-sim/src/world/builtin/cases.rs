//! Three plans made to go wrong: doors that are nearly too narrow, rooms nobody can enter, a robot nobody can free.

use super::super::canvas::Canvas;
use super::super::occupancy::{Class, Occupancy};

/// A corridor with five rooms whose doors grow from 0.65 to 0.90 m.
pub(super) fn narrow_doors() -> Occupancy {
    let mut plan = Canvas::new(18.4, 7.0, Class::Wall);
    plan.floor([0.2, 0.2, 18.2, 2.6]);
    for (room, width) in [0.65, 0.70, 0.75, 0.80, 0.90].into_iter().enumerate() {
        let x0 = 0.2 + 3.65 * room as f64;
        plan.floor([x0, 2.8, x0 + 3.4, 6.8]);
        // Doors on the grid of 5 cm, so that their width is exact.
        let door = x0 + 1.0;
        plan.floor([door, 2.5, door + width, 2.9]);
    }
    plan.finish()
}

/// Two rooms off a hall that the robot cannot enter: one sealed, one with a gap of 0.4 m; and one with a door.
pub(super) fn unreachable_room() -> Occupancy {
    let mut plan = Canvas::new(13.4, 10.4, Class::Wall);
    plan.floor([0.2, 0.2, 13.2, 5.2]);
    for x0 in [0.2, 4.6, 9.0] {
        plan.floor([x0, 5.4, x0 + 4.2, 10.2]);
    }
    plan.floor([6.4, 5.1, 6.8, 5.5]);
    plan.floor([10.8, 5.1, 11.7, 5.5]);
    plan.finish()
}

/// A closet of 1 × 1 m inside a room.
pub(super) fn boxed_in() -> Occupancy {
    let mut plan = Canvas::new(6.4, 6.4, Class::Wall);
    plan.floor([0.2, 0.2, 6.2, 6.2]);
    plan.block([2.3, 2.3, 3.7, 3.7]);
    plan.floor([2.5, 2.5, 3.5, 3.5]);
    plan.finish()
}
