//! Uneven ground on the emulated chip: the same command stream as by call.

use std::path::Path;

use fieldline_tests::emulator::{chip, image};
use fieldline_tests::runs::{assert_same, explored, in_parallel};
use fieldline_tests::uneven::UnevenRun;
use fieldline_tests::worlds;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::Mission;
use host_sim::world::World;

/// The two worlds that are explored in the fewest steps: a drop without a floor, and a ridge.
const WORLDS: [&str; 2] = ["causeway", "pass"];

/// Explores by call and on the chip; returns the chip's report.
pub(crate) fn on_both(world: &World, image: &Path) -> Report {
    let mission = UnevenRun::of(world, 0, 0).mission();
    let (by_call, _) = explored(&mission, world, &mut Direct::new());
    let mission = Mission {
        link: "qemu".into(),
        ..mission
    };
    let (report, _) = explored(&mission, world, &mut chip(image));
    assert_same(&by_call, &report);
    assert!(report.explored(), "{}: {:?}", report.world, report.outcome);
    report
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn the_chip_explores_uneven_ground_as_the_host_does() {
    let image = image();
    let _ = in_parallel(&worlds::builtins(&WORLDS), |world| on_both(world, &image));
}
