//! Corrections of the map during a run, and the return of the map to a device that was reset.
//!
//! A [`Corrector`] looks at every step and at the host's copy of the map, and may correct the map.
//! The copy follows the correction, so it still equals the device's map. If pictures are wanted,
//! the map is read before and after the largest corrections.
//!
//! A device may be told before its first step what is known already: the tiles of a saved map.
//!
//! A device that was reset has lost its session. If the run resumes, it gets the same session, and
//! its map back by a correction with every tile of the copy, and by a recall what lies around its
//! robot and how it came there. It is told where home is, what is left of its budget and which
//! drive is in hand. The state of its strategy is not restored: goals that were given up are tried
//! again, and loops and visits begin anew.

use fieldline_device::convert::quantity;
use fieldline_planner::geometry::Pose;
use fieldline_protocol::message::{Command, Control, Observation, Start, Status};

use super::itinerary::Itinerary;
use super::map_copy::MapCopy;
use super::snapshot::{self, Snapshot};
use super::{Cast, Record, Setup};
use crate::link::LinkError;
use crate::link::correction::MapCorrection;

/// Most resets in a row after which a run does not go on.
const MOST_RESETS: usize = 8;

/// Map and window before and after a correction of the map.
#[derive(Clone, Debug, PartialEq)]
pub struct Corrected {
    /// Way by which it moved the robot in the map, metres.
    pub moved_m: f64,
    /// Before it.
    pub before: Snapshot,
    /// After it.
    pub after: Snapshot,
}

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
    setup: &Setup,
    cast: &mut Cast<'_>,
    (observation, command): (&Observation, &Command),
    record: &mut Record,
) -> Result<(), LinkError> {
    let Some(copy) = cast.survey.copy() else {
        return Ok(());
    };
    let Some(correction) = cast.corrector.correct(observation, command, copy) else {
        return Ok(());
    };
    let moved_m = correction.motion.length_at_m(&copy.pose());
    let is_shown = is_among(setup.snapshots, moved_m, &record.corrections);
    let before = if is_shown {
        Some(snapshot::take(cast.link, record)?)
    } else {
        None
    };
    cast.link.correct(&correction)?;
    copy.correct(&correction);
    if let Some(before) = before {
        let after = snapshot::take(cast.link, record)?;
        record.corrections.push(Corrected {
            moved_m,
            before,
            after,
        });
        leave_out_smallest(setup.snapshots, &mut record.corrections);
    }
    Ok(())
}

/// Returns true if a correction is one of the `wanted` largest so far.
fn is_among(wanted: usize, moved_m: f64, corrections: &[Corrected]) -> bool {
    let larger = corrections.iter().filter(|other| other.moved_m >= moved_m);
    larger.count() < wanted
}

/// Leaves out the smallest corrections of more than `wanted`. The others stay in order.
fn leave_out_smallest(wanted: usize, corrections: &mut Vec<Corrected>) {
    while corrections.len() > wanted {
        let sizes = corrections.iter().map(|other| other.moved_m).enumerate();
        let Some((smallest, _)) = sizes.min_by(|(_, one), (_, other)| one.total_cmp(other)) else {
            return;
        };
        corrections.remove(smallest);
    }
}

/// Begins the session, and tells the device what is known before its first step.
pub(super) fn begin(setup: &Setup, cast: &mut Cast<'_>) -> Result<Status, LinkError> {
    let mut answer = session(setup, cast);
    for _ in 0..MOST_RESETS {
        if !setup.resumes || answer != Err(LinkError::Reset) {
            break;
        }
        answer = session(setup, cast);
    }
    if let (Ok(Status::Exploring), Some(known)) = (&answer, &setup.known) {
        cast.survey.know(known);
    }
    answer
}

fn session(setup: &Setup, cast: &mut Cast<'_>) -> Result<Status, LinkError> {
    let status = cast.link.control(&Control::Start(setup.start.clone()))?;
    if let (Status::Exploring, Some(known)) = (status, &setup.known) {
        cast.link.correct(known)?;
    }
    Ok(status)
}

/// Makes a step; a device that was reset gets its session and its map back, if the run resumes.
pub(super) fn observe(
    setup: &Setup,
    cast: &mut Cast<'_>,
    (record, itinerary): (&Record, &mut Itinerary),
    observation: &Observation,
) -> Result<Command, LinkError> {
    let mut answer = cast.link.observe(observation);
    for _ in 0..MOST_RESETS {
        if !setup.resumes || answer != Err(LinkError::Reset) {
            break;
        }
        let resumed = resume(setup, cast, (record, itinerary));
        answer = resumed.and_then(|()| cast.link.observe(observation));
    }
    answer
}

/// Gives a device that was reset its session, its map and its orders back, however often it is
/// reset meanwhile.
pub(super) fn restore(
    setup: &Setup,
    cast: &mut Cast<'_>,
    (record, itinerary): (&Record, &mut Itinerary),
) -> Result<(), LinkError> {
    let mut answer = Err(LinkError::Reset);
    for _ in 0..MOST_RESETS {
        if answer != Err(LinkError::Reset) {
            break;
        }
        answer = resume(setup, cast, (record, itinerary));
    }
    answer
}

fn resume(
    setup: &Setup,
    cast: &mut Cast<'_>,
    (record, itinerary): (&Record, &mut Itinerary),
) -> Result<(), LinkError> {
    let Some(mirror) = cast.survey.mirror() else {
        return Err(LinkError::Reset);
    };
    cast.link.control(&Control::Start(Start {
        budget: itinerary.budget_left(record),
        ..setup.start.clone()
    }))?;
    let (correction, recall) = (mirror.whole(), mirror.recall());
    cast.link.correct(&correction)?;
    cast.link.recall(&recall)?;
    mirror.resume(&correction, &recall);
    if let Some(home) = mirror.home() {
        cast.link.control(&set_home(&home))?;
    }
    itinerary.take_up(cast.link)
}

fn set_home(home: &Pose) -> Control {
    Control::SetHome {
        x: quantity(home.x_m),
        y: quantity(home.y_m),
        yaw: quantity(home.yaw_rad),
    }
}
