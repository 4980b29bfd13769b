//! Named places of the built-in worlds: doors, holes, islands, entrances.
//!
//! Each world's places come from the same constants as its drawing, so a test can take them from
//! here and needs no copied coordinates. Metres, in the world's frame.

use super::BUILTINS;

/// A named place of a built-in world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its name, unique within the world.
    pub name: &'static str,
    /// Its reference point: the centre of the extent unless the world's file says otherwise.
    pub point_m: [f64; 2],
    /// Its extent, as [x0, y0, x1, y1].
    pub extent_m: [f64; 4],
}

impl Place {
    /// A rectangle from (x0, y0) to (x1, y1), with its centre as the reference point.
    pub(super) const fn area(name: &'static str, extent_m: [f64; 4]) -> Self {
        let [x0, y0, x1, y1] = extent_m;
        Self {
            name,
            point_m: [0.5 * (x0 + x1), 0.5 * (y0 + y1)],
            extent_m,
        }
    }
}

/// The named places of a built-in world; empty if it has none or no world has that name.
#[must_use]
pub fn places(world: &str) -> &'static [Place] {
    let named = BUILTINS.iter().find(|builtin| builtin.name == world);
    named.map_or(&[], |builtin| builtin.places)
}

/// One place of a built-in world by name.
#[must_use]
pub fn place(world: &str, name: &str) -> Option<&'static Place> {
    places(world).iter().find(|place| place.name == name)
}
