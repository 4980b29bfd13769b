//! Bounds and no-go polygons of a team, drawn at random around the first robot's start: with true
//! odometry, with odometry that drifts, and with starts that are known only roughly.
//!
//! What must hold of each robot: no place of its true hull is as deep as a map cell in what is
//! forbidden, or deeper than that and the greatest error of its pose; it touches no wall; it ends
//! with a reason.

use core::ops::Range;

use fieldline_tests::random::Random;
use fieldline_tests::runs::in_parallel;
use fieldline_tests::table::{Table, number};
use fieldline_tests::teams::TeamRun;
use fieldline_tests::{fences, golden, worlds};
use host_sim::fence::{Fence, Polygon};
use host_sim::report::{Report, TeamReport};
use host_sim::trial::mission::OdometryProfile;
use host_sim::world::World;

use crate::drift::settings;

const WORLDS: [&str; 3] = ["office", "hall", "cave"];
/// Side of a map cell, metres.
const CELL_M: f64 = 0.1;

/// Draws bounds and up to three triangles in which the first robot can stand.
fn fence(world: &World, seed: u64) -> Fence {
    let mut random = Random::mixed(seed.wrapping_add(0x7ea_0000));
    let polygon =
        |corners: &[[f64; 2]]| Polygon::of(corners).unwrap_or_else(|error| panic!("{error}"));
    fences::around(world, |start| Fence {
        bounds: vec![polygon(&fences::bounds(&mut random, start))],
        no_go: fences::no_go(&mut random, start)
            .iter()
            .map(|corners| polygon(corners))
            .collect(),
    })
}

/// Returns what is wrong with a robot's run; nothing if it kept to its bounds.
fn faults(report: &Report, odometry: OdometryProfile) -> Vec<String> {
    let mut faults = Vec::new();
    let deepest_m = report.fence.as_ref().map_or(0.0, |it| it.deepest_m);
    let error_m = match odometry {
        OdometryProfile::Truth => 0.0,
        _ => report.localization.max_error_m.unwrap_or_default(),
    };
    if deepest_m >= CELL_M + error_m {
        faults.push(format!("{deepest_m:.3} m deep, error {error_m:.3} m"));
    }
    if report.safety.collisions > 0 {
        faults.push(format!("{} touches", report.safety.collisions));
    }
    if !matches!(report.outcome.status.as_str(), "finished" | "fault") {
        faults.push(format!("ended {:?}", report.outcome));
    }
    faults
}

/// Makes the runs of these seeds, and returns their table and all faults.
fn go(robots: &[usize], seeds: Range<u64>) -> (String, Vec<String>) {
    let worlds = WORLDS.map(worlds::builtin);
    let of_world =
        |world: &World| -> Vec<Fence> { seeds.clone().map(|seed| fence(world, seed)).collect() };
    let drawn = worlds.each_ref().map(of_world);
    let mut runs = Vec::new();
    for ((world, drawn), &robots) in worlds
        .iter()
        .zip(&drawn)
        .flat_map(|it| robots.iter().map(move |robots| (it, robots)))
    {
        for (seed, fence) in seeds.clone().zip(drawn) {
            let fence = Some(fence);
            runs.extend(settings(world, robots, seed).map(|run| TeamRun { fence, ..run }));
        }
    }
    let reports = in_parallel(&runs, TeamRun::go);
    let all = runs.iter().zip(&reports);
    let faults = all.flat_map(|(run, report)| {
        report.robots.iter().flat_map(move |robot| {
            let what = format!(
                "{}, {}, seed {}",
                run.world.name(),
                run.settings(),
                run.seed
            );
            let robot_faults = faults(&robot.report, run.odometry);
            robot_faults
                .into_iter()
                .map(move |fault| format!("{what}, robot {}: {fault}", robot.robot))
        })
    });
    let faults = faults.collect();
    (table(&runs, &reports), faults)
}

fn table(runs: &[TeamRun<'_>], reports: &[TeamReport]) -> String {
    let columns = [
        "world",
        "team",
        "odometry",
        "starts",
        "seed",
        "end",
        "known m2",
        "time s",
        "deepest m",
        "worst pose m",
        "contacts",
    ];
    let mut table = Table::new(4, &columns);
    for (run, report) in runs.iter().zip(reports) {
        let whole = &report.whole;
        let errors = report
            .robots
            .iter()
            .filter_map(|it| it.report.localization.max_error_m);
        let starts = if run.start_error.is_empty() {
            "known"
        } else {
            "rough"
        };
        table.row(vec![
            whole.world.clone(),
            run.robots.to_string(),
            whole.odometry.clone(),
            starts.into(),
            run.seed.to_string(),
            whole.outcome.reason.clone(),
            number(Some(whole.coverage.known_m2), 1),
            number(Some(whole.sim_time_s), 0),
            number(whole.fence.as_ref().map(|it| it.deepest_m), 3),
            number(Some(errors.fold(0.0, f64::max)), 2),
            whole.safety.robot_contacts.unwrap_or(0).to_string(),
        ]);
    }
    table.to_string()
}

#[test]
fn no_robot_of_a_team_leaves_its_bounds() {
    let (text, faults) = go(&[2], 0..2);
    golden::compare("fences-teams.txt", &text);
    assert!(faults.is_empty(), "{faults:#?}");
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 180 runs of two and three robots; tests/run --full runs it"]
    fn many_fences_of_teams() {
        let (text, faults) = go(&[2, 3], 10..20);
        println!("{text}\n{faults:#?}");
    }
}
