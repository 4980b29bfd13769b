//! The true field of a window: its equation solved in f64, directly.
//!
//! ```text
//! 4 q = N + S + W + E + ε/2 · (|N − S| + |W − E|)        N: q of the cell to the north, and so on
//! ```
//!
//! With the signs of N − S and W − E held fixed the equation is linear. Its banded matrix is solved
//! by elimination: an M-matrix needs no pivoting and keeps the relative precision of small values.
//! Then the signs are taken again, until they stay (Howard's policy iteration). Preferences of both
//! signs can make that run in circles; Gauss–Seidel sweeps in between break them. A solution is
//! accepted only with a relative residual below 1e-12. It uses the boundary and the preferences of
//! the planner's window, and nothing of its field.

use fieldline_planner::field::{SIDE, Window};

use super::cells;

/// Largest relative residual of an accepted solution.
const RESIDUAL: f64 = 1e-12;

const WIDTH: usize = SIDE + 2;

/// The solved field: q from 0 (obstacle) to 1 (goal), with a border of zeros.
#[derive(Clone, Debug)]
pub struct Truth {
    q: Vec<f64>,
    half_preference: Vec<f64>,
    free: Vec<usize>,
}

fn at(x: usize, y: usize) -> usize {
    (y + 1) * WIDTH + x + 1
}

impl Truth {
    /// Solves for the boundary and the preferences of `window`.
    ///
    /// # Panics
    /// If the residual stays too large.
    #[must_use]
    pub fn of(window: &Window) -> Self {
        let mut truth = Self {
            q: vec![0.0; WIDTH * WIDTH],
            half_preference: vec![0.0; WIDTH * WIDTH],
            free: Vec::new(),
        };
        for (x, y) in cells() {
            truth.half_preference[at(x, y)] = f64::from(window.preference(x, y).get()) / 2.0;
            if window.is_goal(x, y) {
                truth.q[at(x, y)] = 1.0;
            } else if window.is_reached(x, y) {
                truth.free.push(at(x, y));
            }
        }
        for _ in 0..200 {
            truth.solve_frozen();
            for _ in 0..20 {
                truth.sweep();
                if truth.residual() < RESIDUAL {
                    return truth;
                }
            }
        }
        panic!("the oracle stays at a residual of {:e}", truth.residual());
    }

    /// Returns q of a cell, from 0 to 1.
    #[must_use]
    pub fn q(&self, x: usize, y: usize) -> f64 {
        self.q[at(x, y)]
    }

    /// Returns twice ∇q at a cell, by the planner's central differences.
    #[must_use]
    pub fn gradient(&self, x: usize, y: usize) -> (f64, f64) {
        let i = at(x, y);
        (
            self.q[i + 1] - self.q[i - 1],
            self.q[i + WIDTH] - self.q[i - WIDTH],
        )
    }

    /// Returns the heading of −∇p at a cell, radians.
    #[must_use]
    pub fn heading(&self, x: usize, y: usize) -> f64 {
        let (gx, gy) = self.gradient(x, y);
        gy.atan2(gx)
    }

    /// Returns `p_diff` at a cell: the mean of `|p − p_robot|` over the reachable cells of the
    /// kernel from 10 cells before to 9 cells after.
    #[must_use]
    pub fn p_diff(&self, x: usize, y: usize) -> f64 {
        let inside = |a: usize, b: usize| b + 10 >= a && b < a + 10;
        let reached = |c, r| self.free.binary_search(&at(c, r)).is_ok() && (c, r) != (x, y);
        let kernel = cells().filter(|&(c, r)| inside(x, c) && inside(y, r));
        let differences: Vec<f64> = kernel
            .filter(|&(c, r)| reached(c, r))
            .map(|(c, r)| (self.q(c, r) - self.q(x, y)).abs())
            .collect();
        differences.iter().sum::<f64>() / differences.len() as f64
    }

    /// Returns the greatest relative change that a Gauss–Seidel sweep would make first.
    fn residual(&self) -> f64 {
        let change =
            |&i: &usize| (self.relaxed(i) - self.q[i]).abs() / self.q[i].max(f64::MIN_POSITIVE);
        self.free.iter().map(change).fold(0.0, f64::max)
    }

    fn sweep(&mut self) {
        for k in 0..self.free.len() {
            let i = self.free[k];
            self.q[i] = self.relaxed(i);
        }
    }

    fn relaxed(&self, i: usize) -> f64 {
        let (n, s, w, e) = (
            self.q[i + WIDTH],
            self.q[i - WIDTH],
            self.q[i - 1],
            self.q[i + 1],
        );
        ((n + s) + (w + e) + self.half_preference[i] * ((n - s).abs() + (w - e).abs())) / 4.0
    }

    /// Solves the linear system of the present signs.
    fn solve_frozen(&mut self) {
        let mut unknown = vec![usize::MAX; self.q.len()];
        for (row, &i) in self.free.iter().enumerate() {
            unknown[i] = row;
        }
        let mut system = Banded::new(self.free.len());
        for (row, &i) in self.free.iter().enumerate() {
            system.add(row, row, 4.0);
            for (a, b) in [(i + WIDTH, i - WIDTH), (i - 1, i + 1)] {
                let tilt = if self.q[a] >= self.q[b] {
                    self.half_preference[i]
                } else {
                    -self.half_preference[i]
                };
                for (k, weight) in [(a, 1.0 + tilt), (b, 1.0 - tilt)] {
                    match unknown[k] {
                        usize::MAX => system.right[row] += weight * self.q[k],
                        column => system.add(row, column, -weight),
                    }
                }
            }
        }
        for (&i, q) in self.free.iter().zip(system.solve()) {
            self.q[i] = q;
        }
    }
}

/// A linear system whose unknowns depend only on others less than a window's row away.
struct Banded {
    unknowns: usize,
    /// Row by row, from column − [`BAND`] to column + [`BAND`].
    matrix: Vec<f64>,
    right: Vec<f64>,
}

const BAND: usize = SIDE;
const SPAN: usize = 2 * BAND + 1;

impl Banded {
    fn new(unknowns: usize) -> Self {
        Self {
            unknowns,
            matrix: vec![0.0; unknowns * SPAN],
            right: vec![0.0; unknowns],
        }
    }

    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.matrix[row * SPAN + BAND + column - row] += value;
    }

    fn solve(mut self) -> Vec<f64> {
        for pivot in 0..self.unknowns {
            let (above, below) = self.matrix.split_at_mut((pivot + 1) * SPAN);
            let pivot_row = &above[pivot * SPAN + BAND..];
            for row in pivot + 1..(pivot + BAND + 1).min(self.unknowns) {
                let target = &mut below[(row - pivot - 1) * SPAN..][BAND + pivot - row..][..=BAND];
                let factor = target[0] / pivot_row[0];
                if factor != 0.0 {
                    for (t, p) in target.iter_mut().zip(pivot_row) {
                        *t -= factor * p;
                    }
                    self.right[row] -= factor * self.right[pivot];
                }
            }
        }
        for row in (0..self.unknowns).rev() {
            let line = &self.matrix[row * SPAN + BAND..][..=BAND];
            let known = line[1..]
                .iter()
                .zip(&self.right[row + 1..])
                .map(|(a, x)| a * x)
                .sum::<f64>();
            self.right[row] = (self.right[row] - known) / line[0];
        }
        self.right
    }
}
