//! What a robot is ordered to do after its exploration: goals, and then home.
//!
//! ```text
//! explore ─► goal ─► goal ─► … ─► home ─► end
//!    └──────────┴── the budget is spent ──┘
//! ```
//!
//! A goal that is refused or cannot be reached is left, and the next one is tried. The exploration
//! may have ended in any way that leaves the robot where it knows its place.
//!
//! A viewer's request to drive comes before all of this. The drive that it cuts short is made
//! later,
//! the robot stands where the request took it, and *resume* goes on with what was to be done.
//!
//! Units: metres and radians in the device's map; in reports degrees.

use std::collections::VecDeque;

use fieldline_protocol::message::{Budget, Command, Control, Errand, Finish, Status};
use fixed::types::I16F16;

use super::{Ending, Record};
use crate::link::{Link, LinkError};
use crate::report;
use crate::report::tum::Stamped;

/// What the robot does after its exploration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Orders {
    /// Places to drive to, in this order.
    pub goals_m: Vec<[f64; 2]>,
    /// True if it then drives home.
    pub home: bool,
    /// What it may drive before it must be home. The device turns home by itself.
    pub budget: Budget,
}

/// A place to drive to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Leg {
    Goal([f64; 2]),
    Home,
}

/// A drive by order, as far as it went.
#[derive(Clone, Debug, PartialEq)]
struct Trip {
    leg: Leg,
    /// Status at its end; `None` while it lasts.
    end: Option<Status>,
    /// The device's reason if it refused the order.
    refused: Option<String>,
    /// It was a viewer's request, or one cut it short: no part of the orders' success.
    is_aside: bool,
    begun_ms: u32,
    ended_ms: u32,
    /// Where the robot thought it was at the end, and where it was.
    estimate: Stamped,
    truth: Stamped,
}

/// The orders that are left, and the drives so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Itinerary {
    left: VecDeque<Leg>,
    trips: Vec<Trip>,
    /// The end of the exploration.
    explored: Option<Ending>,
    /// Where the session began.
    home: Option<Stamped>,
    /// The device turned home by itself.
    is_spent: bool,
    /// The last trip is in hand.
    drives: bool,
    /// The last trip was a viewer's, and the robot stands at its end.
    waits: bool,
    /// What ends the run with the next step: no order is left after a viewer's request.
    ending: Option<Ending>,
}

impl Itinerary {
    /// Makes the itinerary of these orders.
    pub(super) fn new(orders: &Orders) -> Self {
        let goals = orders.goals_m.iter().map(|goal| Leg::Goal(*goal));
        Self {
            left: goals.chain(orders.home.then_some(Leg::Home)).collect(),
            ..Self::default()
        }
    }

    /// Takes what would end the run without orders. Returns what ends it; `None` if the robot was
    /// ordered to drive on.
    ///
    /// # Errors
    /// [`LinkError`] if the link fails.
    pub(super) fn end_or_go_on(
        &mut self,
        ending: Ending,
        record: &Record,
        link: &mut dyn Link,
    ) -> Result<Option<Ending>, LinkError> {
        let may_drive = match &ending {
            Ending::Finished(why) => *why != Finish::Stopped,
            Ending::Fault(_) => true,
            _ => false,
        };
        if self.explored.is_some() || !may_drive || self.left.is_empty() {
            return Ok(Some(ending));
        }
        self.explored = Some(ending);
        self.next(record, link)
    }

    /// Takes a command. Returns what ends the run, once no order is left.
    ///
    /// # Errors
    /// [`LinkError`] if the link fails.
    pub(super) fn note(
        &mut self,
        command: &Command,
        record: &Record,
        link: &mut dyn Link,
    ) -> Result<Option<Ending>, LinkError> {
        if self.home.is_none() {
            self.home = record.steps.first().map(|step| step.estimate);
        }
        if let Some(ending) = self.ending.take() {
            return Ok(Some(ending));
        }
        match command.status {
            Status::Going(Errand::Home) if !self.is_on_the_way_home() => {
                self.finish(None, None, record);
                self.is_spent = true;
                self.left.clear();
                self.begin(Leg::Home, record);
                Ok(None)
            }
            Status::Arrived(_) | Status::Unreachable(_) if self.waits => Ok(None),
            status @ (Status::Arrived(_) | Status::Unreachable(_)) => {
                self.finish(Some(status), None, record);
                self.waits = self.is_a_viewers();
                match self.waits {
                    true => Ok(None),
                    false => self.next(record, link),
                }
            }
            _ => Ok(None),
        }
    }

    /// Drives where a viewer asks for. A drive in hand is put off.
    ///
    /// # Errors
    /// [`LinkError`]; if the device refuses, nothing changes.
    pub(super) fn interject(
        &mut self,
        control: &Control,
        record: &Record,
        link: &mut dyn Link,
    ) -> Result<Status, LinkError> {
        let leg = match control {
            Control::GoTo { x, y } => Leg::Goal([x, y].map(|at| at.to_num())),
            _ => Leg::Home,
        };
        let status = link.control(control)?;
        self.put_off(record);
        self.begin(leg, record);
        self.set_aside();
        Ok(status)
    }

    /// Ends a pause; else goes on with what a viewer's request cut short.
    ///
    /// # Errors
    /// As [`Itinerary::interject`].
    pub(super) fn resume(
        &mut self,
        record: &Record,
        link: &mut dyn Link,
    ) -> Result<Status, LinkError> {
        let status = record.steps.last().map(|step| step.command.status);
        let status = status.unwrap_or_default();
        if matches!(status, Status::Paused | Status::EmergencyStop) {
            return link.control(&Control::Resume);
        }
        let is_aside = self.drives && self.is_a_viewers();
        if !self.waits && !is_aside {
            return Err(LinkError::Refused("nothing was interrupted".into()));
        }
        if self.explored.is_none() {
            let status = link.control(&Control::Explore)?;
            self.put_off(record);
            return Ok(status);
        }
        self.put_off(record);
        self.ending = self.next(record, link)?;
        Ok(status)
    }

    /// Returns true if the robot stands where a viewer's request took it.
    pub(super) const fn waits(&self) -> bool {
        self.waits
    }

    /// Leaves the drive in hand. One of the orders is made later.
    fn put_off(&mut self, record: &Record) {
        self.waits = false;
        if !self.drives {
            return;
        }
        if !self.is_a_viewers()
            && let Some(trip) = self.trips.last()
        {
            self.left.push_front(trip.leg);
            self.set_aside();
        }
        self.finish(None, None, record);
    }

    fn set_aside(&mut self) {
        if let Some(trip) = self.trips.last_mut() {
            trip.is_aside = true;
        }
    }

    fn is_a_viewers(&self) -> bool {
        self.trips.last().is_some_and(|trip| trip.is_aside)
    }

    fn is_on_the_way_home(&self) -> bool {
        let last = self.trips.last().filter(|_| self.drives);
        last.is_some_and(|trip| trip.leg == Leg::Home)
    }

    /// Enters the beginning of a drive.
    fn begin(&mut self, leg: Leg, record: &Record) {
        let step = record.steps.last();
        let now_ms = step.map_or(0, |step| step.truth.time_ms);
        self.drives = true;
        self.trips.push(Trip {
            leg,
            end: None,
            refused: None,
            is_aside: false,
            begun_ms: now_ms,
            ended_ms: now_ms,
            estimate: Stamped::default(),
            truth: Stamped::default(),
        });
    }

    /// Enters the end of the drive in hand.
    fn finish(&mut self, end: Option<Status>, refused: Option<String>, record: &Record) {
        if !core::mem::take(&mut self.drives) {
            return;
        }
        let (Some(trip), Some(step)) = (self.trips.last_mut(), record.steps.last()) else {
            return;
        };
        (trip.end, trip.refused) = (end, refused);
        (trip.estimate, trip.truth) = (step.estimate, step.truth);
        trip.ended_ms = step.truth.time_ms;
    }

    /// Orders the next drive that the device takes. Returns what ends the run if none is left.
    fn next(&mut self, record: &Record, link: &mut dyn Link) -> Result<Option<Ending>, LinkError> {
        while let Some(leg) = self.left.pop_front() {
            self.begin(leg, record);
            match link.control(&leg.control()) {
                Ok(_) => return Ok(None),
                Err(LinkError::Refused(reason)) => self.finish(None, Some(reason), record),
                Err(error) => return Err(error),
            }
        }
        // With a budget that is spent only home counts.
        let counts = |trip: &&Trip| !trip.is_aside && (!self.is_spent || trip.leg == Leg::Home);
        let mut failed = self.trips.iter().filter(counts);
        let ending = match failed.find(|trip| !trip.has_arrived()) {
            None if self.is_spent => Some(Ending::AtHome),
            Some(trip) => Some(Ending::Unreachable(trip.leg.errand())),
            None => self.explored.clone(),
        };
        Ok(Some(ending.unwrap_or(Ending::Interrupted)))
    }

    /// Returns the report's part on drives by order.
    pub(super) fn report(&self) -> Vec<report::Trip> {
        let home = self.home.unwrap_or_default();
        self.trips.iter().map(|trip| trip.report(&home)).collect()
    }
}

impl Leg {
    fn control(self) -> Control {
        match self {
            Self::Home => Control::Home,
            Self::Goal(at) => {
                let [x, y] = at.map(I16F16::saturating_from_num);
                Control::GoTo { x, y }
            }
        }
    }

    const fn errand(self) -> Errand {
        match self {
            Self::Home => Errand::Home,
            Self::Goal(_) => Errand::Goal,
        }
    }
}

impl Trip {
    const fn has_arrived(&self) -> bool {
        matches!(self.end, Some(Status::Arrived(_)))
    }

    /// Returns the trip for the report. `home` is where the session began.
    fn report(&self, home: &Stamped) -> report::Trip {
        let to_m = match self.leg {
            Leg::Home => [home.x_m, home.y_m],
            Leg::Goal(at) => at,
        };
        let off_m = |at: &Stamped| (at.x_m - to_m[0]).hypot(at.y_m - to_m[1]);
        let turn = self.estimate.yaw_rad - home.yaw_rad;
        let off_deg = turn.sin().atan2(turn.cos()).abs().to_degrees();
        report::Trip {
            to: super::wording::errand(self.leg.errand()).into(),
            to_m,
            reached: self.has_arrived(),
            refused: self.refused.clone(),
            error_m: off_m(&self.estimate),
            error_deg: matches!(self.leg, Leg::Home).then_some(off_deg),
            true_error_m: off_m(&self.truth),
            stands_m: [self.estimate.x_m, self.estimate.y_m],
            time_s: f64::from(self.ended_ms - self.begun_ms) / 1000.0,
        }
    }
}
