//! Uneven ground with odometry that drifts: corrected, not corrected, and with the true pose.
//!
//! `golden/terrain-drift.txt` has one seed of two worlds, `golden/terrain-drift-full.txt` three of
//! all nine. Noisy odometry has errors of 0.5° in roll and pitch too. Coverage is what the robot
//! truly saw, judged by its true poses. A run is *false* if it says *explored* with less than 97 %
//! truly seen.

use core::fmt::Write as _;
use core::ops::Range;

use fieldline_tests::digests::Digest;
use fieldline_tests::odometry::{self, Drive, Setting, sweep};
use fieldline_tests::runs::{self, assert_faultless, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, worlds};
use host_sim::report::Report;
use host_sim::trial::mission::OdometryProfile::Noisy;
use host_sim::world::World;

/// Worlds of the quick table.
const QUICK: [&str; 2] = ["causeway", "kerbs"];
/// Least share that is truly seen.
const LEAST_SEEN: f64 = 0.97;
/// Greatest mean position error of the quick runs, metres.
const MOST_MEAN_M: f64 = 0.35;

/// Returns the odometry of a run, as tables name it, and its settings in [`digests`].
///
/// [`digests`]: fieldline_tests::digests
fn names(report: &Report) -> [&'static str; 2] {
    match (report.odometry.as_str(), report.localization.corrected) {
        ("truth", _) => ["truth", "drift-truth"],
        (_, true) => ["noisy, on", "drift-on"],
        (_, false) => ["noisy, off", "drift-off"],
    }
}

fn is_false(report: &Report) -> bool {
    report.explored() && report.coverage.fraction < LEAST_SEEN
}

fn table(reports: &[Report]) -> Table {
    let more = ["degenerate %", "touched", "falls", "tips"];
    odometry::table(reports, &["odometry"], &more, |report| {
        let (at, safety) = (&report.localization, &report.safety);
        let degenerate = at.quality.map(|quality| 100.0 * quality.degenerate);
        let [name, _] = names(report);
        let more = vec![
            number(degenerate, 1),
            safety.collisions.to_string(),
            safety.falls.to_string(),
            safety.tips.to_string(),
        ];
        (vec![name.into()], more)
    })
}

/// Returns a line for each odometry: how many runs did what.
fn sums(reports: &[Report]) -> String {
    let mut text = String::new();
    for name in ["truth", "noisy, on", "noisy, off"] {
        let of = reports.iter().filter(|it| names(it)[0] == name);
        let of: Vec<&Report> = of.collect();
        let count = |holds: fn(&Report) -> bool| of.iter().filter(|it| holds(it)).count();
        let errors = of.iter().filter_map(|it| it.localization.mean_error_m);
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_unstable_by(f64::total_cmp);
        let middle = errors.get(errors.len() / 2).copied();
        let _ = writeln!(
            text,
            "{}: {} runs, {} explored, {} of them false; {} touched, {} fell, {} tipped; \
             median mean error {} m, greatest {} m",
            name,
            of.len(),
            count(Report::explored),
            count(is_false),
            count(|it| it.safety.collisions > 0),
            count(|it| it.safety.falls > 0),
            count(|it| it.safety.tips > 0),
            number(middle, 3),
            number(errors.last().copied(), 3),
        );
    }
    text
}

/// Compares the runs with golden table `name`. Returns those that were corrected.
fn check(name: &str, worlds: &[World], seeds: &Range<u64>) -> Vec<Report> {
    let drives = sweep(worlds, seeds, &Setting::beside_truth(&[Noisy]));
    let reports = in_parallel(&drives, Drive::go);
    let digest = |report: &Report| Digest::of(report, names(report)[1]);
    let digests: Vec<Digest> = reports.iter().map(digest).collect();
    let text = format!("{}\n{}", table(&reports), sums(&reports));
    golden::compare_runs(name, &text, &digests);
    let corrected = reports.into_iter().filter(|it| it.localization.corrected);
    corrected.collect()
}

#[test]
fn drift_on_uneven_ground_is_corrected() {
    let corrected = check("terrain-drift", &worlds::builtins(&QUICK), &(0..1));
    assert_faultless(&corrected, |report| {
        odometry::faults(report, LEAST_SEEN, MOST_MEAN_M)
    });
}

/// Worlds of the parts: holes, a slope that winds, a drop without a floor.
const PARTS_WORLDS: [&str; 3] = ["holes", "spiral", "causeway"];
/// Name, and constants with other values.
type Part = (&'static str, &'static [(&'static str, f32)]);
const PARTS: [Part; 6] = [
    ("all parts", &[]),
    ("no landmarks", &[("localise.landmark_slope", 1.0)]),
    (
        "landmarks of every beam",
        &[("localise.landmark_slope", -1.0)],
    ),
    ("beams count in full", &[("localise.uneven_share", 1.0)]),
    ("beams count a fifth", &[("localise.uneven_share", 0.2)]),
    (
        "beams count a hundredth",
        &[("localise.uneven_share", 0.01)],
    ),
];

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 54 runs; tests/run --full runs it"]
    fn parts_of_the_localisation_on_uneven_ground() {
        let worlds = worlds::builtins(&PARTS_WORLDS);
        // No constant was chosen on these seeds.
        let seeds = 100..103;
        let names = [
            "part",
            "runs",
            "explored",
            "fell",
            "mean m",
            "worst m",
            "least seen %",
        ];
        let mut table = Table::new(1, &names);
        for (name, constants) in PARTS {
            let tuning = runs::tuned(constants);
            let usual = sweep(&worlds, &seeds, &[Setting::corrected(Noisy)]).into_iter();
            let drives: Vec<_> = usual.map(|drive| Drive { tuning, ..drive }).collect();
            let reports = in_parallel(&drives, Drive::go);
            let all: Vec<&Report> = reports.iter().collect();
            let error = |report: &Report| report.localization.mean_error_m;
            let seen = all.iter().map(|it| it.coverage.fraction);
            let well = |it: &&&Report| it.explored() && it.coverage.fraction >= LEAST_SEEN;
            table.row(vec![
                name.into(),
                all.len().to_string(),
                all.iter().filter(well).count().to_string(),
                all.iter()
                    .filter(|it| it.safety.falls > 0)
                    .count()
                    .to_string(),
                number(runs::mean(&all, error), 3),
                number(all.iter().filter_map(|it| error(it)).reduce(f64::max), 3),
                number(seen.reduce(f64::min).map(|it| 100.0 * it), 2),
            ]);
        }
        golden::compare("terrain-drift-parts.txt", &table.to_string());
    }

    #[test]
    #[ignore = "takes minutes: 81 runs; tests/run --full runs it"]
    fn drift_in_every_uneven_world_with_three_seeds() {
        check(
            "terrain-drift-full",
            &worlds::builtins(&worlds::UNEVEN),
            &(0..3),
        );
    }
}
