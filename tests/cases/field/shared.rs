//! Windows from pictures, and ways to solve them.

use fieldline_planner::field::{Method, SCRATCH_FLOATS, SIDE, SolverConfig, Window, solve};
use fieldline_tests::field::Rows;

/// Solves far beyond the stop rule, to the precision of f32.
pub(crate) fn converge(window: &mut Window) {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let config = SolverConfig {
        max_cycles: 100,
        tolerance: 3e-6,
        method: Method::Multigrid,
    };
    solve(window, &mut scratch, &config);
}

/// Makes sweeps of Gauss–Seidel, five for each of `fives`.
pub(crate) fn sweeps(window: &mut Window, fives: u16) {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let config = SolverConfig {
        max_cycles: fives,
        method: Method::GaussSeidel,
        ..SolverConfig::default()
    };
    solve(window, &mut scratch, &config);
}

/// Makes a window from a picture whose first line has the greatest y: `#` obstacle, `.` free, `G`
/// goal.
pub(crate) fn window(picture: &[&str]) -> Window {
    let (mut free, mut goal): (Rows, Rows) = ([0; SIDE], [0; SIDE]);
    for (y, line) in picture.iter().rev().enumerate() {
        for (x, cell) in line.chars().enumerate() {
            match cell {
                '.' => free[y] |= 1 << x,
                'G' => goal[y] |= 1 << x,
                _ => {}
            }
        }
    }
    let mut window = Window::new();
    window.set_boundary(&free, &goal);
    window
}
