//! Rays through the map, all around a cell: 64 directions, evenly spaced along the sides of a
//! square.
//!
//! ```text
//! cell k of a ray = from + k · (1, s)     |s| ≤ 1, 16 values to each side of the square
//! ```
//!
//! Units: map cells; directions in sixteenths of a cell.

use crate::geometry::Cell;

/// Rays from a cell, all around.
pub(crate) const RAYS: i32 = 64;
/// Rays through a side of the square that is twice as long as a ray: their slopes differ by
/// 2 / [`RAYS_A_SIDE`].
pub(crate) const RAYS_A_SIDE: i32 = RAYS / 4;

/// Returns a step along ray number n, sixteenths of a cell. Its longer side is a whole cell.
pub(crate) const fn ray(number: i32) -> (i32, i32) {
    let slant = number % RAYS_A_SIDE * 2 - 16;
    match number / RAYS_A_SIDE {
        0 => (16, slant),
        1 => (-slant, 16),
        2 => (-16, -slant),
        _ => (slant, -16),
    }
}

/// Returns the cell `steps` along a ray.
pub(crate) const fn along(from: Cell, ray: (i32, i32), steps: i32) -> Cell {
    Cell {
        x: (from.x * 16 + 8 + ray.0 * steps) >> 4,
        y: (from.y * 16 + 8 + ray.1 * steps) >> 4,
    }
}
