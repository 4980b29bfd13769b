//! A first value for each cell that has none, or one far too low.
//!
//! The multigrid multiplies. It lowers values that are too high within a few cycles. It raises
//! values that are too low only as far as its smoothing carries, and it never raises zero. At the
//! solution a cell has at least (1 − |ε|/2)/4 of its best neighbour's value. So a cell with less
//! than a sixteenth (a new cell, or one beside a new goal or behind a door that opened) has no
//! valid value yet:
//!
//! ```text
//! q ← 0.85 n  where  16 q < n = max(N, S, W, E)
//! ```
//!
//! Around a warm field this continues the field outwards. In a cold window the ratio is 1.25
//! instead of 16: values become about 0.85 to the power of the distance to the nearest goal, which
//! is roughly the field's shape.
//!
//! The three constants belong together and are not tuned: the sweeps end only because each ratio is
//! above 1/0.85.
//!
//! Invariant: no cell falls; afterwards no reachable cell is below a sixteenth of a neighbour.

use core::cell::Cell;

use crate::field::runs::Runs;
use crate::field::window::{SIDE, STRIDE, Window, index};

/// Part of its best neighbour's value that a raised cell takes: about the field's ratio from cell
/// to cell indoors (measured: docs/MEASURED.md, "Value of a cell in a cold window").
const PART: f32 = 0.85;

/// Greatest ratio of a neighbour to a cell in a field that was right before the boundary moved. A
/// strong repulsion, ε < −1.5, can exceed it and gets a worse start.
const STEEPEST: f32 = 16.0;

/// Greatest ratio in a cold window, which has no value to keep: slightly more than 1/[`PART`].
const STEEPEST_COLD: f32 = 1.25;

/// Raises the cells that are too low, in sweeps up and down over the rows that may hold such cells:
/// rows with a new cell or goal, and the neighbours of a row that changed.
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

/// Raises the cells of a row that their neighbours exceed too far. Returns true if one changed.
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

/// Returns the greater of two numbers; `f32::max` handles NaN and compiles to a call.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
