//! Worlds with uneven ground: the four scenarios of \[Maffei20, fig. 4\], drawn from their
//! descriptions, and five courses.
//!
//! The ground is a function of x and y, sampled every 5 cm at the centres of the plan's cells; so a
//! sheer face is 5 cm wide. Only sums, products, comparisons, square roots and `libm` are used: the
//! same bits on every machine. Ground for driving stays within
//! [`crate::robot::Limits::WORKING`]; other ground is far beyond these limits.

pub(super) mod building;
pub(super) mod causeway;
pub(super) mod cliff;
pub(super) mod holes;
pub(super) mod kerbs;
pub(super) mod pass;
pub(super) mod slope;
pub(super) mod spiral;
pub(super) mod waves;

use super::super::canvas::{Canvas, roughness};
use super::super::elevation::Elevation;
use super::super::occupancy::{Class, Occupancy};

/// A plan and its ground.
pub(super) type Drawing = (Occupancy, Elevation);

/// Thickness of the fence around a world, metres.
const FENCE_M: f64 = 0.2;

/// A plan of this size with a fence around it, trees given by centre and radius, and blocks given
/// by their corners.
fn plan(size_m: [f64; 2], trees: &[[f64; 3]], blocks: &[[f64; 4]]) -> Canvas {
    let mut plan = Canvas::new(size_m[0], size_m[1], Class::Free);
    for [x, y, radius] in trees {
        plan.disc(Class::Wall, [*x, *y], *radius);
    }
    for corners in blocks {
        plan.block(*corners);
    }
    plan.border(FENCE_M);
    plan
}

/// Puts a plan on ground of this height.
fn raised(plan: Canvas, height_m: impl Fn(f64, f64) -> f64) -> Drawing {
    let plan = plan.finish();
    let size = [plan.width(), plan.height()];
    let ground = Elevation::from_fn(size, plan.resolution_m(), plan.origin_m(), height_m);
    (plan, ground)
}

/// Bumps of up to ± `height_m`: features of about 4 m, slopes of about `30 height_m` degrees.
fn bumps(x: f64, y: f64, height_m: f64) -> f64 {
    height_m * roughness(0.25 * x, 0.25 * y)
}

/// A ramp from 0 to 1 for t from 0 to `length`: straight, with both ends rounded over `soft`. The
/// grade between is `1 / (length − soft)`.
fn ramp(t: f64, length: f64, soft: f64) -> f64 {
    // Integral of a grade that grows to 1 over `soft`.
    let foot = |t: f64| {
        if t <= 0.0 {
            0.0
        } else if t < soft {
            0.5 * t * t / soft
        } else {
            t - 0.5 * soft
        }
    };
    (foot(t) - foot(t - (length - soft))) / (length - soft)
}

/// 1 inside of a rectangle and 0 outside.
fn within([x, y]: [f64; 2], [x0, y0, x1, y1]: [f64; 4]) -> f64 {
    f64::from(u8::from(x > x0 && x < x1 && y > y0 && y < y1))
}

#[cfg(test)]
mod tests;
