//! What a watcher sees of a step, and the requests that it may make.
//!
//! ```text
//! observe ─► device ─► record ─► ended? ─► see(Sight) ─► drive
//!                                            │ request: pause, resume, stop, home, go to, explore
//!                                            ▼
//!                                          device, record.live_requests, itinerary
//! ```
//!
//! A look changes nothing. A request goes over the same link as any other, acts from the next step
//! on, and stands in the record with its answer.

use std::collections::BTreeMap;

use fieldline_protocol::message::{Control, Observation, Status};

use super::itinerary::Itinerary;
use super::mirror::Mirror;
use super::{Ending, Record, Setup, Step, wording};
use crate::link::inside::{Inside, Key};
use crate::link::{Link, LinkError};
use crate::report::LiveRequest;

/// Most requests that a record keeps. Later ones are done and not kept.
const MOST_KEPT: usize = 10_000;

/// A step as its watcher sees it.
#[expect(missing_debug_implementations, reason = "borrowed trait objects")]
pub struct Sight<'a> {
    /// The settings of the run.
    pub setup: &'a Setup,
    /// What the robot measured.
    pub observation: &'a Observation,
    /// The host's copy of the map; `None` without one.
    pub mirror: Option<&'a Mirror>,
    /// What ends the run with this step; `None` if it goes on.
    pub ending: Option<&'a Ending>,
    /// The session is made again from a log or a recording. Then the record's true poses are those
    /// of odometry, and its coverage is the share of the session that is over.
    pub again: bool,
    pub(super) record: &'a mut Record,
    /// `None` for a robot that takes no requests: one of a team, or of a session made again.
    pub(super) itinerary: Option<&'a mut Itinerary>,
    pub(super) link: &'a mut dyn Link,
}

impl Sight<'_> {
    /// Returns the record up to this step.
    #[must_use]
    pub const fn record(&self) -> &Record {
        self.record
    }

    /// Returns the step.
    #[must_use]
    pub fn step(&self) -> Option<&Step> {
        self.record.steps.last()
    }

    /// Looks into the device, if it lives in this process.
    #[must_use]
    pub fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        self.link.end().inside()
    }

    /// Returns the number of the map's changes so far, which wraps; `None` without a map.
    #[must_use]
    pub fn map_edits(&self) -> Option<u32> {
        let inside = self.inside().map(|inside| inside.edits());
        inside.or_else(|| Some(self.mirror?.map().tiles().edits()))
    }

    /// Returns the map's tiles: the device's own, if it lives in this process, else the host's
    /// copy. A cell has two bits, least x and y first, as [`Inside::cells`] tells them.
    #[must_use]
    pub fn map_tiles(&self) -> BTreeMap<Key, [u8; 256]> {
        match (self.inside(), self.mirror) {
            (Some(inside), _) => {
                let keys = inside.tiles().into_iter();
                keys.filter_map(|key| Some((key, inside.cells(key)?)))
                    .collect()
            }
            (None, Some(mirror)) => {
                let keys = mirror.map().tiles().touched();
                let tiles = keys
                    .filter_map(|(x, y)| Some(((x as i16, y as i16), mirror.map().shown(x, y)?)));
                tiles.collect()
            }
            (None, None) => BTreeMap::new(),
        }
    }

    /// Returns true if the robot stands where a request took it, until the next request.
    #[must_use]
    pub fn waits(&self) -> bool {
        let status = self.step().map(|step| step.command.status);
        let waits = self.itinerary.as_ref().is_some_and(|it| it.waits());
        waits || status == Some(Status::Paused)
    }

    /// Makes a request of the device, and enters it in the record. *Resume* ends a pause; where the
    /// robot stands or drives by an earlier request, it goes on with what it did before.
    ///
    /// # Errors
    /// As [`LinkError`]; [`LinkError::Refused`] if the device says no, the run has ended, the robot
    /// is one of a team or of a session made again, or the request is none that a viewer may make.
    /// A link that fails ends the run with the next step.
    pub fn request(&mut self, control: &Control) -> Result<Status, LinkError> {
        let answer = self.ask(control);
        let (words, done) = match &answer {
            Ok(status) => (wording::status(*status), true),
            Err(LinkError::Refused(reason)) => (reason.clone(), false),
            Err(error) => (error.to_string(), false),
        };
        let time_ms = self.step().map_or(0, |step| step.truth.time_ms);
        if self.record.live_requests.len() < MOST_KEPT {
            self.record.live_requests.push(LiveRequest {
                time_s: f64::from(time_ms) / 1000.0,
                request: request_words(control),
                answer: words,
                done,
            });
        }
        answer
    }

    fn ask(&mut self, control: &Control) -> Result<Status, LinkError> {
        if self.ending.is_some() {
            return Err(LinkError::Refused("the run has ended".into()));
        }
        let Some(itinerary) = self.itinerary.as_mut() else {
            let whose = if self.again {
                "a session that is made again"
            } else {
                "a robot of a team"
            };
            let why = format!("{whose} takes no requests of a viewer");
            return Err(LinkError::Refused(why));
        };
        match control {
            Control::Pause | Control::Stop => self.link.control(control),
            Control::Resume | Control::Explore => itinerary.resume(self.record, self.link),
            Control::Home | Control::GoTo { .. } => {
                itinerary.interject(control, self.record, self.link)
            }
            Control::Start(_) | Control::Reset | Control::SetHome { .. } => Err(
                LinkError::Refused("a viewer neither begins a session nor moves its home".into()),
            ),
        }
    }
}

/// Returns a request in words.
#[must_use]
pub fn request_words(control: &Control) -> String {
    match control {
        Control::Start(_) => "start".into(),
        Control::Pause => "pause".into(),
        Control::Resume => "resume".into(),
        Control::Stop => "stop".into(),
        Control::Reset => "reset".into(),
        Control::Home => "home".into(),
        Control::GoTo { x, y } => format!("go to {x:.2},{y:.2}"),
        Control::Explore => "explore".into(),
        Control::SetHome { x, y, .. } => format!("set home {x:.2},{y:.2}"),
    }
}
