//! Trials of the solver, judged against the true field.
//!
//! A heading or a cell is *right* if it is within 5° of the truth, now and at every later look. A
//! *field* is right if 99 % of its cells are right and none is a local minimum.

use core::fmt::Write as _;

use fieldline_planner::field::descent;
use fieldline_planner::field::{
    Method, SCRATCH_FLOATS, Solution, SolverConfig, Stop, Window, solve,
};
use fieldline_tests::field::truth::Truth;
use fieldline_tests::field::{ascend, cells, degrees_between};

/// Largest error of a right heading, degrees.
pub(crate) const TOLERANCE_DEG: f64 = 5.0;

/// Cycles after which the multigrid has failed.
pub(crate) const CYCLE_LIMIT: u32 = 40;

/// Sweeps after which Gauss–Seidel has failed.
pub(crate) const SWEEP_LIMIT: u32 = 2000;

/// Compares a field with the truth while it is being solved.
pub(crate) struct Judge {
    /// The true field.
    pub(crate) truth: Truth,
    robot: (usize, usize),
}

impl Judge {
    /// Solves `window` in f64.
    pub(crate) fn new(window: &Window, robot: (usize, usize)) -> Self {
        Self {
            truth: Truth::of(window),
            robot,
        }
    }

    /// Returns true if the robot's heading is right.
    pub(crate) fn heading_is_right(&self, window: &Window) -> bool {
        let (x, y) = self.robot;
        let truth = self.truth.heading(x, y);
        descent::heading(window, x, y)
            .is_some_and(|heading| degrees_between(f64::from(heading), truth) < TOLERANCE_DEG)
    }

    /// Returns true if 99 % of the cells are right and none is a local minimum.
    pub(crate) fn field_is_right(&self, window: &Window) -> bool {
        let (mut count, mut right) = (0, 0);
        for (x, y) in cells().filter(|&(x, y)| window.is_reached(x, y)) {
            if ascend(window, x, y).is_none() {
                return false;
            }
            let q = |x: usize, y: usize| f64::from(window.q(x, y));
            let (gx, gy) = (
                q(x + 1, y) - q(x.wrapping_sub(1), y),
                q(x, y + 1) - q(x, y.wrapping_sub(1)),
            );
            let (tx, ty) = self.truth.gradient(x, y);
            let within = TOLERANCE_DEG.to_radians().cos() * gx.hypot(gy) * tx.hypot(ty);
            count += 1;
            right += u32::from(gx * tx + gy * ty >= within);
        }
        100 * right >= 99 * count
    }
}

/// The cycle from which on something stayed right.
#[derive(Clone, Copy, Default)]
pub(crate) struct Since(pub(crate) Option<u32>);

impl Since {
    fn look(&mut self, right: bool, now: u32) {
        self.0 = if right { self.0.or(Some(now)) } else { None };
    }
}

/// One solve, in cycles or sweeps.
#[derive(Default)]
pub(crate) struct Trial {
    /// The robot's heading stayed right.
    pub(crate) heading: Since,
    /// The field stayed right.
    pub(crate) field: Since,
    /// The stop rule ended the solve.
    pub(crate) stop: Option<u32>,
    /// The stop rule ended it before the field was right.
    pub(crate) stopped_wrong: bool,
}

/// Solves with a budget of cycles.
pub(crate) fn work(
    window: &mut Window,
    scratch: &mut Scratch,
    method: Method,
    cycles: u16,
) -> Solution {
    let config = SolverConfig {
        max_cycles: cycles,
        method,
        ..SolverConfig::default()
    };
    solve(window, scratch, &config)
}

/// The solver's scratch memory.
pub(crate) type Scratch = [f32; SCRATCH_FLOATS];

/// Solves by multigrid, cycle by cycle.
pub(crate) fn multigrid(window: &mut Window, judge: &Judge, scratch: &mut Scratch) -> Trial {
    let mut trial = Trial::default();
    for cycle in 1..=CYCLE_LIMIT {
        let solution = work(window, scratch, Method::Multigrid, 1);
        let right = judge.field_is_right(window);
        trial.heading.look(judge.heading_is_right(window), cycle);
        trial.field.look(right, cycle);
        if solution.stop == Stop::Converged && trial.stop.is_none() {
            trial.stop = Some(cycle);
            trial.stopped_wrong = !right;
        }
    }
    trial
}

/// Solves by Gauss–Seidel, five sweeps at a time.
pub(crate) fn gauss_seidel(window: &mut Window, judge: &Judge, scratch: &mut Scratch) -> Trial {
    let mut trial = Trial::default();
    let mut sweeps = 0;
    while sweeps < SWEEP_LIMIT && trial.stop.is_none() {
        let solution = work(window, scratch, Method::GaussSeidel, 1);
        sweeps += u32::from(solution.sweeps);
        let stopped = solution.stop == Stop::Converged;
        trial.heading.look(judge.heading_is_right(window), sweeps);
        if stopped || sweeps % 20 == 0 {
            let right = judge.field_is_right(window);
            trial.field.look(right, sweeps);
            trial.stop = stopped.then_some(sweeps);
            trial.stopped_wrong = stopped && !right;
        }
    }
    trial
}

/// Median, 95th percentile and greatest of cycles; `-` for a rank that was never reached.
pub(crate) struct Ranks([Option<u32>; 3]);

impl Ranks {
    /// Ranks some numbers of cycles; `None` counts as endless.
    pub(crate) fn of(values: impl Iterator<Item = Option<u32>>) -> Self {
        let mut values: Vec<u32> = values.map(|value| value.unwrap_or(u32::MAX)).collect();
        values.sort_unstable();
        let rank = |part: usize| values[((values.len() * part).div_ceil(100)).saturating_sub(1)];
        Self([50, 95, 100].map(|part| Some(rank(part)).filter(|&value| value < u32::MAX)))
    }

    /// Returns true if no rank exceeds its limit.
    pub(crate) fn at_most(&self, limits: [u32; 3]) -> bool {
        self.0
            .iter()
            .zip(limits)
            .all(|(value, limit)| value.is_some_and(|value| value <= limit))
    }
}

impl core::fmt::Display for Ranks {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for value in self.0 {
            match value {
                Some(value) => write!(f, "{value:>5}")?,
                None => write!(f, "{:>5}", "-")?,
            }
        }
        Ok(())
    }
}

/// Trials of both methods over the same windows.
#[derive(Default)]
pub(crate) struct Row {
    /// By multigrid.
    pub(crate) multigrid: Vec<Trial>,
    /// By Gauss–Seidel.
    pub(crate) gauss_seidel: Vec<Trial>,
}

impl Row {
    /// Ranks of the heading, of the field, and of the stop rule.
    pub(crate) fn ranks(trials: &[Trial]) -> [Ranks; 3] {
        [
            Ranks::of(trials.iter().map(|trial| trial.heading.0)),
            Ranks::of(trials.iter().map(|trial| trial.field.0)),
            Ranks::of(trials.iter().map(|trial| trial.stop)),
        ]
    }

    /// Counts the trials whose heading or field never became right.
    pub(crate) fn failures(trials: &[Trial]) -> usize {
        let failed = |trial: &&Trial| trial.heading.0.is_none() || trial.field.0.is_none();
        trials.iter().filter(failed).count()
    }

    /// Writes a line of the table.
    pub(crate) fn write(&self, out: &mut String, label: &str) {
        write!(out, "{label:<20}{:>4}", self.multigrid.len()).unwrap();
        for trials in [&self.multigrid, &self.gauss_seidel] {
            let [heading, field, stop] = Self::ranks(trials);
            let wrong = trials.iter().filter(|trial| trial.stopped_wrong).count();
            let failed = Self::failures(trials);
            write!(out, " |{heading} |{field} |{stop} |{wrong:>3}{failed:>3}").unwrap();
        }
        out.push('\n');
    }
}
