//! Uneven ground on the emulated chip: whole runs give the same command stream as by call, bit for bit, and no step takes more than the chip has.
//!
//! | golden file | what | when |
//! | --- | --- | --- |
//! | `costs-terrain.txt` | instructions of every step of every built-in uneven world, explored to its end | `tests/run --full` |

use std::path::Path;

use fieldline_tests::runs::{explored, in_parallel};
use fieldline_tests::uneven::Tour;
use fieldline_tests::{costs, emulator, full, worlds};
use host_sim::link::direct::Direct;
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::qemu;
use host_sim::report::Report;
use host_sim::trial::mission::Mission;

/// The two that are explored in the fewest steps: a drop without a floor, and a ridge.
const WORLDS: [&str; 2] = ["causeway", "pass"];

/// The same run by call and on the chip; what the chip's was.
fn on_both(name: &str, image: &Path) -> Report {
    let world = worlds::builtin(name);
    let mission = Tour::of(&world, 0, 0).mission();
    let (clean, _) = explored(&mission, &world, &mut Direct::new());
    let line = qemu::open_line(image).expect("it started a moment ago");
    let mission = Mission {
        link: "qemu".into(),
        ..mission
    };
    let mut chip = Endpoint::new(line, RetryPolicy::LOCKSTEP, 1);
    let (report, _) = explored(&mission, &world, &mut chip);
    let facts = |r: &Report| (r.digest.clone(), r.steps, r.outcome.clone());
    assert_eq!(facts(&report), facts(&clean), "{name}");
    assert!(report.explored(), "{name}: {:?}", report.outcome);
    assert_eq!(report.debug.map_matches_mirror, Some(true));
    report
}

#[test]
fn the_emulated_chip_explores_uneven_ground_as_the_host_does() {
    if full() {
        return println!("skipped: among all worlds");
    }
    let Some(image) = emulator::image() else {
        return;
    };
    let _ = in_parallel(&WORLDS, |name| on_both(name, &image));
}

#[test]
fn every_uneven_world_costs_the_chip_no_more_than_it_has() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    let Some(image) = emulator::image() else {
        return;
    };
    let reports = in_parallel(&worlds::UNEVEN, |name| on_both(name, &image));
    costs::check("costs-terrain.txt", &reports);
}
