//! Cost of a step, counted by the board and split into stages.
//!
//! A `Stopwatch` connects the board's counter to the planner's stages. A [`Mark`] is a point at
//! which the counter is read: what was counted since the last mark belongs to the stage that the
//! new one ends. The emulated board shows its marks to whoever watches it, so that a model of the
//! chip's cycles divides them among the same stages. The watch starts when a request is complete,
//! so decoding the request counts too. The cost of encoding a reply is known only after the reply
//! is written, so it counts in the next step. Receiving single bytes does not count, because it
//! continues as long as the line is busy.
//!
//! Invariant: a cost's instructions are the sum of its stages. Units: instructions in the emulator,
//! where they are exact; on silicon the board defines the unit.

use fieldline_planner::{Stage, StageTimer};
use fieldline_protocol::message::Stages;

/// A board's counter of instructions, and its record of the deepest stack.
pub trait Meter {
    /// A step starts: count nothing else until [`Meter::stop`].
    fn start(&mut self);
    /// The step has ended.
    fn stop(&mut self);
    /// Returns the count so far, from any origin, wrapping; a constant where nothing is counted. A
    /// board that is watched shows the mark first.
    fn mark(&mut self, mark: Mark) -> u32;
    /// Returns the deepest stack since the boot, bytes; 0 where it is not known.
    fn stack_bytes(&self) -> u32;
}

/// A point of a request at which the counter is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A request is complete.
    Request,
    /// The session has decoded it, or has done with the planner.
    Session,
    /// The end of a stage of the planner.
    Stage(Stage),
    /// The reply is about to be encoded.
    Reply,
    /// The reply is encoded.
    Replied,
}

impl Mark {
    /// Returns the mark's number, as in `host-sim/cycles/src/steps.rs`.
    #[must_use]
    pub const fn number(self) -> usize {
        match self {
            Self::Request => 0,
            Self::Session => 1,
            Self::Stage(stage) => 2 + stage as usize,
            Self::Reply => 8,
            Self::Replied => 9,
        }
    }
}

/// A meter that measures nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMeter;

impl Meter for NoMeter {
    fn start(&mut self) {}

    fn stop(&mut self) {}

    fn mark(&mut self, _: Mark) -> u32 {
        0
    }

    fn stack_bytes(&self) -> u32 {
        0
    }
}

/// Counts the instructions of each stage of a step.
#[derive(Debug)]
pub(crate) struct Stopwatch<'m, M> {
    meter: &'m mut M,
    /// The meter's count at the last mark.
    since: u32,
    stages: Stages,
}

impl<'m, M: Meter> Stopwatch<'m, M> {
    /// Starts at the meter's count `since`, with `session` instructions already counted.
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

    /// Adds everything since the last mark to the stage `session`.
    pub(crate) fn mark_session(&mut self) {
        let counted = self.count(Mark::Session);
        self.stages.session = self.stages.session.wrapping_add(counted);
    }

    /// Returns what was counted since the last mark.
    fn count(&mut self, mark: Mark) -> u32 {
        let now = self.meter.mark(mark);
        now.wrapping_sub(core::mem::replace(&mut self.since, now))
    }

    /// Returns the stages so far.
    pub(crate) const fn stages(&self) -> Stages {
        self.stages
    }
}

impl<M: Meter> StageTimer for Stopwatch<'_, M> {
    #[inline(never)]
    fn mark(&mut self, stage: Stage) {
        let counted = self.count(Mark::Stage(stage));
        let stages = &mut self.stages;
        let total = match stage {
            Stage::Sense => &mut stages.sense,
            Stage::Topology => &mut stages.topology,
            Stage::Plan => &mut stages.plan,
            Stage::Window => &mut stages.window,
            Stage::Solve => &mut stages.solve,
            Stage::Drive => &mut stages.drive,
        };
        *total = total.wrapping_add(counted);
    }
}

/// Returns the sum of the stages.
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
    use super::{Mark, Meter, Stopwatch, sum};
    use fieldline_planner::{Stage, StageTimer};
    use fieldline_protocol::message::Stages;

    /// A meter with a given increment for each call. It starts just below the wrap.
    struct Script(u32, std::vec::IntoIter<u32>, std::vec::Vec<Mark>);

    impl Meter for Script {
        fn start(&mut self) {}
        fn stop(&mut self) {}
        fn mark(&mut self, mark: Mark) -> u32 {
            self.2.push(mark);
            self.0 = self.0.wrapping_add(self.1.next().unwrap_or(0));
            self.0
        }
        fn stack_bytes(&self) -> u32 {
            0
        }
    }

    #[test]
    fn every_count_belongs_to_one_stage() {
        let counts = std::vec![5, 100, 7, 30, 2].into_iter();
        let mut script = Script(u32::MAX - 1, counts, std::vec![]);
        let mut watch = Stopwatch::new(&mut script, u32::MAX - 1, 1000);
        watch.mark_session();
        watch.mark(Stage::Sense);
        watch.mark(Stage::Drive);
        watch.mark(Stage::Sense);
        watch.mark_session();
        let stages = Stages {
            session: 1007,
            sense: 130,
            drive: 7,
            ..Stages::default()
        };
        assert_eq!(watch.stages(), stages);
        assert_eq!(sum(&stages), 1144);
        let marks = [
            Mark::Session,
            Mark::Stage(Stage::Sense),
            Mark::Stage(Stage::Drive),
            Mark::Stage(Stage::Sense),
            Mark::Session,
        ];
        assert_eq!(script.2, marks);
        assert_eq!(marks.map(Mark::number), [1, 2, 7, 2, 1]);
    }
}
