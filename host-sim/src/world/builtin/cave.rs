//! A cave of 22 × 18 m: chambers and passages with rough walls, and islands to go around.
//!
//! Everything is a disc or a thick line whose border smooth noise moves in and out.

use super::super::canvas::{Canvas, roughness};
use super::super::occupancy::{Class, Occupancy};

/// How far the noise moves the walls in and out, metres.
const ROUGH_M: f64 = 0.45;

/// Draws it.
pub(super) fn plan() -> Occupancy {
    let mut plan = Canvas::new(22.0, 18.0, Class::Wall);
    for [x, y, radius] in [
        [4.2, 4.2, 2.9],
        [11.4, 3.8, 2.6],
        [18.0, 4.6, 2.8],
        [4.4, 12.8, 3.3],
        [11.2, 10.6, 2.8],
        [17.6, 13.2, 3.2],
        [11.0, 15.6, 1.6],
    ] {
        plan.fill(Class::Free, |px, py| near([px, py], [x, y], [x, y], radius));
    }
    for [x0, y0, x1, y1, half_width] in [
        [4.2, 4.2, 11.4, 3.8, 1.0],
        [11.4, 3.8, 18.0, 4.6, 1.1],
        [4.2, 4.2, 4.4, 12.8, 1.2],
        [4.4, 12.8, 11.2, 10.6, 1.1],
        [11.2, 10.6, 17.6, 13.2, 1.1],
        [18.0, 4.6, 17.6, 13.2, 1.2],
        [11.4, 3.8, 11.2, 10.6, 1.0],
        [11.2, 10.6, 11.0, 15.6, 1.1],
        [18.0, 4.6, 20.6, 8.6, 0.9],
    ] {
        plan.fill(Class::Free, |px, py| {
            near([px, py], [x0, y0], [x1, y1], half_width)
        });
    }
    // Islands.
    for [x, y, radius] in [
        [4.5, 13.0, 1.2],
        [17.9, 13.4, 1.0],
        [11.3, 10.4, 0.9],
        [18.3, 4.4, 0.8],
        [3.6, 5.4, 0.5],
    ] {
        plan.fill(Class::Wall, |px, py| near([px, py], [x, y], [x, y], radius));
    }
    plan.border(0.2);
    plan.finish()
}

/// Returns true if a point is within `reach` of a line, with the noise added.
fn near([px, py]: [f64; 2], [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], reach: f64) -> bool {
    let (dx, dy) = (x1 - x0, y1 - y0);
    let length2 = (dx * dx + dy * dy).max(1e-9);
    let along = (((px - x0) * dx + (py - y0) * dy) / length2).clamp(0.0, 1.0);
    let (ex, ey) = (px - x0 - along * dx, py - y0 - along * dy);
    let reach = reach + ROUGH_M * roughness(px, py);
    ex * ex + ey * ey < reach * reach
}
