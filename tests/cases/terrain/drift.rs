//! Uneven ground with odometry that drifts: corrected, not corrected, and with the true pose.
//!
//! `golden/terrain-drift.txt` has one seed of two worlds, `golden/terrain-drift-full.txt` three of
//! all nine. Noisy odometry has errors of 0.5° in roll and pitch too. Coverage is what the robot
//! truly saw, judged by its true poses. A run is *false* if it says *explored* with less than 97 %
//! truly seen.

use core::fmt::Write as _;
use core::ops::Range;

use fieldline_tests::digests::Digest;
use fieldline_tests::runs::{self, assert_faultless, explored, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::uneven::UnevenRun;
use fieldline_tests::{golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::world::World;

/// Worlds of the quick table.
const QUICK: [&str; 2] = ["causeway", "kerbs"];
/// Least share that is truly seen.
const LEAST_SEEN: f64 = 0.97;
/// Greatest mean position error of the quick runs, metres.
const MOST_MEAN_M: f64 = 0.35;

/// Odometry, and whether the device corrects it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Setting {
    Truth,
    On,
    Off,
}

impl Setting {
    const ALL: [Self; 3] = [Self::Truth, Self::On, Self::Off];

    const fn name(self) -> &'static str {
        match self {
            Self::Truth => "truth",
            Self::On => "noisy, on",
            Self::Off => "noisy, off",
        }
    }

    fn go(self, world: &World, seed: u64) -> Report {
        let odometry = match self {
            Self::Truth => OdometryProfile::Truth,
            Self::On | Self::Off => OdometryProfile::Noisy,
        };
        let mission = Mission {
            odometry,
            localise: self == Self::On,
            ..UnevenRun::of(world, 0, seed).mission()
        };
        explored(&mission, world, &mut Direct::new()).0
    }
}

fn is_false(report: &Report) -> bool {
    report.explored() && report.coverage.fraction < LEAST_SEEN
}

fn table(runs: &[(Setting, Report)]) -> Table {
    let columns = [
        "world",
        "odometry",
        "end",
        "seed",
        "seen %",
        "s",
        "mean m",
        "max m",
        "degenerate %",
        "touched",
        "falls",
        "tips",
    ];
    let mut table = Table::new(3, &columns);
    for (setting, report) in runs {
        let (at, safety) = (&report.localization, &report.safety);
        let degenerate = at.quality.map(|quality| 100.0 * quality.degenerate);
        table.row(vec![
            report.world.clone(),
            setting.name().into(),
            report.outcome.reason.clone(),
            report.seed.to_string(),
            number(Some(100.0 * report.coverage.fraction), 2),
            number(Some(report.sim_time_s), 1),
            number(at.mean_error_m, 3),
            number(at.max_error_m, 3),
            number(degenerate.filter(|_| *setting == Setting::On), 1),
            safety.collisions.to_string(),
            safety.falls.to_string(),
            safety.tips.to_string(),
        ]);
    }
    table
}

/// Returns a line for each setting: how many runs did what.
fn sums(runs: &[(Setting, Report)]) -> String {
    let mut text = String::new();
    for setting in Setting::ALL {
        let of: Vec<&Report> = runs
            .iter()
            .filter(|it| it.0 == setting)
            .map(|it| &it.1)
            .collect();
        let count = |holds: fn(&Report) -> bool| of.iter().filter(|it| holds(it)).count();
        let errors = of.iter().filter_map(|it| it.localization.mean_error_m);
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_unstable_by(f64::total_cmp);
        let middle = errors.get(errors.len() / 2).copied();
        let _ = writeln!(
            text,
            "{}: {} runs, {} explored, {} of them false; {} touched, {} fell, {} tipped; \
             median mean error {} m, greatest {} m",
            setting.name(),
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
    let mut to_run = Vec::new();
    for world in worlds {
        for seed in seeds.clone() {
            to_run.extend(Setting::ALL.map(|setting| (setting, world, seed)));
        }
    }
    let reports = in_parallel(&to_run, |(setting, world, seed)| setting.go(world, *seed));
    let settings = to_run.iter().map(|it| it.0);
    let runs: Vec<(Setting, Report)> = settings.zip(reports).collect();
    let digest = |(setting, report): &(Setting, Report)| {
        let setting = match setting {
            Setting::Truth => "drift-truth",
            Setting::On => "drift-on",
            Setting::Off => "drift-off",
        };
        Digest::of(report, setting)
    };
    let digests: Vec<Digest> = runs.iter().map(digest).collect();
    let text = format!("{}\n{}", table(&runs), sums(&runs));
    golden::compare_runs(name, &text, &digests);
    let corrected = runs.into_iter().filter(|it| it.0 == Setting::On);
    corrected.map(|it| it.1).collect()
}

#[test]
fn drift_on_uneven_ground_is_corrected() {
    let corrected = check("terrain-drift", &worlds::builtins(&QUICK), &(0..1));
    assert_faultless(&corrected, |report| {
        let mut faults = runs::faults(report, LEAST_SEEN);
        let mean_m = report.localization.mean_error_m.unwrap_or(f64::MAX);
        if mean_m > MOST_MEAN_M {
            faults.push(format!("mean error {mean_m:.3} m"));
        }
        faults
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
            let of = |world| seeds.clone().map(move |seed| (world, seed));
            let to_run: Vec<_> = worlds.iter().flat_map(of).collect();
            let reports = in_parallel(&to_run, |(world, seed)| {
                let mission = Mission {
                    odometry: OdometryProfile::Noisy,
                    localise: true,
                    ..UnevenRun::of(world, 0, *seed).mission()
                };
                explored(&mission, world, &mut Direct::tuned(tuning)).0
            });
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
