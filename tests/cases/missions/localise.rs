//! Explorations with odometry that drifts: corrected, not corrected, and with the true pose.
//!
//! `golden/localise.txt` has one seed of four worlds, `golden/localise-full.txt` 15 of eight, and
//! `golden/localise-data.txt` three of each flat world that others have drawn.
//! Coverage is what the robot truly saw, judged by its true poses; wall errors are those after the
//! best rigid alignment of the whole map.

use core::ops::Range;

use fieldline_planner::Tuning;
use fieldline_tests::digests::Digest;
use fieldline_tests::runs::{self, assert_faultless};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::world::World;

/// Worlds whose scans hold the pose in every direction nearly everywhere.
const ROOMS: [&str; 5] = ["office", "cave", "cluttered", "narrow-doors", "hall"];
/// Worlds of corridors, where odometry alone holds the pose in one direction.
const CORRIDORS: [&str; 3] = ["loop", "ouroboros-a", "ouroboros-b"];
/// Worlds of the quick table.
const QUICK: [&str; 4] = ["office", "cave", "cluttered", "loop"];
/// Greatest mean position error in rooms, metres.
const ROOM_ERROR_M: f64 = 0.20;
/// Greatest mean position error in corridors, metres.
const CORRIDOR_ERROR_M: f64 = 0.35;
/// Least share that is truly seen at the end.
const LEAST_SEEN: f64 = 0.98;

/// One exploration.
pub(super) struct Drive<'a> {
    pub(super) world: &'a World,
    pub(super) seed: u64,
    pub(super) odometry: OdometryProfile,
    pub(super) localise: bool,
    pub(super) tuning: &'static Tuning,
    pub(super) people: usize,
}

impl Drive<'_> {
    pub(super) fn go(&self) -> Report {
        let mission = Mission {
            link: "direct".into(),
            seed: self.seed,
            odometry: self.odometry,
            localise: self.localise,
            people: self.people,
            ..Mission::default()
        };
        runs::explored(&mission, self.world, &mut Direct::tuned(self.tuning)).0
    }
}

/// Returns the runs of each world and seed: true odometry, noise corrected, noise as it is.
fn drives<'a>(
    worlds: &'a [World],
    seeds: &Range<u64>,
    noise: &[OdometryProfile],
) -> Vec<Drive<'a>> {
    let mut drives = Vec::new();
    for world in worlds {
        for seed in seeds.clone() {
            let mut add = |odometry, localise| {
                drives.push(Drive {
                    world,
                    seed,
                    odometry,
                    localise,
                    tuning: &Tuning::DEFAULT,
                    people: 0,
                });
            };
            add(OdometryProfile::Truth, false);
            for &odometry in noise {
                add(odometry, true);
                add(odometry, false);
            }
        }
    }
    drives
}

fn table(reports: &[Report]) -> Table {
    let columns = [
        "world",
        "odometry",
        "localise",
        "end",
        "seed",
        "seen %",
        "s",
        "mean m",
        "max m",
        "end m",
        "wall p95 m",
        "ghosts %",
        "lost %",
        "touched",
    ];
    let mut table = Table::new(4, &columns);
    for report in reports {
        let at = &report.localization;
        let percent = |share: Option<f64>| number(share.map(|it| 100.0 * it), 2);
        table.row(vec![
            report.world.clone(),
            report.odometry.clone(),
            if at.corrected { "on" } else { "off" }.into(),
            report.outcome.reason.clone(),
            report.seed.to_string(),
            percent(Some(report.coverage.fraction)),
            number(Some(report.sim_time_s), 1),
            number(at.mean_error_m, 3),
            number(at.max_error_m, 3),
            number(at.end_error_m, 3),
            number(report.map.map(|map| map.wall_error_m.p95), 3),
            percent(report.map.map(|map| map.ghost_share)),
            percent(at.quality.map(|quality| quality.lost)),
            report.safety.collisions.to_string(),
        ]);
    }
    table
}

/// Compares the runs with golden table `name`. Returns those that were corrected.
fn check(name: &str, drives: &[Drive<'_>]) -> Vec<Report> {
    let reports = runs::in_parallel(drives, Drive::go);
    let digest = |report: &Report| match report.odometry.as_str() {
        "truth" => Digest::of(report, "-"),
        noise if report.localization.corrected => Digest::of(report, &format!("{noise}-on")),
        noise => Digest::of(report, &format!("{noise}-off")),
    };
    let digests: Vec<Digest> = reports.iter().map(digest).collect();
    golden::compare_runs(name, &table(&reports).to_string(), &digests);
    let corrected = reports.into_iter().filter(|it| it.localization.corrected);
    corrected.collect()
}

fn is_room(report: &Report) -> bool {
    ROOMS.contains(&report.world.as_str())
}

#[test]
fn the_chip_corrects_its_own_drift() {
    let worlds = worlds::builtins(&QUICK);
    let drives = drives(&worlds, &(0..1), &[OdometryProfile::Noisy]);
    let corrected = check("localise", &drives);
    assert_faultless(&corrected, |report| {
        let mut faults = runs::faults(report, LEAST_SEEN);
        let mean_m = report.localization.mean_error_m.unwrap_or(f64::MAX);
        let most_m = if is_room(report) {
            ROOM_ERROR_M
        } else {
            CORRIDOR_ERROR_M
        };
        if mean_m > most_m {
            faults.push(format!("mean error {mean_m:.3} m"));
        }
        faults
    });
}

mod full {
    use super::{CORRIDORS, OdometryProfile, ROOMS, check, drives, worlds};

    #[test]
    #[ignore = "takes minutes: 600 runs; tests/run --full runs it"]
    fn drift_in_every_flat_world_with_fifteen_seeds() {
        let worlds = worlds::builtins(&[&ROOMS[..], &CORRIDORS].concat());
        let profiles = [OdometryProfile::Noisy, OdometryProfile::Papers];
        check("localise-full", &drives(&worlds, &(0..15), &profiles));
    }
}

mod data {
    use super::{OdometryProfile, check, drives, worlds};

    #[test]
    #[ignore = "needs worlds drawn by others (FIELDLINE_DATA), and takes five minutes"]
    fn drift_in_worlds_drawn_by_others() {
        let worlds = worlds::drawn_by_others();
        let drives = drives(&worlds, &(0..3), &[OdometryProfile::Noisy]);
        check("localise-data", &drives);
    }
}
