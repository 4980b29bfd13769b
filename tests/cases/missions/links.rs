//! Links: a run by bytes gives the same command stream as a run by call, also if bytes are lost or
//! damaged on the way.
//!
//! Equal digests mean equal velocities and statuses, bit for bit, in every step
//! (`host_sim::link::digest`). The `chip` cases do the same on the emulated chip.

use std::sync::LazyLock;

use fieldline_tests::runs::{FRONTIER, Run, assert_same, in_parallel};
use fieldline_tests::worlds;
use host_sim::link::Link;
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::fault::{Faults, Faulty};
use host_sim::link::loopback::{LocalDevice, loopback};
use host_sim::report::Report;
use host_sim::world::World;

/// All faults at once.
const EVERY_FAULT: &str = "drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.02,delay=0.05";

/// Small worlds, each explored in a few hundred steps, and their runs by call.
static BY_CALL: LazyLock<Vec<(World, Report)>> = LazyLock::new(|| {
    let names = ["narrow-doors", "hall", "cluttered"];
    in_parallel(&names, |name| {
        let world = worlds::builtin(name);
        let report = Run::first(&world, FRONTIER).go();
        (world, report)
    })
});

/// Makes a run over a link.
fn by(name: &str, world: &World, link: &mut dyn Link) -> Report {
    Run::first(world, FRONTIER).go_by(name, link)
}

/// Returns a link with faults on its line, to a device in this process.
pub(crate) fn faulty(faults: &str, seed: u64) -> Endpoint<Faulty<LocalDevice>> {
    let faults: Faults = faults.parse().expect("a fault specification");
    let line = Faulty::new(LocalDevice::new(), faults, seed);
    Endpoint::new(line, RetryPolicy::VIRTUAL, 1)
}

#[test]
fn bytes_change_nothing() {
    for (world, clean) in BY_CALL.iter() {
        assert_same(clean, &by("loopback", world, &mut loopback()));
    }
}

#[test]
fn faults_on_the_line_change_nothing() {
    let (world, clean) = &BY_CALL[0];
    for faults in [
        "drop=0.02",
        "duplicate=0.02",
        "corrupt=0.02",
        "truncate=0.02",
        "delay=0.05",
        EVERY_FAULT,
    ] {
        let report = by(faults, world, &mut faulty(faults, 1));
        assert_same(clean, &report);
        let stats = &report.link_stats;
        let noticed = stats.retries + stats.dropped + stats.crc_errors;
        assert!(noticed > 0, "{faults} had no effect: {stats:?}");
    }
}

#[test]
fn faults_on_the_line_change_nothing_in_any_small_world() {
    for (seed, (world, clean)) in (2..).zip(BY_CALL.iter()) {
        let report = by(EVERY_FAULT, world, &mut faulty(EVERY_FAULT, seed));
        assert_same(clean, &report);
    }
}
