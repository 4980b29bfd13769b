//! Where a particle goes after a motion, and how well a scan fits there.
//!
//! ```text
//! motion     x ~ p(x | u)                  w ∝ p(z | x)
//! matched    x ~ q(x), Gauss–Newton on     w ∝ p(z | x) p(x | u) / q(x)
//!            p(x | u) p(z | x)
//! p(z | x)   likelihood field: exp(−d² / 2σ²) of each end, d to the nearest mean hit
//! ```
//!
//! *Motion* is the proposal of the papers [Thrun05, table 4.3]. *Matched* is that of [Grisetti07],
//! with the Laplace approximation of the fit as q. Beams of one scan share their errors, so the
//! logarithm of p(z | x) is divided by a *temper*.
//!
//! [Thrun05]: S. Thrun, W. Burgard, D. Fox, "Probabilistic Robotics", 2005.
//! [Grisetti07]: G. Grisetti, C. Stachniss, W. Burgard, "Improved techniques for grid mapping with
//! Rao-Blackwellized particle filters", 2007.
//!
//! Units: metres, radians, natural logarithms.

use fieldline_slam::matrix::{Cholesky, Matrix, add_outer, diagonal, times, turned};

use super::grid::{Frame, Grid};
use super::scan::{Beam, Scan};
use crate::replay::relations::{Pose, compose};
use crate::robot::{Noise, OdometryNoise, wrap};

/// Standard deviation of a beam's end from the nearest mean hit, metres.
const SIGMA_M: f64 = 0.06;
/// Divisor of a scan's log likelihood, which no table of the papers was used to choose.
const TEMPER: f64 = 4.0;
/// Every so many beams a beam is weighed.
const WEIGHS_EVERY: usize = 3;
/// Least log likelihood of an end, and that of an end where there is no wall.
const OFF_A_WALL: f64 = -4.0;
/// Log likelihood of an end in what is unseen.
const UNSEEN: f64 = -2.0;
/// Variances of a robot that did not move, m² and rad².
const STILL: [f64; 2] = [1e-6, 1e-7];
/// Most iterations of Gauss–Newton.
const ITERATIONS: usize = 5;
/// Residual at which an end counts half, metres.
const ROBUST_M: f64 = 0.07;
/// Weight of an end without a normal in each axis.
const WITHOUT_NORMAL: f64 = 0.3;
/// Step between headings that are tried first, radians, and most steps to each side.
const HEADING_STEP: (f64, f64) = (0.015, 12.0);

/// How particles move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Proposal {
    /// By odometry alone, as in the papers.
    Motion,
    /// To where the scan fits the particle's own map.
    #[default]
    Matched,
}

impl Proposal {
    /// Returns the name on the command line and in the report.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Motion => "motion",
            Self::Matched => "matched",
        }
    }
}

/// Moves a particle by an increment of odometry. Returns the logarithm by which its weight grows.
pub(super) fn advance(
    (proposal, wheels): (Proposal, &OdometryNoise),
    (pose, grid): (&mut Pose, &Grid),
    (increment, scan): (Pose, &Scan),
    noise: &mut Noise,
) -> f64 {
    let variances = variances(wheels, increment);
    match proposal {
        Proposal::Motion => {
            let drawn = [0, 1, 2].map(|k| increment[k] + variances[k].sqrt() * noise.normal());
            *pose = moved(*pose, drawn);
            fit(grid, *pose, scan, WEIGHS_EVERY) / TEMPER
        }
        Proposal::Matched => {
            let prior = Prior::new(moved(*pose, increment), variances);
            let draw = [0; 3].map(|_| noise.normal());
            let (drawn, log_q) = prior.matched(grid, scan, draw);
            *pose = drawn;
            fit(grid, drawn, scan, WEIGHS_EVERY) / TEMPER + prior.log_density(drawn) - log_q
        }
    }
}

/// Returns the pose after a motion in its own frame, its heading within half a turn.
fn moved(pose: Pose, motion: Pose) -> Pose {
    let [x, y, yaw] = compose(pose, motion);
    [x, y, wrap(yaw)]
}

/// Returns the variances along, across and of the turn of an increment. The scale errors of a run
/// enter as if they were drawn anew each time.
fn variances(wheels: &OdometryNoise, [x, y, turn]: Pose) -> [f64; 3] {
    let (way, turn) = ((x * x + y * y).sqrt(), turn.abs());
    let scale = [wheels.distance_scale * way, wheels.turn_scale * turn];
    let along = wheels.distance_by_distance * way
        + wheels.distance_by_turn * turn
        + scale[0] * scale[0]
        + STILL[0];
    let turned =
        wheels.turn_by_turn * turn + wheels.turn_by_distance * way + scale[1] * scale[1] + STILL[1];
    [along, 0.1 * along, turned]
}

/// Returns the log likelihood of every `every`-th end, before the temper.
fn fit(grid: &Grid, pose: Pose, scan: &Scan, every: usize) -> f64 {
    let frame = Frame::of(pose);
    let ends = scan.beams.iter().step_by(every).filter(|beam| beam.hit);
    let logs = ends.map(|beam| {
        let end = frame.point(beam.end);
        match grid.nearest(end) {
            Some((_, square)) => (-0.5 * square / (SIGMA_M * SIGMA_M)).max(OFF_A_WALL),
            None if grid.is_seen(end) => OFF_A_WALL,
            None => UNSEEN,
        }
    });
    logs.sum()
}

/// The pose by odometry, with what it may err.
#[derive(Clone, Copy, Debug)]
struct Prior {
    pose: Pose,
    /// Along, across, turn.
    variances: [f64; 3],
    /// In the map's axes.
    information: Matrix,
}

impl Prior {
    fn new(pose: Pose, variances: [f64; 3]) -> Self {
        let information = diagonal(variances.map(|variance| (1.0 / variance) as f32));
        Self {
            pose,
            variances,
            information: turned(&information, -pose[2] as f32),
        }
    }

    /// Returns the three differences of a pose to this one, in the map's axes.
    fn difference(&self, pose: Pose) -> [f64; 3] {
        let [x, y, yaw] = self.pose;
        [pose[0] - x, pose[1] - y, wrap(pose[2] - yaw)]
    }

    /// Returns log p(x | u), without the constant.
    fn log_density(&self, pose: Pose) -> f64 {
        let [x, y, turn] = self.difference(pose);
        let (sin, cos) = (libm::sin(self.pose[2]), libm::cos(self.pose[2]));
        let differences = [cos * x + sin * y, cos * y - sin * x, turn];
        let logs = differences.iter().zip(self.variances);
        logs.map(|(d, v)| -0.5 * d * d / v - 0.5 * libm::log(v))
            .sum()
    }

    /// Draws a pose from the approximation of the fit, by three standard normal numbers. Returns
    /// it with its log density, without the constant.
    fn matched(&self, grid: &Grid, scan: &Scan, draw: [f64; 3]) -> (Pose, f64) {
        let (found, information) = self.fitted(grid, scan);
        // The prior's information is positive definite, and a fit only adds to it.
        let factor = Cholesky::of(&information).unwrap_or(Cholesky::UNIT);
        let [x, y, yaw] = factor.backward(&draw.map(|it| it as f32)).map(f64::from);
        let drawn = [found[0] + x, found[1] + y, wrap(found[2] + yaw)];
        let squares: f64 = draw.iter().map(|it| it * it).sum();
        (
            drawn,
            f64::from(factor.log_root_determinant()) - 0.5 * squares,
        )
    }

    /// Returns the pose where prior and scan together fit best, with their information there.
    fn fitted(&self, grid: &Grid, scan: &Scan) -> (Pose, Matrix) {
        let mut pose = self.best_heading(grid, scan);
        let mut information = self.information;
        for _ in 0..ITERATIONS {
            let mut normal = NormalEquations {
                information: self.information,
                gradient: times(
                    &self.information,
                    &self.difference(pose).map(|it| -it as f32),
                ),
            };
            normal.add(grid, pose, scan);
            information = normal.information;
            let Some(factor) = Cholesky::of(&information) else {
                break;
            };
            let [dx, dy, turn] = factor.solve(&normal.gradient).map(f64::from);
            pose = [pose[0] + dx, pose[1] + dy, wrap(pose[2] + turn)];
            if dx * dx + dy * dy < 1e-6 && turn.abs() < 2e-4 {
                break;
            }
        }
        (pose, information)
    }

    /// Returns the pose with the best of some headings. Gauss–Newton finds a wall within a cell of
    /// an end only, and far ends are farther off where odometry is poor.
    fn best_heading(&self, grid: &Grid, scan: &Scan) -> Pose {
        let reach = 2.5 * self.variances[2].sqrt();
        let (step, most) = HEADING_STEP;
        if reach < 2.0 * step {
            return self.pose;
        }
        let steps = (reach / step).ceil().min(most);
        let candidates = (0..=2 * steps as u32).map(|k| {
            let turn = (f64::from(k) - steps) * reach / steps;
            let [x, y, yaw] = self.pose;
            let pose = [x, y, wrap(yaw + turn)];
            let fit = 3.0 * fit(grid, pose, scan, 3 * WEIGHS_EVERY) / TEMPER;
            (fit - 0.5 * turn * turn / self.variances[2], pose)
        });
        let best = candidates.max_by(|(one, _), (other, _)| one.total_cmp(other));
        best.map_or(self.pose, |(_, pose)| pose)
    }
}

/// What ends pull at a pose.
struct NormalEquations {
    information: Matrix,
    gradient: [f32; 3],
}

impl NormalEquations {
    /// Adds the ends of a scan that lie near a wall.
    fn add(&mut self, grid: &Grid, pose: Pose, scan: &Scan) {
        let frame = Frame::of(pose);
        let ends = scan
            .beams
            .iter()
            .step_by(WEIGHS_EVERY)
            .filter(|beam| beam.hit);
        for beam in ends {
            let end = frame.point(beam.end);
            let Some((hit, _)) = grid.nearest(end) else {
                continue;
            };
            let gap = [hit[0] - end[0], hit[1] - end[1]];
            let arm = [end[0] - pose[0], end[1] - pose[1]];
            self.pull(&frame, beam, gap, arm);
        }
    }

    /// Adds one end: its gap to the nearest hit, and its arm from the robot.
    fn pull(&mut self, frame: &Frame, beam: &Beam, gap: [f64; 2], arm: [f64; 2]) {
        let information = 1.0 / (SIGMA_M * SIGMA_M * TEMPER);
        match beam.normal {
            Some(normal) => self.row(frame.direction(normal), information, gap, arm),
            None => {
                for axis in [[1.0, 0.0], [0.0, 1.0]] {
                    self.row(axis, WITHOUT_NORMAL * information, gap, arm);
                }
            }
        }
    }

    /// Adds a residual along a direction.
    fn row(&mut self, [nx, ny]: [f64; 2], information: f64, gap: [f64; 2], arm: [f64; 2]) {
        let residual = nx * gap[0] + ny * gap[1];
        let share = residual / ROBUST_M;
        let weight = (information / (1.0 + share * share)) as f32;
        let row = [nx, ny, ny * arm[0] - nx * arm[1]].map(|it| it as f32);
        for (gradient, along) in self.gradient.iter_mut().zip(row) {
            *gradient += weight * along * residual as f32;
        }
        add_outer(&mut self.information, &row, weight);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Source;

    /// A room of 6 × 4 m, seen from a pose in its middle: 181 beams over half a turn and more.
    fn room(at: Pose) -> Scan {
        let beams = (0..181).map(|k| {
            let bearing = f64::from(k - 90) * 0.03;
            let (sin, cos) = ((at[2] + bearing).sin(), (at[2] + bearing).cos());
            let x = if cos > 0.0 { 3.0 - at[0] } else { -3.0 - at[0] } / cos;
            let y = if sin > 0.0 { 2.0 - at[1] } else { -2.0 - at[1] } / sin;
            let range = x.min(y);
            let axis = if x < y { [1.0, 0.0] } else { [0.0, 1.0] };
            let normal = Frame::of([0.0, 0.0, -at[2]]).direction(axis);
            Beam {
                end: [range * bearing.cos(), range * bearing.sin()],
                hit: true,
                normal: Some(normal),
            }
        });
        Scan {
            origin: [0.0, 0.0],
            beams: beams.collect(),
        }
    }

    fn mapped() -> Grid {
        let mut grid = Grid::over([-5.0, -5.0, 5.0, 5.0]);
        for turn in 0..8 {
            let at = [0.0, 0.0, 0.4 * f64::from(turn)];
            grid.enter(at, &room(at));
        }
        grid
    }

    #[test]
    fn a_match_undoes_the_error_of_odometry() {
        let (grid, truth) = (mapped(), [0.3, -0.2, 0.5]);
        let scan = room(truth);
        let prior = Prior::new([0.36, -0.15, 0.54], [0.01, 0.01, 0.01]);
        let (found, _) = prior.fitted(&grid, &scan);
        let off = [0, 1, 2].map(|k| (found[k] - truth[k]).abs());
        assert!(off[0] < 0.03 && off[1] < 0.03 && off[2] < 0.015, "{off:?}");
        assert!(fit(&grid, found, &scan, 3) > fit(&grid, prior.pose, &scan, 3) + 10.0);
    }

    #[test]
    fn without_a_wall_near_by_the_prior_holds() {
        let grid = Grid::over([-5.0, -5.0, 5.0, 5.0]);
        let prior = Prior::new([0.3, -0.2, 0.5], [1e-4, 1e-5, 1e-4]);
        let (found, information) = prior.fitted(&grid, &room([0.0; 3]));
        assert_eq!(found, prior.pose);
        assert_eq!(information, prior.information);
    }

    /// A draw from a known Gaussian has weight p / q: with no scan that is 1 for every draw.
    #[test]
    fn a_draw_from_the_prior_itself_changes_no_weight() {
        let grid = Grid::over([-5.0, -5.0, 5.0, 5.0]);
        let nothing = Scan {
            origin: [0.0, 0.0],
            beams: Vec::new(),
        };
        let wheels = OdometryNoise::papers();
        let mut noise = Noise::new(4, Source::Particle);
        for _ in 0..50 {
            let mut pose = [1.0, 2.0, 0.7];
            let motion = [0.3, 0.01, 0.2];
            let how = (Proposal::Matched, &wheels);
            let log = advance(how, (&mut pose, &grid), (motion, &nothing), &mut noise);
            assert!(log.abs() < 1e-3, "{log}");
        }
    }

    #[test]
    fn motion_draws_have_the_variances_of_the_wheels() {
        let grid = Grid::over([-5.0, -5.0, 5.0, 5.0]);
        let nothing = Scan {
            origin: [0.0, 0.0],
            beams: Vec::new(),
        };
        let wheels = OdometryNoise::papers();
        let mut noise = Noise::new(4, Source::Particle);
        let (mut along, mut turn) = (0.0, 0.0);
        let count = 20_000;
        for _ in 0..count {
            let mut pose = [0.0; 3];
            let how = (Proposal::Motion, &wheels);
            advance(
                how,
                (&mut pose, &grid),
                ([0.35, 0.0, 0.1], &nothing),
                &mut noise,
            );
            along += (pose[0] - 0.35).powi(2) / f64::from(count);
            turn += (pose[2] - 0.1).powi(2) / f64::from(count);
        }
        // 20 times the usual variances for 0.35 m and 0.1 rad, and the errors of scale.
        let expected_m2 = 20.0 * (2.5e-4 * 0.35 + 1.4e-4 * 0.1) + 0.0035_f64.powi(2) + 1e-6;
        let expected_rad2 = 20.0 * (4.4e-4 * 0.1 + 1.2e-4 * 0.35) + 0.002_f64.powi(2) + 1e-7;
        assert!((along / expected_m2 - 1.0).abs() < 0.05, "{along}");
        assert!((turn / expected_rad2 - 1.0).abs() < 0.05, "{turn}");
    }
}
