//! Scans of lidars that turn while the robot moves, as the device has them: of one instant.
//!
//! A host that keeps scans, for a copy of the map or for a pose graph, keeps these. Without such a
//! lidar it keeps what it sent.

use std::borrow::Cow;

use fieldline_device::convert;
use fieldline_planner::Config;
use fieldline_planner::planner::host_copy;
use fieldline_protocol::message::{Observation, Scan};

/// Brings the scans of a session's observations to one instant, one after the other.
#[derive(Debug, Default)]
pub struct AtOnce {
    planner: host_copy::AtOnce,
    /// The scans of the last observation, if they were brought to one instant.
    last: Option<Vec<Scan>>,
}

impl AtOnce {
    /// Returns an observation as a step of the device reads it. The device knows all observations
    /// before it, also those that it answered without a step.
    pub fn take<'a>(
        &mut self,
        config: &Config,
        observation: &'a Observation,
    ) -> Cow<'a, Observation> {
        let input = convert::input(observation, config.lasers());
        let turns = config.lasers().iter().any(|laser| laser.turn_time_ms > 0);
        let Some(input) = input.filter(|_| turns) else {
            self.last = None;
            return Cow::Borrowed(observation);
        };
        let scans = self.planner.scans(config, &input).into_iter();
        let scan = |ranges_mm: &[u16]| Scan {
            ranges_mm: ranges_mm.iter().copied().collect(),
        };
        let scans = scans.take(observation.scans.len()).map(scan);
        self.last = Some(scans.collect());
        Cow::Owned(self.again(observation))
    }

    /// Returns the last observation as it was returned before.
    #[must_use]
    pub fn again(&self, observation: &Observation) -> Observation {
        let scans = match &self.last {
            Some(scans) => scans.iter().cloned().collect(),
            None => observation.scans.clone(),
        };
        Observation {
            scans,
            ..observation.clone()
        }
    }
}
