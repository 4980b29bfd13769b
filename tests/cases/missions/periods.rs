//! The step period: 100 to 400 ms explore equally well; the device refuses others.

use fieldline_protocol::message::Order;
use fieldline_tests::worlds;
use fixed::types::I4F12;
use host_sim::link::direct::Direct;
use host_sim::trial::mission::{Mission, MissionError, explore};

use crate::whole::LEAST_COVERAGE;

fn at(period_ms: u32) -> Result<host_sim::report::Report, MissionError> {
    // What is not worth the trip is left at any period.
    let worth = I4F12::ZERO;
    let mission = Mission {
        period_ms,
        order: Some(Order::Gain { worth }),
        ..Mission::default()
    };
    let world = worlds::builtin("narrow-doors");
    explore(&mission, &world, &mut Direct::new(), &mut ()).map(|(report, _)| report)
}

#[test]
fn the_shortest_and_the_longest_period_explore() {
    for period_ms in [100, 400] {
        let report = at(period_ms).expect("the period is allowed");
        assert!(report.explored(), "{period_ms} ms: {:?}", report.outcome);
        assert_eq!(report.safety.collisions, 0, "{period_ms} ms");
        assert!(
            report.coverage.fraction > LEAST_COVERAGE,
            "{period_ms} ms: {}",
            report.coverage.fraction
        );
    }
}

#[test]
fn a_refused_period_ends_the_run_before_the_robot_moves() {
    for period_ms in [50, 500, 100_000] {
        let report = at(period_ms).expect("a refused session has a report");
        assert_eq!(report.outcome.reason, "request-refused", "{period_ms} ms");
        assert_eq!(report.path_length_m, 0.0, "{period_ms} ms");
    }
}
