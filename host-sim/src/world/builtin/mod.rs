//! The built-in worlds: six floors to explore, three hard cases, nine worlds with uneven ground,
//! and ten worlds of published sizes or shapes.
//!
//! All have cells of 5 cm, walls at least 0.2 m thick, and their lower left corner at the origin. A
//! drawing has no parameters: it is the same on every machine.

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
mod rooms_and_trees;
mod space;
mod uneven;

use super::occupancy::Occupancy;
use super::{Start, World};
use list::BUILTINS;
pub use places::{Place, place, places};

/// A built-in world.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its description, in one line.
    pub description: &'static str,
    /// Its named places: doors, holes, islands, entrances.
    pub places: &'static [Place],
    plan: Plan,
    starts: &'static [[f64; 3]],
}

/// The drawing of a world.
#[derive(Clone, Copy, Debug)]
enum Plan {
    /// Walls on a level floor.
    Flat(fn() -> Occupancy),
    /// Walls on uneven ground.
    Uneven(fn() -> uneven::Drawing),
}

/// All built-in worlds, in the order of the list.
#[must_use]
pub fn builtins() -> &'static [Builtin] {
    BUILTINS
}

/// Names of the built-in worlds.
pub(super) fn names() -> Vec<&'static str> {
    BUILTINS.iter().map(|world| world.name).collect()
}

/// Draws a world by name.
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
