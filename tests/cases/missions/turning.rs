//! Lidars that turn while the robot moves: their mount says the turn time, or it does not.
//!
//! | setting | the simulated lidar | its mount says |
//! | --- | --- | --- |
//! | `0 ms` | takes all beams at one instant | 0 |
//! | `100 ms`, `200 ms`, told | takes so long for a turn | the turn time |
//! | the same, untold | as above | 0 |
//!
//! Odometry is noisy and corrected. `golden/turning.txt` has one seed of the first two worlds,
//! `golden/turning-full.txt` ten of each, a row for each world and setting. What must hold of what
//! is told: all is explored, nothing is touched, and the mean error is small. What is untold shows
//! what the device would do without.

use fieldline_tests::golden;
use fieldline_tests::odometry::{self, Setting};
use fieldline_tests::runs::{assert_faultless, explored, in_parallel};
use fieldline_tests::table::{Table, number};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::robot::{Lidar, RobotSpec};
use host_sim::trial::mission::OdometryProfile;
use host_sim::world::World;

/// Worlds: rooms, round walls, narrow ways, and corridors.
const WORLDS: [&str; 4] = ["office", "cave", "maze:1", "ouroboros-a"];
/// Turn times, milliseconds, and whether the mount says them.
const SETTINGS: [(u16, bool); 5] = [
    (0, true),
    (100, true),
    (100, false),
    (200, true),
    (200, false),
];
/// Least share that is truly seen at the end.
const LEAST_SEEN: f64 = 0.98;
/// Greatest mean position error of what is told, metres.
const MOST_ERROR_M: f64 = 0.35;

/// One run.
struct Job<'a> {
    lidar: &'static str,
    robot: RobotSpec,
    world: &'a World,
    turn_ms: u16,
    told: bool,
    seed: u64,
}

impl Job<'_> {
    fn go(&self) -> Report {
        let noisy = Setting::corrected(OdometryProfile::Noisy);
        let mut mission = noisy.mission(self.seed).with_robot(&self.robot);
        mission.miswiring.turn_time_untold = !self.told;
        explored(&mission, self.world, &mut Direct::new()).0
    }

    fn said(&self) -> &'static str {
        match self.told {
            true => "told",
            false => "untold",
        }
    }
}

/// The usual robot with a lidar all round, 180 beams of 12 m.
fn all_round(turn_ms: u16) -> RobotSpec {
    let turn_s = f64::from(turn_ms) / 1000.0;
    let sweep = format!("-180,2,180,12,{turn_s}");
    RobotSpec::default().with_sweep(&sweep.parse().expect("a sweep"))
}

/// The usual robot with a clockwise lidar whose first beam looks ahead: 450 beams of 12 m.
fn clockwise(turn_ms: u16) -> RobotSpec {
    let mut robot = RobotSpec::default().with_sweep(&"0,0.8,450,12".parse().expect("a sweep"));
    robot.lidars[0] = Lidar {
        clockwise: true,
        turn_time_s: f64::from(turn_ms) / 1000.0,
        ..robot.lidars[0].clone()
    };
    robot
}

/// Returns the runs of a world with the lidar all round, setting by setting.
fn jobs(world: &World, seeds: core::ops::Range<u64>) -> Vec<Job<'_>> {
    let of = |(turn_ms, told): (u16, bool)| {
        seeds.clone().map(move |seed| Job {
            lidar: "180 beams",
            robot: all_round(turn_ms),
            world,
            turn_ms,
            told,
            seed,
        })
    };
    SETTINGS.into_iter().flat_map(of).collect()
}

fn worlds() -> Vec<World> {
    let open = |name| World::open(name).expect("a world");
    WORLDS.into_iter().map(open).collect()
}

fn percent(share: Option<f64>) -> String {
    number(share.map(|it| 100.0 * it), 2)
}

/// Returns a row for each run.
fn table(jobs: &[Job<'_>], reports: &[Report]) -> Table {
    let columns = ["lidar", "turn ms", "mount"];
    let more = ["wall p95 m", "ghosts %", "touched"];
    let cells = core::cell::RefCell::new(jobs.iter());
    odometry::table(reports, &columns, &more, |report| {
        let job = cells.borrow_mut().next().expect("a job for each report");
        let more = vec![
            number(report.map.and_then(|map| Some(map.wall_error_m?.p95)), 3),
            percent(report.map.map(|map| map.ghost_share)),
            report.safety.collisions.to_string(),
        ];
        let setting = [job.lidar, &job.turn_ms.to_string(), job.said()];
        (setting.map(str::to_owned).into(), more)
    })
}

/// Returns a row for each world and setting: sums and means over the seeds.
fn summary(jobs: &[Job<'_>], reports: &[Report], seeds: usize) -> Table {
    let columns = [
        "world",
        "turn ms",
        "mount",
        "runs",
        "explored",
        "seen %",
        "mean m",
        "worst m",
        "max m",
        "wall p95 m",
        "ghosts %",
        "touched",
    ];
    let mut table = Table::new(3, &columns);
    for (jobs, reports) in jobs.chunks(seeds).zip(reports.chunks(seeds)) {
        let job = &jobs[0];
        let mean = |of: &dyn Fn(&Report) -> Option<f64>| {
            let all: Option<Vec<f64>> = reports.iter().map(of).collect();
            all.map(|all| all.iter().sum::<f64>() / all.len() as f64)
        };
        let worst =
            |of: &dyn Fn(&Report) -> Option<f64>| reports.iter().filter_map(of).reduce(f64::max);
        let mean_m = |it: &Report| it.localization.mean_error_m;
        let wall_m = |it: &Report| Some(it.map?.wall_error_m?.p95);
        let explored = reports.iter().filter(|it| it.explored()).count();
        let touched: u32 = reports.iter().map(|it| it.safety.collisions).sum();
        table.row(vec![
            job.world.name().to_owned(),
            job.turn_ms.to_string(),
            job.said().into(),
            reports.len().to_string(),
            explored.to_string(),
            percent(mean(&|it| Some(it.coverage.fraction))),
            number(mean(&mean_m), 3),
            number(worst(&mean_m), 3),
            number(worst(&|it| it.localization.max_error_m), 3),
            number(mean(&wall_m), 3),
            percent(mean(&|it| Some(it.map?.ghost_share))),
            touched.to_string(),
        ]);
    }
    table
}

#[test]
fn a_turn_that_is_told_costs_nothing() {
    let worlds = worlds();
    let few = worlds.iter().take(2);
    let mut all: Vec<Job<'_>> = few.flat_map(|world| jobs(world, 0..1)).collect();
    // What is untold takes long in the end: the map is made of ghosts.
    all.retain(|job| job.told || job.turn_ms < 200);
    all.extend([true, false].map(|told| Job {
        lidar: "450 clockwise",
        robot: clockwise(100),
        world: &worlds[0],
        turn_ms: 100,
        told,
        seed: 0,
    }));
    let reports = in_parallel(&all, Job::go);
    golden::compare("turning.txt", &table(&all, &reports).to_string());
    let told = all.iter().zip(reports).filter(|(job, _)| job.told);
    let told: Vec<Report> = told.map(|(_, report)| report).collect();
    assert_faultless(&told, |report| {
        odometry::faults(report, LEAST_SEEN, MOST_ERROR_M)
    });
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 200 runs; tests/run --full runs it"]
    fn turning_lidars_in_four_worlds_with_ten_seeds() {
        let worlds = worlds();
        let all: Vec<Job<'_>> = worlds.iter().flat_map(|world| jobs(world, 0..10)).collect();
        let reports = in_parallel(&all, Job::go);
        let table = summary(&all, &reports, 10);
        golden::compare("turning-full.txt", &table.to_string());
    }
}
