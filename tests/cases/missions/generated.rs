//! Explorations of generated worlds: many seeds of each kind, so that no world was looked at while
//! constants were chosen.
//!
//! The strategy is the usual one, over the direct link, with noisy lasers and true odometry. The
//! seed of the noise is 0: the world has a seed of its own.
//!
//! The table does not say that every run is good. It says how many are not, and names them, so that
//! `host-sim explore WORLD` repeats them.

use core::fmt::Write as _;

use fieldline_tests::runs::{FRONTIER, Run, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{flat, golden};
use host_sim::report::Report;
use host_sim::world::{KINDS, Kind, World};

/// Seeds of each kind in the golden table.
const SEEDS: u64 = 334;
/// Least share of what can be seen that is known at the end of a run that is not listed.
const LEAST_COVERAGE: f64 = 0.98;

/// Explores the worlds of a kind with seeds from 0.
fn explored(kind: Kind, seeds: u64) -> Vec<Report> {
    let names: Vec<String> = (0..seeds)
        .map(|seed| format!("{}:{seed}", kind.word()))
        .collect();
    in_parallel(&names, |name| match World::open(name) {
        Ok(world) => Run::first(&world, FRONTIER).go(),
        Err(error) => panic!("{error}"),
    })
}

fn contacts(report: &Report) -> u32 {
    report.safety.collisions + report.safety.falls + report.safety.tips
}

/// Returns true if a run ended as it should.
fn is_good(report: &Report) -> bool {
    report.explored() && contacts(report) == 0 && report.coverage.fraction >= LEAST_COVERAGE
}

/// Makes a table with one line for each kind: how its runs ended, and figures over all of them.
fn summary(kinds: &[(Kind, Vec<Report>)]) -> Table {
    let mut table = Table::new(
        1,
        &[
            "kind",
            "runs",
            "explored",
            "stuck",
            "map",
            "other",
            "listed",
            "hits",
            "clear p5 m",
            "p50 m",
            "known %",
            "least %",
            "end s",
        ],
    );
    for (kind, reports) in kinds {
        let ended = |reasons: &[&str]| {
            let of = |report: &&Report| reasons.contains(&report.outcome.reason.as_str());
            reports.iter().filter(of).count()
        };
        let counts = [
            reports.iter().filter(|report| report.explored()).count(),
            ended(&["stuck"]),
            ended(&["out-of-box", "map-full"]),
        ];
        let other = reports.len() - counts.iter().sum::<usize>();
        let listed = reports.iter().filter(|report| !is_good(report)).count();
        let clear_m = sorted(reports, |report| report.safety.min_clearance_m);
        let known = sorted(reports, |report| Some(report.coverage.fraction * 100.0));
        let end_s = sorted(reports, |report| Some(report.sim_time_s));
        let mut row = vec![kind.word().to_owned(), reports.len().to_string()];
        row.extend(counts.map(|count| count.to_string()));
        row.extend([other, listed].map(|count| count.to_string()));
        row.push(reports.iter().map(contacts).sum::<u32>().to_string());
        row.extend([5, 50].map(|per_cent| number(rank(&clear_m, per_cent), 3)));
        row.extend([number(mean(&known), 2), number(known.first().copied(), 2)]);
        row.push(number(mean(&end_s), 1));
        table.row(row);
    }
    table
}

/// Returns a figure of all runs that have it, least first.
fn sorted(reports: &[Report], of: impl Fn(&Report) -> Option<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = reports.iter().filter_map(of).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Returns a percentile by nearest rank.
fn rank(sorted: &[f64], per_cent: usize) -> Option<f64> {
    let rank = (sorted.len() * per_cent).div_ceil(100).saturating_sub(1);
    sorted.get(rank).copied()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

mod full {
    use super::*;

    /// `FIELDLINE_SEEDS=K` makes K runs of each kind and prints the table instead of comparing it.
    #[test]
    #[ignore = "takes hours: 1002 runs; tests/run --full runs it"]
    fn mazes_rooms_and_dungeons_of_every_seed() {
        let fewer = std::env::var("FIELDLINE_SEEDS").ok().map(|text| {
            text.parse().unwrap_or_else(|_| {
                panic!("FIELDLINE_SEEDS must be a number of seeds, as in FIELDLINE_SEEDS=10")
            })
        });
        let seeds = fewer.unwrap_or(SEEDS);
        let kinds = KINDS.map(|kind| (kind, explored(kind, seeds)));
        let runs = kinds.iter().flat_map(|(_, reports)| reports);
        let listed: Vec<Report> = runs.filter(|report| !is_good(report)).cloned().collect();
        let mut text = format!("Seeds 0..{seeds} of each kind.\n\n{}\n", summary(&kinds));
        let _ = write!(
            text,
            "Runs that did not end explored, touched something, or know less than {} %.\n\n{}",
            LEAST_COVERAGE * 100.0,
            flat::table(&listed)
        );
        if fewer.is_some() {
            println!("{text}");
        } else {
            golden::compare("generated-full.txt", &text);
        }
    }
}
