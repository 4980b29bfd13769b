//! Flat worlds on the emulated chip: the same command stream as by call, and the cost of every
//! step. The plugin that counts cycles is loaded, so it changes no command.
//!
//! `golden/costs.txt` has the exact number of instructions of every step in three small worlds.

use std::sync::LazyLock;

use fieldline_protocol::BAUD;
use fieldline_tests::emulator::{image, watched_chip};
use fieldline_tests::runs::{FRONTIER, Run, assert_same, in_parallel};
use fieldline_tests::{costs, worlds};
use host_sim::link::{Link, qemu::PtyBoard, serial};
use host_sim::report::Report;
use host_sim::world::World;

/// Small worlds, each explored in a few hundred steps.
const SMALL: [&str; 3] = ["narrow-doors", "hall", "cluttered"];

/// The small worlds by call and on the chip, with the plugin that counts cycles.
pub(crate) static RUNS: LazyLock<Vec<Report>> = LazyLock::new(|| {
    let image = image();
    in_parallel(&worlds::builtins(&SMALL), |world| {
        on_both(world, &mut watched_chip(&image))
    })
});

/// Explores by call and on the chip; returns the chip's report.
pub(crate) fn on_both(world: &World, chip: &mut dyn Link) -> Report {
    let run = Run::first(world, FRONTIER);
    let report = run.go_by("qemu", chip);
    assert_same(&run.go(), &report);
    report
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn the_chip_explores_as_the_host_does_within_its_budget() {
    costs::check("costs.txt", &RUNS);
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn a_serial_port_explores_as_the_host_does() {
    let image = image();
    for world in SMALL.map(worlds::builtin) {
        let board = PtyBoard::start(&image).expect("the image starts in QEMU");
        let mut port = serial::serial(board.device(), BAUD).expect("the port is there");
        let run = Run::first(&world, FRONTIER);
        assert_same(&run.go(), &run.go_by("serial", &mut port));
    }
}
