//! Explorations with odometry that drifts: corrected, not corrected, and with the true pose.
//!
//! `golden/localise.txt` has one seed of four worlds, `golden/localise-full.txt` 15 of eight, and
//! `golden/localise-data.txt` three of each flat world that others have drawn.
//! Coverage is what the robot truly saw, judged by its true poses; wall errors are those after the
//! best rigid alignment of the whole map.

use fieldline_tests::digests::Digest;
use fieldline_tests::odometry::{self, Drive, Setting, sweep};
use fieldline_tests::runs::{self, assert_faultless};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, worlds};
use host_sim::report::Report;
use host_sim::trial::mission::OdometryProfile;

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

fn table(reports: &[Report]) -> Table {
    let more = ["end m", "wall p95 m", "ghosts %", "lost %", "touched"];
    odometry::table(reports, &["odometry", "localise"], &more, |report| {
        let at = &report.localization;
        let percent = |share: Option<f64>| number(share.map(|it| 100.0 * it), 2);
        let corrected = if at.corrected { "on" } else { "off" };
        let more = vec![
            number(at.end_error_m, 3),
            number(report.map.and_then(|map| Some(map.wall_error_m?.p95)), 3),
            percent(report.map.map(|map| map.ghost_share)),
            percent(at.quality.map(|quality| quality.lost)),
            report.safety.collisions.to_string(),
        ];
        (vec![report.odometry.clone(), corrected.into()], more)
    })
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
    let settings = Setting::beside_truth(&[OdometryProfile::Noisy]);
    let corrected = check("localise", &sweep(&worlds, &(0..1), &settings));
    assert_faultless(&corrected, |report| {
        let most_mean_m = if is_room(report) {
            ROOM_ERROR_M
        } else {
            CORRIDOR_ERROR_M
        };
        odometry::faults(report, LEAST_SEEN, most_mean_m)
    });
}

mod full {
    use super::{CORRIDORS, OdometryProfile, ROOMS, Setting, check, sweep, worlds};

    #[test]
    #[ignore = "takes minutes: 600 runs; tests/run --full runs it"]
    fn drift_in_every_flat_world_with_fifteen_seeds() {
        let worlds = worlds::builtins(&[&ROOMS[..], &CORRIDORS].concat());
        let profiles = [OdometryProfile::Noisy, OdometryProfile::Papers];
        let settings = Setting::beside_truth(&profiles);
        check("localise-full", &sweep(&worlds, &(0..15), &settings));
    }
}

mod data {
    use super::{OdometryProfile, Setting, check, sweep, worlds};

    #[test]
    #[ignore = "needs worlds drawn by others (FIELDLINE_DATA), and takes five minutes"]
    fn drift_in_worlds_drawn_by_others() {
        let worlds = worlds::drawn_by_others();
        let settings = Setting::beside_truth(&[OdometryProfile::Noisy]);
        check("localise-data", &sweep(&worlds, &(0..3), &settings));
    }
}
