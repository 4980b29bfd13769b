//! Real and built-in buildings by every strategy for one robot, beside the reference: true
//! odometry, five seeds, over the direct link.
//!
//! The tables say how the runs ended, their least clearances, and times as ratios to
//! `greedy-frontier`. They name the runs that did not end as they should, so that `host-sim explore
//! WORLD` repeats them.

use core::fmt::Write as _;

use fieldline_tests::ends::{LEAST_COVERAGE, is_good, summary};
use fieldline_tests::orders::{by_world, strategies, sweep, table};
use fieldline_tests::{flat, golden, worlds};
use host_sim::report::Report;
use host_sim::world::World;

const SEEDS: [u64; 5] = [0, 1, 2, 3, 4];

fn check(name: &str, worlds: &[World]) {
    let strategies = strategies();
    let reports = sweep(worlds, &SEEDS, &strategies);
    let names = strategies.iter().map(|strategy| strategy.name);
    let groups: Vec<(&str, &[Report])> = names.zip(reports.iter().map(Vec::as_slice)).collect();
    let mut text = format!(
        "{} worlds, seeds {SEEDS:?}.\n\n{}\n",
        worlds.len(),
        summary("strategy", &groups)
    );
    let _ = write!(
        text,
        "Ratios to greedy-frontier in the same world with the same seed.\n\n{}\n\
         The usual strategy in each world.\n\n{}\n",
        table(&strategies, &reports),
        by_world(&strategies, &reports)
    );
    let of_device = reports
        .iter()
        .flatten()
        .filter(|run| run.strategy != "greedy-frontier");
    let listed: Vec<Report> = of_device.filter(|run| !is_good(run)).cloned().collect();
    let _ = write!(
        text,
        "Runs on the device that did not end explored, touched something, or know less than {} \
         %.\n\n{}",
        LEAST_COVERAGE * 100.0,
        flat::table(&listed)
    );
    golden::compare(&format!("{name}.txt"), &text);
}

mod full {
    use super::{check, worlds};

    #[test]
    #[ignore = "takes a quarter of an hour: 280 runs; tests/run --full runs it"]
    fn buildings_that_are_built_in() {
        let names = [worlds::EXPLORABLE, worlds::PUBLISHED].concat();
        check("buildings-full", &worlds::builtins(&names));
    }
}

mod data {
    use super::{check, worlds};

    #[test]
    #[ignore = "needs worlds drawn by others (FIELDLINE_DATA) and takes half an hour"]
    fn buildings_that_others_drew() {
        check("buildings-data", &worlds::drawn_by_others());
    }
}
