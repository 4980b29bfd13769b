//! Marks at the ends of a step's stages, so that a caller can measure each stage.
//!
//! The planner has no clock. It calls [`StageTimer::mark`] at the end of a stage. A board reads its
//! instruction counter there. A host passes `()`, and the compiler removes the calls. The output of
//! a step does not depend on the timer.

/// A stage of a step; see [`crate::step`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Enters scans and odometry into the map and the obstacle points.
    Sense,
    /// Loads and thins an instalment of the skeleton.
    Topology,
    /// Runs the wavefront over a new skeleton and follows the path down it.
    Plan,
    /// Builds the window's cells and boundary.
    Window,
    /// Solves the window's field.
    Solve,
    /// Descends the field, chooses the velocity and searches for a recovery.
    Drive,
}

/// Receives the ends of stages.
///
/// ```
/// use fieldline_planner::{Stage, StageTimer};
///
/// /// Counts the solves of a session.
/// struct Solves(u32);
///
/// impl StageTimer for Solves {
///     fn mark(&mut self, stage: Stage) {
///         self.0 += u32::from(stage == Stage::Solve);
///     }
/// }
/// ```
pub trait StageTimer {
    /// Ends `stage`, which began at the last mark or at the begin of the step. A step may mark a
    /// stage several times or never.
    fn mark(&mut self, stage: Stage);
}

/// Ignores all marks.
impl StageTimer for () {
    #[inline(always)]
    fn mark(&mut self, _: Stage) {}
}
