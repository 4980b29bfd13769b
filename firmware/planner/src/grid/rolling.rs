//! A square window that rolls with the robot over the map.
//!
//! Map cell (x, y) always has the slot (x mod SIDE, y mod SIDE), so that the window moves without
//! copying: only the strips of cells that enter have to be cleared.
//!
//! ```text
//! origin = (centre − SIDE / 2), rounded down to a multiple of STRIDE
//! slot   = (y mod SIDE) · SIDE + (x mod SIDE)
//! ```
//!
//! Invariant: a slot belongs to exactly one cell of the window.
//! Units: map cells.

use core::ops::Range;

use crate::geometry::Cell;

/// A window of SIDE × SIDE cells that moves in steps of STRIDE cells; both are powers of two. The
/// owner keeps its `origin`, the least cell.
#[derive(Debug)]
pub(crate) struct Rolling<const SIDE: i32, const STRIDE: i32>;

impl<const SIDE: i32, const STRIDE: i32> Rolling<SIDE, STRIDE> {
    /// Returns the origin of the window around a cell.
    pub(crate) const fn origin(centre: Cell) -> Cell {
        const { assert!(SIDE & (SIDE - 1) == 0 && STRIDE & (STRIDE - 1) == 0) };
        Cell {
            x: (centre.x - SIDE / 2) & !(STRIDE - 1),
            y: (centre.y - SIDE / 2) & !(STRIDE - 1),
        }
    }

    /// Returns true if the window covers the cell.
    #[inline(always)]
    pub(crate) const fn covers(origin: Cell, cell: Cell) -> bool {
        // One comparison for both ends of each axis.
        ((cell.x - origin.x) as u32) < SIDE as u32 && ((cell.y - origin.y) as u32) < SIDE as u32
    }

    /// Returns the slot of a cell that the window covers, and of its twins outside.
    #[inline(always)]
    pub(crate) const fn slot(cell: Cell) -> usize {
        ((cell.y & (SIDE - 1)) * SIDE + (cell.x & (SIDE - 1))) as usize
    }

    /// Returns the columns and the rows that enter if the window moves; `None` if no cell stays.
    pub(crate) fn entering(from: Cell, to: Cell) -> Option<[Range<i32>; 2]> {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        if dx.abs() >= SIDE || dy.abs() >= SIDE {
            return None;
        }
        let strip = |from: i32, to: i32| {
            if to > from {
                from + SIDE..to + SIDE
            } else {
                to..from
            }
        };
        Some([strip(from.x, to.x), strip(from.y, to.y)])
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::Rolling;
    use crate::geometry::Cell;

    type Window = Rolling<8, 2>;

    fn cells(origin: Cell) -> BTreeSet<(i32, i32)> {
        let cells = (-30..30).flat_map(|y| (-30..30).map(move |x| Cell { x, y }));
        let covered = cells.filter(|&cell| Window::covers(origin, cell));
        covered.map(|cell| (cell.x, cell.y)).collect()
    }

    #[test]
    fn the_strips_are_the_cells_that_enter() {
        let from = Window::origin(Cell { x: 3, y: -2 });
        assert_eq!((from, cells(from).len()), (Cell { x: -2, y: -6 }, 64));
        for (x, y) in (-12..12).flat_map(|y| (-12..12).map(move |x| (x, y))) {
            let to = Window::origin(Cell { x, y });
            let entering = &cells(to) - &cells(from);
            let Some([columns, rows]) = Window::entering(from, to) else {
                assert_eq!(entering.len(), 64);
                continue;
            };
            let is_in_a_strip = |(x, y): &(i32, i32)| columns.contains(x) || rows.contains(y);
            let strips = cells(to).into_iter().filter(is_in_a_strip);
            assert_eq!(strips.collect::<BTreeSet<_>>(), entering);
        }
    }

    #[test]
    fn every_cell_of_a_window_has_a_slot_of_its_own() {
        let cells = cells(Cell { x: -7, y: 5 });
        let slot = |&(x, y): &(i32, i32)| Window::slot(Cell { x, y });
        let slots: BTreeSet<usize> = cells.iter().map(slot).collect();
        assert_eq!(slots, (0..64).collect());
    }
}
