//! The worlds that come with the simulator, drawn here: five places to explore and four cases to get wrong.
//!
//! All have cells of 5 cm, walls at least 0.2 m thick, and their lower left corner at the origin. A drawing is a
//! function of nothing: it is the same everywhere and always.

mod cases;
mod cave;
mod cluttered;
mod hall;
mod office;
mod ring;

use super::occupancy::Occupancy;
use super::{Start, World};

/// A built-in world.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is, in one line.
    pub description: &'static str,
    plan: fn() -> Occupancy,
    starts: &'static [[f64; 3]],
}

/// Every built-in world.
const BUILTINS: [Builtin; 9] = [
    Builtin {
        name: "office",
        description: "nine furnished rooms with doors of 0.8 to 0.9 m along a corridor, 24 x 14 m",
        plan: office::plan,
        starts: &[[12.0, 7.0, 0.0], [2.4, 9.4, 0.0], [21.0, 4.4, 3.0]],
    },
    Builtin {
        name: "cave",
        description: "rough chambers and passages around islands of rock, 22 x 18 m",
        plan: cave::plan,
        starts: &[[4.0, 4.2, 0.8], [17.6, 11.4, -2.0]],
    },
    Builtin {
        name: "loop",
        description: "a corridor that closes a ring of 64 m, with niches and a dead end",
        plan: ring::plan,
        starts: &[[3.0, 1.3, 0.0], [19.2, 8.0, 1.6]],
    },
    Builtin {
        name: "cluttered",
        description: "one room of 15 x 15 m full of small obstacles",
        plan: cluttered::plan,
        starts: &[[1.0, 1.0, 0.8], [7.5, 7.5, 0.0]],
    },
    Builtin {
        name: "hall",
        description: "a hall of 24 x 24 m, open but for a few pillars",
        plan: hall::plan,
        starts: &[[3.0, 3.0, 0.0], [12.0, 14.0, 1.5]],
    },
    Builtin {
        name: "empty-hall",
        description: "an empty hall of 30 x 30 m, larger than the lasers see",
        plan: hall::empty,
        starts: &[[15.0, 15.0, 0.0], [2.0, 2.0, 0.8]],
    },
    Builtin {
        name: "narrow-doors",
        description: "five rooms behind doors of 0.65, 0.70, 0.75, 0.80 and 0.90 m",
        plan: cases::narrow_doors,
        starts: &[[1.2, 1.4, 0.0], [16.6, 4.6, -1.6]],
    },
    Builtin {
        name: "unreachable-room",
        description: "one room without a door, one behind a gap of 0.4 m that only the lasers pass",
        plan: cases::unreachable_room,
        starts: &[[2.0, 2.0, 0.0]],
    },
    Builtin {
        name: "boxed-in",
        description: "the robot starts in a closet of 1 x 1 m that has no door",
        plan: cases::boxed_in,
        starts: &[[3.0, 3.0, 0.0]],
    },
];

/// All built-in worlds, in the order of the list.
#[must_use]
pub fn builtins() -> &'static [Builtin] {
    &BUILTINS
}

/// Their names.
pub(super) fn names() -> Vec<&'static str> {
    BUILTINS.iter().map(|world| world.name).collect()
}

/// Draws one.
pub(super) fn draw(name: &str) -> Option<World> {
    let world = BUILTINS.iter().find(|world| world.name == name)?;
    let starts = world.starts.iter().map(|[x_m, y_m, yaw_rad]| Start {
        x_m: *x_m,
        y_m: *y_m,
        yaw_rad: *yaw_rad,
    });
    Some(World::flat(world.name, (world.plan)(), starts.collect()))
}
