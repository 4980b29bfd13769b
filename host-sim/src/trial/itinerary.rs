//! What a robot is ordered to do after its exploration: goals, and then home.
//!
//! ```text
//! explore ─► goal ─► goal ─► … ─► home ─► end
//!    └──────────┴── the budget is spent, ─┘
//!                   or it is time
//! ```
//!
//! A goal that is refused or cannot be reached is left, and the next one is tried. The exploration
//! may have ended in any way that leaves the robot where it knows its place. During a pause the
//! robot stands and waits.
//!
//! A device that was reset and got its map back has forgotten its orders: home, the drive in hand,
//! a pause, and what of its budget is used. It is told them again.
//!
//! A viewer's request to drive comes before all of this. The drive that it cuts short is made
//! later, the
//! robot stands where the request took it, and *resume* goes on with what was to be done.
//!
//! Units: metres and radians in the device's map; milliseconds; in reports degrees.

mod trip;

use std::collections::VecDeque;

use fieldline_protocol::message::{Budget, Command, Control, Errand, Finish, Status};

use super::{Ending, Record};
use crate::link::{Link, LinkError};
use crate::report;
use crate::report::tum::Stamped;
use trip::{Leg, Trip, tell};

/// What the robot does after its exploration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Orders {
    /// Places to drive to, in this order.
    pub goals_m: Vec<[f64; 2]>,
    /// True if it then drives home.
    pub home: bool,
    /// What it may drive before it must be home. The device turns home by itself.
    pub budget: Budget,
    /// Time at which it drives home at the latest, whatever it does.
    pub home_at_ms: Option<u32>,
    /// When it stands and waits.
    pub pauses: Vec<Pause>,
}

/// Most pauses of a run.
pub const MOST_PAUSES: usize = 100;

/// A time in which the robot stands and waits, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pause {
    /// Its beginning.
    pub from_ms: u32,
    /// Its end, which is later.
    pub to_ms: u32,
}

impl Pause {
    const fn holds(&self, now_ms: u32) -> bool {
        self.from_ms <= now_ms && now_ms < self.to_ms
    }
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
    /// The robot went home before the end: its budget was spent, or it was time.
    is_early: bool,
    home_at_ms: Option<u32>,
    pauses: Vec<Pause>,
    is_paused: bool,
    /// The device was reset, and has not been told the drive in hand again.
    is_owed: bool,
    /// What the device was told that the robot may drive, and the way so far, metres.
    budget: Budget,
    driven_m: f64,
    /// The last trip was a viewer's, and the robot stands at its end.
    waits: bool,
    /// What ends the run with the next step: no order is left after a viewer's request.
    ending: Option<Ending>,
}

impl Itinerary {
    /// Makes the itinerary of these orders.
    pub(super) fn new(orders: &Orders) -> Self {
        let goals = orders.goals_m.iter().map(|goal| Leg::Goal(*goal));
        let home = orders.home || orders.home_at_ms.is_some();
        Self {
            left: goals.chain(home.then_some(Leg::Home)).collect(),
            home_at_ms: orders.home_at_ms,
            pauses: orders.pauses.clone(),
            budget: orders.budget,
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
        if may_drive && self.is_owed && self.in_hand().is_some() {
            return self.repeat(record, link);
        }
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
        if let [.., before, now] = &record.steps[..] {
            let (before, now) = (before.estimate, now.estimate);
            self.driven_m += (now.x_m - before.x_m).hypot(now.y_m - before.y_m);
        }
        if let Some(ending) = self.ending.take() {
            return Ok(Some(ending));
        }
        match command.status {
            Status::Going(Errand::Home) if !self.is_on_the_way_home() => {
                self.turn_home(record);
                self.left.clear();
                self.begin(Leg::Home, record);
            }
            Status::Arrived(_) | Status::Unreachable(_) if self.waits => {}
            status @ (Status::Arrived(_) | Status::Unreachable(_)) => {
                self.finish(Some(status), None, record);
                self.waits = self.is_a_viewers();
                if !self.waits {
                    return self.next(record, link);
                }
            }
            _ => {}
        }
        self.pause_or_resume(now_ms(record), link)?;
        // A device that has seen nothing takes no order. One that was reset in a pause sees
        // nothing until it is over.
        if self.is_paused || matches!(command.status, Status::NoScan | Status::Paused) {
            return Ok(None);
        }
        if self.is_owed {
            return self.repeat(record, link);
        }
        if self.is_time(record) {
            self.turn_home(record);
            self.left = VecDeque::from([Leg::Home]);
            return self.next(record, link);
        }
        Ok(None)
    }

    /// Orders the drive in hand again.
    fn repeat(
        &mut self,
        record: &Record,
        link: &mut dyn Link,
    ) -> Result<Option<Ending>, LinkError> {
        if let Some(leg) = self.in_hand()
            && let Some(refused) = tell(leg, link)?
        {
            self.is_owed = false;
            self.finish(None, Some(refused), record);
            return self.next(record, link);
        }
        self.is_owed = false;
        Ok(None)
    }

    /// Returns true once it is time to drive home, if the robot is not on its way there.
    fn is_time(&self, record: &Record) -> bool {
        let is_late = self.home_at_ms.is_some_and(|at_ms| now_ms(record) >= at_ms);
        is_late && !self.is_early && !self.is_on_the_way_home()
    }

    /// Ends the drive in hand, because the robot turns home.
    fn turn_home(&mut self, record: &Record) {
        self.finish(None, None, record);
        (self.is_early, self.waits) = (true, false);
    }

    /// Lets the robot stand, or go on.
    fn pause_or_resume(&mut self, now_ms: u32, link: &mut dyn Link) -> Result<(), LinkError> {
        let is_due = self.pauses.iter().any(|pause| pause.holds(now_ms));
        if is_due != self.is_paused {
            link.control(if is_due {
                &Control::Pause
            } else {
                &Control::Resume
            })?;
            self.is_paused = is_due;
        }
        Ok(())
    }

    /// Returns the drive in hand.
    fn in_hand(&self) -> Option<Leg> {
        let trip = self.trips.last()?;
        trip.ended_ms.is_none().then_some(trip.leg)
    }

    /// Returns what is left of the budget, for a device that begins anew. A device counts what it
    /// drives and how long it takes from the beginning of its session.
    pub(super) fn budget_left(&self, record: &Record) -> Budget {
        let less = |all: u16, used: f64| all.saturating_sub(used.ceil() as u16).max(1);
        let used_s = f64::from(now_ms(record)) / 1000.0;
        Budget {
            range_m: self.budget.range_m.map(|all| less(all, self.driven_m)),
            time_s: self.budget.time_s.map(|all| less(all, used_s)),
        }
    }

    /// Notes that the device was reset and got its map back. A pause goes on, and the drive in hand
    /// is ordered again after the next step.
    ///
    /// # Errors
    /// [`LinkError`] if the link fails.
    pub(super) fn take_up(&mut self, link: &mut dyn Link) -> Result<(), LinkError> {
        self.is_owed = true;
        if self.is_paused {
            link.control(&Control::Pause)?;
        }
        Ok(())
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
        let is_aside = self.in_hand().is_some() && self.is_a_viewers();
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
        if self.in_hand().is_none() {
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
        self.in_hand() == Some(Leg::Home)
    }

    /// Enters the beginning of a drive.
    fn begin(&mut self, leg: Leg, record: &Record) {
        self.trips.push(Trip {
            leg,
            end: None,
            refused: None,
            is_aside: false,
            begun_ms: now_ms(record),
            ended_ms: None,
            estimate: Stamped::default(),
            truth: Stamped::default(),
        });
    }

    /// Enters the end of the drive in hand.
    fn finish(&mut self, end: Option<Status>, refused: Option<String>, record: &Record) {
        if self.in_hand().is_none() {
            return;
        }
        let (Some(trip), Some(step)) = (self.trips.last_mut(), record.steps.last()) else {
            return;
        };
        (trip.end, trip.refused) = (end, refused);
        (trip.estimate, trip.truth) = (step.estimate, step.truth);
        trip.ended_ms = Some(step.truth.time_ms);
    }

    /// Orders the next drive that the device takes. Returns what ends the run if none is left.
    fn next(&mut self, record: &Record, link: &mut dyn Link) -> Result<Option<Ending>, LinkError> {
        while let Some(leg) = self.left.pop_front() {
            self.begin(leg, record);
            match tell(leg, link)? {
                None => return Ok(None),
                Some(reason) => self.finish(None, Some(reason), record),
            }
        }
        // Of a robot that went home before the end only home counts.
        let counts = |trip: &&Trip| !trip.is_aside && (!self.is_early || trip.leg == Leg::Home);
        let mut failed = self.trips.iter().filter(counts);
        let ending = match failed.find(|trip| !trip.has_arrived()) {
            None if self.is_early => Some(Ending::AtHome),
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

/// Returns the time of the last step, milliseconds.
fn now_ms(record: &Record) -> u32 {
    record.steps.last().map_or(0, |step| step.truth.time_ms)
}
