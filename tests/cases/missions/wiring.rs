//! Wiring mistakes: what a robot's first metre and quarter turn tell, and that a robot that is
//! wired rightly is never accused.
//!
//! `golden/wiring.txt` has a row for each mistake: how many of the runs were told it by its own
//! name, how many by that of another mistake, and how many ended otherwise or went on. Time and way
//! are those until it was told.

use core::fmt::Write as _;

use fieldline_protocol::message::Fault;
use fieldline_tests::runs::{explored, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::robot::{RobotSpec, presets};
use host_sim::trial::Ending;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::world::World;

/// Simulated time of a run, milliseconds.
const UNTIL_MS: u32 = 30_000;
/// Mistakes, the words with which a run ends, and if every run must end so.
const MISTAKES: [(&str, &str, bool); 18] = [
    ("mirrored", "scan-mirrored", true),
    ("yaw-sign", "yaw-reversed", true),
    ("wheels-swapped", "turns-reversed", true),
    ("reversed", "drive-reversed|turns-reversed", true),
    ("millimetres", "way-too-long", true),
    ("ranges-times=0.001", "ranges-too-short", true),
    ("clock-stands", "clock-stands", true),
    ("clock-times=1000", "clock-fast", true),
    ("laser-turned=90", "laser-turned-left", false),
    ("laser-turned=-90", "laser-turned-right", false),
    ("laser-turned=180", "laser-turned-back", false),
    ("lasers-swapped", "lasers-swapped", false),
    ("way-sign", "way-reversed", false),
    ("odometry-times=2", "way-too-long", false),
    ("odometry-times=0.5", "way-too-short", false),
    ("odometry-times=0.001", "way-too-short", false),
    ("yaw-times=2", "turn-too-great", false),
    ("yaw-times=0.5", "turn-too-small", false),
];
const WORLDS: [&str; 4] = ["office", "cave", "cluttered", "rooms:5"];

/// A run.
#[derive(Clone)]
struct Job<'a> {
    world: &'a World,
    robot: RobotSpec,
    mistake: &'static str,
    odometry: OdometryProfile,
    disturbances: &'static str,
    seed: u64,
}

impl Job<'_> {
    /// Returns the report, and true if a mistake was told.
    fn go(&self) -> (Report, bool) {
        let mission = Mission {
            seed: self.seed,
            odometry: self.odometry,
            localise: true,
            time_limit_ms: UNTIL_MS,
            miswiring: match self.mistake {
                "" => Default::default(),
                text => text.parse().expect("valid"),
            },
            disturbances: match self.disturbances {
                "" => Default::default(),
                text => text.parse().expect("valid"),
            },
            ..Mission::default()
        };
        let mission = mission.with_robot(&self.robot);
        let (report, record) = explored(&mission, self.world, &mut Direct::new());
        let told = matches!(record.ending, Ending::Fault(Fault::Miswired(_)));
        (report, told)
    }
}

/// Returns the mean and the greatest of some numbers; dashes without any.
fn spread(numbers: &[f64], digits: usize) -> [String; 2] {
    if numbers.is_empty() {
        return ["-", "-"].map(String::from);
    }
    let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
    let most = numbers.iter().copied().fold(0.0, f64::max);
    [mean, most].map(|it| number(Some(it), digits))
}

#[test]
fn mistakes_are_told_in_the_first_metre() {
    let worlds = WORLDS.map(|name| World::open(name).expect("a world"));
    let mut jobs = Vec::new();
    for (mistake, ..) in MISTAKES {
        for world in &worlds {
            jobs.push(Job {
                world,
                robot: RobotSpec::default(),
                mistake,
                odometry: OdometryProfile::Noisy,
                disturbances: "",
                seed: 0,
            });
        }
    }
    let results = in_parallel(&jobs, Job::go);
    let columns = [
        "mistake",
        "runs",
        "told",
        "as another",
        "mean s",
        "most s",
        "mean m",
        "most m",
    ];
    let mut table = Table::new(1, &columns);
    let mut missed = String::new();
    for (mistake, word, always) in MISTAKES {
        let of_mistake = || {
            jobs.iter()
                .zip(&results)
                .filter(|(job, _)| job.mistake == mistake)
        };
        let told: Vec<&Report> = of_mistake()
            .filter(|(_, (report, told))| {
                *told && word.split('|').any(|it| it == report.outcome.reason)
            })
            .map(|(_, (report, _))| report)
            .collect();
        let others = of_mistake().filter(|(_, (_, told))| *told).count() - told.len();
        let runs = of_mistake().count();
        if always && told.len() < runs {
            let _ = writeln!(missed, "{mistake}: {} of {runs}", told.len());
        }
        let seconds: Vec<f64> = told.iter().map(|report| report.sim_time_s).collect();
        let metres: Vec<f64> = told.iter().map(|report| report.path_length_m).collect();
        let counts = [runs, told.len(), others].map(|count| count.to_string());
        let row = [mistake.to_string()].into_iter().chain(counts);
        table.row(
            row.chain(spread(&seconds, 1))
                .chain(spread(&metres, 2))
                .collect(),
        );
    }
    golden::compare("wiring.txt", &table.to_string());
    assert!(missed.is_empty(), "{missed}");
}

/// Returns what was told to robots that are wired rightly.
fn accusations(jobs: &[Job<'_>]) -> String {
    let results = in_parallel(jobs, Job::go);
    let told = jobs.iter().zip(&results).filter(|(_, (_, told))| *told);
    told.map(|(job, (report, _))| {
        let (world, robot) = (job.world.name(), &job.robot.name);
        format!(
            "{world}, {robot}, seed {}: {}\n",
            job.seed, report.outcome.reason
        )
    })
    .collect()
}

/// Runs of robots, worlds, odometries and seeds.
fn healthy<'a>(robots: &[&str], worlds: &'a [World], seeds: u64) -> Vec<Job<'a>> {
    let mut jobs = Vec::new();
    for robot in robots {
        let robot = RobotSpec::open(robot).expect("a preset");
        for world in worlds {
            for odometry in [OdometryProfile::Noisy, OdometryProfile::Papers] {
                jobs.extend((0..seeds).map(|seed| Job {
                    world,
                    robot: robot.clone(),
                    mistake: "",
                    odometry,
                    disturbances: "",
                    seed,
                }));
            }
        }
    }
    jobs
}

/// The first seconds may also be disturbed: a restart of the odometry, a slip, beams that are
/// missing, a laser that is dark.
#[test]
fn nobody_is_accused_who_is_wired_rightly() {
    let worlds = ["office", "cave", "loop", "narrow-doors"].map(worlds::builtin);
    let mut jobs = healthy(&["pioneer-3at", "round-0.35"], &worlds, 1);
    for disturbances in [
        "restart@2",
        "slip@2",
        "missing=0.3",
        "dark@1-3",
        "slip@1,dark@3-4",
    ] {
        jobs.push(Job {
            world: &worlds[0],
            robot: RobotSpec::default(),
            mistake: "",
            odometry: OdometryProfile::Noisy,
            disturbances,
            seed: 0,
        });
    }
    assert_eq!(accusations(&jobs), "");
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 530 runs; tests/run --full runs it"]
    fn nobody_is_accused_who_is_wired_rightly() {
        let names = [
            "office",
            "cave",
            "loop",
            "cluttered",
            "hall",
            "empty-hall",
            "narrow-doors",
            "unreachable-room",
            "ouroboros-a",
            "ouroboros-b",
            "maze:3",
        ];
        let worlds = names.map(|name| World::open(name).expect("a world"));
        // The wide robot does not fit into the maze's cells.
        let (all, maze) = (&worlds[..10], &worlds[10..]);
        let mut jobs = healthy(&presets::names(), all, 5);
        jobs.extend(healthy(
            &["pioneer-3at", "round-0.35", "turtlebot3-burger"],
            maze,
            5,
        ));
        assert_eq!(accusations(&jobs), "");
    }
}
