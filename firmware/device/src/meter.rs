//! What a step costs, measured by the board, stage by stage.
//!
//! A `Stopwatch` stands between the board's counter and the planner's laps. It starts when a request is complete, so that taking
//! the request apart counts too; what it takes to put the reply together is known only once the reply is on its way, and
//! counts in the next step. Receiving bytes one by one does not count: it goes on while the line is busy.
//!
//! Invariant: a cost's instructions are the sum of its stages'.
//! Units: instructions in the emulator, where they are exact; on silicon whatever the board counts and documents.

use fieldline_planner::{Stage, StageTimer};
use fieldline_protocol::message::Stages;

/// A counter of instructions and a mark of the deepest stack.
pub trait Meter {
    /// A step begins: count nothing else until [`Meter::stop`].
    fn start(&mut self);
    /// The step is over.
    fn stop(&mut self);
    /// What was counted so far, from any origin, wrapping; always the same where nothing is counted.
    fn count(&mut self) -> u32;
    /// Deepest stack since boot, bytes; 0 where it is not known.
    fn stack_bytes(&self) -> u32;
}

/// Measures nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMeter;

impl Meter for NoMeter {
    fn start(&mut self) {}

    fn stop(&mut self) {}

    fn count(&mut self) -> u32 {
        0
    }

    fn stack_bytes(&self) -> u32 {
        0
    }
}

/// Takes the time of a step's stages.
#[derive(Debug)]
pub(crate) struct Stopwatch<'m, M> {
    meter: &'m mut M,
    /// The count at the last lap.
    since: u32,
    stages: Stages,
}

impl<'m, M: Meter> Stopwatch<'m, M> {
    /// Began when the meter's count was `since`; `session` were counted before.
    pub(crate) fn new(meter: &'m mut M, since: u32, session: u32) -> Self {
        let stages = Stages {
            session,
            ..Stages::default()
        };
        Self {
            meter,
            since,
            stages,
        }
    }

    /// What was counted since the last lap.
    fn take(&mut self) -> u32 {
        let now = self.meter.count();
        let counted = now.wrapping_sub(self.since);
        self.since = now;
        counted
    }

    /// Everything since the last lap was the conversation.
    pub(crate) fn lap_of_session(&mut self) {
        let counted = self.take();
        self.stages.session = self.stages.session.wrapping_add(counted);
    }

    /// The stages so far.
    pub(crate) const fn stages(&self) -> Stages {
        self.stages
    }
}

impl<M: Meter> StageTimer for Stopwatch<'_, M> {
    #[inline(never)]
    fn mark(&mut self, stage: Stage) {
        let counted = self.take();
        let total = match stage {
            Stage::Sense => &mut self.stages.sense,
            Stage::Topology => &mut self.stages.topology,
            Stage::Plan => &mut self.stages.plan,
            Stage::Window => &mut self.stages.window,
            Stage::Solve => &mut self.stages.solve,
            Stage::Drive => &mut self.stages.drive,
        };
        *total = total.wrapping_add(counted);
    }
}

/// The sum of the stages.
pub(crate) fn sum(stages: &Stages) -> u32 {
    let Stages {
        session,
        sense,
        topology,
        plan,
        window,
        solve,
        drive,
    } = *stages;
    let all = [session, sense, topology, plan, window, solve, drive];
    all.into_iter().fold(0, u32::wrapping_add)
}

#[cfg(test)]
mod tests {
    use super::{Meter, Stopwatch, sum};
    use fieldline_planner::{Stage, StageTimer};
    use fieldline_protocol::message::Stages;

    /// Counts in the given steps, from just below where it wraps.
    struct Script(u32, std::vec::IntoIter<u32>);

    impl Meter for Script {
        fn start(&mut self) {}
        fn stop(&mut self) {}
        fn count(&mut self) -> u32 {
            self.0 = self.0.wrapping_add(self.1.next().unwrap_or(0));
            self.0
        }
        fn stack_bytes(&self) -> u32 {
            0
        }
    }

    #[test]
    fn every_count_falls_into_one_stage() {
        let mut script = Script(u32::MAX - 1, std::vec![5, 100, 7, 30, 2].into_iter());
        let mut watch = Stopwatch::new(&mut script, u32::MAX - 1, 1000);
        watch.lap_of_session();
        watch.mark(Stage::Sense);
        watch.mark(Stage::Drive);
        watch.mark(Stage::Sense);
        watch.lap_of_session();
        let stages = Stages {
            session: 1007,
            sense: 130,
            drive: 7,
            ..Stages::default()
        };
        assert_eq!(watch.stages(), stages);
        assert_eq!(sum(&stages), 1144);
    }
}
