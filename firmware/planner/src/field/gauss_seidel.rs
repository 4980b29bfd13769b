//! Gauss–Seidel: one sweep in row order, the papers' method [BVP; Terrain, eq. 2], in q-form:
//!
//! ```text
//! q ← ((N + S) + (W + E) + (ε/2) (|N − S| + |W − E|)) / 4
//! ```
//!
//! For |ε| ≤ 2 this is a convex combination of the neighbours. Hence: started from q = 0 it rises monotonically, and
//! at every sweep each cell with q > 0 has a strictly better neighbour (no local minimum of p), which neither
//! over-relaxation nor the multigrid can promise in transit.

use core::cell::Cell;

use super::runs::Runs;
use super::window::{Preference, STRIDE, Window, index};

/// Relax every reached cell once, from the lowest row up, left to right.
pub(super) fn sweep(window: &mut Window) {
    if window.preferred {
        sweep_rows::<true>(window);
    } else {
        // (ε/2)(…) would add zero: leaving it out gives the same bits.
        sweep_rows::<false>(window);
    }
}

fn sweep_rows<const PREFERRED: bool>(window: &mut Window) {
    for (y, &reached) in window.reached.iter().enumerate() {
        for run in Runs(reached) {
            let start = index(run.start, y);
            let around = &mut window.q[start - STRIDE..][..run.len() + 2 * STRIDE];
            relax_run::<PREFERRED>(around, &window.preference[start..][..run.len()]);
        }
    }
}

/// Relax a run of cells: `around` starts below the run's first cell and ends above the cell after its last.
#[inline(always)]
fn relax_run<const PREFERRED: bool>(around: &mut [f32], preference: &[Preference]) {
    let length = preference.len();
    let mut west = around[STRIDE - 1];
    let around = Cell::from_mut(around).as_slice_of_cells();
    let south = &around[..length];
    let here = &around[STRIDE..][..length];
    let east = &around[STRIDE + 1..][..length];
    let north = &around[2 * STRIDE..][..length];
    let across = south.iter().zip(north);
    let along = here.iter().zip(east);
    for ((preference, (south, north)), (here, east)) in preference.iter().zip(across).zip(along) {
        let (north, south, east) = (north.get(), south.get(), east.get());
        let mut sum = (north + south) + (west + east);
        if PREFERRED {
            sum += preference.half() * ((north - south).abs() + (west - east).abs());
        }
        west = sum * 0.25;
        here.set(west);
    }
}

/// The greatest relative change that one more sweep would make: max |q′ − q| / q, 0 where nothing is free.
pub(super) fn residual(window: &Window) -> f32 {
    let mut worst = 0.0_f32;
    for (y, &reached) in window.reached.iter().enumerate() {
        for x in Runs(reached).flatten() {
            let at = index(x, y);
            let q = window.q[at];
            let (north, south) = (window.q[at + STRIDE], window.q[at - STRIDE]);
            let (west, east) = (window.q[at - 1], window.q[at + 1]);
            let bend = (north - south).abs() + (west - east).abs();
            let sum = (north + south) + (west + east) + window.preference[at].half() * bend;
            // Below the least normal number a relative change means nothing.
            let change = (sum * 0.25 - q).abs() / q.max(f32::MIN_POSITIVE);
            worst = worst.max(change);
        }
    }
    worst
}
