//! One run: observe, plan, drive, until something ends it.
//!
//! The planner is any [`Link`] (a device on a wire, a direct call, a baseline on the host); the
//! robot is any [`Body`]. The loop is lockstep: simulated time passes only in [`Body::drive`], so
//! commands do not depend on how long the planner takes. The same link, body and seed give the same
//! record, except for measured times.

mod account;
pub mod at_once;
mod body;
pub mod corrector;
pub mod ending;
pub mod freeze;
pub mod itinerary;
mod keeper;
pub mod map_copy;
pub mod mirror;
pub mod mission;
pub mod oracle;
pub mod planned_path;
pub mod record;
pub mod relief;
pub mod series;
pub mod showing;
pub mod sight;
pub mod snapshot;
pub mod space;
mod summary;
pub mod surprises;
pub mod team;
pub mod uneven;
mod watch;
pub mod wiring_advice;
pub mod wording;

use std::time::Instant;

use fieldline_protocol::message::{
    Command, Control, Location, Observation, Quality, Start, Status, Twist,
};

use crate::link::correction::MapCorrection;
use crate::link::{Link, LinkError};
use crate::report::tum::Stamped;
use freeze::FreezeDetector;
use itinerary::{Itinerary, Orders};
use mirror::Mirror;
use relief::Relief;
use series::Series;
use sight::Sight;
use snapshot::{Snapshot, Window};

pub use body::Body;
pub use corrector::Corrector;
pub use ending::Ending;
pub use keeper::{Keeper, Moment};
pub use map_copy::MapCopy;
use record::unstamped;
pub use record::{Record, Step};
pub use watch::{Flow, Progress, Watch};

/// Time for the robot to come to rest after the last command, milliseconds: its watchdog's 500 ms,
/// and braking from full speed at 0.3 m/s².
const REST_MS: u32 = 3_000;

/// Measures the coverage of a run.
pub trait Survey {
    /// Takes an observation, the true pose, and the planner's answer; returns the fraction of the
    /// explorable world that is known now.
    fn note(&mut self, observation: &Observation, truth: &Stamped, command: &Command) -> f64;

    /// Returns the copy of a lone robot's map, which a device that was reset gets back; `None`
    /// without one.
    fn mirror(&mut self) -> Option<&mut Mirror> {
        None
    }

    /// Returns the copy of the device's map, to be corrected with it; `None` without one.
    fn copy(&mut self) -> Option<&mut dyn MapCopy> {
        self.mirror().map(|mirror| mirror as &mut dyn MapCopy)
    }

    /// Takes what the device gets to know before its first step.
    fn know(&mut self, _known: &MapCorrection) {}

    /// Returns heights and preferences in a window that the planner solved; `None` on flat ground.
    fn relief(&self, _window: &Window) -> Option<Relief> {
        None
    }
}

/// Settings of a run.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The start message.
    pub start: Start,
    /// Simulated time after which the run ends, milliseconds.
    pub time_limit_ms: u32,
    /// Compare every heading with that of the converged window.
    pub check_field: bool,
    /// Number of pictures during the run; map and window are read for each.
    pub snapshots: usize,
    /// A device that was reset gets its map back, and the run goes on.
    pub resumes: bool,
    /// What the robot does after its exploration.
    pub orders: Orders,
    /// The map is corrected during the run, so coverage is judged by a map of the true poses.
    pub corrects: bool,
    /// The tiles that the device gets before its first step, as a correction of an empty map.
    pub known: Option<MapCorrection>,
}

/// The parts of a run.
#[expect(missing_debug_implementations, reason = "borrowed trait objects")]
pub struct Cast<'a> {
    /// The planner.
    pub link: &'a mut dyn Link,
    /// The robot.
    pub body: &'a mut dyn Body,
    /// The coverage.
    pub survey: &'a mut dyn Survey,
    /// The watcher.
    pub watch: &'a mut dyn Watch,
    /// What corrects the map.
    pub corrector: &'a mut dyn Corrector,
    /// What keeps the run.
    pub keeper: &'a mut dyn Keeper,
}

/// Runs until something ends the run. The record is complete up to the end.
pub fn run(setup: &Setup, cast: &mut Cast<'_>) -> Record {
    let mut record = Record::default();
    let mut series = Series::new(setup.snapshots);
    record.ending = match corrector::begin(setup, cast) {
        Ok(Status::Fault(fault)) => Ending::Fault(fault),
        Ok(_) => explore(setup, cast, &mut record, &mut series),
        Err(error) => Ending::Link(error),
    };
    let moment = match record.ending {
        Ending::Link(_) => Moment::Broken,
        _ => Moment::End,
    };
    if let Err(error) = keep(cast, moment, &record) {
        record.ending = Ending::Link(error);
    }
    record.snapshots = series.pick();
    bring_to_rest(cast, &record);
    read_out(cast, &mut record);
    record
}

fn explore(
    setup: &Setup,
    cast: &mut Cast<'_>,
    record: &mut Record,
    series: &mut Series<Snapshot>,
) -> Ending {
    let mut freeze = FreezeDetector::default();
    let mut itinerary = Itinerary::new(&setup.orders);
    let ending = drive(setup, cast, record, series, (&mut freeze, &mut itinerary));
    record.trips = itinerary.report();
    ending
}

fn drive(
    setup: &Setup,
    cast: &mut Cast<'_>,
    record: &mut Record,
    series: &mut Series<Snapshot>,
    (freeze, itinerary): (&mut FreezeDetector, &mut Itinerary),
) -> Ending {
    loop {
        let stands = itinerary.waits();
        let (observation, command) = match step(setup, cast, (record, itinerary), series, stands) {
            Ok(done) => done,
            Err(error) => return Ending::Link(error),
        };
        let ended = match ended(setup, cast.watch, freeze, record, &command) {
            Some(ending) => itinerary.end_or_go_on(ending, record, cast.link),
            None => itinerary.note(&command, record, cast.link),
        };
        let ended = match ended {
            Err(LinkError::Reset) if setup.resumes => {
                corrector::restore(setup, cast, (record, itinerary)).map(|()| None)
            }
            ended => ended,
        };
        let kept = ended.and_then(|ended| match ended {
            None => keep(cast, Moment::Step, record).map(|()| None),
            ended => Ok(ended),
        });
        let ended = kept.unwrap_or_else(|error| Some(Ending::Link(error)));
        cast.watch.see(&mut Sight {
            setup,
            observation: &observation,
            mirror: cast.survey.mirror().map(|mirror| &*mirror),
            ending: ended.as_ref(),
            again: false,
            record,
            itinerary: Some(itinerary),
            link: cast.link,
        });
        if let Some(ending) = ended {
            return ending;
        }
        cast.body.drive(Some(command.velocity));
        if let Some(loss) = cast.body.loss() {
            return Ending::Lost(loss);
        }
    }
}

/// Lets the keeper see the run.
fn keep(cast: &mut Cast<'_>, moment: Moment, record: &Record) -> Result<(), LinkError> {
    match cast.survey.mirror() {
        Some(mirror) => cast.keeper.keep(moment, record, mirror),
        None => Ok(()),
    }
}

/// Observes, asks the planner, and enters both in the record. Takes a snapshot if one is due.
///
/// A device that `stands`, where a viewer sent its robot, enters no scan: as one that is paused.
fn step(
    setup: &Setup,
    cast: &mut Cast<'_>,
    (record, itinerary): (&mut Record, &mut Itinerary),
    series: &mut Series<Snapshot>,
    stands: bool,
) -> Result<(Observation, Command), LinkError> {
    let (observation, truth) = (cast.body.observe(), cast.body.truth());
    let asked = Instant::now();
    let command = corrector::observe(setup, cast, (record, itinerary), &observation)?;
    let round_trip_us = asked.elapsed().as_secs_f64() * 1e6;
    let noted = Command {
        status: if stands {
            Status::Paused
        } else {
            command.status
        },
        ..command
    };
    let coverage = cast.survey.note(&observation, &truth, &noted);
    let mut step = Step::new(&observation, truth, command, round_trip_us);
    step.cycles = cast.link.end().cycles();
    let is_held = stands || command.status == Status::Paused;
    if is_held && let Some(mirror) = cast.survey.mirror() {
        step.carry(mirror.carried(&observation));
    }
    record.push(step, coverage);
    corrector::correct(setup, cast, (&observation, &command), record)?;
    if setup.check_field {
        check_field(cast.link, &command, record)?;
    }
    if series.is_due(observation.time_ms) {
        let mut snapshot = snapshot::take(cast.link, record)?;
        snapshot.relief = relief(cast, snapshot.window.as_ref());
        series.take(snapshot);
    }
    Ok((observation, command))
}

/// Returns the reason that ends the run after this step, if there is one.
fn ended(
    setup: &Setup,
    watch: &mut dyn Watch,
    freeze: &mut FreezeDetector,
    record: &Record,
    command: &Command,
) -> Option<Ending> {
    let progress = record.progress();
    let flow = watch.step(&progress);
    let truth = record.steps.last().map(|step| step.truth)?;
    match command.status {
        Status::Finished(why) => Some(Ending::Finished(why)),
        Status::Fault(why) => Some(Ending::Fault(why)),
        _ if flow == Flow::Interrupt => Some(Ending::Interrupted),
        _ if progress.time_ms >= setup.time_limit_ms => Some(Ending::TimeLimit),
        status if freeze.step(&truth, explores(status, command)) => Some(match status {
            Status::NoScan => Ending::NoScan,
            _ => Ending::Frozen,
        }),
        _ => None,
    }
}

/// Returns true if the planner says that it explores, drives by order, or waits for a scan. A lost
/// robot that searches for its place says so and may stand.
fn explores(status: Status, command: &Command) -> bool {
    let is_lost = |location: &Location| location.quality == Quality::Lost;
    status.goes_on() && !command.location.as_ref().is_some_and(is_lost)
}

/// Stops the robot. After a broken link it gets no command and drives on until its watchdog stops
/// it.
fn bring_to_rest(cast: &mut Cast<'_>, record: &Record) {
    let broken = matches!(record.ending, Ending::Link(_));
    if !broken
        && !matches!(
            record.ending,
            Ending::Finished(_) | Ending::AtHome | Ending::Unreachable(_)
        )
    {
        // If the device does not hear this, its own time limit stops it.
        let _ = cast.link.control(&Control::Stop);
    }
    let told = (!broken).then(Twist::default);
    for _ in 0..REST_MS.div_ceil(cast.body.period_ms().max(1)) {
        cast.body.drive(told);
    }
}

/// Reads map, last window, residual frontiers and counters, if the link still answers.
fn read_out(cast: &mut Cast<'_>, record: &mut Record) {
    if !matches!(record.ending, Ending::Link(_))
        && let Err(error) = snapshot::read(cast.link, record, &[])
    {
        record.read_out_error = Some(error);
    }
    record.relief = relief(cast, record.window.as_ref());
    record.link_stats = cast.link.end().stats();
}

fn relief(cast: &Cast<'_>, window: Option<&Window>) -> Option<Relief> {
    window.and_then(|window| cast.survey.relief(window))
}

fn check_field(
    link: &mut dyn Link,
    command: &Command,
    record: &mut Record,
) -> Result<(), LinkError> {
    // A step without a cycle solved no window; the link would return an older one.
    if command.status != Status::Exploring || command.cost.cycles == 0 {
        return Ok(());
    }
    let pose = record.steps.last().map(|step| unstamped(&step.estimate));
    if let Some(window) = snapshot::window(link)?
        && let Some(pose) = pose
        && let Some(error_deg) = oracle::heading_error_deg(&window, &pose, command)
    {
        record.heading_errors_deg.push(error_deg);
    }
    Ok(())
}

#[cfg(test)]
mod tests;
