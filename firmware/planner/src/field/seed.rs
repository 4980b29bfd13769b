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
//! Around a warm field this continues it outwards. A cold window is raised by a finer comb, to about 0.85 to the power of
//! the distance to the nearest goal, so that the start has roughly the field's shape.
//!
//! Invariant: no cell falls; afterwards no reached cell is below a sixteenth of its neighbours.

use super::runs::Runs;
use super::window::{SIDE, STRIDE, Start, Window, index};

/// What a cell takes of its neighbour's value: about the field's fall from cell to cell indoors. From 1, a flat start,
/// the heading behind doors takes a third more cycles.
const PART: f32 = 0.85;

/// How many times a neighbour may exceed a cell of a field that was right before the boundary moved. Strong repulsion,
/// ε < −1.5, may need more, and gets a worse start.
const STEEPEST: f32 = 16.0;

/// The same in a cold window, where no value is worth keeping: just more than 1/0.85.
const STEEPEST_COLD: f32 = 1.25;

/// Raise what is too low, in sweeps up and down the window until nothing changes.
pub(super) fn raise(window: &mut Window) {
    let steepest = match window.start {
        Start::Cold => STEEPEST_COLD,
        Start::Moved => STEEPEST,
        Start::Raised => return,
    };
    let mut idle_sweeps = 0;
    for upward in [true, false].into_iter().cycle() {
        let mut changed = false;
        for step in 0..SIDE {
            let y = if upward { step } else { SIDE - 1 - step };
            for run in Runs(window.reached[y]) {
                let start = index(run.start, y);
                let beside = if upward {
                    start - STRIDE
                } else {
                    start + STRIDE
                };
                let mut source = [0.0; SIDE];
                let source = &mut source[..run.len()];
                source.copy_from_slice(&window.q[beside..][..run.len()]);
                changed |= raise_run(
                    &mut window.q[start - 1..][..run.len() + 2],
                    source,
                    steepest,
                );
            }
        }
        idle_sweeps = if changed { 0 } else { idle_sweeps + 1 };
        if idle_sweeps == 2 {
            break;
        }
    }
    window.start = Start::Raised;
}

/// Raise a run of cells to what the `source` row beside it gives, and its neighbours in the row, the first and the last
/// of `row`. Answers whether a cell changed.
fn raise_run(row: &mut [f32], source: &[f32], steepest: f32) -> bool {
    let mut changed = false;
    let mut raise = |q: &mut f32, neighbour: f32| {
        if steepest * *q < neighbour {
            *q = PART * neighbour;
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
