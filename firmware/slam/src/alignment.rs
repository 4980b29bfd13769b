//! The alignment of a scan with a grid: Gauss–Newton on the distances of its ends to the nearest
//! mean hits, with the pose that odometry predicts as a prior.
//!
//! ```text
//! minimise (p − p₀)ᵀ Λ (p − p₀) + Σ w(e) e²,   e = n · (m − end(p)),   w = w₀ / (1 + (e / 7 cm)²)
//! w₀ = 1 / (σ² · temper)
//! ```
//!
//! n is the normal of the surface at the end, by the scan or else by the hits around m, and m the
//! mean hit nearest to the end. An end without a normal is a corner, or a thing of its own. It
//! counts along both axes, with less weight. On a wall it must not: the hits along a wall lie where
//! earlier scans met it, and would hold the robot back. Beams share errors, so that their
//! information is divided by `temper`.
//!
//! Units: metres, radians.

use crate::grid::{Frame, Grid};
use crate::matrix::{Cholesky, Matrix, Vector, ZERO, add_outer, sum, times};
use crate::pose::{Pose, wrap};
use crate::scan::Scan;

/// Standard deviation of a hit's distance, metres.
const SIGMA_M: f32 = 0.06;
/// Beams that count as one.
const TEMPER: f32 = 2.0;
/// Information of a beam across its surface, 1/m².
pub(crate) const BEAM: f32 = 1.0 / (SIGMA_M * SIGMA_M * TEMPER);
/// Weight of an end without a normal.
const NO_NORMAL: f32 = 0.3;
/// Distance at which the weight of an end is halved, metres.
const HALVED_M: f32 = 0.07;
/// An end is near if a mean hit is nearer than that, square metres.
const NEAR2: f32 = 0.01;
/// Most iterations.
const MOST: usize = 12;
/// Iterations before the steps may be small enough.
const LEAST: usize = 4;
/// A step that ends the iteration, metres and radians.
const SMALL: (f32, f32) = (1e-3, 2e-4);
/// Ends that are enough for an alignment.
const ENDS: usize = 90;

/// The result of an alignment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alignment {
    pub(crate) pose: Pose,
    /// Information of the pose, with the prior's; in the grid's frame.
    pub(crate) information: Matrix,
    /// Information of the ends with a normal alone: what holds the pose. An end without one is
    /// near to some hit wherever along a wall it lies.
    pub(crate) held: Matrix,
    /// Share of the ends with a hit near by.
    pub(crate) share: f32,
}

/// What is known of a pose before its scan is aligned.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prior {
    pub(crate) pose: Pose,
    /// In the grid's frame.
    pub(crate) information: Matrix,
}

/// The normal equations of one iteration.
struct Equations {
    own: Matrix,
    held: Matrix,
    gradient: Vector,
    near: usize,
    ends: usize,
}

/// Aligns a scan from a start.
pub(crate) fn align<const SIDE: usize, const BEAMS: usize>(
    grid: &Grid<SIDE>,
    scan: &Scan<BEAMS>,
    start: &Pose,
    prior: &Prior,
) -> Alignment {
    let mut best = Alignment {
        pose: *start,
        information: prior.information,
        held: ZERO,
        share: 0.0,
    };
    for round in 0..MOST {
        let found = equations(grid, scan, &best.pose);
        best.held = found.held;
        best.information = sum(&prior.information, &found.own);
        best.share = found.near as f32 / found.ends.max(1) as f32;
        let off = times(&prior.information, &prior.pose.minus(&best.pose));
        let [a, b, c] = found.gradient;
        let gradient = [a + off[0], b + off[1], c + off[2]];
        let Some(factor) = Cholesky::of(&best.information) else {
            break;
        };
        let step = factor.solve(&gradient);
        let next = best.pose.plus(step);
        if !next.is_finite() {
            break;
        }
        best.pose = Pose {
            yaw_rad: wrap(next.yaw_rad),
            ..next
        };
        let [x, y, yaw] = step;
        if round >= LEAST && x * x + y * y < SMALL.0 * SMALL.0 && yaw.abs() < SMALL.1 {
            break;
        }
    }
    best
}

/// Returns the equations at a pose.
fn equations<const SIDE: usize, const BEAMS: usize>(
    grid: &Grid<SIDE>,
    scan: &Scan<BEAMS>,
    pose: &Pose,
) -> Equations {
    let mut out = Equations {
        own: ZERO,
        held: ZERO,
        gradient: [0.0; 3],
        near: 0,
        ends: 0,
    };
    let frame = Frame::of(pose);
    let stride = (scan.hits().count() / ENDS).max(1);
    for beam in scan.hits().step_by(stride) {
        out.ends += 1;
        let end = frame.point(beam.end);
        let Some((mean, distance2)) = grid.nearest(end) else {
            continue;
        };
        out.near += usize::from(distance2 < NEAR2);
        let arm = [end[0] - frame.x_m, end[1] - frame.y_m];
        let off = [mean[0] - end[0], mean[1] - end[1]];
        // Far along a wall the ends lie too far apart for a normal of their own.
        let normal = beam.normal.map(|normal| frame.turn(normal));
        match normal.or_else(|| grid.normal(mean)) {
            Some(normal) => {
                let (j, weight) = out.add(normal, BEAM, off, arm);
                add_outer(&mut out.held, &j, weight);
            }
            None => {
                for axis in [[1.0, 0.0], [0.0, 1.0]] {
                    out.add(axis, NO_NORMAL * BEAM, off, arm);
                }
            }
        }
    }
    out
}

impl Equations {
    /// Adds the distance of an end from its hit along a direction. Returns its derivative and its
    /// weight.
    fn add(&mut self, n: [f32; 2], weight: f32, off: [f32; 2], arm: [f32; 2]) -> (Vector, f32) {
        let e = n[0] * off[0] + n[1] * off[1];
        let weight = weight / (1.0 + (e / HALVED_M) * (e / HALVED_M));
        let j = [n[0], n[1], n[1] * arm[0] - n[0] * arm[1]];
        add_outer(&mut self.own, &j, weight);
        for (gradient, j) in self.gradient.iter_mut().zip(j) {
            *gradient += weight * j * e;
        }
        (j, weight)
    }
}
