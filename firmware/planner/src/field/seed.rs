//! A start worth correcting: a value for each cell that has none, or one far too low.
//!
//! The multigrid multiplies. It brings down what is too high in a few cycles, but what is too low it raises only as far
//! as the smoothing carries, and zero it never raises. At the solution a cell has at least (1 − |ε|/2)/4 of its best
//! neighbour's value; so one with less than a sixteenth, in a new cell, beside a new goal, behind a door that opened,
//! holds no value but the lack of one:
//!
//! ```text
//! q ← 0.85 n  where  16 q < n = max(N, S, W, E)
//! ```
//!
//! GroundModel a warm field this continues it outwards. A cold window is raised by a finer comb, to about 0.85 to the power of
//! the distance to the nearest goal, so that the start has roughly the field's shape.
//!
//! Invariant: no cell falls; afterwards no reached cell is below a sixteenth of its neighbours.

use core::cell::Cell;

use crate::field::runs::Runs;
use crate::field::window::{SIDE, STRIDE, Window, index};

/// What a cell takes of its neighbour's value: about the field's fall from cell to cell indoors. From 1, a flat start,
/// the heading behind doors takes a third more cycles.
const PART: f32 = 0.85;

/// How many times a neighbour may exceed a cell of a field that was right before the boundary moved. Strong repulsion,
/// ε < −1.5, may need more, and gets a worse start.
const STEEPEST: f32 = 16.0;

/// The same in a cold window, where no value is worth keeping: just more than 1/0.85.
const STEEPEST_COLD: f32 = 1.25;

/// Raise what is too low, in sweeps up and down over the rows that may hold such cells: those with something new, and
/// those beside a row that changed.
pub(super) fn raise(window: &mut Window) {
    let steepest = if window.warm { STEEPEST } else { STEEPEST_COLD };
    let mut upward = true;
    while window.unraised != 0 {
        for step in 0..SIDE {
            let y = if upward { step } else { SIDE - 1 - step };
            if window.unraised >> y & 1 == 1 {
                window.unraised &= !(1 << y);
                if raise_row(window, y, steepest) {
                    window.touch_rows(1 << y);
                    window.unraised &= !(1 << y);
                }
            }
        }
        upward = !upward;
    }
    window.warm = true;
}

/// Raise the cells of a row to what their neighbours give. Answers whether one changed.
fn raise_row(window: &mut Window, y: usize, steepest: f32) -> bool {
    let mut changed = false;
    for run in Runs(window.reached[y]) {
        let length = run.len();
        let around = &mut window.q[index(run.start, y) - STRIDE..][..length + 2 * STRIDE];
        let around = Cell::from_mut(around).as_slice_of_cells();
        let south = &around[..length];
        let here = &around[STRIDE..][..length];
        let north = &around[2 * STRIDE..][..length];
        let mut raise = |cell: &Cell<f32>, best: f32| {
            let q = cell.get();
            if steepest * q < best {
                changed = true;
                cell.set(PART * best);
                PART * best
            } else {
                q
            }
        };
        let mut west = around[STRIDE - 1].get();
        for (here, (south, north)) in here.iter().zip(south.iter().zip(north)) {
            west = raise(here, greater(west, greater(south.get(), north.get())));
        }
        let mut east = around[STRIDE + length].get();
        for here in here.iter().rev() {
            east = raise(here, east);
        }
    }
    changed
}

/// The greater of two numbers, without the care for NaN that makes `f32::max` a call.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
