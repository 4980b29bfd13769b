//! The map cells of a world as a rectangle: the only place where they are counted through.
//!
//! Cells of [`MAP_CELL_M`], row by row from the least y.

use fieldline_planner::geometry::Cell;

use super::coverage::MAP_CELL_M;
use crate::world::World;

/// A rectangle of map cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Column of the first cell.
    pub x: i32,
    /// Row of the first cell.
    pub y: i32,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Frame {
    /// The cells that lie at least partly in a world.
    #[must_use]
    pub fn of(world: &World) -> Self {
        let [x0, y0] = world.occupancy().origin_m();
        let [width, height] = world.size_m();
        let first = |m: f64| (m / MAP_CELL_M).floor() as i32;
        // A world that ends with a cell, give or take rounding, does not reach into the next.
        let last = |m: f64| (m / MAP_CELL_M - 1e-6).ceil() as i32;
        let count = |low: f64, size: f64| usize::try_from(last(low + size) - first(low));
        Self {
            x: first(x0),
            y: first(y0),
            width: count(x0, width).unwrap_or(0),
            height: count(y0, height).unwrap_or(0),
        }
    }

    /// Where a cell is stored, if it is in the frame.
    #[must_use]
    pub fn index(&self, cell: Cell) -> Option<usize> {
        let x = usize::try_from(cell.x - self.x).ok()?;
        let y = usize::try_from(cell.y - self.y).ok()?;
        (x < self.width && y < self.height).then_some(y * self.width + x)
    }

    /// The cell that is stored at an index.
    #[must_use]
    pub fn cell(&self, index: usize) -> Cell {
        Cell {
            x: self.x + (index % self.width) as i32,
            y: self.y + (index / self.width) as i32,
        }
    }

    /// Cells in it.
    #[must_use]
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Whether it holds nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Class, Occupancy};

    #[test]
    fn cells_and_indices_are_each_others_inverse() {
        let grid = Occupancy::filled(30, 10, 0.05, [-0.75, 0.1], Class::Free);
        let frame = Frame::of(&World::flat("strip", grid, Vec::new()));
        // x from −0.75 to 0.75 touches cells −8 to 7; y from 0.1 to 0.6 fills cells 1 to 5.
        assert_eq!(
            (frame.x, frame.y, frame.width, frame.height),
            (-8, 1, 16, 5)
        );
        assert_eq!((frame.len(), frame.is_empty()), (80, false));
        for index in 0..frame.len() {
            assert_eq!(frame.index(frame.cell(index)), Some(index));
        }
        assert_eq!(frame.index(Cell { x: 8, y: 1 }), None);
        assert_eq!(frame.index(Cell { x: 0, y: 0 }), None);
    }
}
