//! Robots of other shapes with other lidars, with odometry that drifts and is corrected.
//!
//! | lidar | beams |
//! | --- | --- |
//! | `own` | those of the robot's file |
//! | `180° x 181, 8 m` | as many as the wire has |
//! | `270° x 541, 12 m` | three in a sector |
//! | `360° x 180, 8 m` | all round, the seam behind |
//! | `360° x 450, 12 m` | all round, the seam ahead, three in a sector |
//!
//! What must hold in the office: no robot touches anything, every run ends explored, and the mean
//! error is small. `golden/robots.txt` has one seed of it. `golden/robots-full.txt` has two seeds
//! of three worlds with every pair; there some runs fail, and the table says which.

use fieldline_tests::odometry::{self, Setting};
use fieldline_tests::runs::{explored, in_parallel};
use fieldline_tests::table::number;
use fieldline_tests::{golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::robot::{Footprint, RobotSpec, presets};
use host_sim::trial::mission::OdometryProfile;
use host_sim::world::World;

/// Lidars, as after `--laser`.
const LIDARS: [(&str, &str); 4] = [
    ("180° x 181, 8 m", "-90,1,181,8"),
    ("270° x 541, 12 m", "-135,0.5,541,12"),
    ("360° x 180, 8 m", "-180,2,180,8"),
    ("360° x 450, 12 m", "0,0.8,450,12"),
];
const OWN: &str = "own";
/// Greatest mean position error in rooms, metres.
const MOST_ERROR_M: f64 = 0.20;

/// One run: a robot with a lidar in a world.
struct Job<'a> {
    robot: RobotSpec,
    lidar: &'static str,
    world: &'a World,
    seed: u64,
}

impl Job<'_> {
    fn go(&self) -> Report {
        let noisy = Setting::corrected(OdometryProfile::Noisy);
        let mission = noisy.mission(self.seed).with_robot(&self.robot);
        explored(&mission, self.world, &mut Direct::new()).0
    }
}

fn preset(name: &str) -> RobotSpec {
    RobotSpec::open(name).expect("a preset")
}

/// A robot that is longer than wide.
fn long() -> RobotSpec {
    RobotSpec {
        name: "long-0.9x0.6".into(),
        hull: Footprint::rectangle(0.9, 0.6, 0.4),
        radius_m: 0.35,
        ..RobotSpec::default()
    }
}

fn robots() -> Vec<RobotSpec> {
    let presets = presets::names().into_iter().map(preset);
    presets.chain([long()]).collect()
}

/// Returns a robot with a lidar of the list.
fn with_lidar(robot: &RobotSpec, sweep: &str) -> RobotSpec {
    robot.clone().with_sweep(&sweep.parse().expect("a sweep"))
}

fn table(jobs: &[Job<'_>], reports: &[Report]) -> String {
    let more = ["clear m", "touched"];
    let mut jobs = jobs.iter();
    let cells = core::cell::RefCell::new(&mut jobs);
    let table = odometry::table(reports, &["robot", "lidar"], &more, |report| {
        let job = cells.borrow_mut().next().expect("a job for each report");
        let safety = &report.safety;
        let more = vec![
            number(safety.min_clearance_m, 3),
            safety.collisions.to_string(),
        ];
        (vec![job.robot.name.clone(), job.lidar.into()], more)
    });
    table.to_string()
}

/// Makes the runs, and compares their table with a golden one.
fn check(name: &str, jobs: &[Job<'_>]) -> Vec<Report> {
    let reports = in_parallel(jobs, Job::go);
    golden::compare(name, &table(jobs, &reports));
    reports
}

fn assert_explored(job: &Job<'_>, report: &Report) {
    let what = format!("{}, {}, {}", job.robot.name, job.lidar, report.world);
    assert!(report.explored(), "{what}: {:?}", report.outcome.reason);
    assert_eq!(report.safety.collisions, 0, "{what}");
    let mean_m = report.localization.mean_error_m.unwrap_or(f64::MAX);
    assert!(mean_m <= MOST_ERROR_M, "{what}: {mean_m} m");
}

#[test]
fn six_robots_and_five_lidars_explore_the_office() {
    let office = worlds::builtin("office");
    let own = robots().into_iter().map(|robot| (robot, OWN));
    let usual = RobotSpec::default();
    let others = LIDARS.map(|(lidar, sweep)| (with_lidar(&usual, sweep), lidar));
    let jobs: Vec<Job<'_>> = own
        .chain(others)
        .map(|(robot, lidar)| Job {
            robot,
            lidar,
            world: &office,
            seed: 0,
        })
        .collect();
    let reports = check("robots.txt", &jobs);
    for (job, report) in jobs.iter().zip(&reports) {
        assert_explored(job, report);
    }
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 180 runs; tests/run --full runs it"]
    fn every_robot_with_every_lidar_in_three_worlds() {
        let worlds = ["office", "hall", "rooms:7"].map(|name| World::open(name).expect("a world"));
        let mut jobs = Vec::new();
        for robot in robots() {
            let own = (robot.clone(), OWN);
            let others = LIDARS.map(|(lidar, sweep)| (with_lidar(&robot, sweep), lidar));
            for (robot, lidar) in core::iter::once(own).chain(others) {
                for world in &worlds {
                    jobs.extend((0..2).map(|seed| Job {
                        robot: robot.clone(),
                        lidar,
                        world,
                        seed,
                    }));
                }
            }
        }
        let reports = check("robots-full.txt", &jobs);
        let office = jobs.iter().zip(&reports);
        let office = office.filter(|(_, report)| report.world == "office");
        office.for_each(|(job, report)| assert_explored(job, report));
    }
}
