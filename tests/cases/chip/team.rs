//! Two emulated chips in a team with robots by call: the same command streams as when all are by
//! call, and the cost of every step with three peers.
//!
//! `golden/costs-team.txt` has one line for each chip.

use fieldline_tests::emulator::{chip, image};
use fieldline_tests::teams::TeamRun;
use fieldline_tests::{costs, worlds};
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::{Report, TeamReport};
use host_sim::trial::mission::OdometryProfile;

/// Robots that are chips; the others are called.
const CHIPS: usize = 2;

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn chips_in_a_team_explore_as_robots_by_call_do_within_their_budget() {
    let (image, world) = (image(), worlds::builtin("hall"));
    let run = TeamRun::of(&world, CHIPS + 2);
    let link = |robot: usize| -> Box<dyn Link> {
        if robot < CHIPS {
            Box::new(chip(&image))
        } else {
            Box::new(Direct::new())
        }
    };
    let (mixed, _) = run.go_by((0..run.robots).map(link).collect());
    let called = run.go();
    assert!(mixed.whole.explored(), "{:?}", mixed.whole.outcome);
    let digests = |report: &TeamReport| -> Vec<String> {
        let robots = report.robots.iter();
        robots.map(|robot| robot.report.digest.clone()).collect()
    };
    assert_eq!(digests(&mixed), digests(&called));
    let chips: Vec<Report> = mixed
        .robots
        .iter()
        .take(CHIPS)
        .map(|it| it.report.clone())
        .collect();
    costs::check("costs-team.txt", &chips);
}

/// The chip overflowed its stack here once, when it matched the tiles of the other robot.
#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn a_chip_with_a_rough_start_explores_in_a_team() {
    let (image, world) = (image(), worlds::builtin("hall"));
    let run = TeamRun {
        odometry: OdometryProfile::Noisy,
        start_error: "0.3,5",
        ..TeamRun::of(&world, 2)
    };
    let (report, _) = run.go_by(vec![Box::new(Direct::new()), Box::new(chip(&image))]);
    assert!(report.whole.explored(), "{:?}", report.whole.outcome);
}
