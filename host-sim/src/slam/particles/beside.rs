//! A particle filter beside a run: what it is told, when it takes a scan, and how it is judged.
//!
//! ```text
//! PFErr = mean over the steps of  mean over the particles of  |place − true place|
//! area  = known cells of the best map / known cells of the map at the true poses
//!         × share of the explorable ground that the run has seen
//! ```
//!
//! The filter takes a scan each 0.35 m or 0.3 rad, at its start too. Between scans its particles
//! move on by odometry.
//!
//! Units: metres, radians.

use fieldline_protocol::message::{Laser, Observation};

use super::filter::Filter;
use super::grid::Grid;
use super::report::ParticleReport;
use super::scan::Scan;
use super::spec::ParticleSpec;
use crate::replay::relations::{Pose, compose, inverse};
use crate::report::tum::Stamped;
use crate::robot::{self, Odometry, OdometryModel, OdometryNoise, Velocity, wrap};

/// Way and turn after which a scan is taken, metres and radians.
const EACH: (f64, f64) = (0.35, 0.3);
/// Margin of the maps around what the world holds, for particles that stray, metres.
const MARGIN_M: f64 = 5.0;
/// Variances of the odometry that is drawn where the run's is the truth, in multiples of the usual
/// ones: those of [`OdometryNoise::papers`].
const DRAWN: f64 = 20.0;
/// Error that the papers count as small, metres.
const SMALL_M: f64 = 1.0;

/// The filter, and the sums of what it told.
#[derive(Debug)]
pub struct Beside {
    spec: ParticleSpec,
    laser: Laser,
    filter: Filter,
    /// An odometry of its own, with the last true pose; `None` if it takes the run's.
    drawn: Option<(Odometry, Pose)>,
    /// The odometry at the last step; `None` before the first.
    last: Option<Pose>,
    /// The motion since the last scan, by odometry.
    since: Pose,
    /// The map of the same scans at the true poses.
    ideal: Grid,
    sums: Sums,
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    steps: u64,
    small: u64,
    mean_m: f64,
    best_m: f64,
    end_m: f64,
}

impl Beside {
    /// Makes a filter for a robot at a true start in a world with these bounds: least x, least y,
    /// greatest x, greatest y, metres.
    ///
    /// `run` is the odometry of the run. The filter assumes its noise; that of an odometry of its
    /// own, if it draws one.
    #[must_use]
    pub fn new(
        spec: ParticleSpec,
        laser: &Laser,
        (start, [x0, y0, x1, y1]): (robot::Pose, [f64; 4]),
        run: Option<OdometryNoise>,
        seed: u64,
    ) -> Self {
        let own = match (spec.noise, run) {
            (None, Some(_)) => None,
            (factor, _) => Some(OdometryNoise::default().times(factor.unwrap_or(DRAWN))),
        };
        let assumed = own.or(run).unwrap_or_default();
        let place = [start.x_m, start.y_m, start.yaw_rad];
        let bounds_m = [x0 - MARGIN_M, y0 - MARGIN_M, x1 + MARGIN_M, y1 + MARGIN_M];
        let odometry = |noise| Odometry::new(OdometryModel::Noisy(noise), start, seed);
        Self {
            spec,
            laser: *laser,
            filter: Filter::new(
                (spec.count, spec.proposal),
                assumed,
                (place, bounds_m),
                seed,
            ),
            drawn: own.map(|noise| (odometry(noise), place)),
            last: None,
            since: [0.0; 3],
            ideal: Grid::over(bounds_m),
            sums: Sums::default(),
        }
    }

    /// Takes a step of the run: its observation, and where the robot truly was.
    pub fn observe(&mut self, observation: &Observation, truth: &Stamped) {
        let place = [truth.x_m, truth.y_m, truth.yaw_rad];
        let odometry = self.odometry(observation, place);
        if let Some(last) = self.last.replace(odometry) {
            self.since = compose(self.since, between(last, odometry));
            if is_far(self.since) {
                self.take(observation, place);
            }
        } else {
            self.take(observation, place);
        }
        self.judge([truth.x_m, truth.y_m]);
    }

    /// Returns the pose by the odometry that the filter is told.
    fn odometry(&mut self, observation: &Observation, truth: Pose) -> Pose {
        let Some((drawn, before)) = &mut self.drawn else {
            let pose = &observation.pose;
            return [pose.x, pose.y, pose.yaw].map(|it| it.to_num());
        };
        let [x, y, turn] = between(*before, truth);
        *before = truth;
        // A circle's arc is longer than its chord.
        let half = 0.5 * turn;
        let chord = x * libm::cos(half) + y * libm::sin(half);
        let arc = if half.abs() < 1e-6 {
            chord
        } else {
            chord * half / libm::sin(half)
        };
        drawn.advance(&robot::Pose::default(), arc, turn, Velocity::default());
        let pose = drawn.pose();
        [pose.x_m, pose.y_m, pose.yaw_rad]
    }

    /// Lets the filter take the level scan of an observation. An observation without one leaves
    /// the motion to the next.
    fn take(&mut self, observation: &Observation, truth: Pose) {
        let Some(level) = observation.scans.first() else {
            return;
        };
        let scan = Scan::of(&self.laser, &level.ranges_mm);
        self.filter.update(self.since, &scan);
        self.since = [0.0; 3];
        self.ideal.enter(truth, &scan);
    }

    fn judge(&mut self, truth: [f64; 2]) {
        let distances = self.filter.distances(self.since, truth);
        let sums = &mut self.sums;
        sums.steps += 1;
        sums.small += u64::from(distances.mean_m < SMALL_M);
        sums.mean_m += distances.mean_m;
        sums.best_m += distances.best_m;
        sums.end_m = distances.mean_m;
    }

    /// Returns what the particles told. `seen` is the share of the explorable ground that the run
    /// has seen.
    #[must_use]
    pub fn report(&self, seen: f64) -> ParticleReport {
        let sums = &self.sums;
        let steps = sums.steps.max(1) as f64;
        let (updates, resampled) = self.filter.counts();
        let known = self.filter.best_grid().known() as f64 / self.ideal.known().max(1) as f64;
        ParticleReport {
            filter: self.spec.to_string(),
            pf_error_m: sums.mean_m / steps,
            best_error_m: sums.best_m / steps,
            end_error_m: sums.end_m,
            below_1m: sums.small as f64 / steps,
            area_percent: 100.0 * known * seen,
            updates,
            resampled,
            maps_mb: self.filter.bytes() as f64 * 1e-6,
        }
    }
}

/// Returns true if a scan is due after this motion.
pub(super) fn is_far([x, y, turn]: Pose) -> bool {
    x * x + y * y >= EACH.0 * EACH.0 || turn.abs() >= EACH.1
}

/// Returns the motion from one pose to another, with a turn of at most half a circle.
pub(super) fn between(from: Pose, to: Pose) -> Pose {
    let [x, y, turn] = compose(inverse(from), to);
    [x, y, wrap(turn)]
}
