//! An office floor of 24 × 14 m: nine rooms with doors of 0.8 to 0.9 m along a corridor, two of
//! them joined.

use super::super::canvas::Canvas;
use super::super::occupancy::{Class, Occupancy};
use super::places::Place;

/// Rooms above the corridor: left edge, right edge, left edge of the door, width of the door.
const NORTH: [[f64; 4]; 5] = [
    [0.2, 4.8, 3.2, 0.9],
    [5.0, 9.8, 5.6, 0.8],
    [10.0, 15.8, 12.4, 0.9],
    [16.0, 19.8, 18.6, 0.8],
    [20.0, 24.2, 20.6, 0.85],
];
/// Rooms below the corridor, in the same form.
const SOUTH: [[f64; 4]; 4] = [
    [0.2, 6.8, 4.8, 0.9],
    [7.0, 11.8, 8.0, 0.8],
    [12.0, 18.2, 16.0, 0.9],
    [18.4, 24.2, 19.4, 0.8],
];

/// A door to the north of the corridor.
const fn north(name: &'static str, [_, _, door, width]: [f64; 4]) -> Place {
    Place::area(name, [door, 8.1, door + width, 8.5])
}

/// A door to the south of the corridor.
const fn south(name: &'static str, [_, _, door, width]: [f64; 4]) -> Place {
    Place::area(name, [door, 5.9, door + width, 6.3])
}

/// Doors along the corridor, numbered from west to east, and the door between two rooms.
pub(super) const PLACES: [Place; 10] = [
    north("north door 1", NORTH[0]),
    north("north door 2", NORTH[1]),
    north("north door 3", NORTH[2]),
    north("north door 4", NORTH[3]),
    north("north door 5", NORTH[4]),
    south("south door 1", SOUTH[0]),
    south("south door 2", SOUTH[1]),
    south("south door 3", SOUTH[2]),
    south("south door 4", SOUTH[3]),
    Place::area("door between rooms", [6.7, 2.2, 7.1, 3.1]),
];

/// Draws it.
pub(super) fn plan() -> Occupancy {
    let mut plan = Canvas::new(24.4, 14.4, Class::Wall);
    plan.floor([0.2, 6.2, 24.2, 8.2]);
    for [x0, x1, ..] in NORTH {
        plan.floor([x0, 8.4, x1, 14.2]);
    }
    for [x0, x1, ..] in SOUTH {
        plan.floor([x0, 0.2, x1, 6.0]);
    }
    // The door between two rooms closes a loop.
    for door in PLACES {
        plan.floor(door.extent_m);
    }
    furnish(&mut plan);
    plan.finish()
}

fn furnish(plan: &mut Canvas) {
    for corners in [
        // Desks.
        [0.2, 12.6, 1.8, 14.2],
        [0.2, 8.4, 1.0, 10.0],
        [7.2, 12.4, 8.8, 13.2],
        [5.0, 10.6, 5.8, 12.2],
        [16.0, 12.6, 17.6, 14.2],
        [22.6, 11.0, 24.2, 11.8],
        [20.0, 12.8, 21.2, 14.2],
        [0.2, 0.2, 1.8, 1.0],
        [2.6, 2.6, 4.2, 4.2],
        [9.2, 0.2, 11.8, 1.0],
        [10.8, 3.4, 11.8, 5.0],
        // A meeting table, cupboards, shelves.
        [11.4, 10.4, 14.4, 12.0],
        [13.6, 0.2, 14.0, 3.2],
        [15.4, 1.6, 15.8, 4.4],
        [20.4, 1.6, 22.4, 2.6],
        [23.8, 3.0, 24.2, 6.0],
        [0.2, 6.2, 0.6, 6.8],
        [14.0, 7.8, 15.4, 8.2],
    ] {
        plan.block(corners);
    }
    for centre in [
        [8.0, 11.6],
        [2.6, 10.9],
        [17.4, 11.2],
        [9.9, 2.2],
        [5.4, 1.2],
        [22.0, 4.2],
    ] {
        plan.disc(Class::Wall, centre, 0.22);
    }
}
