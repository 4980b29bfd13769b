//! Places in a world, found in its definition: pits in the ground, and a building with its
//! entrance.
//!
//! Units: metres; map cells of 10 cm, cell (0, 0) at the world's origin.

use std::collections::BTreeSet;

use fieldline_planner::geometry::Cell;
use host_sim::metrics::{GroundTruth, TrueClass};
use host_sim::report::grid_map::CELL_M;
use host_sim::world::{GridCell, World};

/// The cells of a pit in the order of rows.
pub type Pit = Vec<[i32; 2]>;

/// Returns the middle of a map cell.
#[must_use]
pub fn middle([x, y]: [i32; 2]) -> [f64; 2] {
    [x, y].map(|k| (f64::from(k) + 0.5) * CELL_M)
}

/// Returns the map cells of a rectangle: west, south, east, north.
pub fn cells(corners: [f64; 4]) -> impl Iterator<Item = [i32; 2]> {
    let [x0, y0, x1, y1] = corners.map(|m| (m / CELL_M).round() as i32);
    (y0..y1).flat_map(move |y| (x0..x1).map(move |x| [x, y]))
}

/// Returns the cells around a cell up to `reach` cells away, with itself.
pub fn around([x, y]: [i32; 2], reach: i32) -> impl Iterator<Item = [i32; 2]> {
    let span = move || -reach..=reach;
    span().flat_map(move |dy| span().map(move |dx| [x + dx, y + dy]))
}

/// Returns the pits of a world: connected pieces of truly negative cells, the northern ones first.
#[must_use]
pub fn pits(world: &World, ground: &GroundTruth) -> Vec<Pit> {
    let [width, height] = world.size_m();
    let is_negative =
        |&[x, y]: &[i32; 2]| matches!(ground.class(Cell { x, y }), TrueClass::Negative);
    let mut left: BTreeSet<[i32; 2]> = cells([0.0, 0.0, width, height])
        .filter(is_negative)
        .collect();
    let mut pits = Vec::new();
    while let Some(&first) = left.first() {
        let mut pit = pieces(first, |cell| left.remove(&cell));
        pit.sort_unstable_by_key(|&[x, y]| (y, x));
        pits.push(pit);
    }
    pits.sort_unstable_by_key(|pit| core::cmp::Reverse(pit.last().map(|&[_, y]| y)));
    pits
}

/// Returns the cells connected with `first`, 8 neighbours each; `take` says once if a cell belongs.
fn pieces(first: [i32; 2], mut take: impl FnMut([i32; 2]) -> bool) -> Vec<[i32; 2]> {
    take(first);
    let mut piece = vec![first];
    let mut next = 0;
    while let Some(&cell) = piece.get(next) {
        next += 1;
        piece.extend(around(cell, 1).filter(|&near| take(near)));
    }
    piece
}

/// A building that stands free in a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Building {
    /// West, south, east and north of its outer walls.
    pub walls: [f64; 4],
    /// Middle of its entrance, on the outer face of its south wall.
    pub entrance: [f64; 2],
}

/// Returns the building of a world: the widest solid piece that does not touch the world's rim. Its
/// entrance is a gap in the middle of its south wall.
///
/// # Panics
/// If the world has no such piece, or its south wall is solid in the middle.
#[must_use]
pub fn building(world: &World) -> Building {
    let grid = world.occupancy();
    let [columns, rows] = [grid.width(), grid.height()].map(|side| side as i32);
    let is_solid = |x: i32, y: i32| {
        grid.is_solid(GridCell {
            i: x.into(),
            j: y.into(),
        })
    };
    let all = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
    let mut left: BTreeSet<[i32; 2]> = all.filter(|&[x, y]| is_solid(x, y)).collect();
    let mut widest = [0; 4];
    while let Some(&first) = left.first() {
        let piece = pieces(first, |cell| left.remove(&cell));
        let bound = |axis: usize| {
            let along = piece.iter().map(move |cell| cell[axis]);
            [along.clone().min(), along.max()].map(Option::unwrap_or_default)
        };
        let ([west, east], [south, north]) = (bound(0), bound(1));
        let inside = west > 0 && south > 0 && east < columns - 1 && north < rows - 1;
        if inside && east - west > widest[2] - widest[0] {
            widest = [west, south, east + 1, north + 1];
        }
    }
    let [west, south, east, _] = widest;
    assert!(
        !is_solid((west + east) / 2, south),
        "{} has no building with an entrance in the south",
        world.name()
    );
    let metres = |cell: i32| f64::from(cell) * grid.resolution_m();
    Building {
        walls: widest.map(metres),
        entrance: [metres(west + east) / 2.0, metres(south)],
    }
}

#[cfg(test)]
mod tests {
    use super::{Building, building};
    use crate::worlds::builtin;

    /// As the world's description says.
    #[test]
    fn the_building_is_found_with_its_entrance() {
        let Building { walls, entrance } = building(&builtin("building"));
        let expected = [10.0, 12.0, 17.0, 18.0, 13.5, 12.0];
        for (found, expected) in walls.into_iter().chain(entrance).zip(expected) {
            assert!((found - expected).abs() < 1e-9, "{walls:?}, {entrance:?}");
        }
    }
}
