//! Solve the window: which method, how long, and when to stop.
//!
//! The multigrid stops when its own factors say that the field is right, max |x − 1| < 0.05: a small residual says
//! nothing, since a slow mode has a small residual and a large error. It gives way to Gauss–Seidel where it is known
//! to be weak, under a strong global attraction, and where its factors stop converging.
//!
//! The budget is in multigrid cycles, a hard bound on time: Gauss–Seidel spends [`SWEEPS_PER_CYCLE`] sweeps for one.
//! A field that ran out of budget stays in the window, and the next call goes on from it.

use crate::config::{Method, SolverConfig};
use crate::field::gauss_seidel;
use crate::field::multigrid::{self, SCRATCH_FLOATS};
use crate::field::runs::Runs;
use crate::field::seed;
use crate::field::window::{Window, index};

/// Gauss–Seidel sweeps that cost about as much as a multigrid cycle.
pub const SWEEPS_PER_CYCLE: u16 = 5;

/// Mean preference above which the multigrid is not used: q comes so near to the goal's value over whole rooms that
/// the factors see little but rounding, and call a field right that is not.
const STRONG_ATTRACTION: f32 = 0.15;

/// Cycles of one call without a better error after which the multigrid gives up.
const PATIENCE: u16 = 12;

/// Relative change of any cell in one sweep below which Gauss–Seidel has converged. Its slowest modes lose less than a
/// hundredth of their error a sweep, so this leaves up to a few thousandths.
const SWEEP_TOLERANCE: f32 = 1e-5;

/// Why a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The stop rule holds.
    Converged,
    /// The budget ran out first; the next call goes on from here.
    Budget,
    /// No free cell can be reached from a goal: there is no field.
    Flat,
}

/// What a solve did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Multigrid cycles spent.
    pub cycles: u16,
    /// Gauss–Seidel sweeps spent, beyond the one in each cycle.
    pub sweeps: u16,
    /// Why it ended.
    pub stop: Stop,
    /// What the stop rule looked at last: the multigrid's max |x − 1|, or the greatest relative change of a sweep.
    pub residual: f32,
    /// The method that ended it: never [`Method::Auto`].
    pub method: Method,
}

/// Solve the window's field from whatever it holds.
pub fn solve(
    window: &mut Window,
    scratch: &mut [f32; SCRATCH_FLOATS],
    config: &SolverConfig,
) -> Solution {
    let mut solution = Solution {
        cycles: 0,
        sweeps: 0,
        stop: Stop::Budget,
        residual: f32::INFINITY,
        method: Method::Multigrid,
    };
    if window.reached.iter().all(|&row| row == 0) {
        return Solution {
            stop: Stop::Flat,
            residual: 0.0,
            ..solution
        };
    }
    let strong = config.method == Method::Auto && mean_preference(window) > STRONG_ATTRACTION;
    if config.method != Method::GaussSeidel && !strong {
        run_multigrid(window, scratch, config, &mut solution);
    } else {
        solution.method = Method::GaussSeidel;
    }
    if solution.method == Method::GaussSeidel {
        run_gauss_seidel(window, config, &mut solution);
    }
    solution
}

fn run_multigrid(
    window: &mut Window,
    scratch: &mut [f32; SCRATCH_FLOATS],
    config: &SolverConfig,
    solution: &mut Solution,
) {
    seed::raise(window);
    let (mut best, mut since) = (f32::INFINITY, 0);
    while solution.cycles < config.max_cycles {
        solution.residual = multigrid::cycle(window, scratch);
        solution.cycles += 1;
        if solution.residual < config.tolerance {
            solution.stop = Stop::Converged;
            return;
        }
        since += 1;
        if solution.residual < best {
            (best, since) = (solution.residual, 0);
        }
        if config.method == Method::Auto && since >= PATIENCE {
            solution.method = Method::GaussSeidel;
            return;
        }
    }
}

fn run_gauss_seidel(window: &mut Window, config: &SolverConfig, solution: &mut Solution) {
    // What has risen part of the way is worth keeping.
    window.warm = true;
    for _ in solution.cycles..config.max_cycles {
        for _ in 1..SWEEPS_PER_CYCLE {
            gauss_seidel::sweep(window);
        }
        solution.residual = gauss_seidel::measured_sweep(window);
        solution.sweeps += SWEEPS_PER_CYCLE;
        if solution.residual < SWEEP_TOLERANCE {
            solution.stop = Stop::Converged;
            return;
        }
    }
}

/// Mean ε of the reached cells.
fn mean_preference(window: &Window) -> f32 {
    if !window.preferred {
        return 0.0;
    }
    let (mut sum, mut cells) = (0.0, 0.0);
    for (y, &reached) in window.reached.iter().enumerate() {
        for run in Runs(reached) {
            cells += run.len() as f32;
            let start = index(run.start, y);
            let preferences = window.preference.get(start..start + run.len());
            let epsilons = preferences.unwrap_or_default().iter();
            sum += epsilons.map(|p| 2.0 * p.half()).sum::<f32>();
        }
    }
    sum / cells
}
