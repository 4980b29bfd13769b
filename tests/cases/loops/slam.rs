//! Loops closed by the pose graph beside the link: the device's map is corrected while it explores.
//!
//! `golden/slam.txt` has runs with the papers' odometry, with and without the graph.

use fieldline_tests::digests::Digest;
use fieldline_tests::golden;
use fieldline_tests::runs::{explored, in_parallel, mean};
use fieldline_tests::table::{Table, number};
use fieldline_tests::worlds;
use host_sim::link::direct::Direct;
use host_sim::link::loopback::loopback;
use host_sim::report::Report;
use host_sim::slam::SlamPlace;
use host_sim::trial::mission::{Mission, OdometryProfile};

/// Greatest mean error of the runs that close loops, metres.
const MOST_ERROR_M: f64 = 0.25;

/// A run: its strategy, its start and seed, and where loops are closed.
type Run = (&'static str, usize, SlamPlace);

fn mission(&(strategy, start, slam): &Run) -> Mission {
    Mission {
        strategy: strategy.into(),
        seed: start as u64,
        start,
        odometry: OdometryProfile::Papers,
        localise: true,
        slam,
        ..Mission::default()
    }
}

fn place(report: &Report) -> &str {
    report.slam.as_ref().map_or("off", |slam| &slam.place)
}

fn table(reports: &[Report]) -> Table {
    let heads = [
        "world",
        "strategy",
        "slam",
        "start",
        "end",
        "s",
        "m",
        "error m",
        "most m",
        "end m",
        "closed",
        "refused",
        "corrections",
        "largest m",
    ];
    let mut table = Table::new(3, &heads);
    for report in reports {
        let (at, slam) = (&report.localization, report.slam.as_ref());
        let count = |of: fn(&host_sim::slam::SlamReport) -> usize| {
            slam.map_or_else(|| "-".into(), |slam| of(slam).to_string())
        };
        table.row(vec![
            report.world.clone(),
            report.strategy.clone(),
            place(report).into(),
            report.start.to_string(),
            report.outcome.reason.clone(),
            number(Some(report.sim_time_s), 1),
            number(Some(report.path_length_m), 1),
            number(at.mean_error_m, 3),
            number(at.max_error_m, 3),
            number(at.end_error_m, 3),
            count(|slam| slam.closed),
            count(|slam| slam.refused),
            count(|slam| slam.corrections),
            number(slam.map(|slam| slam.largest_m), 2),
        ]);
    }
    table
}

#[test]
fn a_strategy_that_closes_loops_corrects_its_map() {
    let worlds = worlds::builtins(&["ouroboros-a"]);
    let places = [SlamPlace::Off, SlamPlace::Host];
    let runs: Vec<Run> = ["ouroboros", "frontier"]
        .into_iter()
        .flat_map(|strategy| (0..2).map(move |start| (strategy, start)))
        .flat_map(|(strategy, start)| places.map(|slam| (strategy, start, slam)))
        .collect();
    let reports = in_parallel(&runs, |run| {
        explored(&mission(run), &worlds[0], &mut Direct::new()).0
    });
    let digests: Vec<Digest> = reports
        .iter()
        .map(|report| Digest::of(report, &format!("papers-on-slam={}", place(report))))
        .collect();
    golden::compare_runs("slam", &table(&reports).to_string(), &digests);
    for report in &reports {
        let run = format!("{} {} {}", report.strategy, report.start, place(report));
        assert_eq!(report.safety.collisions, 0, "{run}");
        assert_eq!(report.debug.map_matches_mirror, Some(true), "{run}");
    }
    let of = |strategy: &str, slam: &str| {
        let chosen = reports.iter().filter(|report| report.strategy == strategy);
        let chosen: Vec<&Report> = chosen.filter(|report| place(report) == slam).collect();
        mean(&chosen, |report| report.localization.mean_error_m).expect("there are runs")
    };
    let (off, host) = (of("ouroboros", "off"), of("ouroboros", "host"));
    assert!(
        host < off && host <= MOST_ERROR_M,
        "{host} m, without the graph {off} m"
    );
}

#[test]
fn corrections_are_the_same_over_bytes() {
    let worlds = worlds::builtins(&["ouroboros-a"]);
    let run = ("ouroboros", 0, SlamPlace::Host);
    let limited = |link: &str| Mission {
        link: link.into(),
        time_limit_ms: 200_000,
        ..mission(&run)
    };
    let by_call = explored(&limited("direct"), &worlds[0], &mut Direct::new()).0;
    let by_bytes = explored(&limited("loopback"), &worlds[0], &mut loopback()).0;
    assert_eq!(by_call.digest, by_bytes.digest);
    assert_eq!(by_call.slam, by_bytes.slam);
    let corrections = by_call.slam.map_or(0, |slam| slam.corrections);
    assert!(corrections > 2, "{corrections} corrections");
}
