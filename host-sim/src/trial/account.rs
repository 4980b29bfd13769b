//! Coverage during a run, by the host's copy of the device's map.

use fieldline_planner::geometry::Cell;
use fieldline_protocol::message::{Observation, Status};

use super::mirror::Mirror;
use super::relief::Relief;
use super::snapshot::Window;
use super::{Setup, Survey};
use crate::metrics::{Coverage, Footing, GroundTruth};
use crate::robot::laser;
use crate::sim::Simulator;

/// The map's copy and the coverage judged by it.
#[derive(Debug)]
pub(super) struct Account {
    pub(super) mirror: Mirror,
    pub(super) coverage: Coverage,
    /// The true ground in an uneven world.
    pub(super) ground: Option<GroundTruth>,
}

impl Account {
    /// Makes the account of a run that has not begun.
    pub(super) fn new(setup: &Setup, simulator: &Simulator<'_>) -> Self {
        let (world, working) = (simulator.world(), &simulator.config().working);
        let start = simulator.start();
        let range_m = f64::from(laser::level().range_limit_mm) / 1000.0;
        let uneven = world.elevation();
        let footing =
            uneven.map(|_| Footing::new(world, start, simulator.config().radius_m, working));
        Self {
            mirror: Mirror::new(&setup.start),
            coverage: match &footing {
                Some(footing) => Coverage::on(footing),
                None => Coverage::new(world, start, simulator.config().radius_m, range_m),
            },
            ground: footing.map(|footing| GroundTruth::new(world, &footing, working)),
        }
    }
}

impl Account {
    /// Makes the account of another robot of the same team, which has not begun.
    pub(super) fn beside(&self, setup: &Setup) -> Self {
        Self {
            mirror: Mirror::new(&setup.start),
            coverage: self.coverage.clone(),
            ground: self.ground.clone(),
        }
    }

    /// Begins with an empty map again. What the robot measured before stays counted.
    pub(super) fn forget(&mut self, setup: &Setup) {
        self.mirror = Mirror::new(&setup.start);
    }
}

impl Survey for Account {
    fn note(&mut self, observation: &Observation, status: Status) -> f64 {
        self.mirror.observe(observation, status);
        let time_s = f64::from(observation.time_ms) / 1000.0;
        let mirror = &self.mirror;
        self.coverage
            .update(time_s, |cell: Cell| mirror.is_known(cell))
    }

    fn relief(&self, window: &Window) -> Option<Relief> {
        self.mirror.relief(window)
    }
}
