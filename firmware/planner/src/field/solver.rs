//! Solving of the window: choice of the method, budget, stop rule.
//!
//! The multigrid stops when its factors show that the field is right: max |x − 1| < 0.05. The
//! residual is no measure, because a slow mode has a small residual and a large error. Gauss–Seidel
//! takes over under a strong global attraction, where the multigrid is weak, and when the factors
//! stop converging.
//!
//! The budget is in multigrid cycles, a hard bound on time: Gauss–Seidel spends
//! [`FieldTuning::sweeps_per_cycle`] sweeps per cycle. If the budget runs out, the field stays in
//! the window and the next call continues from it.

use crate::config::{FieldTuning, Method, SolverConfig};
use crate::field::gauss_seidel;
use crate::field::multigrid::{self, SCRATCH_FLOATS};
use crate::field::runs::Runs;
use crate::field::seed;
use crate::field::window::{Window, index};

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
    tuning: &FieldTuning,
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
    let strong =
        config.method == Method::Auto && mean_preference(window) > tuning.strong_attraction;
    if config.method != Method::GaussSeidel && !strong {
        run_multigrid(window, scratch, (config, tuning), &mut solution);
    } else {
        solution.method = Method::GaussSeidel;
    }
    if solution.method == Method::GaussSeidel {
        run_gauss_seidel(window, (config, tuning), &mut solution);
    }
    solution
}

fn run_multigrid(
    window: &mut Window,
    scratch: &mut [f32; SCRATCH_FLOATS],
    (config, tuning): (&SolverConfig, &FieldTuning),
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
        if config.method == Method::Auto && since >= tuning.most_idle_cycles {
            solution.method = Method::GaussSeidel;
            return;
        }
    }
}

fn run_gauss_seidel(
    window: &mut Window,
    (config, tuning): (&SolverConfig, &FieldTuning),
    solution: &mut Solution,
) {
    // Values that rose only in part are worth keeping.
    window.warm = true;
    for _ in solution.cycles..config.max_cycles {
        for _ in 1..tuning.sweeps_per_cycle {
            gauss_seidel::sweep(window);
        }
        solution.residual = gauss_seidel::measured_sweep(window);
        solution.sweeps += tuning.sweeps_per_cycle;
        if solution.residual < tuning.sweep_tolerance {
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
