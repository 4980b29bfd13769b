//! Bounds, no-go polygons and the way home, drawn at random around the start of flat worlds.
//!
//! What must hold: no place of the true hull is as deep as a map cell in what is forbidden, or,
//! with odometry that drifts and is corrected, deeper than that and the greatest error of the pose;
//! no touch; and each run ends with a reason. A robot that says that it is home is there.

use fieldline_tests::random::Random;
use fieldline_tests::runs::{explored, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{fences, golden, worlds};
use host_sim::fence::{Fence, Polygon};
use host_sim::link::direct::Direct;
use host_sim::report::{Report, Trip};
use host_sim::trial::itinerary::Orders;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::world::World;

const WORLDS: [&str; 5] = ["office", "cave", "hall", "cluttered", "loop"];
const STRATEGIES: [&str; 5] = ["frontier", "ouroboros", "tdbvp", "sbpf", "esbpf"];
/// Side of a map cell, metres.
const CELL_M: f64 = 0.1;
/// What home means: 0.2 m and 10°.
const HOME: (f64, f64) = (0.2, 10.0);

/// One run: a world and a strategy, with the fence that the seed draws.
#[derive(Clone, Copy)]
struct Job<'a> {
    world: &'a World,
    strategy: &'a str,
    odometry: OdometryProfile,
    seed: u64,
}

impl Job<'_> {
    fn go(&self) -> Report {
        let mission = Mission {
            strategy: self.strategy.into(),
            seed: self.seed,
            odometry: self.odometry,
            localise: self.odometry != OdometryProfile::Truth,
            fence: fence(self.world, self.seed),
            orders: Orders {
                home: true,
                ..Orders::default()
            },
            ..Mission::default()
        };
        explored(&mission, self.world, &mut Direct::new()).0
    }

    /// Asserts what must hold of every run.
    fn check(&self, report: &Report) {
        let what = format!("{}, {}, seed {}", report.world, report.strategy, self.seed);
        let fence = report.fence.as_ref().expect("the run has a fence");
        let drift_m = match self.odometry {
            OdometryProfile::Truth => 0.0,
            _ => report.localization.max_error_m.unwrap_or_default(),
        };
        assert!(
            fence.deepest_m < CELL_M + drift_m,
            "{what}: {} m",
            fence.deepest_m
        );
        assert_eq!(report.safety.collisions, 0, "{what}");
        let is_typed = matches!(report.outcome.status.as_str(), "finished" | "fault");
        assert!(is_typed, "{what}: {:?}", report.outcome);
        if let Some(home) = home(report) {
            let is_home = home.error_m <= HOME.0 && home.error_deg.unwrap_or(180.0) <= HOME.1;
            assert!(!home.reached || is_home, "{what}: {home:?}");
        }
    }
}

fn home(report: &Report) -> Option<&Trip> {
    report.trips.iter().find(|trip| trip.to == "home")
}

/// Draws a fence around the world's first start: bounds, and up to three triangles, with corners in
/// whole millimetres.
fn fence(world: &World, seed: u64) -> Fence {
    let mut random = Random::mixed(seed);
    fences::around(world, |start| Fence {
        bounds: vec![polygon(&fences::bounds(&mut random, start))],
        no_go: fences::no_go(&mut random, start)
            .iter()
            .map(|corners| polygon(corners))
            .collect(),
    })
}

/// Returns the polygon that a user gives with these corners.
fn polygon(corners: &[[f64; 2]]) -> Polygon {
    let corners = corners.iter().map(|[x, y]| format!("{x:.3},{y:.3}"));
    let corners: Vec<String> = corners.collect();
    corners.join(",").parse().expect("corners")
}

fn table(reports: &[Report]) -> String {
    let columns = [
        "world",
        "strategy",
        "odometry",
        "seed",
        "end",
        "known m2",
        "time s",
        "deepest m",
        "home m",
        "home deg",
    ];
    let mut table = Table::new(3, &columns);
    for report in reports {
        let fence = report.fence.as_ref().expect("the run has a fence");
        let home = home(report);
        table.row(vec![
            report.world.clone(),
            report.strategy.clone(),
            report.odometry.clone(),
            report.seed.to_string(),
            report.outcome.reason.clone(),
            number(Some(report.coverage.known_m2), 1),
            number(Some(report.sim_time_s), 0),
            number(Some(fence.deepest_m), 3),
            number(home.map(|it| it.error_m), 2),
            number(home.and_then(|it| it.error_deg), 1),
        ]);
    }
    table.to_string()
}

/// Makes the runs of these seeds, and checks each. The strategies take turns.
fn runs(worlds: &[World], odometry: OdometryProfile, seeds: core::ops::Range<u64>) -> Vec<Report> {
    let mut jobs = Vec::new();
    for seed in seeds {
        for (k, world) in worlds.iter().enumerate() {
            let strategy = STRATEGIES[(k + seed as usize) % STRATEGIES.len()];
            jobs.push(Job {
                world,
                strategy,
                odometry,
                seed,
            });
        }
    }
    let reports = in_parallel(&jobs, Job::go);
    jobs.iter()
        .zip(&reports)
        .for_each(|(job, report)| job.check(report));
    reports
}

#[test]
fn no_robot_leaves_its_bounds_or_enters_a_no_go_polygon() {
    let worlds = WORLDS.map(worlds::builtin);
    let mut reports = runs(&worlds, OdometryProfile::Truth, 0..2);
    reports.extend(runs(&worlds, OdometryProfile::Noisy, 2..4));
    golden::compare("fences.txt", &table(&reports));
}

/// The area that a robot is told to explore is smaller than the house around it.
#[test]
fn an_area_with_bounds_ends_explored_within_them() {
    let world = worlds::builtin("office");
    let start = world.starts()[0];
    let bounds = Polygon::rectangle([start.x_m - 2.0, start.y_m - 2.0, 4.0, 4.0]);
    for strategy in STRATEGIES {
        let mission = Mission {
            strategy: strategy.into(),
            fence: Fence {
                bounds: vec![bounds.clone()],
                no_go: Vec::new(),
            },
            ..Mission::default()
        };
        let report = explored(&mission, &world, &mut Direct::new()).0;
        let fence = report.fence.as_ref().expect("the run has a fence");
        assert!(fence.deepest_m < CELL_M, "{strategy}: {}", fence.deepest_m);
        let reason = report.outcome.reason.as_str();
        assert!(
            matches!(reason, "explored" | "covered") || strategy == "sbpf",
            "{strategy}: {reason}"
        );
    }
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 200 runs; tests/run --full runs it"]
    fn many_fences_with_odometry_that_drifts() {
        let worlds = WORLDS.map(worlds::builtin);
        let reports = runs(&worlds, OdometryProfile::Noisy, 10..50);
        println!("{}", table(&reports));
        let homes: Vec<&Trip> = reports.iter().filter_map(home).collect();
        let reached = homes.iter().filter(|trip| trip.reached).count();
        println!("home: {reached} of {}", homes.len());
    }
}
