//! Whole explorations, several at a time, and assertions about them.
//!
//! A run is lockstep and seeded: its report depends neither on the machine nor on its load.

use core::fmt::Write as _;
use core::ops::Range;
use core::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

use fieldline_planner::Tuning;
use host_sim::baseline::{Bvp, GreedyFrontier, Session};
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::Record;
use host_sim::trial::mission::{Mission, explore, on_device};
use host_sim::world::World;

/// The device's usual strategy.
pub const FRONTIER: &str = "frontier";
/// Strategies that only a host has the memory for.
pub const BASELINES: [&str; 2] = ["bvp", "greedy-frontier"];

/// One exploration to run.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// World to explore.
    pub world: &'a World,
    /// Strategy that plans.
    pub strategy: &'a str,
    /// Seed of the noise.
    pub seed: u64,
    /// Index of the start in the world.
    pub start: usize,
}

impl<'a> Run<'a> {
    /// Makes the usual run: seed 0 from the first start.
    #[must_use]
    pub const fn first(world: &'a World, strategy: &'a str) -> Self {
        Self {
            world,
            strategy,
            seed: 0,
            start: 0,
        }
    }

    /// Explores over the direct link.
    ///
    /// # Panics
    /// If it cannot begin.
    #[must_use]
    pub fn go(&self) -> Report {
        self.go_by("direct", planner(self.strategy).as_mut())
    }

    /// Explores over a link; `name` is its name in the report.
    ///
    /// # Panics
    /// If it cannot begin.
    pub fn go_by(&self, name: &str, link: &mut dyn Link) -> Report {
        let mission = Mission {
            strategy: self.strategy.into(),
            link: name.into(),
            seed: self.seed,
            start: self.start,
            ..Mission::default()
        };
        explored(&mission, self.world, link).0
    }
}

/// Explores over a link.
///
/// # Panics
/// If it cannot begin.
pub fn explored(mission: &Mission, world: &World, link: &mut dyn Link) -> (Report, Record) {
    match explore(mission, world, link, &mut ()) {
        Ok(run) => run,
        Err(error) => panic!("{} by {}: {error}", world.name(), mission.link),
    }
}

/// Returns the planner of a strategy, reached without bytes in between.
///
/// # Panics
/// If no strategy has that name.
fn planner(strategy: &str) -> Box<dyn Link> {
    match strategy {
        known if on_device(known).is_some() => Box::new(Direct::new()),
        "bvp" => Box::new(Session::new(Bvp::new())),
        "greedy-frontier" => Box::new(Session::new(GreedyFrontier::default())),
        other => panic!("no strategy is called {other}"),
    }
}

/// Lists runs of every world: the device's strategy with `seeds`, each baseline with its own seeds.
#[must_use]
pub fn each(worlds: &[World], seeds: Range<u64>, baseline_seeds: Range<u64>) -> Vec<Run<'_>> {
    let strategies = || {
        let baselines = BASELINES.map(|name| (name, baseline_seeds.clone()));
        core::iter::once((FRONTIER, seeds.clone())).chain(baselines)
    };
    let mut runs = Vec::new();
    for world in worlds {
        for (strategy, seeds) in strategies() {
            runs.extend(seeds.map(|seed| Run {
                world,
                strategy,
                seed,
                start: 0,
            }));
        }
    }
    runs
}

/// Makes all runs, one on each core at a time; returns the reports in the order of the runs.
///
/// # Panics
/// If one cannot begin.
#[must_use]
pub fn sweep(runs: &[Run<'_>]) -> Vec<Report> {
    in_parallel(runs, Run::go)
}

/// Applies `work` to every item, one on each core at a time; returns results in the items' order.
///
/// # Panics
/// If `work` panics.
#[must_use]
pub fn in_parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some((k, item)) = take(&next, items) {
                    let result = work(item);
                    if let Ok(mut done) = done.lock() {
                        done.push((k, result));
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(k, _)| *k);
    assert_eq!(done.len(), items.len(), "a run was lost");
    done.into_iter().map(|(_, result)| result).collect()
}

fn take<'a, T>(next: &AtomicUsize, items: &'a [T]) -> Option<(usize, &'a T)> {
    let k = next.fetch_add(1, Ordering::Relaxed);
    items.get(k).map(|item| (k, item))
}

/// Returns the mean of a quantity; `None` if a run does not have it.
#[must_use]
pub fn mean(reports: &[&Report], of: impl Fn(&Report) -> Option<f64>) -> Option<f64> {
    let values: Option<Vec<f64>> = reports.iter().map(|report| of(report)).collect();
    let values = values.filter(|values| !values.is_empty())?;
    Some(values.iter().sum::<f64>() / values.len() as f64)
}

/// Asserts that a run over another link is the same as the run by call: its command stream, its
/// number of steps, its outcome; that it explored; and that the device's map is right.
///
/// # Panics
/// If one of these does not hold.
pub fn assert_same(by_call: &Report, other: &Report) {
    let (world, outcome) = (&by_call.world, &by_call.outcome);
    assert!(by_call.explored(), "{world}: {outcome:?}");
    let facts = |report: &Report| (report.digest.clone(), report.steps, report.outcome.clone());
    assert_eq!(facts(other), facts(by_call), "{world} by {}", other.link);
    assert_eq!(other.debug.map_matches_mirror, Some(true), "{world}");
}

/// Lists what is wrong with an exploration by the device. At least the share `least_coverage` must
/// be known at the end.
#[must_use]
pub fn faults(report: &Report, least_coverage: f64) -> Vec<String> {
    let (outcome, safety) = (&report.outcome, &report.safety);
    let mut faults = Vec::new();
    if !report.explored() {
        faults.push(format!("{} ({})", outcome.status, outcome.reason));
    }
    if report.coverage.fraction < least_coverage {
        faults.push(format!("coverage {:.4}", report.coverage.fraction));
    }
    for (count, what) in [
        (safety.collisions, "collisions"),
        (safety.falls, "falls"),
        (safety.tips, "tips"),
    ] {
        if count > 0 {
            faults.push(format!("{count} {what}"));
        }
    }
    if report.debug.map_matches_mirror != Some(true) {
        faults.push("the device's map differs from the host's copy".into());
    }
    faults
}

/// Asserts that no run has faults. `faults` lists those of one run.
///
/// # Panics
/// If a run has faults. The message lists them all.
pub fn assert_faultless<'a>(
    reports: impl IntoIterator<Item = &'a Report>,
    faults: impl Fn(&Report) -> Vec<String>,
) {
    let mut list = String::new();
    for report in reports {
        let (world, strategy) = (&report.world, &report.strategy);
        let (start, seed) = (report.start, report.seed);
        for fault in faults(report) {
            let _ = writeln!(
                list,
                "{world} {strategy} start {start} seed {seed}: {fault}"
            );
        }
    }
    assert!(list.is_empty(), "\n{list}");
}

/// Returns the tuned constants with other values than their defaults. A planner refers to them for
/// as long as the program runs.
///
/// # Panics
/// If a constant is unknown or beyond its range.
#[must_use]
pub fn tuned(changes: &[(&str, f32)]) -> &'static Tuning {
    let mut tuning = Tuning::DEFAULT;
    for &(name, value) in changes {
        if let Err(error) = tuning.set(name, value) {
            panic!("{name}: {error}");
        }
    }
    Box::leak(Box::new(tuning))
}

#[cfg(test)]
mod tests {
    use super::each;
    use crate::worlds::builtin;

    #[test]
    fn the_baselines_have_their_own_seeds() {
        let worlds = [builtin("loop"), builtin("hall")];
        let runs = each(&worlds, 3..5, 7..8);
        let listed: Vec<_> = runs.iter().map(|run| (run.strategy, run.seed)).collect();
        let one = [
            ("frontier", 3),
            ("frontier", 4),
            ("bvp", 7),
            ("greedy-frontier", 7),
        ];
        assert_eq!(listed, [one, one].concat());
    }
}
