//! The map cells of a world as a rectangle, and the index of each.
//!
//! Cells have a side of [`MAP_CELL_M`]; indices run row by row from the least y.

use fieldline_planner::geometry::Cell;

use super::coverage::MAP_CELL_M;
use crate::world::World;

/// A rectangle of map cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellArea {
    /// Column of the first cell.
    pub x: i32,
    /// Row of the first cell.
    pub y: i32,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl CellArea {
    /// The cells that lie at least partly in a world.
    #[must_use]
    pub fn of(world: &World) -> Self {
        let [x0, y0] = world.occupancy().origin_m();
        let [width, height] = world.size_m();
        let first = |m: f64| (m / MAP_CELL_M).floor() as i32;
        // A world that ends with a cell, except for rounding, does not reach into the next cell.
        let last = |m: f64| (m / MAP_CELL_M - 1e-6).ceil() as i32;
        let count = |low: f64, size: f64| usize::try_from(last(low + size) - first(low));
        Self {
            x: first(x0),
            y: first(y0),
            width: count(x0, width).unwrap_or(0),
            height: count(y0, height).unwrap_or(0),
        }
    }

    /// Index of a cell; `None` outside.
    #[must_use]
    pub fn index(&self, cell: Cell) -> Option<usize> {
        let x = usize::try_from(cell.x - self.x).ok()?;
        let y = usize::try_from(cell.y - self.y).ok()?;
        (x < self.width && y < self.height).then_some(y * self.width + x)
    }

    /// Index of the cell at an offset from another cell; `None` outside.
    pub(super) fn beside(&self, cell: Cell, [dx, dy]: [i32; 2]) -> Option<usize> {
        self.index(Cell {
            x: cell.x + dx,
            y: cell.y + dy,
        })
    }

    /// Indices of the cells within a square of `cells` cells around one, itself included.
    pub(super) fn around(&self, cell: Cell, cells: i32) -> impl Iterator<Item = usize> + '_ {
        (-cells..=cells)
            .flat_map(move |dy| (-cells..=cells).map(move |dx| [dx, dy]))
            .filter_map(move |offset| self.beside(cell, offset))
    }

    /// The cell at an index.
    #[must_use]
    pub fn cell(&self, index: usize) -> Cell {
        Cell {
            x: self.x + (index % self.width) as i32,
            y: self.y + (index / self.width) as i32,
        }
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Returns true if it has no cells.
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
    fn a_cells_index_gives_the_cell() {
        let grid = Occupancy::filled(30, 10, 0.05, [-0.75, 0.1], Class::Free);
        let area = CellArea::of(&World::flat("strip", grid, Vec::new()));
        // x from −0.75 to 0.75 touches cells −8 to 7; y from 0.1 to 0.6 fills cells 1 to 5.
        assert_eq!((area.x, area.y, area.width, area.height), (-8, 1, 16, 5));
        assert_eq!((area.len(), area.is_empty()), (80, false));
        for index in 0..area.len() {
            assert_eq!(area.index(area.cell(index)), Some(index));
        }
        assert_eq!(area.index(Cell { x: 8, y: 1 }), None);
        assert_eq!(area.index(Cell { x: 0, y: 0 }), None);
    }
}
