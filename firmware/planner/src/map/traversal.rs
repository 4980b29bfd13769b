//! The cells that a beam crosses, by Amanatides–Woo traversal, tile by tile.
//!
//! ```text
//! next = (length at which the beam leaves the present column, length at which it leaves the row)
//! min(next) = length at which it leaves the present cell
//! ```
//!
//! Within a tile a cell is a row and a bit. So a step is an addition and a shift, and the traversal
//! looks up a tile once in about thirty cells.
//!
//! Units: metres along the beam from the start of the traversal; map cells.

use crate::geometry::{CELL_M, Cell, Point};
use crate::map::tiles::TILE_SIDE;

/// A traversal in progress.
#[derive(Clone, Copy, Debug)]
pub(super) struct Traversal {
    /// The tile that holds the present cell.
    tile: (i32, i32),
    /// The present cell's row in it, and its column as a bit.
    row: i32,
    bit: u32,
    /// Lengths at which the beam leaves the present column and row, metres.
    next: (f32, f32),
    /// Lengths from one column and row to the next, metres.
    every: (f32, f32),
    /// Shifts of the bit to the next column, up and down; one of them is 0.
    up: u32,
    down: u32,
    /// Step to the next row: −1, 0 or 1.
    step: i32,
    length_m: f32,
    /// The beam ended on something in the last cell, so it does not cross that cell.
    excludes_end: bool,
}

/// Returns, along one axis, the step from cell to cell, the length at which the beam leaves the
/// first one, and the length from one to the next.
fn axis(position: f32, index: i32, direction: f32) -> (i32, f32, f32) {
    if direction > 1e-6 {
        let border = (index + 1) as f32 * CELL_M;
        (1, (border - position) / direction, CELL_M / direction)
    } else if direction < -1e-6 {
        let border = index as f32 * CELL_M;
        (-1, (border - position) / direction, -CELL_M / direction)
    } else {
        (0, f32::MAX, 0.0)
    }
}

impl Traversal {
    /// Creates a traversal from `start` along a unit vector for `length_m`, with or without the
    /// cell at its end.
    pub(super) fn new(
        start: Point,
        direction: (f32, f32),
        length_m: f32,
        excludes_end: bool,
    ) -> Self {
        let cell = start.cell();
        let (step_x, next_x, every_x) = axis(start.x_m, cell.x, direction.0);
        let (step, next_y, every_y) = axis(start.y_m, cell.y, direction.1);
        Self {
            tile: (cell.x.div_euclid(TILE_SIDE), cell.y.div_euclid(TILE_SIDE)),
            row: cell.y.rem_euclid(TILE_SIDE),
            bit: 1 << cell.x.rem_euclid(TILE_SIDE),
            next: (next_x, next_y),
            every: (every_x, every_y),
            up: (step_x > 0) as u32,
            down: (step_x < 0) as u32,
            step,
            length_m,
            excludes_end,
        }
    }

    /// Returns the tile of the next cell.
    pub(super) const fn tile(&self) -> (i32, i32) {
        self.tile
    }

    /// Returns the map cell at a row and a bit of a tile.
    pub(super) const fn cell(tile: (i32, i32), row: usize, bit: u32) -> Cell {
        Cell {
            x: tile.0 * TILE_SIDE + bit.trailing_zeros() as i32,
            y: tile.1 * TILE_SIDE + row as i32,
        }
    }

    /// Returns true if no cell is left.
    pub(super) fn is_over(&self) -> bool {
        let (x, y) = self.next;
        self.excludes_end && (if x < y { x } else { y }) >= self.length_m
    }

    /// Visits the cells in the present tile and moves to the next tile.
    ///
    /// The visitor receives the row, the bit, and the length at which the beam leaves the cell; it
    /// returns false to stop. Returns false if the beam ended or the visitor stopped it.
    #[inline(always)]
    pub(super) fn cross_tile(&mut self, mut visit: impl FnMut(usize, u32, f32) -> bool) -> bool {
        let Self {
            mut row,
            mut bit,
            next: (mut next_x, mut next_y),
            every,
            up,
            down,
            step,
            length_m,
            ..
        } = *self;
        loop {
            let sideways = next_x < next_y;
            let leaves = if sideways { next_x } else { next_y };
            if leaves >= length_m {
                // The last cell.
                if !self.excludes_end {
                    visit(row as usize, bit, leaves);
                }
                return false;
            }
            if !visit(row as usize, bit, leaves) {
                return false;
            }
            if sideways {
                next_x += every.0;
                bit = bit << up >> down;
                if bit == 0 {
                    break;
                }
            } else {
                next_y += every.1;
                row += step;
                if row as u32 >= TILE_SIDE as u32 {
                    break;
                }
            }
        }
        (self.row, self.bit, self.next) = (row, bit, (next_x, next_y));
        self.enter_next_tile();
        true
    }

    /// Moves to the tile that holds the present cell.
    fn enter_next_tile(&mut self) {
        if self.bit == 0 {
            self.tile.0 += if self.up == 1 { 1 } else { -1 };
            self.bit = if self.up == 1 {
                1
            } else {
                1 << (TILE_SIDE - 1)
            };
        } else {
            self.tile.1 += self.step;
            self.row = self.row.rem_euclid(TILE_SIDE);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::Traversal;
    use crate::geometry::{CELL_M, Cell, Point};
    use crate::math;

    fn cells(start: Point, direction: (f32, f32), length_m: f32, excludes_end: bool) -> Vec<Cell> {
        let mut traversal = Traversal::new(start, direction, length_m, excludes_end);
        let mut cells = Vec::new();
        loop {
            let tile = traversal.tile();
            let goes_on = traversal.cross_tile(|row, bit, _| {
                cells.push(Traversal::cell(tile, row, bit));
                true
            });
            if !goes_on {
                return cells;
            }
        }
    }

    /// Dense samples of the segment must all lie in visited cells, except those on a border.
    #[test]
    fn every_cell_of_the_segment_is_visited_in_order() {
        for k in 0..200 {
            let start = Point {
                x_m: 0.013 * k as f32,
                y_m: -0.7 + 0.01 * k as f32,
            };
            let (sin, cos) = math::sin_cos(0.17 * k as f32);
            let length_m = 0.05 + 0.04 * k as f32;
            let cells = cells(start, (cos, sin), length_m, false);
            for pair in cells.windows(2) {
                assert_eq!(
                    (pair[0].x - pair[1].x).abs() + (pair[0].y - pair[1].y).abs(),
                    1
                );
            }
            let mut at = 0;
            for i in 0..=2000 {
                let s = length_m * i as f32 / 2000.0;
                let p = Point {
                    x_m: start.x_m + cos * s,
                    y_m: start.y_m + sin * s,
                };
                let inside = |v: f32| (v / CELL_M - (v / CELL_M).round()).abs() > 1e-3;
                if inside(p.x_m) && inside(p.y_m) {
                    while at < cells.len() && cells[at] != p.cell() {
                        at += 1;
                    }
                    assert!(at < cells.len(), "beam {k} misses {:?}", p.cell());
                }
            }
        }
    }

    #[test]
    fn the_end_may_be_left_out() {
        let start = Point {
            x_m: 3.05,
            y_m: -0.05,
        };
        for direction in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let whole = cells(start, direction, 1.0, false);
            let short = cells(start, direction, 1.0, true);
            assert_eq!((whole.len(), &whole[..10]), (11, &short[..]));
        }
    }
}
