//! Loops and rails on the emulated chip: whole runs give the same command stream as by call, bit for bit, in steps that it has time for.

use fieldline_tests::loops::{OUROBOROS, TDBVP};
use fieldline_tests::runs::{Run, in_parallel};
use fieldline_tests::{emulator, worlds};
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::qemu;

/// Instructions of a step at the most.
const MOST: f64 = 8e6;

#[test]
fn the_emulated_chip_closes_loops_as_the_host_does() {
    let Some(image) = emulator::image() else {
        return;
    };
    let world = worlds::builtin("tdbvp-nested");
    let _ = in_parallel(&[OUROBOROS, TDBVP], |&strategy| {
        let run = Run {
            world: &world,
            strategy,
            seed: 0,
            start: 0,
        };
        let clean = run.go();
        let line = qemu::open_line(&image).expect("it started a moment ago");
        let report = run.go_by("qemu", &mut Endpoint::new(line, RetryPolicy::LOCKSTEP, 1));
        assert!(report.explored(), "{strategy}: {:?}", report.outcome);
        assert_eq!(
            (&report.digest, report.steps),
            (&clean.digest, clean.steps),
            "{strategy}"
        );
        let cost = report.planner.instructions.expect("the chip counts them");
        assert!(cost.max <= MOST, "{strategy}: {cost:?}");
    });
}
