//! Known maps that are wrong: a door that has closed since the map was saved, and one that opened.
//!
//! ```text
//! +--------+--------+
//! |   A    D   B    |    D is the door; the robot starts in A
//! +--------+--------+
//! ```
//!
//! What must hold: nothing is touched, and each run ends with a reason that is true.

use fieldline_tests::runs::{explored, in_parallel};
use host_sim::known_map::KnownMap;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::itinerary::Orders;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::world::{Class, GridCell, Occupancy, Start, World};

/// Cells of the floor, and the column of the wall between the rooms. A cell has 0.1 m.
const SIZE: [usize; 2] = [121, 51];
const WALL: i64 = 60;
/// Rows of the door.
const DOOR: core::ops::Range<i64> = 20..34;
const START: Start = Start {
    x_m: 2.0,
    y_m: 2.5,
    yaw_rad: 0.0,
};

/// Returns the two rooms, with the door open or shut.
fn rooms(is_open: bool) -> Occupancy {
    let mut plan = Occupancy::filled(SIZE[0], SIZE[1], 0.1, [0.0, 0.0], Class::Free);
    let [width, height] = SIZE.map(|cells| cells as i64);
    for j in 0..height {
        for i in 0..width {
            let is_rim = i == 0 || j == 0 || i == width - 1 || j == height - 1;
            let is_door = DOOR.contains(&j) && is_open;
            if is_rim || (i == WALL && !is_door) {
                plan.set(GridCell { i, j }, Class::Wall);
            }
        }
    }
    plan
}

/// Returns a plan of which room B is not known.
fn without_b(mut plan: Occupancy) -> Occupancy {
    for j in 0..SIZE[1] as i64 {
        for i in WALL + 1..SIZE[0] as i64 {
            plan.set(GridCell { i, j }, Class::Unknown);
        }
    }
    plan
}

/// Makes runs with true odometry, and with odometry that drifts and is corrected.
fn runs(is_open: bool, known: &Occupancy, goals_m: &[[f64; 2]]) -> Vec<Report> {
    let world = World::flat("two-rooms-changed", rooms(is_open), vec![START]);
    let profiles = [
        (OdometryProfile::Truth, 0),
        (OdometryProfile::Noisy, 1),
        (OdometryProfile::Noisy, 2),
    ];
    let reports = in_parallel(&profiles, |&(odometry, seed)| {
        let mission = Mission {
            odometry,
            localise: odometry != OdometryProfile::Truth,
            seed,
            known: Some(KnownMap::new("m.yaml", known.clone(), None)),
            orders: Orders {
                goals_m: goals_m.to_vec(),
                ..Orders::default()
            },
            ..Mission::default()
        };
        explored(&mission, &world, &mut Direct::new()).0
    });
    for report in &reports {
        assert_eq!(report.safety.collisions, 0, "seed {}", report.seed);
        assert_ne!(report.debug.map_matches_mirror, Some(false));
    }
    reports
}

#[test]
fn behind_a_door_that_has_closed_nothing_can_be_reached() {
    for report in runs(false, &without_b(rooms(true)), &[]) {
        assert_eq!(report.outcome.reason, "explored");
        assert!(report.sim_time_s < 120.0, "{}", report.sim_time_s);
        assert!(
            report.coverage.fraction > 0.99,
            "{}",
            report.coverage.fraction
        );
    }
}

#[test]
fn a_goal_behind_a_door_that_has_closed_cannot_be_got_to() {
    for report in runs(false, &rooms(true), &[[9.0, 2.5]]) {
        assert_eq!(report.outcome.reason, "cannot-get-to-goal");
        let trip = report.trips.first().expect("a trip");
        assert!(!trip.reached && trip.stands_m[0] < 6.0, "{trip:?}");
    }
}

#[test]
fn a_door_that_has_opened_is_found_and_driven_through() {
    for report in runs(true, &without_b(rooms(false)), &[[9.0, 2.5]]) {
        let trip = report.trips.first().expect("a trip");
        assert!(trip.reached, "{} {trip:?}", report.outcome.reason);
        assert_eq!(report.outcome.reason, "explored");
        assert!(
            report.coverage.fraction > 0.99,
            "{}",
            report.coverage.fraction
        );
    }
}
