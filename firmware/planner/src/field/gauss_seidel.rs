//! Gauss–Seidel: one sweep in row order, the papers' method \[Prestes02; Maffei20, eq. 2\], for
//! q = 1 − p:
//!
//! ```text
//! q ← ((N + S) + (W + E) + (ε/2) (|N − S| + |W − E|)) / 4
//! ```
//!
//! For |ε| ≤ 2 this is a convex combination of the neighbours. So from q = 0 the field rises
//! monotonically, and after every sweep each cell with q > 0 has a strictly better neighbour: p has
//! no local minimum. Over-relaxation and the multigrid do not guarantee that before they converge.

use core::cell::Cell;

use crate::field::runs::Runs;
use crate::field::window::{Preference, STRIDE, Window, index};

/// Relaxes every reachable cell once, from the lowest row up, left to right.
pub(super) fn sweep(window: &mut Window) {
    if window.preferred {
        sweep_rows::<true, false>(window);
    } else {
        // Without preferences the last term is zero; without the term the bits are the same.
        sweep_rows::<false, false>(window);
    }
}

/// Sweeps as [`sweep`] does and returns the greatest relative change of a cell. The change is
/// infinite while a cell rises from zero.
pub(super) fn measured_sweep(window: &mut Window) -> f32 {
    if window.preferred {
        sweep_rows::<true, true>(window)
    } else {
        sweep_rows::<false, true>(window)
    }
}

fn sweep_rows<const PREFERRED: bool, const MEASURED: bool>(window: &mut Window) -> f32 {
    let mut worst = 0.0;
    for (y, &reached) in window.reached.iter().enumerate() {
        for run in Runs(reached) {
            let start = index(run.start, y);
            let around = &mut window.q[start - STRIDE..][..run.len() + 2 * STRIDE];
            let preference = &window.preference[start..][..run.len()];
            relax_run::<PREFERRED, MEASURED>(around, preference, &mut worst);
        }
    }
    worst
}

/// Relaxes a run of cells. `around` begins below the run's first cell and ends above the cell after
/// its last one.
#[inline(always)]
fn relax_run<const PREFERRED: bool, const MEASURED: bool>(
    around: &mut [f32],
    preference: &[Preference],
    worst: &mut f32,
) {
    let length = preference.len();
    let mut west = around[STRIDE - 1];
    let around = Cell::from_mut(around).as_slice_of_cells();
    let south = &around[..length];
    let here = &around[STRIDE..][..length];
    let east = &around[STRIDE + 1..][..length];
    let north = &around[2 * STRIDE..][..length];
    let upright = south.iter().zip(north);
    let level = here.iter().zip(east);
    for ((preference, (south, north)), (here, east)) in preference.iter().zip(upright).zip(level) {
        let (north, south, east) = (north.get(), south.get(), east.get());
        let mut sum = (north + south) + (west + east);
        if PREFERRED {
            sum += preference.half() * ((north - south).abs() + (west - east).abs());
        }
        west = sum * 0.25;
        if MEASURED {
            // Below the least normal number a relative change has no meaning.
            let change = (west - here.get()).abs();
            if change > *worst * here.get() + f32::MIN_POSITIVE {
                *worst = change / here.get();
            }
        }
        here.set(west);
    }
}
