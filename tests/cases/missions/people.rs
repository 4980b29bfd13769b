//! Explorations among people who walk about, with odometry that drifts and is corrected.
//!
//! What must hold: the robot touches nothing and nobody, no run says *explored* with less than
//! [`LEAST_SEEN`] truly seen, and the people leave few lasting obstacles in the map.
//!
//! `golden/people.txt` has three seeds of one world, `golden/people-full.txt` 15 of three, each
//! with and without people.

use core::ops::Range;

use fieldline_tests::odometry::{self, Drive, Setting, sweep};
use fieldline_tests::table::number;
use fieldline_tests::{golden, runs, worlds};
use host_sim::report::Report;
use host_sim::trial::mission::OdometryProfile;
use host_sim::world::World;

/// People in a world.
const PEOPLE: usize = 10;
/// Least share that is truly seen when a run says *explored*.
const LEAST_SEEN: f64 = 0.97;

fn explore(worlds: &[World], counts: &[usize], seeds: &Range<u64>) -> Vec<Report> {
    let settings = [Setting::corrected(OdometryProfile::Noisy)];
    let mut drives = Vec::new();
    for world in worlds {
        for &people in counts {
            let alone = sweep(core::slice::from_ref(world), seeds, &settings);
            drives.extend(alone.into_iter().map(|drive| Drive { people, ..drive }));
        }
    }
    runs::in_parallel(&drives, Drive::go)
}

fn table(reports: &[Report]) -> String {
    let more = [
        "wall p95 m",
        "ghosts %",
        "gap m",
        "touched",
        "people touched",
    ];
    let table = odometry::table(reports, &["people"], &more, |report| {
        let safety = &report.safety;
        let more = vec![
            number(report.map.and_then(|map| Some(map.wall_error_m?.p95)), 3),
            number(report.map.map(|map| 100.0 * map.ghost_share), 2),
            number(safety.min_person_gap_m, 3),
            safety.collisions.to_string(),
            number(safety.person_contacts.map(f64::from), 0),
        ];
        (vec![report.people.unwrap_or(0).to_string()], more)
    });
    table.to_string()
}

/// Judges the runs with people.
fn assert_nothing_is_touched_or_claimed(reports: &[Report]) {
    for report in reports.iter().filter(|report| report.people.is_some()) {
        let (name, seed) = (&report.world, report.seed);
        let safety = &report.safety;
        let touched = safety.collisions + safety.person_contacts.unwrap_or(0);
        assert_eq!(touched, 0, "{name}, seed {seed}: {safety:?}");
        let seen = report.coverage.fraction;
        assert!(
            !report.explored() || seen >= LEAST_SEEN,
            "{name}, seed {seed}: explored with {seen} seen"
        );
    }
}

#[test]
fn among_people_the_office_is_explored_and_nobody_is_touched() {
    let reports = explore(&worlds::builtins(&["office"]), &[PEOPLE], &(0..3));
    golden::compare("people.txt", &table(&reports));
    assert_nothing_is_touched_or_claimed(&reports);
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes a minute: 90 runs; tests/run --full runs it"]
    fn people_in_three_worlds() {
        let worlds = worlds::builtins(&["office", "hall", "cave"]);
        let reports = explore(&worlds, &[0, PEOPLE], &(0..15));
        golden::compare("people-full.txt", &table(&reports));
        assert_nothing_is_touched_or_claimed(&reports);
    }
}
