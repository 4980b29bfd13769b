//! The robot in its world, as a run needs it.

use fieldline_protocol::message::{Observation, Twist};

use super::record;
use crate::report::tum::Stamped;
use crate::sim::{Loss, Simulator};

/// The robot in its world.
pub trait Body {
    /// Returns the simulated time from one observation to the next, milliseconds.
    fn period_ms(&self) -> u32;
    /// Returns an observation of the present moment.
    fn observe(&mut self) -> Observation;
    /// Drives for one period. `None` is silence: the last velocity counts until the robot's own
    /// watchdog stops it.
    fn drive(&mut self, velocity: Option<Twist>);
    /// Returns the true pose, in the frame of the observations' poses.
    fn truth(&self) -> Stamped;
    /// Returns the reason why the robot is lost, if it is.
    fn loss(&self) -> Option<Loss> {
        None
    }
}

impl Body for Simulator<'_> {
    fn period_ms(&self) -> u32 {
        self.config().period_ms
    }

    fn observe(&mut self) -> Observation {
        Simulator::observe(self)
    }

    fn drive(&mut self, velocity: Option<Twist>) {
        Simulator::drive(self, velocity);
    }

    fn truth(&self) -> Stamped {
        record::stamped(self.time_ms(), &self.above_start(self.pose()).to_wire())
    }

    fn loss(&self) -> Option<Loss> {
        Simulator::loss(self)
    }
}
