//! Whole explorations, several at a time, and what a table says of each.
//!
//! A run is lockstep and seeded, so its report does not depend on the machine, nor on what else runs; only the number of
//! runs at a time does. Units in tables: seconds of simulated time, metres, per cent of what can be seen.

use core::ops::Range;
use core::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

use host_sim::baseline::{Bvp, GreedyFrontier, Session};
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, explore, on_device};
use host_sim::trial::{Flow, Progress, Record, Watch};
use host_sim::world::World;

use crate::table::{Table, number};

/// The usual strategy of the device.
pub const FRONTIER: &str = "frontier";
/// Those that only the host has the memory for.
pub const BASELINES: [&str; 2] = ["bvp", "greedy-frontier"];

/// One exploration.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Where.
    pub world: &'a World,
    /// What plans.
    pub strategy: &'a str,
    /// Decides the noise.
    pub seed: u64,
    /// Which of the world's starts.
    pub start: usize,
}

/// Nobody looks on.
#[derive(Clone, Copy, Debug)]
pub struct Unseen;

impl Watch for Unseen {
    fn step(&mut self, _: &Progress) -> Flow {
        Flow::Continue
    }
}

impl Run<'_> {
    /// Explore by the direct link.
    ///
    /// # Panics
    /// If it cannot begin.
    #[must_use]
    pub fn go(&self) -> Report {
        self.go_by("direct", planner(self.strategy).as_mut())
    }

    /// Explore by a link, and say so under its name.
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

/// Explores over a link, with nobody looking on.
///
/// # Panics
/// If it cannot begin.
pub fn explored(mission: &Mission, world: &World, link: &mut dyn Link) -> (Report, Record) {
    match explore(mission, world, link, &mut Unseen) {
        Ok(run) => run,
        Err(error) => panic!("{} by {}: {error}", world.name(), mission.link),
    }
}

/// What plans so, without bytes in between.
///
/// # Panics
/// If nothing does.
fn planner(strategy: &str) -> Box<dyn Link> {
    match strategy {
        known if on_device(known).is_some() => Box::new(Direct::new()),
        "bvp" => Box::new(Session::new(Bvp::new())),
        "greedy-frontier" => Box::new(Session::new(GreedyFrontier::default())),
        other => panic!("no strategy is called {other}"),
    }
}

/// Every world with the device's strategy and these seeds, and with each baseline and its seeds.
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

/// Explores all of them, one on each core at a time; the reports are in the order of the runs.
///
/// # Panics
/// If one cannot begin.
#[must_use]
pub fn sweep(runs: &[Run<'_>]) -> Vec<Report> {
    in_parallel(runs, Run::go)
}

/// What `work` makes of every item, one on each core at a time; in the order of the items.
///
/// # Panics
/// If `work` does.
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

/// One line a run.
#[must_use]
pub fn table(reports: &[Report]) -> Table {
    let mut table = Table::new(
        3,
        &[
            "world", "strategy", "ended", "seed", "known %", "T90 s", "T99 s", "end s", "path m",
            "overlap", "hits", "clear m", "left", "digest",
        ],
    );
    for report in reports {
        let (coverage, safety) = (&report.coverage, &report.safety);
        table.row(vec![
            report.world.clone(),
            report.strategy.clone(),
            format!("{}({})", report.outcome.status, report.outcome.reason),
            report.seed.to_string(),
            format!("{:.2}", coverage.fraction * 100.0),
            number(coverage.t90_s, 1),
            number(coverage.t99_s, 1),
            format!("{:.1}", report.sim_time_s),
            format!("{:.1}", report.path_length_m),
            number(coverage.overlap, 3),
            (safety.collisions + safety.falls + safety.tips).to_string(),
            number(safety.min_clearance_m, 3),
            report.outcome.residual_frontiers.len().to_string(),
            report.digest.chars().take(8).collect(),
        ]);
    }
    table
}

/// The mean of a quantity that every run has.
#[must_use]
pub fn mean(reports: &[&Report], of: impl Fn(&Report) -> Option<f64>) -> Option<f64> {
    let values: Option<Vec<f64>> = reports.iter().map(|report| of(report)).collect();
    let values = values.filter(|values| !values.is_empty())?;
    Some(values.iter().sum::<f64>() / values.len() as f64)
}

/// One line for each world: the mean T99 of the device's strategy beside the better baseline's.
///
/// A baseline of which a run did not come so far is not the better one; the ratio is above 1 where the device is slower.
#[must_use]
pub fn beside(reports: &[Report]) -> Table {
    let mut table = Table::new(
        2,
        &["world", "better baseline", "its T99 s", "T99 s", "ratio"],
    );
    for group in reports.chunk_by(|a, b| a.world == b.world) {
        let t99_s = |strategy: &str| {
            let runs: Vec<&Report> = group.iter().filter(|r| r.strategy == strategy).collect();
            mean(&runs, |report| report.coverage.t99_s)
        };
        let better = BASELINES
            .iter()
            .filter_map(|name| Some((*name, t99_s(name)?)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let (own_s, its_s) = (t99_s(FRONTIER), better.map(|(_, t99_s)| t99_s));
        table.row(vec![
            group[0].world.clone(),
            better.map_or("-", |(name, _)| name).into(),
            number(its_s, 1),
            number(own_s, 1),
            number(own_s.zip(its_s).map(|(own, its)| own / its), 2),
        ]);
    }
    table
}

/// What must hold of an exploration by the device, of which so much must be known at the end; what does not.
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
        faults.push("the device's map is not what it was shown".into());
    }
    faults
}

/// One line for each world and strategy, of its runs over the seeds.
///
/// T99 is a mean only where every run came so far; `hits` and `unfinished` are sums.
#[must_use]
pub fn means(reports: &[Report]) -> Table {
    let mut table = Table::new(
        2,
        &[
            "world",
            "strategy",
            "known %",
            "T90 s",
            "T99 s",
            "path m",
            "overlap",
            "hits",
            "unfinished",
        ],
    );
    for group in reports.chunk_by(|a, b| (&a.world, &a.strategy) == (&b.world, &b.strategy)) {
        let runs: Vec<&Report> = group.iter().collect();
        let mean = |of: &dyn Fn(&Report) -> Option<f64>| mean(&runs, of);
        let hits = |r: &Report| r.safety.collisions + r.safety.falls + r.safety.tips;
        table.row(vec![
            group[0].world.clone(),
            group[0].strategy.clone(),
            number(mean(&|r| Some(r.coverage.fraction * 100.0)), 2),
            number(mean(&|r| r.coverage.t90_s), 1),
            number(mean(&|r| r.coverage.t99_s), 1),
            number(mean(&|r| Some(r.path_length_m)), 1),
            number(mean(&|r| r.coverage.overlap), 3),
            group.iter().map(hits).sum::<u32>().to_string(),
            group.iter().filter(|r| !r.explored()).count().to_string(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::{Run, beside, each, means};
    use crate::worlds::builtin;
    use host_sim::report::Report;

    /// Reports of one world that say what they are given.
    fn told(rows: &[(&str, Option<f64>)]) -> Vec<Report> {
        let world = builtin("boxed-in");
        let run = Run {
            world: &world,
            strategy: "frontier",
            seed: 0,
            start: 0,
        };
        let blank = run.go();
        let report = |&(strategy, t99_s): &(&str, Option<f64>)| {
            let mut report = blank.clone();
            report.strategy = strategy.into();
            report.coverage.t99_s = t99_s;
            report
        };
        rows.iter().map(report).collect()
    }

    #[test]
    fn the_baselines_have_their_own_seeds() {
        let worlds = [builtin("loop"), builtin("hall")];
        let runs = each(&worlds, 3..5, 7..8);
        let told: Vec<_> = runs.iter().map(|run| (run.strategy, run.seed)).collect();
        let one = [
            ("frontier", 3),
            ("frontier", 4),
            ("bvp", 7),
            ("greedy-frontier", 7),
        ];
        assert_eq!(told, [one, one].concat());
    }

    #[test]
    fn a_baseline_that_did_not_come_so_far_is_not_the_better_one() {
        let reports = told(&[
            ("frontier", Some(100.0)),
            ("frontier", Some(110.0)),
            ("bvp", Some(60.0)),
            ("bvp", None),
            ("greedy-frontier", Some(80.0)),
            ("greedy-frontier", Some(88.0)),
        ]);
        let text = beside(&reports).to_string();
        let row: Vec<&str> = text.lines().nth(1).unwrap().split_whitespace().collect();
        assert_eq!(
            row,
            ["boxed-in", "greedy-frontier", "84.0", "105.0", "1.25"]
        );
        let text = beside(&told(&[("frontier", None), ("bvp", Some(1.0))])).to_string();
        assert!(
            text.ends_with("bvp                    1.0      -      -\n"),
            "{text}"
        );
    }

    #[test]
    fn a_mean_is_of_what_every_run_has() {
        let reports = told(&[("bvp", Some(60.0)), ("bvp", None), ("frontier", Some(5.0))]);
        let text = means(&reports).to_string();
        let t99 = |line: usize| text.lines().nth(line).unwrap().split_whitespace().nth(4);
        assert_eq!((t99(1), t99(2)), (Some("-"), Some("5.0")), "{text}");
    }
}
