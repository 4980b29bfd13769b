//! Where a step's time goes: marks between its stages, for whoever holds a counter.
//!
//! The planner knows no clock. It says which stage it has just ended, and what that means is the
//! caller's business: a board reads its instruction counter, a host passes `()` and the marks are
//! compiled away. The answer of a step does not depend on it.

/// A part of a step; see [`crate::planner`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Scans and odometry into the map and the near field.
    Sense,
    /// An instalment of loading and thinning.
    Topology,
    /// The wave over a new skeleton, and the path down it.
    Plan,
    /// The window's cells and boundary.
    Window,
    /// The window's field.
    Solve,
    /// Descent, drive, and the search for a manoeuvre.
    Drive,
}

/// Takes notice of the ends of stages.
pub trait StageTimer {
    /// Everything since the last lap, or since the step began, was `stage`. A step may have several
    /// timer of a stage, or none.
    fn mark(&mut self, stage: Stage);
}

/// Takes no notice.
impl StageTimer for () {
    #[inline(always)]
    fn mark(&mut self, _: Stage) {}
}
