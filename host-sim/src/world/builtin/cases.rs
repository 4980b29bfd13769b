//! Three hard cases: doors that are nearly too narrow, rooms that the robot cannot enter, and a
//! robot that cannot leave.

use super::super::canvas::Canvas;
use super::super::occupancy::{Class, Occupancy};
use super::places::Place;

/// Left edge of a room of `narrow-doors`, metres.
const fn left_m(room: usize) -> f64 {
    0.2 + 3.65 * room as f64
}

/// A door of `narrow-doors`: on the grid of 5 cm, so its width is exact.
const fn door(name: &'static str, room: usize, width_m: f64) -> Place {
    let door_m = left_m(room) + 1.0;
    Place::area(name, [door_m, 2.5, door_m + width_m, 2.9])
}

/// Doors of `narrow-doors`, from west to east.
pub(super) const DOORS: [Place; 5] = [
    door("door of 0.65 m", 0, 0.65),
    door("door of 0.70 m", 1, 0.70),
    door("door of 0.75 m", 2, 0.75),
    door("door of 0.80 m", 3, 0.80),
    door("door of 0.90 m", 4, 0.90),
];

/// A corridor with five rooms whose doors grow from 0.65 to 0.90 m.
pub(super) fn narrow_doors() -> Occupancy {
    let mut plan = Canvas::new(18.4, 7.0, Class::Wall);
    plan.floor([0.2, 0.2, 18.2, 2.6]);
    for (room, door) in DOORS.iter().enumerate() {
        let x0 = left_m(room);
        plan.floor([x0, 2.8, x0 + 3.4, 6.8]);
        plan.floor(door.extent_m);
    }
    plan.finish()
}

/// Rooms of `unreachable-room` and the openings of two of them.
pub(super) const ROOMS: [Place; 5] = [
    Place::area("sealed room", [0.2, 5.4, 0.2 + 4.2, 10.2]),
    Place::area("room behind the gap", [4.6, 5.4, 4.6 + 4.2, 10.2]),
    Place::area("room with a door", [9.0, 5.4, 9.0 + 4.2, 10.2]),
    Place::area("gap", [6.4, 5.1, 6.8, 5.5]),
    Place::area("door", [10.8, 5.1, 11.7, 5.5]),
];

/// Three rooms off a hall: one sealed, one with a gap of 0.4 m, and one with a door. The robot can
/// enter only the last.
pub(super) fn unreachable_room() -> Occupancy {
    let mut plan = Canvas::new(13.4, 10.4, Class::Wall);
    plan.floor([0.2, 0.2, 13.2, 5.2]);
    for place in ROOMS {
        plan.floor(place.extent_m);
    }
    plan.finish()
}

/// The closet of `boxed-in`.
pub(super) const CLOSET: [Place; 1] = [Place::area("closet", [2.5, 2.5, 3.5, 3.5])];

/// A closet of 1 × 1 m inside a room.
pub(super) fn boxed_in() -> Occupancy {
    let mut plan = Canvas::new(6.4, 6.4, Class::Wall);
    plan.floor([0.2, 0.2, 6.2, 6.2]);
    plan.block([2.3, 2.3, 3.7, 3.7]);
    plan.floor(CLOSET[0].extent_m);
    plan.finish()
}
