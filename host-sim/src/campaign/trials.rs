//! The trials of a campaign on several threads.
//!
//! ```text
//! trials → the next one to whichever thread is free → results, as they finish → one writer
//! ```
//!
//! A trial is deterministic, and its number orders it, so no result depends on the threads. A panic
//! ends its trial and is that trial's failure.

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::io;
use std::sync::mpsc;
use std::thread;
use std::time::Instant;

use serde_json::value::RawValue;

use super::CampaignError;
use super::plan::Trial;
use super::store::{self, Finished, Measured};
use crate::panics::caught;
use crate::report::Report;
use crate::trial::series::Series;
use crate::trial::{Flow, Progress, Record, Watch};

/// Moments of a trial whose coverage is kept, beside its begin and its end.
const MOMENTS: usize = 50;
/// Stack of a thread, bytes: as much as the main thread has.
const STACK: usize = 8 << 20;
/// Error of a pose that counts as small, metres.
const SMALL_ERROR_M: f64 = 1.0;

/// Makes the run of a trial.
pub trait Explore: Sync {
    /// Makes the run that `host-sim explore` makes with these arguments.
    ///
    /// # Errors
    /// Why the run could not begin.
    fn explore(
        &self,
        arguments: &[String],
        watch: &mut dyn Watch,
    ) -> Result<(Report, Record), String>;
}

/// Who runs the trials, and who hears of them.
#[expect(missing_debug_implementations, reason = "borrowed trait objects")]
pub struct Crew<'a> {
    /// Makes the runs.
    pub explorer: &'a dyn Explore,
    /// Number of threads.
    pub jobs: usize,
    /// Returns true once the campaign is to end; running trials are then given up.
    pub interrupted: &'a (dyn Fn() -> bool + Sync),
}

/// Runs the trials; `heard` gets each result as it finishes. If it fails, no further trial begins
/// and those that run are given up.
///
/// # Errors
/// The error of `heard`, or the system has no threads.
pub fn run(
    crew: &Crew<'_>,
    trials: &[Trial],
    heard: &mut dyn FnMut(Finished) -> Result<(), CampaignError>,
) -> Result<(), CampaignError> {
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    // Without a buffer: no trial begins whose thread could not give its last result away.
    let (send, results) = mpsc::sync_channel::<Finished>(0);
    let is_over = || stop.load(Ordering::Relaxed) || (crew.interrupted)();
    let work = |send: mpsc::SyncSender<Finished>| {
        while !is_over() {
            let Some(trial) = trials.get(next.fetch_add(1, Ordering::Relaxed)) else {
                break;
            };
            let done = one(crew.explorer, trial, &is_over);
            // The writer is gone only after an error of its own.
            if done.is_some_and(|done| send.send(done).is_err()) {
                break;
            }
        }
    };
    thread::scope(|scope| {
        let hired = (0..crew.jobs.clamp(1, trials.len().max(1))).try_for_each(|_| {
            let (send, work) = (send.clone(), &work);
            let thread = thread::Builder::new().stack_size(STACK);
            thread.spawn_scoped(scope, move || work(send)).map(|_| ())
        });
        drop(send);
        let heard = results.into_iter().try_for_each(heard);
        stop.store(heard.is_err(), Ordering::Relaxed);
        heard.and(hired.map_err(|error| no_threads(&error)))
    })
}

fn no_threads(error: &io::Error) -> CampaignError {
    CampaignError::new(format!(
        "cannot begin a thread: {error}; say a smaller --jobs"
    ))
}

/// Makes one trial; `None` if it was given up.
fn one(explorer: &dyn Explore, trial: &Trial, is_over: &dyn Fn() -> bool) -> Option<Finished> {
    let began = Instant::now();
    let mut sampler = Sampler {
        series: Series::new(MOMENTS),
        first: None,
        last: [0.0; 2],
        is_over,
        given_up: false,
    };
    let result = caught(|| explorer.explore(&trial.arguments(), &mut sampler));
    if sampler.given_up {
        return None;
    }
    let result = match result {
        Ok(result) => result,
        Err((place, text)) => Err(format!("panicked at {place}: {text}")),
    };
    Some(match result {
        Ok((report, record)) => measured(trial, &report, &record, sampler, began),
        Err(failure) => Finished::failed(trial, failure),
    })
}

fn measured(
    trial: &Trial,
    report: &Report,
    record: &Record,
    sampler: Sampler<'_>,
    began: Instant,
) -> Finished {
    let Ok(raw) = RawValue::from_string(report.to_json_line()) else {
        return Finished::failed(trial, "the report has no text".into());
    };
    Finished {
        command: store::command(trial),
        failure: None,
        trial: Some(Measured {
            explored: report.explored(),
            below_1m: below_1m(record),
            wall_s: (began.elapsed().as_secs_f64() * 100.0).round() / 100.0,
        }),
        coverage: sampler.coverage(),
        report: Some(raw),
        ..Finished::failed(trial, String::new())
    }
}

/// Returns the share of the steps whose estimated position is less than 1 m off.
fn below_1m(record: &Record) -> Option<f64> {
    let small = record.steps.iter().filter(|step| {
        let (estimate, truth) = (step.estimate, step.truth);
        (estimate.x_m - truth.x_m).hypot(estimate.y_m - truth.y_m) < SMALL_ERROR_M
    });
    let steps = record.steps.len();
    (steps > 0).then(|| small.count() as f64 / steps as f64)
}

/// Keeps the coverage of a trial evenly in simulated time, and gives the trial up when the campaign
/// is to end.
struct Sampler<'a> {
    series: Series<[f64; 2]>,
    first: Option<[f64; 2]>,
    last: [f64; 2],
    is_over: &'a dyn Fn() -> bool,
    given_up: bool,
}

impl Sampler<'_> {
    /// Returns seconds and share known: the first step, the moments, the last step.
    fn coverage(self) -> Vec<[f64; 2]> {
        let mut coverage: Vec<[f64; 2]> = self.first.into_iter().collect();
        coverage.extend(self.series.pick());
        if coverage.last().is_some_and(|last| last[0] < self.last[0]) {
            coverage.push(self.last);
        }
        coverage
    }
}

impl Watch for Sampler<'_> {
    fn step(&mut self, progress: &Progress) -> Flow {
        // Four digits are enough for a plot.
        let share = (progress.coverage * 1e4).round() / 1e4;
        self.last = [f64::from(progress.time_ms) / 1000.0, share];
        self.first.get_or_insert(self.last);
        if self.series.is_due(progress.time_ms) {
            self.series.take(self.last);
        }
        self.given_up = (self.is_over)();
        if self.given_up {
            Flow::Interrupt
        } else {
            Flow::Continue
        }
    }
}

#[cfg(test)]
mod tests;
