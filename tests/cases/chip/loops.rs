//! Loops and rails on the emulated chip: the same command stream as by call, within a budget.

use fieldline_tests::emulator::{chip, image};
use fieldline_tests::loops::{OUROBOROS, TDBVP};
use fieldline_tests::runs::{Run, in_parallel};
use fieldline_tests::worlds;

/// Most instructions of a step.
const MOST: f64 = 8e6;

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn the_chip_closes_loops_as_the_host_does() {
    let image = image();
    let world = worlds::builtin("tdbvp-nested");
    let _ = in_parallel(&[OUROBOROS, TDBVP], |&strategy| {
        let run = Run::first(&world, strategy);
        let by_call = run.go();
        let report = run.go_by("qemu", &mut chip(&image));
        assert!(report.explored(), "{strategy}: {:?}", report.outcome);
        assert_eq!(
            (&report.digest, report.steps),
            (&by_call.digest, by_call.steps),
            "{strategy}"
        );
        let cost = report.planner.instructions.expect("the chip counts them");
        assert!(cost.max <= MOST, "{strategy}: {cost:?}");
    });
}
