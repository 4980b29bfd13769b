//! The built-in worlds: six floors to explore, three hard cases, nine worlds with uneven ground,
//! and ten worlds of published sizes or shapes.
//!
//! Each is a file of `host-sim/worlds`: description, drawing, named places and starts, in strict
//! YAML. All have cells of 5 cm, walls at least 0.2 m thick, and their lower left corner at the
//! origin. A drawing has no parameters: it is the same on every machine.

mod drawing;
mod ground;

use core::mem::take;
use std::sync::LazyLock;

use super::{Start, World};
use drawing::{File, NamedPlace};

/// Embeds the files of the worlds with these names.
macro_rules! files {
    ($($name:literal)*) => {
        &[$(($name, include_str!(concat!("../../../worlds/", $name, ".yaml")))),*]
    };
}

/// Name and file of every built-in world, in the order of the list.
const FILES: &[(&str, &str)] = files!(
    "office" "cave" "loop" "cluttered" "hall" "empty-hall"
    "narrow-doors" "unreachable-room" "boxed-in"
    "slope" "holes" "building" "cliff" "spiral" "kerbs" "waves" "pass" "causeway"
    "ouroboros-a" "ouroboros-b" "ouroboros-c" "ouroboros-d"
    "tdbvp-adjacent" "tdbvp-nested" "tdbvp-floor"
    "two-rooms" "c-room" "partition"
);

/// The files as read.
static BUILTINS: LazyLock<Vec<Builtin>> = LazyLock::new(|| {
    let files = FILES.iter();
    files
        .map(|(name, text)| Builtin::read(name, text))
        .collect()
});

/// A built-in world.
#[derive(Clone, Debug)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its description, in one line.
    pub description: String,
    /// Its named places: doors, holes, islands, entrances.
    pub places: Vec<Place>,
    file: File,
}

/// A named place of a built-in world. Metres, in the world's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Its name, unique within the world.
    pub name: String,
    /// Its reference point: the centre of the extent unless the world's file says otherwise.
    pub point_m: [f64; 2],
    /// Its extent, as [x0, y0, x1, y1].
    pub extent_m: [f64; 4],
}

impl Builtin {
    fn read(name: &'static str, text: &str) -> Self {
        let file = serde_saphyr::from_str(text);
        let mut file: File = file.unwrap_or_else(|error| panic!("worlds/{name}.yaml: {error}"));
        let place = |NamedPlace {
                         name,
                         extent,
                         point,
                     }| {
            let [x0, y0, x1, y1] = extent;
            Place {
                name,
                point_m: point.unwrap_or([0.5 * (x0 + x1), 0.5 * (y0 + y1)]),
                extent_m: extent,
            }
        };
        Self {
            name,
            description: take(&mut file.description),
            places: take(&mut file.places).into_iter().map(place).collect(),
            file,
        }
    }
}

/// All built-in worlds, in the order of the list.
#[must_use]
pub fn builtins() -> &'static [Builtin] {
    &BUILTINS
}

/// Names of the built-in worlds.
pub(super) fn names() -> Vec<&'static str> {
    FILES.iter().map(|(name, _)| *name).collect()
}

fn find(name: &str) -> Option<&'static Builtin> {
    BUILTINS.iter().find(|world| world.name == name)
}

/// Draws a world by name.
pub(super) fn draw(name: &str) -> Option<World> {
    let world = find(name)?;
    let plan = world.file.drawn();
    let start = |&[x_m, y_m, yaw_rad]: &[f64; 3]| Start { x_m, y_m, yaw_rad };
    let starts = world.file.robots.iter().map(start).collect();
    Some(match world.file.ground {
        None => World::flat(world.name, plan, starts),
        Some(shape) => {
            let ground = shape.over(&plan, &world.places);
            World::uneven(world.name, plan, ground, starts)
        }
    })
}

/// The named places of a built-in world; empty if it has none or no world has that name.
#[must_use]
pub fn places(world: &str) -> &'static [Place] {
    find(world).map_or(&[], |builtin| &builtin.places)
}

/// One place of a built-in world by name.
#[must_use]
pub fn place(world: &str, name: &str) -> Option<&'static Place> {
    places(world).iter().find(|place| place.name == name)
}

#[cfg(test)]
mod tests;
