//! Down the potential: the heading of −∇p, which is +∇q.
//!
//! ```text
//! ∂q/∂x = (q(x+1, y) − q(x−1, y)) / 2        ∂q/∂y likewise
//! ```
//!
//! Obstacles take part with their q = 0, so that the heading turns away from walls. Between cell centres the gradient
//! is interpolated bilinearly over those of the four cells around that have one.
//!
//! Units: headings in radians, counter-clockwise from x; positions in cells, cell (x, y) covering [x, x+1) × [y, y+1).

use crate::field::window::{STRIDE, Window, index};
use crate::math;

/// The heading of −∇p at the centre of cell (x, y); `None` where the field is flat: on goals, obstacles, outside, in
/// cells that no goal can be reached from, and where q has underflowed.
#[must_use]
pub fn heading(window: &Window, x: usize, y: usize) -> Option<f32> {
    angle(gradient(window, x, y)?)
}

/// The heading of −∇p at a point of a free cell, in cells; `None` as for [`heading`].
#[must_use]
pub fn heading_at(window: &Window, x: f32, y: f32) -> Option<f32> {
    let (home_x, home_y) = (math::floor(x), math::floor(y));
    cell_gradient(window, home_x, home_y)?;
    let (west, south) = (math::floor(x - 0.5), math::floor(y - 0.5));
    let (along, up) = (x - 0.5 - west as f32, y - 0.5 - south as f32);
    let mut sum = (0.0, 0.0);
    for (dx, dy, weight) in [
        (0, 0, (1.0 - along) * (1.0 - up)),
        (1, 0, along * (1.0 - up)),
        (0, 1, (1.0 - along) * up),
        (1, 1, along * up),
    ] {
        if let Some((gx, gy)) = cell_gradient(window, west + dx, south + dy) {
            sum = (sum.0 + weight * gx, sum.1 + weight * gy);
        }
    }
    angle(sum)
}

/// One step of the steepest way from cell (x, y): a goal beside it, or else the one of the four cells beside with the
/// greatest q, if that is greater than q here. From any reached cell of a solved window these steps lead to a goal.
#[must_use]
pub fn ascend(window: &Window, x: usize, y: usize) -> Option<(usize, usize)> {
    if !window.is_reached(x, y) {
        return None;
    }
    let mut best = (window.q(x, y), None);
    for (x, y) in [
        (x.wrapping_sub(1), y),
        (x + 1, y),
        (x, y.wrapping_sub(1)),
        (x, y + 1),
    ] {
        // Among goals alone q may have rounded to a goal's own value.
        if window.is_goal(x, y) {
            return Some((x, y));
        }
        if window.q(x, y) > best.0 {
            best = (window.q(x, y), Some((x, y)));
        }
    }
    best.1
}

/// Twice ∇q at the centre of a reached cell; `None` in all others.
#[must_use]
pub fn gradient(window: &Window, x: usize, y: usize) -> Option<(f32, f32)> {
    if !window.is_reached(x, y) {
        return None;
    }
    let south = index(x, y) - STRIDE;
    let q = |at| window.q.get(at).copied();
    let upright = q(south + 2 * STRIDE)? - q(south)?;
    Some((q(south + STRIDE + 1)? - q(south + STRIDE - 1)?, upright))
}

fn cell_gradient(window: &Window, x: i32, y: i32) -> Option<(f32, f32)> {
    gradient(window, usize::try_from(x).ok()?, usize::try_from(y).ok()?)
}

fn angle((x, y): (f32, f32)) -> Option<f32> {
    // Written so that a position that is no number has no heading.
    (x.abs() + y.abs() > 0.0).then(|| math::atan2(y, x))
}
