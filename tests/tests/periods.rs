//! A session may be stepped ten times a second or five times in two: the doors are passed either way, and nothing is touched.

use fieldline_tests::runs::Unseen;
use fieldline_tests::worlds;
use host_sim::link::direct::Direct;
use host_sim::trial::mission::{Mission, MissionError, explore};

fn at(period_ms: u32) -> Result<host_sim::report::Report, MissionError> {
    let mission = Mission {
        period_ms,
        ..Mission::default()
    };
    let world = worlds::builtin("narrow-doors");
    explore(&mission, &world, &mut Direct::new(), &mut Unseen).map(|(report, _)| report)
}

#[test]
fn the_shortest_and_the_longest_period_explore_as_well() {
    for period_ms in [100, 400] {
        let report = at(period_ms).expect("a period that a session may have");
        assert!(report.explored(), "{period_ms} ms: {:?}", report.outcome);
        assert_eq!(report.safety.collisions, 0, "{period_ms} ms");
        assert!(report.coverage.fraction > 0.98, "{period_ms} ms");
    }
}

#[test]
fn a_period_that_the_device_refuses_ends_the_run_before_it_moves() {
    for period_ms in [50, 500, 100_000] {
        let report = at(period_ms).expect("a report that says so");
        assert_eq!(report.outcome.reason, "request-refused", "{period_ms} ms");
        assert_eq!(report.path_length_m, 0.0, "{period_ms} ms");
    }
}
