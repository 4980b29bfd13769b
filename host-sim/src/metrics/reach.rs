//! The cells of a flat world that a disc can reach from the start.
//!
//! A cell is open if no solid cell is closer to its centre than the radius, exactly. Open cells
//! with a common edge are connected. The start and the free cells within [`START_SLACK_M`] of it
//! count as open: a robot's rectangle may fit where its disc does not, and then the whole world
//! would count as unreachable.

use crate::world::{GridCell, Start, World};

/// Distance from the start within which free cells count as open, metres.
pub const START_SLACK_M: f64 = 0.10;

/// A set of cells of the world's own grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellSet {
    width: usize,
    height: usize,
    members: Vec<bool>,
    count: usize,
}

impl CellSet {
    /// The cells that are connected with the start, by common edges, through cells that satisfy
    /// `open`.
    #[must_use]
    pub fn flood(world: &World, start: Start, open: impl Fn(GridCell) -> bool) -> Self {
        let grid = world.occupancy();
        let mut set = Self {
            width: grid.width(),
            height: grid.height(),
            members: vec![false; grid.width() * grid.height()],
            count: 0,
        };
        let first = grid.cell_at(start.x_m, start.y_m);
        let mut waiting = vec![first];
        while let Some(cell) = waiting.pop() {
            if (cell == first || open(cell)) && set.insert(cell) {
                for (di, dj) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                    waiting.push(GridCell {
                        i: cell.i + di,
                        j: cell.j + dj,
                    });
                }
            }
        }
        set
    }

    /// The cells that a disc of `radius_m` reaches.
    #[must_use]
    pub fn reach(world: &World, start: Start, radius_m: f64) -> Self {
        let grid = world.occupancy();
        Self::flood(world, start, |cell| {
            is_open(world, start, radius_m, (cell, grid.centre(cell)))
        })
    }

    /// The free cells that are connected with the start.
    #[must_use]
    pub fn free(world: &World, start: Start) -> Self {
        let grid = world.occupancy();
        Self::flood(world, start, |cell| !grid.is_solid(cell))
    }

    /// Returns true if a cell is in the set.
    #[must_use]
    pub fn contains(&self, cell: GridCell) -> bool {
        self.index(cell).is_some_and(|index| self.members[index])
    }

    /// Number of cells in the set.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    fn index(&self, cell: GridCell) -> Option<usize> {
        cell.index([self.width, self.height])
    }

    /// Adds a cell and returns true if it is new. Cells outside of the world are not added.
    fn insert(&mut self, cell: GridCell) -> bool {
        match self.index(cell) {
            Some(index) if !self.members[index] => {
                self.members[index] = true;
                self.count += 1;
                true
            }
            _ => false,
        }
    }
}

/// Returns true if the disc's centre can be at a point of a cell: the cell is free, and solid cells
/// are at least the radius away or the start is near.
pub(super) fn is_open(
    world: &World,
    start: Start,
    radius_m: f64,
    (cell, [x, y]): (GridCell, [f64; 2]),
) -> bool {
    let (dx, dy) = (x - start.x_m, y - start.y_m);
    // A rounding error must not close a door that fits exactly.
    !world.occupancy().is_solid(cell)
        && (world.distance().from_centre_m(cell) >= radius_m - 1e-9
            || dx * dx + dy * dy <= START_SLACK_M * START_SLACK_M)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Class, Occupancy};

    /// Two rooms of 2 × 2 m with a gap between them, `gap` cells of 5 cm wide.
    fn two_rooms(gap: i64) -> World {
        let mut grid = Occupancy::filled(84, 40, 0.05, [0.0, 0.0], Class::Free);
        for j in (0..40).filter(|j| !(20..20 + gap).contains(j)) {
            for i in 40..44 {
                grid.set(GridCell { i, j }, Class::Wall);
            }
        }
        World::flat("two rooms", grid, Vec::new())
    }

    fn at(x_m: f64, y_m: f64) -> Start {
        Start {
            x_m,
            y_m,
            yaw_rad: 0.0,
        }
    }

    #[test]
    fn a_disc_passes_a_gap_of_its_diameter_and_no_narrower_one() {
        let other_room = GridCell { i: 70, j: 20 };
        for (gap, radius_m, passes) in [(13, 0.3, true), (13, 0.325, true), (12, 0.3, false)] {
            let reach = CellSet::reach(&two_rooms(gap), at(1.0, 1.0), radius_m);
            assert_eq!(
                reach.contains(other_room),
                passes,
                "{gap} cells, {radius_m} m"
            );
            assert!(!reach.contains(GridCell { i: 2, j: 2 }));
        }
        // Centres from 0.325 m to 1.675 m: 28 × 28 cells.
        assert_eq!(
            CellSet::reach(&two_rooms(0), at(1.0, 1.0), 0.3).count(),
            28 * 28
        );
        assert_eq!(CellSet::free(&two_rooms(0), at(1.0, 1.0)).count(), 40 * 40);
        assert_eq!(
            CellSet::free(&two_rooms(1), at(1.0, 1.0)).count(),
            2 * 40 * 40 + 4
        );
    }

    #[test]
    fn a_start_slightly_too_close_to_a_wall_counts_as_open() {
        let reach = CellSet::reach(&two_rooms(0), at(0.26, 1.0), 0.3);
        assert!(reach.count() > 28 * 28 && reach.contains(GridCell { i: 20, j: 20 }));
        // Much too close: only the cells around the start.
        let stuck = CellSet::reach(&two_rooms(0), at(0.15, 1.0), 0.3);
        assert!(stuck.count() < 20, "{}", stuck.count());
    }
}
