//! The baseline that the papers compare with, as a robot runs it: `bvp-papers` stores its potential
//! and makes some sweeps a step, where `bvp` solves the field.
//!
//! `golden/bvp-papers-full.txt` has three starts of the worlds of \[Jorge15\] and \[Maffei14\] with
//! the usual sweeps, beside the solved field and the strategy of the paper, and of four worlds with
//! other numbers of sweeps and with p in single precision. Odometry is true.

use fieldline_tests::digests::Digest;
use fieldline_tests::loops::{BVP, OUROBOROS, TDBVP};
use fieldline_tests::runs::{self, Run, explored, in_parallel, mean};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, worlds};
use host_sim::baseline::bvp_papers::{Precision, Relaxation};
use host_sim::baseline::{BvpPapers, Session};
use host_sim::report::Report;
use host_sim::trial::mission::{BVP_PAPERS, Mission};
use host_sim::world::World;

/// Worlds, the paper's strategy there, and its mean time over that of the paper's BVP.
const PAPERS: [(&str, &str, f64); 6] = [
    ("ouroboros-a", OUROBOROS, 4399.3 / 4881.9),
    ("ouroboros-b", OUROBOROS, 5231.7 / 8585.4),
    ("ouroboros-c", OUROBOROS, 4985.8 / 3549.7),
    ("ouroboros-d", OUROBOROS, 3691.3 / 5823.9),
    ("tdbvp-adjacent", TDBVP, 1971.1 / 1947.0),
    ("tdbvp-nested", TDBVP, 1604.4 / 1627.4),
];
/// Starts of each world.
const STARTS: usize = 3;
/// Worlds of the second table.
const VARIED: [&str; 4] = [
    "ouroboros-a",
    "ouroboros-c",
    "ouroboros-d",
    "tdbvp-adjacent",
];
/// Sweeps a step and the stored type of the second table.
const VARIANTS: [(u16, Precision); 4] = [
    (1, Precision::F64),
    (5, Precision::F64),
    (20, Precision::F64),
    (100, Precision::F32),
];

fn go(world: &World, start: usize, relaxation: Relaxation) -> Report {
    let mission = Mission {
        strategy: BVP_PAPERS.into(),
        start,
        relaxation,
        ..Mission::default()
    };
    let mut session = Session::new(BvpPapers::new(relaxation));
    explored(&mission, world, &mut session).0
}

/// Explores from the first starts.
fn sweep(world: &World, relaxation: Relaxation) -> Vec<Report> {
    let starts: [usize; STARTS] = core::array::from_fn(|start| start);
    in_parallel(&starts, |&start| go(world, start, relaxation))
}

/// Returns the ends of runs: explored, nothing attracts, all others.
fn ends(reports: &[Report]) -> [String; 3] {
    let count = |reason: &str| {
        let same = reports.iter().filter(|it| it.outcome.reason == reason);
        same.count()
    };
    let (explored, flat) = (count("explored"), count("nothing-attracts"));
    [explored, flat, reports.len() - explored - flat].map(|count| count.to_string())
}

/// Returns mean time, path and known share.
fn means(reports: &[Report]) -> [Option<f64>; 3] {
    let all: Vec<&Report> = reports.iter().collect();
    [
        mean(&all, |it| Some(it.sim_time_s)),
        mean(&all, |it| Some(it.path_length_m)),
        mean(&all, |it| Some(100.0 * it.coverage.fraction)),
    ]
}

fn over(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.zip(b).map(|(a, b)| a / b)
}

/// Makes the runs with the usual sweeps; returns the table and its runs.
fn usual(digests: &mut Vec<Digest>) -> Table {
    let columns = [
        "world", "explored", "flat", "other", "time s", "path m", "known %", "bvp s", "bvp m",
        "strategy", "its s", "its/this", "paper",
    ];
    let mut table = Table::new(1, &columns);
    for (name, strategy, paper) in PAPERS {
        let world = worlds::builtin(name);
        let reports = sweep(&world, Relaxation::DEFAULT);
        digests.extend(Digest::of_all(&reports, "-"));
        let by = |strategy: &'static str| {
            let run = |start| Run {
                start,
                ..Run::first(&world, strategy)
            };
            let runs: Vec<Run<'_>> = (0..STARTS).map(run).collect();
            means(&runs::sweep(&runs))
        };
        let [time_s, path_m, known] = means(&reports);
        let ([bvp_s, bvp_m, _], [its_s, ..]) = (by(BVP), by(strategy));
        let row = [name.into()].into_iter().chain(ends(&reports)).chain([
            number(time_s, 1),
            number(path_m, 1),
            number(known, 2),
            number(bvp_s, 1),
            number(bvp_m, 1),
            strategy.into(),
            number(its_s, 1),
            number(over(its_s, time_s), 2),
            format!("{paper:.2}"),
        ]);
        table.row(row.collect());
        assert!(reports.iter().all(|it| it.safety.collisions == 0), "{name}");
    }
    table
}

/// Makes the runs with other sweeps and stored types; returns their table.
fn variants(digests: &mut Vec<Digest>) -> Table {
    let columns = [
        "world", "sweeps", "type", "explored", "flat", "other", "time s", "path m", "known %",
    ];
    let mut table = Table::new(3, &columns);
    for name in VARIED {
        let world = worlds::builtin(name);
        for (sweeps, precision) in VARIANTS {
            let relaxation = Relaxation { sweeps, precision };
            let reports = sweep(&world, relaxation);
            let settings = format!("sweeps={sweeps},{}", precision.name());
            digests.extend(Digest::of_all(&reports, &settings));
            let label = [name.into(), sweeps.to_string(), precision.name().into()];
            let [time_s, path_m, known] = means(&reports);
            let numbers = [number(time_s, 1), number(path_m, 1), number(known, 2)];
            let row = label.into_iter().chain(ends(&reports)).chain(numbers);
            table.row(row.collect());
        }
    }
    table
}

/// Compares the tables with golden table `name`.
pub(crate) fn check_three_starts(name: &str) {
    let mut digests = Vec::new();
    let text = format!(
        "The first {STARTS} starts, 100 sweeps, f64. flat: nothing attracts at the end.\n\n{}\n\
         The same with other sweeps.\n\n{}",
        usual(&mut digests),
        variants(&mut digests)
    );
    golden::compare_runs(name, &text, &digests);
}
