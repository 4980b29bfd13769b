//! A first value for cells that have none, which the multigrid could never raise from zero.
//!
//! ```text
//! q ← max(q, 0.85 max(N, S, W, E))        over the blank cells, up and down the window
//! ```
//!
//! Around a warm field this continues it outwards; in a cold window it makes about 0.85 to the power of the distance to
//! the nearest goal, so that a start has roughly the field's shape.
//!
//! Invariant: a blank cell with a way to a value above zero gets one; other cells keep theirs.

use super::runs::Runs;
use super::window::{SIDE, STRIDE, Window, index};

/// What a cell takes of its neighbour's value: about the field's fall from cell to cell indoors. From 1, a flat start,
/// the heading behind doors takes a third more cycles.
const PART: f32 = 0.85;

/// Give every blank cell a value.
pub(super) fn fill_blanks(window: &mut Window) {
    let mut idle_sweeps = 0;
    for upward in [true, false].into_iter().cycle() {
        let (mut changed, mut missing) = (false, false);
        for step in 0..SIDE {
            let y = if upward { step } else { SIDE - 1 - step };
            for run in Runs(window.blank[y]) {
                let start = index(run.start, y);
                let beside = if upward {
                    start - STRIDE
                } else {
                    start + STRIDE
                };
                let mut source = [0.0; SIDE];
                let source = &mut source[..run.len()];
                source.copy_from_slice(&window.q[beside..][..run.len()]);
                changed |= raise_run(&mut window.q[start - 1..][..run.len() + 2], source);
                // A value spreads over its whole run, so the first cell speaks for the rest.
                missing |= window.q[start] == 0.0;
            }
        }
        // Beside values that have underflowed, blank cells stay at zero.
        idle_sweeps = if changed { 0 } else { idle_sweeps + 1 };
        if !missing || idle_sweeps == 2 {
            break;
        }
    }
    window.blank = [0; SIDE];
}

/// Raise a run of blank cells to what the `source` row beside it gives, and its neighbours in the row, the first and the
/// last of `row`. Answers whether a cell changed.
fn raise_run(row: &mut [f32], source: &[f32]) -> bool {
    let mut changed = false;
    let mut raise = |q: &mut f32, neighbour: f32| {
        let value = PART * neighbour;
        if value > *q {
            *q = value;
            changed = true;
        }
        *q
    };
    let [west, cells @ .., east] = row else {
        return false;
    };
    let mut west = *west;
    for (q, &source) in cells.iter_mut().zip(source) {
        west = raise(q, if source > west { source } else { west });
    }
    let mut east = *east;
    for q in cells.iter_mut().rev() {
        east = raise(q, east);
    }
    changed
}
