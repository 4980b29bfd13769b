//! What may surprise in a mission's world, said before the run begins.
//!
//! | world | line |
//! | --- | --- |
//! | uneven, and the planner takes it for flat | the robot may fall or tip over |
//! | more floor than tiles in the device's map | the map will be full |
//! | what the picture of a known map may hide | as of a world's picture |
//!
//! A tile is 3.2 m a side. Metres.

use std::collections::BTreeSet;

use fieldline_device::SLOTS;

use super::mission::{Mission, on_device};
use crate::metrics::CellSet;
use crate::world::{GridCell, World};

/// Difference of heights from which ground is uneven, metres: the step that a wheel feels.
const UNEVEN_M: f64 = 0.05;
/// Side of a tile, metres.
const TILE_M: f64 = 3.2;

/// Returns a line for each surprise.
#[must_use]
pub fn surprises(mission: &Mission, world: &World) -> Vec<String> {
    let lines = [uneven(mission, world), large(mission, world)];
    let known = mission.known.iter();
    let known = known.flat_map(|map| map.notes.iter().map(|it| format!("{}: {it}", map.file)));
    lines.into_iter().flatten().chain(known).collect()
}

/// Uneven ground that the planner does not expect.
fn uneven(mission: &Mission, world: &World) -> Option<String> {
    let [least_m, most_m] = world.elevation()?.span_m()?;
    (mission.uneven_ground.is_none() && most_m - least_m > UNEVEN_M).then(|| {
        format!(
            "the ground is uneven, from {least_m:.2} to {most_m:.2} m, and the planner takes it \
             for flat: the robot may fall or tip over; say --ground uneven"
        )
    })
}

/// More floor than the map of a device has tiles.
fn large(mission: &Mission, world: &World) -> Option<String> {
    on_device(&mission.strategy)?;
    let tiles = |side_m: f64| (side_m / TILE_M).ceil() as usize + 1;
    let [across, up] = world.size_m().map(tiles);
    if across * up <= SLOTS {
        return None;
    }
    let needed = floor_tiles(mission, world)?;
    (needed > SLOTS).then(|| {
        format!(
            "the floor that the robot can see takes about {needed} tiles of {TILE_M} m, and the \
             device's map has {SLOTS}: it will be full before everything is explored"
        )
    })
}

/// Returns the number of tiles with floor that is connected with the start.
fn floor_tiles(mission: &Mission, world: &World) -> Option<usize> {
    let start = *world.starts().get(mission.start)?;
    let floor = CellSet::free(world, start);
    let grid = world.occupancy();
    let tile = |at_m: f64| (at_m / TILE_M).floor() as i64;
    let mut tiles = BTreeSet::new();
    for j in 0..grid.height() as i64 {
        for i in 0..grid.width() as i64 {
            let cell = GridCell { i, j };
            if floor.contains(cell) {
                tiles.insert(grid.centre(cell).map(tile));
            }
        }
    }
    Some(tiles.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::uneven::TABLE_I;
    use crate::world::{Class, Occupancy, Start};

    #[test]
    fn uneven_ground_that_is_taken_for_flat_is_told() {
        let world = World::builtin("cliff").expect("a built-in world");
        let told = surprises(&Mission::default(), &world);
        assert!(
            told.len() == 1 && told[0].contains("--ground uneven"),
            "{told:?}"
        );
        let expected = Mission {
            uneven_ground: Some(TABLE_I),
            ..Mission::default()
        };
        assert!(surprises(&expected, &world).is_empty());
        let flat = World::builtin("office").expect("a built-in world");
        assert!(surprises(&Mission::default(), &flat).is_empty());
    }

    #[test]
    fn a_floor_larger_than_the_map_is_told() {
        let start = Start {
            x_m: 5.0,
            y_m: 5.0,
            ..Start::default()
        };
        // 70 m squared are 22 tiles a side.
        let hall = |free: i64| {
            let mut grid = Occupancy::filled(350, 350, 0.2, [0.0, 0.0], Class::Unknown);
            for j in 0..350 {
                for i in 0..free {
                    grid.set(GridCell { i, j }, Class::Free);
                }
            }
            World::flat("hall", grid, vec![start])
        };
        let told = surprises(&Mission::default(), &hall(350));
        assert!(
            told.len() == 1 && told[0].contains("about 484 tiles"),
            "{told:?}"
        );
        // A part of the picture is unknown: 10 tiles by 22.
        assert!(surprises(&Mission::default(), &hall(160)).is_empty());
    }
}
