//! Descent of the potential: the heading of −∇p, which is +∇q.
//!
//! ```text
//! ∂q/∂x = (q(x+1, y) − q(x−1, y)) / 2        ∂q/∂y likewise
//! ```
//!
//! Obstacles count with q = 0, so the heading turns away from walls. Between cell centres the
//! gradient is interpolated bilinearly over those of the four surrounding cells that have one.
//!
//! Units: headings in radians, counter-clockwise from x; positions in cells.
//! Cell (x, y) covers [x, x+1) × [y, y+1).

use crate::field::window::{STRIDE, Window, index};
use crate::math;

/// Returns the heading of −∇p at the centre of cell (x, y), radians.
///
/// `None` where the field is flat: on goals and obstacles, outside the window, in cells from which
/// no goal is reachable, and where q has underflowed.
#[must_use]
pub fn heading(window: &Window, x: usize, y: usize) -> Option<f32> {
    angle(gradient(window, x, y)?)
}

/// Returns the heading of −∇p at a point of a free cell, given in cells; `None` as in [`heading`].
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

/// Returns 2 ∇q at the centre of a reachable cell; `None` in all others.
#[must_use]
pub(crate) fn gradient(window: &Window, x: usize, y: usize) -> Option<(f32, f32)> {
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
    // The comparison is false for NaN: such a position has no heading.
    (x.abs() + y.abs() > 0.0).then(|| math::atan2(y, x))
}
