//! Uneven ground on the emulated chip: the same command stream as by call.

use std::sync::LazyLock;

use fieldline_tests::emulator::{chip, image, watched_chip};
use fieldline_tests::runs::{assert_same, explored, in_parallel};
use fieldline_tests::uneven::UnevenRun;
use fieldline_tests::worlds;
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::Mission;
use host_sim::world::World;

/// The two worlds that are explored in the fewest steps: a drop without a floor, and a ridge.
const WORLDS: [&str; 2] = ["causeway", "pass"];

/// The first of them by call and on the chip, with the plugin that counts cycles.
pub(crate) static COUNTED: LazyLock<Report> = LazyLock::new(|| {
    let world = worlds::builtin(WORLDS[0]);
    on_both(&world, &mut watched_chip(&image()))
});

/// Explores by call and on the chip; returns the chip's report.
pub(crate) fn on_both(world: &World, chip: &mut dyn Link) -> Report {
    let mission = UnevenRun::of(world, 0, 0).mission();
    let (by_call, _) = explored(&mission, world, &mut Direct::new());
    let mission = Mission {
        link: "qemu".into(),
        ..mission
    };
    let (report, _) = explored(&mission, world, chip);
    assert_same(&by_call, &report);
    assert!(report.explored(), "{}: {:?}", report.world, report.outcome);
    report
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn the_chip_explores_uneven_ground_as_the_host_does() {
    let image = image();
    let reports = in_parallel(&WORLDS, |&name| match name == WORLDS[0] {
        true => COUNTED.clone(),
        // The plugin takes time, so one run is without it.
        false => on_both(&worlds::builtin(name), &mut chip(&image)),
    });
    assert_eq!(reports.len(), WORLDS.len());
}
