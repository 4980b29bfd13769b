//! Corrections of the map during a run, and the return of the map to a device that was reset.
//!
//! A [`Corrector`] looks at every step and at the host's copy of the map, and may correct the map.
//! The copy follows the correction, so it still equals the device's map.
//!
//! A device that was reset has lost its session. If the run resumes, it gets the same session, and
//! its map back by a correction with every tile of the copy. The state of its strategy is not
//! restored: goals that were given up are tried again, and loops and visits begin anew.

use fieldline_protocol::message::{Command, Control, Observation};

use super::map_copy::MapCopy;
use super::{Cast, Setup};
use crate::link::LinkError;
use crate::link::correction::MapCorrection;

/// Most resets in a row after which a run does not go on.
const MOST_RESETS: usize = 8;

/// Corrects the map during a run.
pub trait Corrector {
    /// Called after every step; returns the correction that is sent now.
    fn correct(
        &mut self,
        observation: &Observation,
        command: &Command,
        copy: &dyn MapCopy,
    ) -> Option<MapCorrection>;
}

/// Corrects nothing.
impl Corrector for () {
    fn correct(&mut self, _: &Observation, _: &Command, _: &dyn MapCopy) -> Option<MapCorrection> {
        None
    }
}

/// Sends a correction if there is one after this step.
pub(super) fn correct(
    cast: &mut Cast<'_>,
    observation: &Observation,
    command: &Command,
) -> Result<(), LinkError> {
    let Some(copy) = cast.survey.copy() else {
        return Ok(());
    };
    if let Some(correction) = cast.corrector.correct(observation, command, copy) {
        cast.link.correct(&correction)?;
        copy.correct(&correction);
    }
    Ok(())
}

/// Makes a step; a device that was reset gets its session and its map back, if the run resumes.
pub(super) fn observe(
    setup: &Setup,
    cast: &mut Cast<'_>,
    observation: &Observation,
) -> Result<Command, LinkError> {
    let mut answer = cast.link.observe(observation);
    for _ in 0..MOST_RESETS {
        if !setup.resumes || answer != Err(LinkError::Reset) {
            break;
        }
        answer = resume(setup, cast).and_then(|()| cast.link.observe(observation));
    }
    answer
}

fn resume(setup: &Setup, cast: &mut Cast<'_>) -> Result<(), LinkError> {
    let Some(mirror) = cast.survey.mirror() else {
        return Err(LinkError::Reset);
    };
    cast.link.control(&Control::Start(setup.start.clone()))?;
    let correction = mirror.whole();
    cast.link.correct(&correction)?;
    mirror.resume(&correction);
    Ok(())
}
