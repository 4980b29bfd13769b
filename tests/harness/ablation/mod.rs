//! Ablation of the tuned constants: does the robot drive otherwise, or worse, if a constant is half
//! or double its default?
//!
//! | module | content |
//! | --- | --- |
//! | [`rooms`] | the runs that judge each room's constants |
//! | [`share`] | half and double of a constant, within its range |
//! | [`effect`] | a changed set of runs against the runs with the defaults, and the verdict |
//! | [`store`] | outcomes on the disk, so that an interrupted ablation goes on |
//! | [`page`] | the tables of `docs/ABLATION.md` |
//!
//! Every run has two limits of simulated time: one hour with the defaults, and
//! `MOST_TIMES` times the default's time with a changed constant. A run that reaches a limit, or
//! whose planner panics, did not explore.

pub mod effect;
pub mod page;
pub mod rooms;
pub mod share;
pub mod store;

use core::panic::AssertUnwindSafe;
use std::collections::BTreeMap;
use std::panic::catch_unwind;

use fieldline_planner::{Tuned, Tuning};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::world::World;

use crate::runs::{explored, in_parallel};
use crate::worlds::builtin;
use effect::{Effect, Figures, Outcome};
use rooms::{Room, Run};
use share::{DOUBLE, HALF, scaled};
use store::Store;

/// Longest time of a run with a changed constant, as a multiple of the default's.
const MOST_TIMES: f64 = 2.0;
/// Time limit of a run with the defaults, milliseconds.
const MOST_MS: u32 = 3_600_000;
/// Seeds of the noise that only measure the spread of the figures. The ablation itself has seed 0.
const OTHER_SEEDS: core::ops::Range<u64> = 1..5;

/// A changed constant.
#[derive(Clone, Debug)]
pub struct Change {
    /// The value.
    pub value: f32,
    /// Its effect on the runs of its room.
    pub effect: Effect,
}

/// The result of a constant.
#[derive(Clone, Debug)]
pub struct Row {
    /// The constant.
    pub tuned: Tuned,
    /// The changes to half and to double; `None` if the range does not allow it.
    pub changes: [Option<Change>; 2],
}

/// The result of a room.
#[derive(Clone, Debug)]
pub struct Findings {
    /// The outcomes of the runs with the defaults.
    pub defaults: Vec<Outcome>,
    /// The spread of the figures over other seeds, root mean square.
    pub noise: Figures,
    /// A row for each constant.
    pub rows: Vec<Row>,
}

/// A run with its tuning.
struct Job {
    run: usize,
    name: String,
    tuning: &'static Tuning,
    seed: u64,
    limit_ms: u32,
}

/// Makes all runs of a room: the defaults, half and double of every constant, and other seeds of
/// the defaults. Outcomes that `store` has are not made again.
///
/// # Panics
/// If a run cannot begin, or the store cannot be written.
#[must_use]
pub fn of(room: &Room, store: &Store) -> Findings {
    let bench = Bench::new(room, store);
    let defaults = bench.defaults(0);
    let rows = bench.rows(&defaults);
    let spread = OTHER_SEEDS.map(|seed| Effect::of(&defaults, &bench.defaults(seed)).figures);
    let noise = Figures::root_mean_square(&spread.collect::<Vec<_>>());
    Findings {
        defaults,
        noise,
        rows,
    }
}

/// Returns the constants of a room.
fn constants(room: &str) -> Vec<Tuned> {
    let mut constants = Vec::new();
    Tuning::DEFAULT.parameters(|tuned| {
        if tuned.room == room {
            constants.push(tuned);
        }
    });
    constants
}

/// What the runs of a room share.
struct Bench<'a> {
    room: &'a Room,
    store: &'a Store,
    worlds: BTreeMap<&'static str, World>,
}

impl<'a> Bench<'a> {
    fn new(room: &'a Room, store: &'a Store) -> Self {
        let world = |run: &Run| (run.world, builtin(run.world));
        let worlds = room.runs.iter().map(world).collect();
        Self {
            room,
            store,
            worlds,
        }
    }

    /// Makes all runs with the defaults.
    fn defaults(&self, seed: u64) -> Vec<Outcome> {
        let job = |run| Job {
            run,
            name: "default".into(),
            tuning: &Tuning::DEFAULT,
            seed,
            limit_ms: MOST_MS,
        };
        self.go(&(0..self.room.runs.len()).map(job).collect::<Vec<_>>())
    }

    /// Makes all runs with half and with double of every constant.
    fn rows(&self, defaults: &[Outcome]) -> Vec<Row> {
        let mut rows = Vec::new();
        let mut jobs = Vec::new();
        for tuned in constants(self.room.name) {
            let values = [HALF, DOUBLE].map(|share| scaled(&tuned, share));
            for (value, tuning) in values.iter().flatten() {
                let tuning: &'static Tuning = Box::leak(Box::new(*tuning));
                jobs.extend(defaults.iter().enumerate().map(|(run, default)| Job {
                    run,
                    name: format!("{}={value}", tuned.name),
                    tuning,
                    seed: 0,
                    limit_ms: (1000.0 * MOST_TIMES * default.end_s) as u32,
                }));
            }
            rows.push((tuned, values.map(|it| it.map(|(value, _)| value))));
        }
        let outcomes = self.go(&jobs);
        let mut effects = outcomes
            .chunks(defaults.len())
            .map(|it| Effect::of(defaults, it));
        let mut change = |value: Option<f32>| {
            let (value, effect) = (value?, effects.next()?);
            Some(Change { value, effect })
        };
        let row = |(tuned, values): (Tuned, [Option<f32>; 2])| Row {
            tuned,
            changes: values.map(&mut change),
        };
        rows.into_iter().map(row).collect()
    }

    /// Makes the runs. Those of the room's first run come first, so that the store of a stopped
    /// ablation has all constants of fewer runs.
    fn go(&self, jobs: &[Job]) -> Vec<Outcome> {
        let mut order: Vec<usize> = (0..jobs.len()).collect();
        order.sort_by_key(|&k| jobs[k].run);
        let outcomes = in_parallel(&order, |&k| {
            let (job, run) = (&jobs[k], &self.room.runs[jobs[k].run]);
            let key = format!("{}:{}:{}:{}", self.room.name, run.key(), job.seed, job.name);
            self.store.get_or(&key, || self.outcome(run, job))
        });
        let mut outcomes: Vec<_> = order.into_iter().zip(outcomes).collect();
        outcomes.sort_by_key(|(k, _)| *k);
        outcomes.into_iter().map(|(_, outcome)| outcome).collect()
    }

    fn outcome(&self, run: &Run, job: &Job) -> Outcome {
        let mission = run.mission(job.seed, job.limit_ms);
        let world = &self.worlds[run.world];
        let mut link = Direct::tuned(job.tuning);
        let go = || explored(&mission, world, &mut link).0;
        let report = catch_unwind(AssertUnwindSafe(go)).ok();
        report.map_or_else(Outcome::panicked, |report: Report| {
            Outcome::of(&report, run)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::rooms::ROOMS;
    use fieldline_planner::Tuning;

    #[test]
    fn every_constant_has_a_room_with_runs() {
        Tuning::DEFAULT.parameters(|tuned| {
            let room = ROOMS.iter().find(|room| room.name == tuned.room);
            assert!(room.is_some_and(|room| !room.runs.is_empty()), "{tuned}");
        });
    }
}
