//! All heights measured so far.
//!
//! The planner's elevation window rolls with the robot and forgets the cells that leave it. This
//! grid keeps the last height of every cell. Units: metres above the start; map cells.

use std::collections::BTreeMap;

use fieldline_planner::geometry::Cell;
use fieldline_planner::ground::Heights;
use fieldline_planner::ground::elevation::WINDOW_SIDE;

/// Cells along a block's side.
const SIDE: i32 = 64;

/// Heights in blocks of 64 × 64 cells; NaN in a cell that was not measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeightGrid {
    blocks: BTreeMap<(i32, i32), Vec<f32>>,
}

impl HeightGrid {
    /// Copies every height of the window.
    pub fn keep(&mut self, heights: &Heights<'_>) {
        let Cell { x, y } = heights.origin();
        for cell in
            (y..y + WINDOW_SIDE).flat_map(|y| (x..x + WINDOW_SIDE).map(move |x| Cell { x, y }))
        {
            if let Some(height_m) = heights.height_m(cell) {
                let (block, slot) = place(cell);
                let empty = || vec![f32::NAN; (SIDE * SIDE) as usize];
                self.blocks.entry(block).or_insert_with(empty)[slot] = height_m;
            }
        }
    }

    /// Returns the last height of a cell, metres.
    #[must_use]
    pub fn height_m(&self, cell: Cell) -> Option<f32> {
        let (block, slot) = place(cell);
        let height_m = *self.blocks.get(&block)?.get(slot)?;
        (!height_m.is_nan()).then_some(height_m)
    }
}

/// Returns the block of a cell, and its index in the block.
fn place(cell: Cell) -> ((i32, i32), usize) {
    let block = (cell.x.div_euclid(SIDE), cell.y.div_euclid(SIDE));
    let slot = cell.y.rem_euclid(SIDE) * SIDE + cell.x.rem_euclid(SIDE);
    (block, slot as usize)
}

#[cfg(test)]
mod tests {
    use super::HeightGrid;
    use fieldline_planner::GroundTuning;
    use fieldline_planner::geometry::Cell;
    use fieldline_planner::ground::elevation::{Elevation, WINDOW_CELLS};

    #[test]
    fn a_height_outlives_the_window_and_a_new_measurement_replaces_it() {
        let (mut bytes, mut marks) = (vec![0; 2 * WINDOW_CELLS], vec![0; WINDOW_CELLS]);
        let mut origin = Cell { x: -32, y: -32 };
        let mut grid = HeightGrid::default();
        let (here, far) = (Cell { x: -5, y: 7 }, Cell { x: 300, y: 7 });
        let mut elevation =
            Elevation::new(&mut bytes, &mut marks, &mut origin, &GroundTuning::DEFAULT);
        elevation.mark_wheel_contact(here, 0.5);
        grid.keep(&elevation.read());
        elevation.follow(far);
        elevation.mark_wheel_contact(far, -1.0);
        grid.keep(&elevation.read());
        assert_eq!(elevation.read().height_m(here), None);
        assert_eq!(
            (grid.height_m(here), grid.height_m(far)),
            (Some(0.5), Some(-1.0))
        );
        assert_eq!(grid.height_m(Cell { x: -4, y: 7 }), None);
        elevation.follow(here);
        elevation.mark_wheel_contact(here, 0.25);
        grid.keep(&elevation.read());
        assert_eq!(grid.height_m(here), Some(0.25));
    }
}
