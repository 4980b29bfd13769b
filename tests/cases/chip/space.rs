//! Space-based fields on the emulated chip: the same command stream as by call, and the cost of
//! every step.
//!
//! `golden/costs-space.txt` has two small worlds: one of the paper, and one twice as wide
//! as the range of the lasers.

use fieldline_tests::emulator::{chip, image};
use fieldline_tests::runs::{Run, assert_same, in_parallel};
use fieldline_tests::{costs, worlds};

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn the_chip_follows_forces_as_the_host_does_within_its_budget() {
    let image = image();
    let reports = in_parallel(&worlds::builtins(&["c-room", "hall"]), |world| {
        let run = Run::first(world, "esbpf");
        let report = run.go_by("qemu", &mut chip(&image));
        assert_same(&run.go(), &report);
        report
    });
    costs::check("costs-space.txt", &reports);
}
