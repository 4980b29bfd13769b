//! Loops closed by the pose graph beside the link: the device's map is corrected while it explores.
//!
//! `golden/slam.txt` has runs with the papers' odometry, with and without the graph,
//! `slam-uneven.txt` runs on uneven ground with the usual noise, and `slam-full.txt` five starts of
//! each published world that has loops.

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
use host_sim::trial::uneven::TABLE_I;

/// Strategies that close loops, and one that does not.
const STRATEGIES: [&str; 3] = ["ouroboros", "tdbvp", "frontier"];
/// Starts of each world in the long table.
const STARTS: usize = 5;
/// Simulated time of a run of the long table, milliseconds.
const LIMIT_MS: u32 = 1_800_000;

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

/// Returns the published worlds that have loops.
fn with_loops() -> Vec<&'static str> {
    let published = worlds::PUBLISHED.iter().copied();
    published.filter(|name| *name != "tdbvp-floor").collect()
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
        assert_eq!(report.debug.map_matches_mirror, Some(true), "{run}");
    }
    let touches: u32 = reports.iter().map(|it| it.safety.collisions).sum();
    assert_eq!(touches, 0);
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

/// A run on uneven ground: its seed, and where loops are closed.
fn on_uneven_ground(seed: u64, slam: SlamPlace) -> Mission {
    Mission {
        seed,
        uneven_ground: Some(TABLE_I),
        odometry: OdometryProfile::Noisy,
        localise: true,
        slam,
        ..Mission::default()
    }
}

/// In `building` walls stand around the robot, and heights go with them.
#[test]
fn on_uneven_ground_a_map_among_walls_is_corrected() {
    let worlds = worlds::builtins(&["building"]);
    let runs: Vec<(u64, SlamPlace)> = (0..2)
        .flat_map(|seed| [SlamPlace::Off, SlamPlace::Host].map(|slam| (seed, slam)))
        .collect();
    let reports = in_parallel(&runs, |&(seed, slam)| {
        explored(
            &on_uneven_ground(seed, slam),
            &worlds[0],
            &mut Direct::new(),
        )
        .0
    });
    let digests: Vec<Digest> = reports
        .iter()
        .map(|report| Digest::of(report, &format!("uneven-slam={}", place(report))))
        .collect();
    golden::compare_runs("slam-uneven", &table(&reports).to_string(), &digests);
    for report in &reports {
        let run = format!("seed {} {}", report.seed, place(report));
        let safety = &report.safety;
        let lost = [safety.collisions, safety.falls, safety.tips];
        assert_eq!(lost, [0; 3], "{run}");
        assert!(report.explored(), "{run}");
        assert_eq!(report.debug.map_matches_mirror, Some(true), "{run}");
    }
    let of = |slam: &str| {
        let chosen = reports.iter().filter(|report| place(report) == slam);
        let chosen: Vec<&Report> = chosen.collect();
        mean(&chosen, |report| report.localization.mean_error_m).expect("there are runs")
    };
    let (off, host) = (of("off"), of("host"));
    assert!(host < off, "{host} m, without the graph {off} m");
}

/// Runs five starts with the graph, and compares the errors of each strategy with those of
/// `frontier` from the same start with golden file `name`.
pub(crate) fn check_five_starts(name: &str) {
    let worlds = worlds::builtins(&with_loops());
    let runs: Vec<(usize, Run)> = (0..worlds.len())
        .flat_map(|world| STRATEGIES.map(|strategy| (world, strategy)))
        .flat_map(|(world, strategy)| {
            (0..STARTS).map(move |start| (world, (strategy, start, SlamPlace::Host)))
        })
        .collect();
    let reports = in_parallel(&runs, |(world, run)| {
        let mission = Mission {
            time_limit_ms: LIMIT_MS,
            ..mission(run)
        };
        explored(&mission, &worlds[*world], &mut Direct::new()).0
    });
    golden::compare(&format!("{name}.txt"), &summary(&reports).to_string());
    let failed: Vec<&str> = reports
        .iter()
        .map(|report| report.outcome.reason.as_str())
        .filter(|reason| ["pose-lost", "map-full"].contains(reason))
        .collect();
    assert!(failed.is_empty(), "{failed:?}");
}

const COLUMNS: [&str; 14] = [
    "world",
    "strategy",
    "runs",
    "explored",
    "stuck",
    "time limit",
    "contacts",
    "s",
    "error m",
    "most m",
    "end m",
    "corrections",
    "smaller than frontier",
    "z",
];

/// Returns a row for each world and strategy, and one for all worlds.
fn summary(reports: &[Report]) -> Table {
    let mut table = Table::new(2, &COLUMNS);
    for world in with_loops().into_iter().chain(["all"]) {
        let of = |strategy: &str| -> Vec<&Report> {
            let here = reports
                .iter()
                .filter(|it| world == "all" || it.world == world);
            here.filter(|it| it.strategy == strategy).collect()
        };
        let other = errors(&of("frontier"));
        for strategy in STRATEGIES {
            table.row(row(world, strategy, &of(strategy), &other));
        }
    }
    table
}

/// Returns the row of a strategy in a world; `other` are the errors of *frontier* there.
fn row(world: &str, strategy: &str, runs: &[&Report], other: &[f64]) -> Vec<String> {
    let ends = |reason: &str| {
        let ended = runs.iter().filter(|it| it.outcome.reason == reason);
        ended.count().to_string()
    };
    let own = errors(runs);
    let smaller = own.iter().zip(other).filter(|(own, other)| own < other);
    let [smaller, z] = if strategy == "frontier" {
        ["-".into(), "-".into()]
    } else {
        let z = signed_rank(&own, other);
        [smaller.count().to_string(), number(z, 1)]
    };
    let contacts: u32 = runs.iter().map(|it| it.safety.collisions).sum();
    let corrections = |it: &Report| it.slam.as_ref().map(|slam| slam.corrections as f64);
    vec![
        world.into(),
        strategy.into(),
        runs.len().to_string(),
        ends("explored"),
        ends("stuck"),
        ends("simulated-time"),
        contacts.to_string(),
        number(mean(runs, |it| Some(it.sim_time_s)), 0),
        number(mean(runs, |it| it.localization.mean_error_m), 3),
        number(mean(runs, |it| it.localization.max_error_m), 2),
        number(mean(runs, |it| it.localization.end_error_m), 3),
        number(mean(runs, corrections), 0),
        smaller,
        z,
    ]
}

fn errors(reports: &[&Report]) -> Vec<f64> {
    let errors = reports.iter().map(|it| it.localization.mean_error_m);
    errors.map(|it| it.expect("a run has steps")).collect()
}

/// Returns z of Wilcoxon's signed-rank test of pairs: below −1.6 the first ones are the smaller
/// ones, at a level of 5 %. `None` if no pair differs.
fn signed_rank(one: &[f64], other: &[f64]) -> Option<f64> {
    let apart = one.iter().zip(other).map(|(one, other)| one - other);
    let apart: Vec<f64> = apart.filter(|it| *it != 0.0).collect();
    let rank = |of: &f64| {
        let nearer = apart.iter().filter(|it| it.abs() < of.abs()).count() as f64;
        let equal = apart.iter().filter(|it| it.abs() == of.abs()).count() as f64;
        nearer + 0.5 * (equal + 1.0)
    };
    let above: f64 = apart.iter().filter(|it| **it > 0.0).map(rank).sum();
    let n = apart.len() as f64;
    let spread = (n * (n + 1.0) * (2.0 * n + 1.0) / 24.0).sqrt();
    (n > 0.0).then(|| (above - 0.25 * n * (n + 1.0)) / spread)
}

/// Ten pairs of a textbook's example, one of them equal.
#[test]
fn the_signed_rank_test_counts_ranks() {
    let one = [
        125.0, 115.0, 130.0, 140.0, 140.0, 115.0, 140.0, 125.0, 140.0, 135.0,
    ];
    let other = [
        110.0, 122.0, 125.0, 120.0, 140.0, 124.0, 123.0, 137.0, 135.0, 145.0,
    ];
    // Nine pairs differ: 27 of 45.
    let z = signed_rank(&one, &other).expect("pairs differ");
    assert!((z - (27.0 - 22.5) / 71.25_f64.sqrt()).abs() < 1e-9, "{z}");
    assert_eq!(signed_rank(&one, &one), None);
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
    assert!(corrections > 1, "{corrections} corrections");
}

#[test]
fn corrections_on_uneven_ground_are_the_same_over_bytes() {
    let worlds = worlds::builtins(&["building"]);
    let limited = |link: &str| Mission {
        link: link.into(),
        time_limit_ms: 400_000,
        ..on_uneven_ground(1, SlamPlace::Host)
    };
    let by_call = explored(&limited("direct"), &worlds[0], &mut Direct::new()).0;
    let by_bytes = explored(&limited("loopback"), &worlds[0], &mut loopback()).0;
    assert_eq!(by_call.digest, by_bytes.digest);
    assert_eq!(by_call.slam, by_bytes.slam);
    let corrections = by_call.slam.map_or(0, |slam| slam.corrections);
    assert!(corrections > 0, "nothing was corrected");
}
