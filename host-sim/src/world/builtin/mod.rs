//! The worlds that come with the simulator, drawn here: five places to explore, four cases to get wrong, uneven ground, and
//! loops and places of published sizes.
//!
//! All have cells of 5 cm, walls at least 0.2 m thick, and their lower left corner at the origin. A drawing is a
//! function of nothing: it is the same everywhere and always.

mod cases;
mod cave;
mod cluttered;
mod hall;
mod list;
mod loops;
mod office;
mod places;
mod poses;
mod ring;
mod uneven;

use super::occupancy::Occupancy;
use super::{Start, World};
use list::BUILTINS;

/// A built-in world.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is, in one line.
    pub description: &'static str,
    plan: Plan,
    starts: &'static [[f64; 3]],
}

/// How a world is drawn.
#[derive(Clone, Copy, Debug)]
enum Plan {
    /// Walls on a level floor.
    Flat(fn() -> Occupancy),
    /// Walls on ground.
    Uneven(fn() -> uneven::Drawing),
}

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
    let starts = starts.collect();
    Some(match world.plan {
        Plan::Flat(draw) => World::flat(world.name, draw(), starts),
        Plan::Uneven(draw) => {
            let (plan, ground) = draw();
            World::uneven(world.name, plan, ground, starts)
        }
    })
}

#[cfg(test)]
mod tests;
