//! Where the robot can get: cells of the world whose centre a disc can be driven to from the start.
//!
//! A cell is open if no solid cell comes closer to its centre than the radius, exactly; open cells with a common edge are
//! connected. The start and the free cells within [`START_SLACK_M`] of it count as open: a robot whose rectangle fits
//! where the disc does not quite must not make the whole world unreachable.

use crate::world::{GridCell, Start, World};

/// How far around the start free cells count as open, metres.
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
    /// Everything connected, by common edges, with the start through cells that satisfy `open`.
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
            if grid.is_solid(cell) {
                return false;
            }
            let [x, y] = grid.centre(cell);
            let (dx, dy) = (x - start.x_m, y - start.y_m);
            // A rounding error must not close a door that fits exactly.
            world.distance().from_centre_m(cell) >= radius_m - 1e-9
                || dx * dx + dy * dy <= START_SLACK_M * START_SLACK_M
        })
    }

    /// The free cells in one piece with the start.
    #[must_use]
    pub fn free(world: &World, start: Start) -> Self {
        let grid = world.occupancy();
        Self::flood(world, start, |cell| !grid.is_solid(cell))
    }

    /// Is a cell in the set?
    #[must_use]
    pub fn contains(&self, cell: GridCell) -> bool {
        self.index(cell).is_some_and(|index| self.members[index])
    }

    /// Cells in the set.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    fn index(&self, cell: GridCell) -> Option<usize> {
        let i = usize::try_from(cell.i).ok().filter(|i| *i < self.width)?;
        let j = usize::try_from(cell.j).ok().filter(|j| *j < self.height)?;
        Some(j * self.width + i)
    }

    /// Adds a cell; says whether it was new. Outside of the world nothing can be added.
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
