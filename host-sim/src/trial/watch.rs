//! Who watches a run, and may end it. Units: simulated milliseconds, metres.

use fieldline_protocol::message::Command;

use super::sight::Sight;
use crate::report::tum::Stamped;

/// Watches a run and may end it: a progress line, a pacer, the interrupt key, a live page.
pub trait Watch {
    /// Called after every step; the answer says if the run goes on.
    fn step(&mut self, progress: &Progress) -> Flow;

    /// Called then with all that the step knows, before the robot drives. Whoever watches may look
    /// and make requests of the device, as [`Sight::request`] does.
    fn see(&mut self, _sight: &mut Sight<'_>) {}

    /// As [`Self::see`], for a robot of a team by its number. [`Self::see`] is not called then.
    fn see_robot(&mut self, _robot: usize, _sight: &mut Sight<'_>) {}
}

/// Watches nothing; the run goes on.
impl Watch for () {
    fn step(&mut self, _: &Progress) -> Flow {
        Flow::Continue
    }
}

/// Answer of a [`Watch`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Go on.
    Continue,
    /// Stop the robot and end the run.
    Interrupt,
}

/// Progress of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Simulated milliseconds.
    pub time_ms: u32,
    /// Fraction of the explorable world that is known.
    pub coverage: f64,
    /// Metres driven.
    pub path_m: f64,
    /// Where the planner takes the robot to be.
    pub estimate: Stamped,
    /// The last command.
    pub command: Command,
}
