//! Alignment of a scan with the map, by Gauss–Newton.
//!
//! ```text
//! minimise  Σ w(r) r² + v d²,    r = 1 − m(end(p)),  d² = (p − p₀)ᵀ P⁻¹ (p − p₀)
//! (H + v P⁻¹) δ = b + v P⁻¹ (p₀ − p),    H = Σ w J Jᵀ,  b = Σ w r J
//! J = (g, g × (end − p)),    g = ∇m on an edge, n (n · ∇m) on a surface with the normal n
//! w = 1 / (1 + (r / robust_cells)²),     v = 1 / (1 + d² / slip_gap)
//! ```
//!
//! m is the map as a field, and the first sum is that of \[Kohlbrecher11\]. The normal is
//! ours: the cells of a wall that few beams have met are points, and would hold the scan along the
//! wall as well.
//!
//! A scan enters the map with the error of its pose, and the next one is matched with it. So the
//! errors of beams do not average out, and a beam's information is less than the width of its cell
//! says. With less still, the map drifts less in simulated buildings and more in recorded ones
//! (measured: docs/MEASURED.md, "Information of a beam").
//!
//! The last term is odometry: it is all that holds a direction that no beam observes. Its weight v
//! falls where the beams agree on a pose far from it, because wheels slip. An unobserved direction
//! is taken out of H and b, because the little that is there is the map's own grain:
//!
//! ```text
//! S = H over (x, y) with the yaw eliminated;  e = eigenvector of the least eigenvalue λ of S
//! λ < least_information  ⇒  H, b without e
//! ```
//!
//! Units: map cells, radians.

use crate::config::LocaliseTuning;
use crate::geometry::{CELL_M, Cell};
use crate::localise::occupancy::occupancy;
use crate::localise::scan_points::ScanPoint;
use crate::localise::symmetric::{Eigen, Symmetric};
use crate::map::neighbourhood::{INNER, Neighbourhood};
use crate::map::{Class, Tiles};
use crate::math;

/// The scan's constraints on a pose.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Constraints {
    /// Information.
    pub(super) h: Symmetric,
    /// The gradient: the step that the beams ask for, times their information.
    pub(super) b: [f32; 3],
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

/// Beams whose end the map knows.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    /// Those that ended within two cells of an obstacle.
    agreeing: u16,
    /// Those that ended in free space without an obstacle within two cells. In unknown space a beam
    /// says nothing.
    contradicting: u16,
}

impl Tally {
    /// Returns true if more than this share of at least `least` beams contradicts the map.
    fn contradicts(&self, share: f32, least: f32) -> bool {
        let counted = f32::from(self.agreeing + self.contradicting);
        f32::from(self.contradicting) > share * counted && counted >= least
    }
}

/// How far a scan agrees with the map.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Agreement {
    /// All beams. Those that end on people contradict the map too.
    all: Tally,
    /// Beams that end on a surface. A person has none: nothing of it is flat for the 0.4 m which a
    /// normal takes.
    surfaces: Tally,
    /// Number of beams that end on a surface, wherever.
    beams: u16,
    /// Those of them that ended within a cell of an obstacle.
    close: u16,
    /// Beams that ended within a cell of an obstacle, on a surface or not.
    near: u16,
}

/// A pose in cells and radians, as a motion of points in metres.
pub(super) struct Frame {
    place: (f32, f32),
    sin: f32,
    cos: f32,
}

impl Frame {
    pub(super) fn of([x, y, yaw]: [f32; 3]) -> Self {
        let (sin, cos) = math::sin_cos(yaw);
        Self {
            place: (x, y),
            sin,
            cos,
        }
    }

    pub(super) fn turn(&self, (x, y): (f32, f32)) -> (f32, f32) {
        (self.cos * x - self.sin * y, self.sin * x + self.cos * y)
    }

    /// Returns the arm from the robot to the point's end, and the end.
    pub(super) fn reach(&self, point: &ScanPoint) -> ((f32, f32), (f32, f32)) {
        let (x, y) = self.turn((point.end.x_m, point.end.y_m));
        let arm = (x / CELL_M, y / CELL_M);
        (arm, (self.place.0 + arm.0, self.place.1 + arm.1))
    }
}

/// Returns the weight of a beam with the residual r.
#[inline(always)]
pub(super) fn weight(r: f32, tuning: &LocaliseTuning) -> f32 {
    let scale = 1.0 / (tuning.robust_cells * tuning.robust_cells);
    tuning.beam_information / (1.0 + r * r * scale)
}

/// Returns the constraints of a scan at a pose.
pub(super) fn constraints<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &[ScanPoint],
    pose: [f32; 3],
    tuning: &LocaliseTuning,
) -> Constraints {
    let frame = Frame::of(pose);
    let mut near = Neighbourhood::of(tiles);
    let mut sum = Constraints::default();
    for point in points {
        let (arm, end) = frame.reach(point);
        let Some(found) = occupancy(&mut near, end) else {
            continue;
        };
        let (gx, gy) = match point.normal {
            None => found.gradient,
            Some(normal) => {
                let (x, y) = frame.turn(normal);
                let slope = x * found.gradient.0 + y * found.gradient.1;
                (slope * x, slope * y)
            }
        };
        let r = 1.0 - found.value;
        let weight = weight(r, tuning);
        let row = [gx, gy, gy * arm.0 - gx * arm.1];
        sum.h.add_outer(weight, row);
        for (b, j) in sum.b.iter_mut().zip(row) {
            *b += weight * r * j;
        }
    }
    sum.without_unobserved(tuning.least_information)
}

impl Agreement {
    /// Returns how far a scan agrees with the map at a pose.
    fn of<const TILES: usize, const SLOTS: usize>(
        tiles: &Tiles<TILES, SLOTS>,
        points: &[ScanPoint],
        pose: [f32; 3],
    ) -> Self {
        let frame = Frame::of(pose);
        let mut near = Neighbourhood::of(tiles);
        let mut sum = Self::default();
        for point in points {
            let (_, (x, y)) = frame.reach(point);
            let cell = Cell {
                x: math::floor(x),
                y: math::floor(y),
            };
            let square = near.obstacles_from::<5>(cell.offset(-2, -2));
            let agrees = u16::from(square != 0);
            let contradicts = u16::from(square == 0 && tiles.class(cell) == Class::Free);
            sum.near += u16::from(square & INNER != 0);
            sum.all.agreeing += agrees;
            sum.all.contradicting += contradicts;
            if point.normal.is_some() {
                sum.surfaces.agreeing += agrees;
                sum.surfaces.contradicting += contradicts;
                sum.beams += 1;
                sum.close += u16::from(square & INNER != 0);
            }
        }
        sum
    }

    /// Returns true if the scan contradicts the map. One that `doubts` already is held to half of
    /// the shares: a wrong place near by agrees better than the one before.
    pub(super) fn is_contradicted(&self, doubts: bool, tuning: &LocaliseTuning) -> bool {
        let part = if doubts { 0.5 } else { 1.0 };
        let least = tuning.least_counted;
        let surfaces = part * tuning.contradicted_surfaces;
        let beams = part * tuning.contradicted_share;
        self.surfaces.contradicts(surfaces, least) || self.all.contradicts(beams, least)
    }

    /// Returns true if the scan refutes the place: half of the surfaces contradict the map, or so
    /// many beams as no crowd around the robot stops.
    pub(super) fn is_refuted(&self, tuning: &LocaliseTuning) -> bool {
        let least = tuning.least_counted;
        self.surfaces.contradicts(0.5, least) || self.all.contradicts(0.75, least)
    }

    /// Returns the number of beams that ended within a cell of an obstacle, and of those that ended
    /// on ground that the map knows.
    pub(super) const fn counts(&self) -> (u16, u16) {
        (self.near, self.all.agreeing + self.all.contradicting)
    }

    /// Returns by what share of the surfaces more agree here than elsewhere.
    pub(super) fn excess(&self, elsewhere: &Self) -> f32 {
        let more = f32::from(self.close) - f32::from(elsewhere.close);
        more / f32::from(self.beams.max(1))
    }

    /// Returns true if the scan agrees with the map here and much better than elsewhere.
    pub(super) fn is_better_than(&self, elsewhere: &Self, tuning: &LocaliseTuning) -> bool {
        !self.is_contradicted(false, tuning) && self.excess(elsewhere) >= tuning.better_share
    }
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

    /// Removes a direction: `H ← M H M`, `b ← M b` with `M = I − e eᵀ`.
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
}

/// The pose after alignment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aligned {
    /// x, y and yaw.
    pub(super) pose: [f32; 3],
    /// The information about it: odometry's and the scan's.
    pub(super) information: Symmetric,
    /// What the scan does not observe at the pose.
    pub(super) unobserved: Unobserved,
    /// How far the scan agrees with the map there.
    pub(super) agreement: Agreement,
}

impl Aligned {
    /// Returns true if the scan agrees with the map so well that a lost robot is found: it observes
    /// both directions, and most beams end on obstacles.
    pub(super) fn is_agreed(&self, tuning: &LocaliseTuning) -> bool {
        let close = f32::from(self.agreement.close);
        self.unobserved == Unobserved::Nothing
            && close >= tuning.agreed_share * f32::from(self.agreement.beams)
            && close >= tuning.least_counted
    }
}

/// Aligns a scan with the map. `prior` is odometry's pose, with its information.
pub(super) fn align<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &[ScanPoint],
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
        unobserved: constraints.unobserved,
        agreement: Agreement::of(tiles, points, pose),
    }
}

/// A shorter step ends the iterations, cells.
const SMALL_CELLS: f32 = 0.01;
/// A smaller turn ends the iterations, radians.
const SMALL_RAD: f32 = 2e-4;
