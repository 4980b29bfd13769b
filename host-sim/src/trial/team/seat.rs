//! A robot's seat in the fleet: its body, and what it measures for itself and for the team.

use fieldline_protocol::message::{Command, Observation, Twist};

use super::copy::TeamCopy;
use crate::metrics::Coverage;
use crate::report::tum::Stamped;
use crate::sim::Fleet;
use crate::trial::account::Account;
use crate::trial::{Body, MapCopy, Survey, record};

/// One robot of a fleet as a body. It drives with the fleet, never alone.
pub(super) struct Seat<'a, 'w> {
    pub(super) fleet: &'a mut Fleet<'w>,
    pub(super) robot: usize,
}

impl Body for Seat<'_, '_> {
    fn period_ms(&self) -> u32 {
        self.fleet.robots()[self.robot].config().period_ms
    }

    fn observe(&mut self) -> Observation {
        self.fleet.observe(self.robot)
    }

    fn drive(&mut self, _: Option<Twist>) {}

    fn truth(&self) -> Stamped {
        let robot = &self.fleet.robots()[self.robot];
        record::stamped(robot.time_ms(), &robot.above_start(robot.pose()).to_wire())
    }
}

/// Counts what a robot measures for the robot and for the team.
pub(super) struct Witness<'a> {
    pub(super) own: &'a mut Account,
    pub(super) all: &'a mut Coverage,
    /// The copy of the device's map, if it is corrected.
    pub(super) copy: Option<&'a mut TeamCopy>,
}

impl Survey for Witness<'_> {
    fn note(&mut self, observation: &Observation, truth: &Stamped, command: &Command) -> f64 {
        let fraction = self.own.note(observation, truth, command);
        if let Some(copy) = &mut self.copy {
            copy.observe(observation, command);
        }
        let time_s = f64::from(observation.time_ms) / 1000.0;
        let own = &self.own;
        self.all.update(time_s, |cell| own.has_seen(cell));
        fraction
    }
    fn copy(&mut self) -> Option<&mut dyn MapCopy> {
        let copy = self.copy.as_mut()?;
        Some(&mut **copy)
    }
}
