//! Coverage during a run: what the robot truly saw.
//!
//! With true odometry that is the host's copy of the device's map. If the odometry drifts, a second
//! map takes the same scans at the true poses, and coverage is judged by it: a map that folds over
//! itself gains nothing.

use fieldline_planner::geometry::Cell;
use fieldline_protocol::message::{Command, Observation, Start};

use super::mirror::Mirror;
use super::relief::Relief;
use super::snapshot::Window;
use super::{Setup, Survey, record};
use crate::link::correction::MapCorrection;
use crate::metrics::{Coverage, Footing, GroundTruth};
use crate::report::tum::Stamped;
use crate::robot::OdometryModel;
use crate::sim::Simulator;
use crate::slam::particles::Beside;

/// The map's copy and the coverage judged by it.
#[derive(Debug)]
pub(super) struct Account {
    pub(super) mirror: Mirror,
    /// The map that the true poses would have made; `None` if they are the odometry.
    seen: Option<Mirror>,
    pub(super) coverage: Coverage,
    /// The true ground in an uneven world.
    pub(super) ground: Option<GroundTruth>,
    /// A particle filter beside the run.
    pub(super) particles: Option<Beside>,
}

impl Account {
    /// Makes the account of a run that has not begun.
    pub(super) fn new(setup: &Setup, simulator: &Simulator<'_>) -> Self {
        let (world, working) = (simulator.world(), &simulator.config().working);
        let start = simulator.start();
        let level = setup.start.lasers.first();
        let range_m = f64::from(level.map_or(0, |laser| laser.range_limit_mm)) / 1000.0;
        let uneven = world.elevation();
        let footing =
            uneven.map(|_| Footing::new(world, start, simulator.config().radius_m, working));
        Self {
            mirror: Mirror::new(&setup.start),
            seen: seen(setup, simulator),
            coverage: match &footing {
                Some(footing) => Coverage::on(footing),
                None => Coverage::new(world, start, simulator.config().radius_m, range_m),
            },
            ground: footing.map(|footing| GroundTruth::new(world, &footing, working)),
            particles: None,
        }
    }
}

impl Account {
    /// Makes the account of another robot of the same team, which has not begun.
    pub(super) fn beside(&self, setup: &Setup, simulator: &Simulator<'_>) -> Self {
        Self {
            mirror: Mirror::new(&setup.start),
            seen: seen(setup, simulator),
            coverage: self.coverage.clone(),
            ground: self.ground.clone(),
            particles: None,
        }
    }

    /// Begins with an empty map again. What the robot measured before stays counted.
    pub(super) fn forget(&mut self, setup: &Setup) {
        self.mirror = Mirror::new(&setup.start);
    }

    /// Returns the area of a device's map of so many known cells, in per cent of what a whole
    /// exploration at the true poses makes; `None` if nothing was seen.
    pub(super) fn area_percent(&self, known: usize) -> Option<f64> {
        let seen = self.seen.as_ref().unwrap_or(&self.mirror).known();
        let whole = seen as f64 / self.coverage.fraction();
        (seen > 0).then(|| 100.0 * known as f64 / whole)
    }

    /// Returns true if the robot truly saw a cell.
    pub(super) fn has_seen(&self, cell: Cell) -> bool {
        let seen = self.seen.as_ref().unwrap_or(&self.mirror);
        seen.is_known(cell)
    }
}

/// Returns the map for the true poses; `None` if they are the odometry, and the map stays where it
/// is.
fn seen(setup: &Setup, simulator: &Simulator<'_>) -> Option<Mirror> {
    let drifts = matches!(simulator.config().odometry, OdometryModel::Noisy(_));
    (drifts || setup.corrects).then(|| {
        Mirror::new(&Start {
            localise: false,
            ..setup.start.clone()
        })
    })
}

impl Survey for Account {
    fn note(&mut self, observation: &Observation, truth: &Stamped, command: &Command) -> f64 {
        self.mirror.observe(observation, command.status);
        if command.forgot_arrivals {
            self.mirror.forget_arrivals();
        }
        if let Some(particles) = &mut self.particles {
            particles.observe(&self.mirror.measured(observation), truth);
        }
        if let Some(seen) = &mut self.seen {
            let pose = record::unstamped(truth);
            let observation = Observation {
                pose,
                ..observation.clone()
            };
            seen.observe(&observation, command.status);
        }
        let time_s = f64::from(observation.time_ms) / 1000.0;
        let seen = self.seen.as_ref().unwrap_or(&self.mirror);
        self.coverage.update(time_s, |cell| seen.is_known(cell))
    }

    fn mirror(&mut self) -> Option<&mut Mirror> {
        Some(&mut self.mirror)
    }

    /// A map of the true poses knows it as well.
    fn know(&mut self, known: &MapCorrection) {
        self.mirror.correct(known);
        if let Some(seen) = &mut self.seen {
            seen.correct(known);
        }
    }

    fn relief(&self, window: &Window) -> Option<Relief> {
        self.mirror.relief(window)
    }
}
