//! Every documented option of strategies, ground, localisation and teams once on the emulated chip,
//! in short runs: no crash, the same command stream as by call, and the stack within its bound.
//!
//! `golden/costs-options.txt` has the deepest stack of each and the most instructions of a step.

use std::path::Path;

use fieldline_protocol::message::{Command, Observation, Order, Preference, Scan};
use fieldline_tests::emulator::{chip, image};
use fieldline_tests::runs::{explored, in_parallel};
use fieldline_tests::table::Table;
use fieldline_tests::uneven::UnevenRun;
use fieldline_tests::watched::Watched;
use fieldline_tests::{costs, golden, worlds};
use fixed::types::I4F12;
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::replay::carmen::{Beams, LogScan};
use host_sim::replay::run;
use host_sim::replay::wire::LogLaser;
use host_sim::report::Report;
use host_sim::robot::Footprint;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::trial::team::{TeamMission, explore as explore_as_team};
use host_sim::world::World;

use crate::stack::MOST as MOST_STACK;

/// Simulated time of a run of one robot, milliseconds.
const RUN_MS: u32 = 12_000;
/// Simulated time of a run of a team, milliseconds: the robots begin to meet.
const TEAM_MS: u32 = 16_000;
/// Simulated time of a patrol of the smallest world with its exploration, milliseconds.
const PATROL_MS: u32 = 30_000;
/// Faults of wheels and lasers, as on the command line.
const DISTURBANCES: &str = "slip@2,spin@3-4,push@5-6,dark@7-8,missing=0.3";
/// Most instructions of a step, whatever the options.
const MOST_INSTRUCTIONS: f64 = 8e6;

/// One run of one robot.
struct Case {
    /// Its options as on the command line.
    options: String,
    world: &'static str,
    mission: Mission,
}

/// What a run on the chip took.
struct Taken {
    options: String,
    world: String,
    steps: u64,
    instructions: f64,
    stack_bytes: u32,
}

impl Taken {
    fn of(options: &str, report: &Report) -> Self {
        let instructions = report.planner.instructions.expect("the chip counts them");
        Self {
            options: options.into(),
            world: report.world.clone(),
            steps: report.steps,
            instructions: instructions.max,
            stack_bytes: report.planner.stack_bytes.expect("the chip measures it"),
        }
    }
}

fn of(options: &str, world: &'static str, change: impl FnOnce(&mut Mission)) -> Case {
    let mut mission = Mission {
        time_limit_ms: RUN_MS,
        ..Mission::default()
    };
    change(&mut mission);
    Case {
        options: options.into(),
        world,
        mission,
    }
}

/// Returns the runs on flat ground.
fn flat() -> Vec<Case> {
    let strategy = |options: &str, world, name: &str| {
        of(&format!("--strategy {name}{options}"), world, |it| {
            it.strategy = name.into();
        })
    };
    let patrol = of("--strategy tdbvp --patrol-for 20", "partition", |it| {
        (it.strategy, it.patrol_s, it.time_limit_ms) = ("tdbvp".into(), 20, PATROL_MS);
    });
    let corrected = |options: &str, change: fn(&mut Mission)| {
        of(options, "office", |it| {
            (it.odometry, it.localise) = (OdometryProfile::Noisy, true);
            change(it);
        })
    };
    vec![
        strategy("", "office", "frontier"),
        strategy("", "ouroboros-a", "ouroboros"),
        strategy("", "tdbvp-nested", "tdbvp"),
        strategy("", "c-room", "sbpf"),
        strategy("", "c-room", "esbpf"),
        patrol,
        of("--order nearest", "office", |it| {
            it.order = Some(Order::Nearest { worth: I4F12::ZERO });
        }),
        of("--worth 0", "office", |it| {
            let worth = I4F12::ZERO;
            it.order = Some(Order::Gain { worth });
        }),
        of("--hull 0.9x0.6x0.4 --radius 0.5", "hall", |it| {
            (it.hull, it.radius_m) = (Footprint::rectangle(0.9, 0.6, 0.4), 0.5);
        }),
        corrected("--odometry noisy", |_| ()),
        corrected("--odometry papers", |it| {
            it.odometry = OdometryProfile::Papers;
        }),
        corrected("--odometry mobilesim", |it| {
            it.odometry = OdometryProfile::MobileSim;
        }),
        corrected("--odometry noisy --localise off", |it| it.localise = false),
        corrected("--odometry noisy --people 10", |it| it.people = 10),
        corrected(
            &format!("--odometry noisy --disturb {DISTURBANCES}"),
            |it| {
                it.disturbances = DISTURBANCES.parse().expect("five disturbances");
            },
        ),
    ]
}

/// Returns the runs on uneven ground.
fn uneven() -> Vec<Case> {
    let case = |options: &str, change: fn(&mut UnevenRun<'_>), odometry| {
        let world = worlds::builtin("pass");
        let mut run = UnevenRun::of(&world, 0, 0);
        change(&mut run);
        let mission = Mission {
            odometry,
            localise: odometry != OdometryProfile::Truth,
            time_limit_ms: RUN_MS,
            ..run.mission()
        };
        Case {
            options: format!("--ground uneven {options}"),
            world: "pass",
            mission,
        }
    };
    let (truth, noisy) = (OdometryProfile::Truth, OdometryProfile::Noisy);
    let mut cases = vec![
        case(
            "--preference off",
            |it| it.preference = Preference::Off,
            truth,
        ),
        case(
            "--preference height",
            |it| it.preference = Preference::Height,
            truth,
        ),
        case(
            "--preference global",
            |it| it.preference = Preference::Global,
            truth,
        ),
        case("--preference both", |_| (), truth),
        case("--levels off", |it| it.levels = Some(false), truth),
        case(
            "--ground-parameters roll=10",
            |it| it.roll_deg = Some(10.0),
            truth,
        ),
        case("--odometry noisy", |_| (), noisy),
    ];
    for strategy in ["ouroboros", "tdbvp", "sbpf", "esbpf"] {
        let mut case = case(&format!("--strategy {strategy}"), |_| (), truth);
        case.mission.strategy = strategy.into();
        cases.push(case);
    }
    cases
}

/// One run of a team: the second robot is a chip, the other ones are called.
struct TeamCase {
    options: &'static str,
    world: &'static str,
    strategy: &'static str,
    change: fn(&mut TeamMission),
}

fn teams() -> Vec<TeamCase> {
    let case = |options, strategy, change| TeamCase {
        options,
        world: "hall",
        strategy,
        change,
    };
    let uneven = |it: &mut TeamMission| {
        let world = worlds::builtin("pass");
        it.mission.uneven_ground = UnevenRun::of(&world, 0, 0).mission().uneven_ground;
    };
    let rough = |it: &mut TeamMission| {
        (it.mission.odometry, it.mission.localise) = (OdometryProfile::Noisy, true);
        it.start_error = "0.3,5".parse().expect("two numbers");
    };
    let noisy = |it: &mut TeamMission| {
        (it.mission.odometry, it.mission.localise) = (OdometryProfile::Noisy, true);
    };
    let lossy = |it: &mut TeamMission| {
        let radio = "range=10,walls=8,loss=0.3,duplicate=0.1,delay=0.4,reorder=0.1";
        it.radio = radio.parse().expect("a radio");
    };
    let timetable = |it: &mut TeamMission| {
        it.timetable.leave = vec!["0@4".parse().expect("an appointment")];
        it.timetable.join = vec!["0@8".parse().expect("an appointment")];
    };
    vec![
        case("team", "frontier", |_| ()),
        case("team --strategy ouroboros", "ouroboros", |_| ()),
        case("team --strategy tdbvp", "tdbvp", |_| ()),
        case("team --strategy sbpf", "sbpf", |_| ()),
        case("team --strategy esbpf", "esbpf", |_| ()),
        case("team --robots 8", "frontier", |it| {
            *it = TeamMission::of(it.mission.clone(), 8);
        }),
        case("team --apart", "frontier", |it| it.apart = true),
        case("team --order nearest", "frontier", |it| {
            it.mission.order = Some(Order::Nearest { worth: I4F12::ZERO });
        }),
        case("team --radio lossy", "frontier", lossy),
        case("team --leave 0@4 --join 0@8", "frontier", timetable),
        case("team --odometry noisy", "frontier", noisy),
        case(
            "team --odometry noisy --start-error 0.3,5",
            "frontier",
            rough,
        ),
        TeamCase {
            world: "pass",
            ..case("team --ground uneven", "frontier", uneven)
        },
    ]
}

/// Returns the report of a crash or of another end of a run that the planner did not decide.
fn lost(report: &Report) -> Option<String> {
    let outcome = &report.outcome;
    let is_over = outcome.status == "finished" || outcome.status == "time-limit";
    (!is_over).then(|| format!("{} ({})", outcome.status, outcome.reason))
}

/// Asserts that the chip did what the robot did that was called, to the bit.
fn assert_same(options: &str, called: &Report, chip: &Report) {
    assert_eq!(lost(chip), None, "{options}");
    let facts = |report: &Report| (report.digest.clone(), report.steps, report.outcome.clone());
    assert_eq!(facts(chip), facts(called), "{options}");
}

fn alone(case: &Case, image: &Path) -> Taken {
    let world = worlds::builtin(case.world);
    let called = explored(&case.mission, &world, &mut Direct::new()).0;
    let report = explored(&case.mission, &world, &mut chip(image)).0;
    assert_same(&case.options, &called, &report);
    Taken::of(&case.options, &report)
}

fn in_team(case: &TeamCase, image: &Path) -> Taken {
    let mission = Mission {
        strategy: case.strategy.into(),
        time_limit_ms: TEAM_MS,
        ..Mission::default()
    };
    let mut team = TeamMission::of(mission, 2);
    (case.change)(&mut team);
    let world = worlds::builtin(case.world);
    let called = second_of(&team, &world, case.options, || Box::new(Direct::new()));
    let report = second_of(&team, &world, case.options, || Box::new(chip(image)));
    assert_same(case.options, &called, &report);
    Taken::of(case.options, &report)
}

/// Explores as a team, of which the second robot has this link; returns its report.
fn second_of(
    team: &TeamMission,
    world: &World,
    options: &str,
    link: impl Fn() -> Box<dyn Link>,
) -> Report {
    let link_of = |robot| {
        if robot == 1 {
            link()
        } else {
            Box::new(Direct::new())
        }
    };
    let mut links: Vec<Box<dyn Link>> = (0..team.robots).map(link_of).collect();
    match explore_as_team(team, world, &mut links, &mut ()) {
        Ok((report, _)) => report.robots[1].report.clone(),
        Err(error) => panic!("{options}: {error}"),
    }
}

/// Replays a log of a short exploration: a session that surveys.
fn replay(image: &Path) -> Taken {
    let mut log = Vec::new();
    let note = |_: &mut Direct, observation: &Observation, _: &_| {
        log.extend(log_scan(observation));
        Ok(())
    };
    let case = of("replay", "office", |_| ());
    let world = worlds::builtin(case.world);
    let _ = explored(
        &case.mission,
        &world,
        &mut Watched::new(Direct::new(), note),
    );
    let laser = LogLaser::of(&log);
    let odometry = run::odometry(&log, Some(2.0), 0);
    let by = |link: &mut dyn Link| {
        run::run(&laser, &log, &odometry, link, None, &mut ())
            .expect("the replay goes on to its end")
    };
    let (mut instructions, mut stack_bytes) = (0, 0);
    let mut counted = Watched::new(chip(image), |_: &mut _, _: &_, command: &Command| {
        instructions = instructions.max(command.cost.instructions);
        stack_bytes = command.cost.stack_bytes;
        Ok(())
    });
    let replayed = by(&mut counted);
    assert_eq!(replayed, by(&mut Direct::new()));
    Taken {
        options: case.options,
        world: case.world.into(),
        steps: log.len() as u64,
        instructions: f64::from(instructions),
        stack_bytes,
    }
}

/// Returns an observation as a line of a log; `None` without a scan.
fn log_scan(observation: &Observation) -> Option<LogScan> {
    let Scan { ranges_mm } = observation.scans.first()?;
    let pose = &observation.pose;
    let place: [f64; 3] = [pose.x.to_num(), pose.y.to_num(), pose.yaw.to_num()];
    Some(LogScan {
        line: 1,
        time: f64::from(observation.time_ms) / 1000.0,
        ranges: ranges_mm
            .iter()
            .map(|range| f64::from(*range) / 1000.0)
            .collect(),
        beams: Beams::half_turn(ranges_mm.len()),
        laser: place,
        odometry: place,
        speed: [
            observation.velocity.linear.to_num(),
            observation.velocity.angular.to_num(),
        ],
    })
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn every_option_runs_on_the_chip_as_on_the_host_within_its_stack() {
    let image = image();
    let cases: Vec<Case> = flat().into_iter().chain(uneven()).collect();
    let mut taken = in_parallel(&cases, |case| alone(case, &image));
    taken.extend(in_parallel(&teams(), |case| in_team(case, &image)));
    taken.push(replay(&image));
    let columns = [
        "options",
        "world",
        "steps",
        "most instructions",
        "stack bytes",
    ];
    let mut table = Table::new(2, &columns);
    for it in &taken {
        table.row(vec![
            it.options.clone(),
            it.world.clone(),
            it.steps.to_string(),
            format!("{:.0}", it.instructions),
            it.stack_bytes.to_string(),
        ]);
    }
    golden::compare_about("costs-options.txt", &table.to_string(), costs::DRIFT);
    for it in &taken {
        assert!(it.instructions <= MOST_INSTRUCTIONS, "{table}");
        assert!(it.stack_bytes <= MOST_STACK, "{table}");
    }
}
