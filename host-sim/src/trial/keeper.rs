//! Who keeps what a run knows, so that it can go on after its host was killed.

use super::Record;
use super::mirror::Mirror;
use crate::link::LinkError;

/// Keeps what a run knows, so that it can go on after its host was killed.
pub trait Keeper {
    /// Called after every step, and at the end of the run before the robot is brought to rest.
    /// `mirror` is the copy of a lone robot's map.
    ///
    /// # Errors
    /// [`LinkError::Io`] if the run that is resumed is not the one that was kept.
    fn keep(&mut self, at: Moment, record: &Record, mirror: &Mirror) -> Result<(), LinkError>;
}

/// Keeps nothing.
impl Keeper for () {
    fn keep(&mut self, _: Moment, _: &Record, _: &Mirror) -> Result<(), LinkError> {
        Ok(())
    }
}

/// When a [`Keeper`] is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// After a step, before the robot drives.
    Step,
    /// After the last step.
    End,
    /// After the link failed in the step that follows the last one.
    Broken,
}
