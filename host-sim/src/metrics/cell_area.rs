//! The map cells of a world as a rectangle, and the index of each.
//!
//! Cells have a side of [`MAP_CELL_M`]; indices run row by row from the least y.

use fieldline_planner::geometry::Cell;

use super::coverage::MAP_CELL_M;
use crate::world::World;

/// A rectangle of map cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

    /// Returns the least rectangle that contains both; one without cells does not count.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        if self.is_empty() {
            return other;
        } else if other.is_empty() {
            return self;
        }
        let (x, y) = (self.x.min(other.x), self.y.min(other.y));
        let end = |low: i32, cells: usize| low + cells as i32;
        let east = end(self.x, self.width).max(end(other.x, other.width));
        let north = end(self.y, self.height).max(end(other.y, other.height));
        Self {
            x,
            y,
            width: (east - x) as usize,
            height: (north - y) as usize,
        }
    }

    /// The cell at an index.
    #[must_use]
    pub fn cell(&self, index: usize) -> Cell {
        let (x, y) = self.place(index);
        Cell {
            x: self.x + x as i32,
            y: self.y + y as i32,
        }
    }

    /// Column and row of an index, counted from the first cell.
    #[must_use]
    pub fn place(&self, index: usize) -> (usize, usize) {
        let width = self.width.max(1);
        (index % width, index / width)
    }

    /// The four neighbours of an index that is not on the outermost ring: east, north, west,
    /// south.
    #[must_use]
    pub const fn four(&self, index: usize) -> [usize; 4] {
        [index + 1, index + self.width, index - 1, index - self.width]
    }

    /// Returns true if an index is on the outermost ring.
    #[must_use]
    pub fn is_rim(&self, index: usize) -> bool {
        let (x, y) = self.place(index);
        x == 0 || y == 0 || x + 1 >= self.width || y + 1 >= self.height
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

    #[test]
    fn the_rectangle_around_two_contains_both() {
        let area = |x, y, width, height| CellArea {
            x,
            y,
            width,
            height,
        };
        let both = area(-5, 2, 10, 4).with(area(0, 0, 8, 5));
        assert_eq!(both, area(-5, 0, 13, 6));
        assert_eq!(area(9, 9, 0, 0).with(both), both);
        assert_eq!(both.with(area(9, 9, 0, 4)), both);
    }
}
