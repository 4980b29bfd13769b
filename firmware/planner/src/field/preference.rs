//! How flat the field is around the robot [Maffei20, §III]:
//!
//! ```text
//! p_diff(r) = mean of |p_r − p_n| over the cells n of the kernel around the robot's cell r
//! ```
//!
//! Conventions, on which the paper is silent. The kernel is 20 cells wide, an even number: it covers 10 columns to the
//! left of the robot's and 9 to the right, 10 rows below and 9 above. Only free cells with a way to a goal count, and
//! not the robot's own. The mean is of absolute differences: the signed mean of a harmonic field is about zero.
//!
//! In q-form `|p_r − p_n| = |q_r − q_n|`, and small values keep their precision: in a converged field it is right to
//! 1e-4 down to 1e-30; in any other it is as right as the field.

use crate::config::KERNEL_CELLS;
use crate::field::window::{GOAL, SIDE, Window};

/// `p_diff` at cell (x, y), where p runs from 0 to 1; 0 if no goal can be reached from it, or it is alone in its kernel.
#[must_use]
pub fn p_diff(window: &Window, x: usize, y: usize) -> f32 {
    if !window.is_reached(x, y) {
        return 0.0;
    }
    let q_robot = window.q(x, y);
    let half = KERNEL_CELLS / 2;
    let (mut sum, mut cells) = (0.0, 0_u16);
    for row in y.saturating_sub(half)..(y + half).min(SIDE) {
        for column in x.saturating_sub(half)..(x + half).min(SIDE) {
            if window.is_reached(column, row) && (column, row) != (x, y) {
                sum += (window.q(column, row) - q_robot).abs();
                cells += 1;
            }
        }
    }
    if cells == 0 {
        0.0
    } else {
        sum / f32::from(cells) / GOAL
    }
}
