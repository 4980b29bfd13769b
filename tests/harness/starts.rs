//! Starts drawn at random, for flat worlds that have only one.
//!
//! Every cell that the robot can reach from the world's own start is equally likely if it has
//! [`ROOM_M`] of free space around it, and so is every heading. All starts lie in one connected
//! piece, so the ground that counts is the same from every start.

use host_sim::metrics::CellSet;
use host_sim::robot::RADIUS_M;
use host_sim::world::{GridCell, Start, World};

use crate::random::Random;

/// Free space around a start, metres: the robot's corner is 0.4 m from its middle.
pub const ROOM_M: f64 = 0.45;
/// Number of headings to draw from, all around.
const HEADINGS: u64 = 360;

/// Returns a flat world with `count` starts: its own first one, and others drawn from `seed`.
///
/// # Panics
/// If the world is not flat, or no cell has free space around it.
#[must_use]
pub fn drawn(world: &World, count: usize, seed: u64) -> World {
    assert!(
        world.elevation().is_none(),
        "{} is not flat; draw starts in flat worlds only",
        world.name()
    );
    let own = world.starts().first().copied().unwrap_or_default();
    let places = places(world, own);
    assert!(
        !places.is_empty(),
        "{} has no reachable place with {ROOM_M} m around it",
        world.name()
    );
    let mut random = Random::new(seed);
    let mut starts = vec![own];
    while starts.len() < count {
        let [x_m, y_m] = places[random.below(places.len() as u64) as usize];
        let turn = random.below(HEADINGS) as f64 / HEADINGS as f64;
        let yaw_rad = (turn - 0.5) * core::f64::consts::TAU;
        let [x_m, y_m, yaw_rad] = [x_m, y_m, yaw_rad].map(short);
        starts.push(Start { x_m, y_m, yaw_rad });
    }
    World::flat(world.name(), world.occupancy().clone(), starts)
}

/// Rounds to a thousandth, so that a world file can hold the number exactly.
fn short(number: f64) -> f64 {
    (number * 1000.0).round() / 1000.0
}

/// Returns the centres of the cells where a robot may start, row by row.
fn places(world: &World, own: Start) -> Vec<[f64; 2]> {
    let (grid, reach) = (world.occupancy(), CellSet::reach(world, own, RADIUS_M));
    let cells = (0..grid.height() as i64)
        .flat_map(|j| (0..grid.width() as i64).map(move |i| GridCell { i, j }));
    cells
        .filter(|&cell| reach.contains(cell) && world.distance().from_centre_m(cell) >= ROOM_M)
        .map(|cell| grid.centre(cell))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{ROOM_M, drawn};
    use crate::worlds::builtin;
    use host_sim::metrics::CellSet;
    use host_sim::robot::RADIUS_M;

    #[test]
    fn drawn_starts_have_room_and_lie_in_one_piece_with_the_first() {
        let world = builtin("unreachable-room");
        let drawn = drawn(&world, 40, 3);
        assert_eq!(drawn.starts().len(), 40);
        let own = world.starts()[0];
        assert_eq!(drawn.starts()[0], own);
        let reach = CellSet::reach(&world, own, RADIUS_M);
        for start in &drawn.starts()[1..] {
            let cell = world.occupancy().cell_at(start.x_m, start.y_m);
            assert!(reach.contains(cell), "{start:?}");
            assert!(world.distance().from_centre_m(cell) >= ROOM_M, "{start:?}");
        }
    }

    #[test]
    fn the_seed_decides_the_starts() {
        let world = builtin("office");
        let starts = |seed| drawn(&world, 5, seed).starts().to_vec();
        assert_eq!(starts(1), starts(1));
        assert_ne!(starts(1), starts(2));
    }
}
