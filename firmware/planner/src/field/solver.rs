//! Solve the window: which method, how long, and when to stop.
//!
//! The multigrid stops when its own factors say that the field is right, max |x − 1| < 0.05: a small residual says
//! nothing, since a slow mode has a small residual and a large error. It gives way to Gauss–Seidel where it is known
//! to be weak, under a strong global attraction, and where its factors stop converging.
//!
//! The budget is in multigrid cycles, a hard bound on time: Gauss–Seidel spends [`SWEEPS_PER_CYCLE`] sweeps for one.
//! A field that ran out of budget stays in the window, and the next call goes on from it.

use super::gauss_seidel;
use super::multigrid::{self, SCRATCH_FLOATS};
use super::runs::Runs;
use super::window::{SIDE, STRIDE, Window, index};

/// Gauss–Seidel sweeps that cost about as much as a multigrid cycle.
pub const SWEEPS_PER_CYCLE: u16 = 5;

/// Mean preference above which the multigrid is not used: q rounds to the goal's value over whole rooms there, and
/// the coarse factors see nothing but rounding.
const STRONG_ATTRACTION: f32 = 0.15;

/// Cycles without a better error after which the multigrid gives up.
const PATIENCE: u16 = 8;

/// Relative change in a block of sweeps, per sweep, below which Gauss–Seidel has converged.
const SWEEP_TOLERANCE: f32 = 1e-5;

/// What a blank cell takes of its best neighbour's value: about the field's fall from cell to cell indoors, so that a
/// cold start begins with the right shape. 1 would do, with a third more cycles behind doors.
const FILL: f32 = 0.85;

/// How to solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Multigrid where it works, Gauss–Seidel where it does not.
    #[default]
    Auto,
    /// Multigrid, come what may.
    Multigrid,
    /// Gauss–Seidel from q = 0.
    GaussSeidel,
}

/// Parameters of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverConfig {
    /// Most multigrid cycles, or a fifth of the sweeps. Default: 12.
    pub max_cycles: u16,
    /// max |x − 1| below which the multigrid stops. Default: 0.05.
    pub tolerance: f32,
    /// How to solve. Default: [`Method::Auto`].
    pub method: Method,
}

impl Default for SolverConfig {
    fn default() -> Self {
        Self {
            max_cycles: 12,
            tolerance: 0.05,
            method: Method::Auto,
        }
    }
}

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
    fill_blanks(window);
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
    window.blank = [0; SIDE];
    let sweeps = (config.max_cycles - solution.cycles).saturating_mul(SWEEPS_PER_CYCLE);
    while solution.sweeps < sweeps {
        gauss_seidel::sweep(window);
        solution.sweeps += 1;
        // Measuring costs about a sweep: do it now and then.
        if solution.sweeps % SWEEPS_PER_CYCLE == 0 {
            solution.residual = gauss_seidel::residual(window);
            if solution.residual < SWEEP_TOLERANCE {
                solution.stop = Stop::Converged;
                return;
            }
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
            let preferences = &window.preference[index(run.start, y)..][..run.len()];
            sum += preferences.iter().map(|p| 2.0 * p.half()).sum::<f32>();
        }
    }
    sum / cells
}

/// Give each blank cell a part of its best neighbour's value, which the multigrid could never raise from zero: sweeps
/// up and down the window until all have one. Cold, this makes about 0.85 to the power of the distance.
fn fill_blanks(window: &mut Window) {
    for upward in [true, false].into_iter().cycle() {
        let (mut missing, mut changed) = (false, false);
        for step in 0..SIDE {
            let y = if upward { step } else { SIDE - 1 - step };
            for run in Runs(window.blank[y]) {
                let around = &mut window.q[index(run.start, y) - STRIDE..];
                for i in 0..run.len() {
                    let i = if upward { i } else { run.len() - 1 - i };
                    let upright = around[i].max(around[i + 2 * STRIDE]);
                    let level = around[i + STRIDE - 1].max(around[i + STRIDE + 1]);
                    let value = FILL * upright.max(level);
                    let q = &mut around[i + STRIDE];
                    changed |= value > *q;
                    *q = q.max(value);
                    missing |= *q == 0.0;
                }
            }
        }
        // Beside a value that has underflowed, zero it stays.
        if !missing || !changed {
            break;
        }
    }
    window.blank = [0; SIDE];
}
