//! Solving of the window: choice of the method, budget, stop rule.
//!
//! The multigrid stops when its factors show that the field is right: max |x − 1| < 0.05. The
//! residual is no measure, because a slow mode has a small residual and a large error. Gauss–Seidel
//! takes over under a strong global attraction, where the multigrid is weak, and when the factors
//! stop converging.
//!
//! The budget is in multigrid cycles, a hard bound on time: Gauss–Seidel spends
//! [`SWEEPS_PER_CYCLE`] sweeps per cycle. If the budget runs out, the field stays in
//! the window and the next call continues from it.

use crate::config::{Method, SolverConfig};
use crate::field::gauss_seidel;
use crate::field::multigrid::{self, SCRATCH_FLOATS};
use crate::field::runs::Runs;
use crate::field::seed;
use crate::field::window::{Window, index};

/// Mean preference of the reachable cells above which Gauss–Seidel solves instead of the multigrid.
/// Under a strong attraction q is so near to the goal's value over whole rooms that the factors
/// show only rounding, and a wrong field seems right. The ablation's runs stay below half of it.
const STRONG_ATTRACTION: f32 = 0.15;
/// Gauss–Seidel sweeps for each multigrid cycle of the budget: about as many as take the same time.
pub const SWEEPS_PER_CYCLE: u16 = 5;
/// Consecutive cycles of one call without a smaller error after which the multigrid gives up. The
/// default budget of a call ends earlier.
const MOST_IDLE_CYCLES: u16 = 12;
/// Greatest relative change of a cell in the last sweep of Gauss–Seidel. Its slowest modes lose
/// less than a hundredth of their error per sweep, so the remaining error is a few thousandths at
/// most.
const SWEEP_TOLERANCE: f32 = 1e-5;

/// Reason for the end of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The stop rule holds.
    Converged,
    /// The budget ran out first; the next call continues.
    Budget,
    /// No free cell reaches a goal: there is no field.
    Flat,
}

/// Result of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Multigrid cycles spent.
    pub cycles: u16,
    /// Gauss–Seidel sweeps spent, beyond the one in each cycle.
    pub sweeps: u16,
    /// Reason for the end.
    pub stop: Stop,
    /// Last value of the stop rule: max |x − 1| of the multigrid, or the greatest relative change
    /// of a sweep.
    pub residual: f32,
    /// The method of the end: never [`Method::Auto`].
    pub method: Method,
}

/// Solves the window's field, starting from its present values.
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
        if config.method == Method::Auto && since >= MOST_IDLE_CYCLES {
            solution.method = Method::GaussSeidel;
            return;
        }
    }
}

fn run_gauss_seidel(window: &mut Window, config: &SolverConfig, solution: &mut Solution) {
    // Values that rose only in part are worth keeping.
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

/// Returns the mean ε of the reachable cells.
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
