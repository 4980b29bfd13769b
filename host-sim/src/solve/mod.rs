//! `host-sim solve`: one window from a text file, solved by the planner's own field module.
//!
//! The drawn window lies in the lower left of the planner's 61 × 61 cells; all other cells are
//! obstacles. Headings are in radians, x right, y up; q = 1 − p, scaled so that a goal is 1.

pub mod sheet;

use core::fmt::Write as _;

use clap::ValueEnum;
use fieldline_planner::field::{
    GOAL, Method, Preference, SCRATCH_FLOATS, SIDE, SWEEPS_PER_CYCLE, SolverConfig, Stop, Window,
    descent, preference, solve,
};
use serde::Serialize;

use sheet::{Sheet, SheetCell};

/// Relative change of a sweep that is only rounding: half a unit in the last place of an f32.
const ROUNDING: f32 = 6e-8;
/// Number of blocks of sweeps without a smaller change after which the solver stops: under
/// preferences, rounding can repeat in a cycle.
const MOST_IDLE: u32 = 40;
/// Greatest number of Gauss–Seidel sweeps: three times as many as the slowest window of the tests
/// needs.
const MOST_SWEEPS: u32 = 60_000;

/// The requested solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Solver {
    /// Multigrid; Gauss-Seidel under strong preferences
    Multigrid,
    /// Gauss-Seidel from q = 0
    GaussSeidel,
}

/// The answer, in the order of the JSON line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// `multigrid` or `gauss-seidel`: the requested solver.
    pub solver: &'static str,
    /// The method that finished: under strong preferences multigrid hands over to Gauss–Seidel.
    pub method: &'static str,
    /// Columns of the drawn window.
    pub width: usize,
    /// Rows of the drawn window.
    pub height: usize,
    /// Multigrid cycles; `null` if there were none.
    pub cycles: Option<u32>,
    /// Gauss–Seidel sweeps, beyond the one in each cycle; `null` if there were none.
    pub sweeps: Option<u32>,
    /// `converged`, `budget` or `flat`.
    pub stop: &'static str,
    /// Last value of the stop rule: a cycle's greatest factor less one, or a sweep's greatest
    /// relative change.
    pub residual: f32,
    /// Heading of −∇p at the robot; `null` without a robot or if the field is flat there.
    pub heading_rad: Option<f32>,
    /// Mean `|p_r − p|` around the robot; `null` without a robot.
    pub p_diff: Option<f32>,
    /// True if no goal has any effect on the field (at the robot, if there is one), so there is no
    /// gradient to follow.
    pub flat: bool,
}

/// A solved window and the answer about it.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The answer.
    pub answer: Answer,
    /// q of every drawn cell, rows from the least y, goal = 1.
    pub q: Vec<Vec<f64>>,
}

/// Solves a drawn window, with optional preferences in rows from the least y.
#[must_use]
pub fn run(sheet: &Sheet, epsilon: Option<&[Vec<f32>]>, solver: Solver) -> Solved {
    let mut window = Box::new(Window::new());
    let (free, goal) = boundary(sheet);
    window.set_boundary(&free, &goal);
    if let Some(rows) = epsilon {
        window.set_preferences(|x, y| {
            let cell = rows.get(y).and_then(|row| row.get(x));
            Preference::nearest(cell.copied().unwrap_or(0.0))
        });
    }
    let solution = converge(&mut window, solver);
    let heading = sheet
        .robot
        .and_then(|(x, y)| descent::heading(&window, x, y));
    // There is no way to a goal, or it is so far or so much repelled that its effect rounds to 0.
    let flat_at = |(x, y)| window.q(x, y) == 0.0;
    let answer = Answer {
        solver: solver.name(),
        method: match solution.method {
            Method::GaussSeidel => "gauss-seidel",
            Method::Auto | Method::Multigrid => "multigrid",
        },
        width: sheet.width(),
        height: sheet.height(),
        cycles: spent(solution.cycles),
        sweeps: spent(solution.sweeps),
        stop: match solution.stop {
            Stop::Converged => "converged",
            Stop::Budget => "budget",
            Stop::Flat => "flat",
        },
        residual: solution.residual,
        heading_rad: heading,
        p_diff: sheet.robot.map(|(x, y)| preference::p_diff(&window, x, y)),
        flat: solution.stop == Stop::Flat || sheet.robot.is_some_and(flat_at),
    };
    let q = |y: usize| {
        let scaled = |x| f64::from(window.q(x, y)) / f64::from(GOAL);
        (0..sheet.width()).map(scaled).collect()
    };
    Solved {
        answer,
        q: (0..sheet.height()).map(q).collect(),
    }
}

impl Solver {
    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Multigrid => "multigrid",
            Self::GaussSeidel => "gauss-seidel",
        }
    }
}

/// Work and result of [`converge`].
struct Effort {
    cycles: u32,
    sweeps: u32,
    stop: Stop,
    residual: f32,
    method: Method,
}

/// Solves until the field is right to about four digits, far more than a heading needs.
///
/// The stop rule of Gauss–Seidel tests the change of a sweep, which in a slow window is far below
/// the error. So this function continues until the change is only rounding.
fn converge(window: &mut Window, solver: Solver) -> Effort {
    let mut config = SolverConfig {
        max_cycles: MOST_SWEEPS.min(u16::MAX.into()) as u16 / SWEEPS_PER_CYCLE,
        tolerance: 1e-5,
        method: match solver {
            Solver::Multigrid => Method::Auto,
            Solver::GaussSeidel => Method::GaussSeidel,
        },
    };
    let mut scratch = Box::new([0.0; SCRATCH_FLOATS]);
    let first = solve(window, &mut scratch, &config);
    let mut effort = Effort {
        cycles: first.cycles.into(),
        sweeps: first.sweeps.into(),
        stop: first.stop,
        residual: first.residual,
        method: first.method,
    };
    (config.method, config.max_cycles) = (Method::GaussSeidel, 1);
    let (mut best, mut idle) = (effort.residual, 0);
    while effort.method == Method::GaussSeidel
        && effort.stop == Stop::Converged
        && effort.residual > ROUNDING
        && effort.sweeps < MOST_SWEEPS
        && idle < MOST_IDLE
    {
        let more = solve(window, &mut scratch, &config);
        effort.sweeps += u32::from(more.sweeps);
        effort.residual = more.residual;
        idle = if more.residual < best { 0 } else { idle + 1 };
        best = best.min(more.residual);
    }
    effort
}

fn spent(count: u32) -> Option<u32> {
    (count > 0).then_some(count)
}

fn boundary(sheet: &Sheet) -> ([u64; SIDE], [u64; SIDE]) {
    let row_bits = |row: &[SheetCell], kind: SheetCell| {
        let bit = |(x, cell): (usize, &SheetCell)| u64::from(*cell == kind) << x;
        row.iter().enumerate().map(bit).sum()
    };
    let bits = |kind: SheetCell| {
        core::array::from_fn(|y| sheet.rows.get(y).map_or(0, |row| row_bits(row, kind)))
    };
    (bits(SheetCell::Free), bits(SheetCell::Goal))
}

impl Solved {
    /// The text of FIELD.csv: the drawn window's layout, nine significant digits, so that every f32
    /// is exact.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut out = String::new();
        for row in self.q.iter().rev() {
            for (x, q) in row.iter().enumerate() {
                let comma = if x == 0 { "" } else { "," };
                // Writing into a string does not fail.
                let _ = write!(out, "{comma}{q:.8e}");
            }
            out.push('\n');
        }
        out
    }
}

impl Answer {
    /// The answer as one line of JSON, without a newline.
    #[must_use]
    pub fn to_json_line(&self) -> String {
        crate::report::json_line(self)
    }

    /// The answer as two lines of text.
    #[must_use]
    pub fn to_text(&self) -> String {
        let count = |name: &str, n: Option<u32>| n.map(|n| format!("{n} {name}"));
        let spent: Vec<String> = [count("cycles", self.cycles), count("sweeps", self.sweeps)]
            .into_iter()
            .flatten()
            .collect();
        let heading = match self.heading_rad {
            Some(rad) => format!("heading {rad:.5} rad ({:.2} deg)", rad.to_degrees()),
            None => "no heading".into(),
        };
        let p_diff = self
            .p_diff
            .map_or_else(String::new, |p| format!(", p_diff {p:.4e}"));
        let flat = if self.flat { ", flat" } else { "" };
        format!(
            "{} x {} cells, {}: {} ({}), residual {:.2e}\n{heading}{p_diff}{flat}",
            self.width,
            self.height,
            self.method,
            self.stop,
            if spent.is_empty() {
                "nothing to do".into()
            } else {
                spent.join(", ")
            },
            self.residual,
        )
    }
}

#[cfg(test)]
mod tests;
