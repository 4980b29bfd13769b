//! Explorations of generated worlds: many seeds of each kind, so that no world was looked at while
//! constants were chosen.
//!
//! The strategy is the usual one, over the direct link, with noisy lasers and true odometry. The
//! seed of the noise is 0: the world has a seed of its own.
//!
//! The table does not say that every run is good. It says how many are not, and names them, so that
//! `host-sim explore WORLD` repeats them.

use core::fmt::Write as _;

use fieldline_tests::ends::{LEAST_COVERAGE, is_good, summary};
use fieldline_tests::runs::{FRONTIER, Run, in_parallel};
use fieldline_tests::{flat, golden};
use host_sim::report::Report;
use host_sim::world::{KINDS, Kind, World};

/// Seeds of each kind in the golden table.
const SEEDS: u64 = 334;

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
        let groups: Vec<(&str, &[Report])> = kinds
            .iter()
            .map(|(kind, reports)| (kind.word(), reports.as_slice()))
            .collect();
        let mut text = format!(
            "Seeds 0..{seeds} of each kind.\n\n{}\n",
            summary("kind", &groups)
        );
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
