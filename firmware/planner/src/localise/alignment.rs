//! Alignment of a scan with the map, by Gauss–Newton.
//!
//! ```text
//! minimise  Σ w(r) r² + v d²,    r = n · (wall − end(p)),  d² = (p − p₀)ᵀ P⁻¹ (p − p₀)
//! (H + v P⁻¹) δ = b + v P⁻¹ (p₀ − p),    H = Σ w J Jᵀ,  J = (n, n × (end − p))
//! w = 1 / (1 + (r / robust_cells)²),     v = 1 / (1 + d² / slip_gap)
//! ```
//!
//! The last term is odometry: it is all that holds a direction that no beam observes. Its weight v
//! falls where the beams agree on a pose far from it, because wheels slip. An unobserved direction
//! is taken out of H and b, because the little that is there is the map's own grain:
//!
//! ```text
//! S = H over (x, y) with the yaw eliminated;  v = eigenvector of the least eigenvalue λ of S
//! λ < least_information  ⇒  H, b without v
//! ```
//!
//! A beam that ends in free space with no obstacle around it contradicts the map, a beam near an
//! obstacle agrees with it, and one in unknown space says nothing.
//!
//! Units: map cells, radians.

use crate::config::LocaliseTuning;
use crate::geometry::{CELL_M, Cell, Point};
use crate::localise::symmetric::{Eigen, Symmetric};
use crate::localise::wall::{INNER, wall};
use crate::map::{Class, Tiles};
use crate::math;

/// The scan's constraints on a pose.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Constraints {
    /// Information.
    pub(super) h: Symmetric,
    /// The gradient: the step that the beams ask for, times their information.
    pub(super) b: [f32; 3],
    /// Beams that ended near an obstacle.
    pub(super) agreeing: u16,
    /// Those of them within a cell of one.
    pub(super) close: u16,
    /// Beams that ended in free space.
    pub(super) contradicting: u16,
    /// What the scan does not observe.
    pub(super) unobserved: Unobserved,
}

/// What a scan does not observe of the position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Unobserved {
    /// All of it.
    #[default]
    Everything,
    /// The direction of this unit vector.
    Direction([f32; 2]),
    /// Nothing: both directions are observed.
    Nothing,
}

/// Returns the constraints of a scan at a pose.
pub(super) fn constraints<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &[Point],
    [x, y, yaw]: [f32; 3],
    tuning: &LocaliseTuning,
) -> Constraints {
    let (sin, cos) = math::sin_cos(yaw);
    let (sin, cos) = (sin / CELL_M, cos / CELL_M);
    let scale = 1.0 / (tuning.robust_cells * tuning.robust_cells);
    let mut sum = Constraints::default();
    for point in points {
        let arm = (
            cos * point.x_m - sin * point.y_m,
            sin * point.x_m + cos * point.y_m,
        );
        let end = (x + arm.0, y + arm.1);
        let cell = Cell {
            x: math::floor(end.0),
            y: math::floor(end.1),
        };
        let square = tiles.obstacles_around(cell);
        if square == 0 {
            sum.contradicting += u16::from(tiles.class(cell) == Class::Free);
            continue;
        }
        sum.agreeing += 1;
        sum.close += u16::from(square & INNER != 0);
        let Some(wall) = wall(square) else {
            continue;
        };
        let gap = (
            wall.place.0 + cell.x as f32 + 0.5 - end.0,
            wall.place.1 + cell.y as f32 + 0.5 - end.1,
        );
        let mut add = |n: (f32, f32)| {
            let r = n.0 * gap.0 + n.1 * gap.1;
            let weight = tuning.beam_information / (1.0 + r * r * scale);
            let row = [n.0, n.1, n.1 * arm.0 - n.0 * arm.1];
            sum.h.add_outer(weight, row);
            for (b, j) in sum.b.iter_mut().zip(row) {
                *b += weight * r * j;
            }
        };
        match wall.normal {
            Some(normal) => add(normal),
            None => {
                add((1.0, 0.0));
                add((0.0, 1.0));
            }
        }
    }
    sum.without_unobserved(tuning.least_information)
}

impl Constraints {
    /// Removes the directions with too little information.
    fn without_unobserved(mut self, least: f32) -> Self {
        let h = &self.h;
        let part = if h.tt > 0.0 { 1.0 / h.tt } else { 0.0 };
        let eigen = Eigen::of([
            h.xx - h.xt * h.xt * part,
            h.xy - h.xt * h.yt * part,
            h.yy - h.yt * h.yt * part,
        ]);
        if eigen.greatest() < least {
            self.h = Symmetric::default();
            self.b = [0.0; 3];
            self.unobserved = Unobserved::Everything;
            return self;
        }
        if eigen.least() >= least {
            self.unobserved = Unobserved::Nothing;
            return self;
        }
        let direction = eigen.least_direction();
        self.remove(direction);
        self.unobserved = Unobserved::Direction(direction);
        self
    }

    /// Removes a direction: `H ← M H M`, `b ← M b` with `M = I − v vᵀ`.
    fn remove(&mut self, [x, y]: [f32; 2]) {
        // The direction across is what is left.
        let (u, w) = (-y, x);
        let h = &self.h;
        let across = u * u * h.xx + 2.0 * u * w * h.xy + w * w * h.yy;
        let turn = u * h.xt + w * h.yt;
        let push = u * self.b[0] + w * self.b[1];
        self.h = Symmetric {
            xx: across * u * u,
            xy: across * u * w,
            yy: across * w * w,
            xt: turn * u,
            yt: turn * w,
            tt: h.tt,
        };
        self.b = [push * u, push * w, self.b[2]];
    }

    /// Returns true if the scan agrees with the map so well that a lost robot is found: it observes
    /// both directions, and most of its `beams` end on obstacles.
    pub(super) fn is_agreed(&self, beams: usize, tuning: &LocaliseTuning) -> bool {
        self.unobserved == Unobserved::Nothing
            && f32::from(self.close) >= tuning.agreed_share * beams as f32
            && f32::from(self.close) >= tuning.least_counted
    }

    /// Returns true if the scan contradicts the map.
    pub(super) fn is_contradicted(&self, tuning: &LocaliseTuning) -> bool {
        let counted = f32::from(self.agreeing + self.contradicting);
        f32::from(self.contradicting) > tuning.contradicted_share * counted
            && counted >= tuning.least_counted
    }
}

/// The pose after alignment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aligned {
    /// x, y and yaw.
    pub(super) pose: [f32; 3],
    /// The information about it: odometry's and the scan's.
    pub(super) information: Symmetric,
    /// The constraints at the pose.
    pub(super) constraints: Constraints,
}

/// Aligns a scan with the map. `prior` is odometry's pose, with its information.
pub(super) fn align<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &[Point],
    (prior, information): ([f32; 3], &Symmetric),
    start: [f32; 3],
    tuning: &LocaliseTuning,
) -> Aligned {
    let mut pose = start;
    let mut trust = 1.0;
    for _ in 0..tuning.iterations {
        let found = constraints(tiles, points, pose, tuning);
        let from_prior = [
            prior[0] - pose[0],
            prior[1] - pose[1],
            math::wrap(prior[2] - pose[2]),
        ];
        let pull = information.times(from_prior);
        let gap = pull[0] * from_prior[0] + pull[1] * from_prior[1] + pull[2] * from_prior[2];
        trust = 1.0 / (1.0 + gap / tuning.slip_gap);
        let [bx, by, bt] = found.b;
        let [px, py, pt] = pull.map(|pull| trust * pull);
        let b = [bx + px, by + py, bt + pt];
        let Some([dx, dy, turn]) = (found.h + information.scaled(trust)).solve(b) else {
            break;
        };
        pose = [pose[0] + dx, pose[1] + dy, math::wrap(pose[2] + turn)];
        if dx * dx + dy * dy < SMALL_CELLS * SMALL_CELLS && turn.abs() < SMALL_RAD {
            break;
        }
    }
    let constraints = constraints(tiles, points, pose, tuning);
    Aligned {
        pose,
        information: constraints.h + information.scaled(trust),
        constraints,
    }
}

/// A shorter step ends the iterations, cells.
const SMALL_CELLS: f32 = 0.01;
/// A smaller turn ends the iterations, radians.
const SMALL_RAD: f32 = 2e-4;
