//! Flat worlds on the emulated chip: the same command stream as by call, and the cost of every
//! step.
//!
//! `golden/costs.txt` has the exact number of instructions of every step in three small worlds.

use std::path::Path;

use fieldline_protocol::BAUD;
use fieldline_tests::emulator::{chip, image};
use fieldline_tests::runs::{FRONTIER, Run, assert_same, in_parallel};
use fieldline_tests::{costs, worlds};
use host_sim::link::{qemu::PtyBoard, serial};
use host_sim::report::Report;
use host_sim::world::World;

/// Small worlds, each explored in a few hundred steps.
const SMALL: [&str; 3] = ["narrow-doors", "hall", "cluttered"];

/// Explores by call and on the chip; returns the chip's report.
pub(crate) fn on_both(world: &World, image: &Path) -> Report {
    let run = Run::first(world, FRONTIER);
    let report = run.go_by("qemu", &mut chip(image));
    assert_same(&run.go(), &report);
    report
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn the_chip_explores_as_the_host_does_within_its_budget() {
    let image = image();
    let reports = in_parallel(&worlds::builtins(&SMALL), |world| on_both(world, &image));
    costs::check("costs.txt", &reports);
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
