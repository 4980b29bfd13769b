//! One trial on every rung: whole runs give the same command stream by call, by bytes, on the emulated chip and through a
//! serial port; bytes that go wrong on the way change nothing; and a device that is lost stops the robot.
//!
//! Equal digests mean equal velocities and statuses, bit for bit, step for step (`host_sim::link::digest`). The emulated
//! runs also give the exact number of instructions of every step, which `golden/costs.txt` keeps.

use core::time::Duration;
use std::path::Path;

use fieldline_protocol::BAUD;
use fieldline_protocol::message::{Observation, Status, Strategy, Twist};
use fieldline_tests::costs;
use fieldline_tests::runs::{FRONTIER, Run, in_parallel};
use fieldline_tests::{emulator, worlds};
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::fault::{Faults, Faulty};
use host_sim::link::loopback::{LocalDevice, loopback};
use host_sim::link::qemu::{self, PtyBoard};
use host_sim::link::{Link, serial};
use host_sim::report::Report;
use host_sim::report::tum::Stamped;
use host_sim::robot::Velocity;
use host_sim::sim::{SimConfig, Simulator};
use host_sim::trial::{self, Body, Cast, Flow, Progress, Record, Setup, Survey, Watch};
use host_sim::world::World;

/// Small worlds, each a few hundred steps long.
const SMALL: [&str; 3] = ["narrow-doors", "hall", "cluttered"];

fn by(name: &str, world: &World, link: &mut dyn Link) -> Report {
    let run = Run {
        world,
        strategy: FRONTIER,
        seed: 0,
        start: 0,
    };
    run.go_by(name, link)
}

fn clean(world: &World) -> Report {
    by("direct", world, &mut host_sim::link::direct::Direct::new())
}

/// The same run, told by another link.
fn assert_same(world: &World, clean: &Report, other: &Report) {
    assert!(clean.explored(), "{}: {:?}", world.name(), clean.outcome);
    let facts = |report: &Report| (report.digest.clone(), report.steps, report.outcome.clone());
    assert_eq!(
        facts(other),
        facts(clean),
        "{} by {}",
        world.name(),
        other.link
    );
    assert_eq!(other.debug.map_matches_mirror, Some(true));
}

#[test]
fn bytes_change_nothing() {
    for world in SMALL.map(worlds::builtin) {
        assert_same(
            &world,
            &clean(&world),
            &by("loopback", &world, &mut loopback()),
        );
    }
}

/// An end with faults on its line, to a device in this process.
fn faulty(faults: &str, seed: u64) -> Endpoint<Faulty<LocalDevice>> {
    let faults: Faults = faults.parse().expect("a fault specification");
    let line = Faulty::new(LocalDevice::new(), faults, seed);
    Endpoint::new(line, RetryPolicy::VIRTUAL, 1)
}

#[test]
fn faults_on_the_line_change_nothing() {
    let world = worlds::builtin("narrow-doors");
    let clean = clean(&world);
    for faults in [
        "drop=0.02",
        "duplicate=0.02",
        "corrupt=0.02",
        "truncate=0.02",
        "delay=0.05",
        "drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.02,delay=0.05",
    ] {
        let report = by(faults, &world, &mut faulty(faults, 1));
        assert_same(&world, &clean, &report);
        let stats = &report.link_stats;
        let noticed = stats.retries + stats.dropped + stats.crc_errors;
        assert!(noticed > 0, "{faults} was not felt: {stats:?}");
    }
}

#[test]
fn faults_on_the_line_change_nothing_in_any_small_world() {
    let faults = "drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.02,delay=0.05";
    for (seed, world) in (2..).zip(SMALL.map(worlds::builtin)) {
        let report = by(faults, &world, &mut faulty(faults, seed));
        assert_same(&world, &clean(&world), &report);
    }
}

#[test]
fn the_emulated_chip_explores_as_the_host_does_and_within_its_means() {
    let Some(image) = emulator::image() else {
        return;
    };
    let reports = in_parallel(&SMALL, |name| {
        let world = worlds::builtin(name);
        let report = by("qemu", &world, &mut emulated(&image));
        assert_same(&world, &clean(&world), &report);
        report
    });
    costs::check("costs.txt", &reports);
}

#[test]
fn every_world_costs_the_chip_no_more_than_it_has() {
    if !fieldline_tests::full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    let Some(image) = emulator::image() else {
        return;
    };
    let explore = |world: &World| {
        let report = by("qemu", world, &mut emulated(&image));
        assert_same(world, &clean(world), &report);
        report
    };
    let ours = in_parallel(&worlds::EXPLORABLE, |name| explore(&worlds::builtin(name)));
    costs::check("costs-full.txt", &ours);
    if let Some(others) = worlds::drawn_by_others() {
        costs::check("costs-data.txt", &in_parallel(&others, explore));
    }
}

fn emulated(image: &Path) -> Endpoint<qemu::QemuLine> {
    let line = qemu::open_line(image).expect("it started a moment ago");
    Endpoint::new(line, RetryPolicy::LOCKSTEP, 1)
}

#[test]
fn a_serial_port_explores_as_the_host_does() {
    let Some(image) = emulator::image() else {
        return;
    };
    for world in SMALL.map(worlds::builtin) {
        let board = PtyBoard::start(&image).expect("it started a moment ago");
        let mut port = serial::serial(board.device(), BAUD).expect("the pty is there");
        assert_same(&world, &clean(&world), &by("serial", &world, &mut port));
    }
}

/// A robot whose every period is written down.
struct Witness<'w> {
    robot: Simulator<'w>,
    periods: Vec<Period>,
}

/// One of them.
struct Period {
    begin_ms: u32,
    told: bool,
    after: Velocity,
}

impl Body for Witness<'_> {
    fn period_ms(&self) -> u32 {
        self.robot.config().period_ms
    }
    fn observe(&mut self) -> Observation {
        self.robot.observe()
    }
    fn drive(&mut self, velocity: Option<Twist>) {
        let begin_ms = self.robot.time_ms();
        self.robot.drive(velocity);
        self.periods.push(Period {
            begin_ms,
            told: velocity.is_some(),
            after: self.robot.velocity(),
        });
    }
    fn truth(&self) -> Stamped {
        Body::truth(&self.robot)
    }
}

/// Nobody keeps account, nobody looks on.
struct Nobody;

impl Survey for Nobody {
    fn note(&mut self, _: &Observation, _: Status) -> f64 {
        0.0
    }
}

impl Watch for Nobody {
    fn step(&mut self, _: &Progress) -> Flow {
        Flow::Continue
    }
}

/// A run over `link`, with every period of it.
fn witnessed(link: &mut dyn Link, world: &World) -> (Record, Vec<Period>) {
    let robot = Simulator::new(world, SimConfig::default()).expect("the start is free");
    let setup = Setup {
        start: robot.start_message(Strategy::Frontier, (20, 20)),
        time_limit_ms: 600_000,
        check_field: false,
        snapshots: 0,
    };
    let mut body = Witness {
        robot,
        periods: Vec::new(),
    };
    let record = trial::run(
        &setup,
        &mut Cast {
            link,
            body: &mut body,
            survey: &mut Nobody,
            watch: &mut Nobody,
        },
    );
    assert_eq!(body.robot.safety().collisions, 0);
    (record, body.periods)
}

/// The robot goes on as it was told last for no longer than the stale limit, and then brakes until it stands.
fn assert_stopped(periods: &[Period]) {
    let last_told_ms = periods
        .iter()
        .rfind(|period| period.told)
        .map_or(0, |period| period.begin_ms);
    let config = SimConfig::default();
    let stale_ms = last_told_ms + config.stale_ms;
    let speed = |period: &Period| period.after.linear_mps.abs();
    let late: Vec<&Period> = periods
        .iter()
        .filter(|period| period.begin_ms >= stale_ms)
        .collect();
    assert!(late.len() > 5, "the run goes on until the robot stands");
    for pair in late.windows(2) {
        assert!(
            speed(pair[1]) < speed(pair[0]) || speed(pair[0]) == 0.0,
            "it brakes"
        );
    }
    let limits = config.limits;
    let braking_s =
        (limits.linear_mps / limits.braking_mps2).max(limits.angular_radps / limits.angular_radps2);
    let still_ms = stale_ms + (braking_s * 1000.0) as u32;
    for period in late.iter().filter(|period| period.begin_ms >= still_ms) {
        assert_eq!(period.after, Velocity::default(), "it stands");
    }
}

#[test]
fn a_device_that_is_lost_stops_the_robot_and_ends_the_run() {
    let world = worlds::builtin("loop");
    for (faults, reason) in [
        ("reset@200", "device-reset"),
        ("silent@200", "link-silent"),
        (
            "drop=0.02,corrupt=0.02,delay=0.05,reset@200",
            "device-reset",
        ),
        ("duplicate=0.02,truncate=0.02,silent@200", "link-silent"),
    ] {
        let mut link = faulty(faults, 3);
        let (record, periods) = witnessed(&mut link, &world);
        let ending = (record.ending.status(), record.ending.reason());
        assert_eq!(ending, ("fault", reason), "{faults}");
        assert!(record.ending.advice().is_some(), "{faults}");
        assert!((100..200).contains(&record.steps.len()), "{faults}");
        let was_driving = record.steps.last().map(|step| step.command.velocity);
        assert_ne!(
            was_driving,
            Some(Twist::default()),
            "{faults}: no test of stopping"
        );
        assert_stopped(&periods);
    }
}

/// Of the time that passes while nobody answers, no more than the stale limit, by the line's own clock.
#[test]
fn the_host_gives_up_within_the_stale_limit() {
    let world = worlds::builtin("loop");
    let mut link = faulty("silent@200", 3);
    let (record, _) = witnessed(&mut link, &world);
    assert_eq!(record.ending.reason(), "link-silent");
    let limit = Duration::from_millis(u64::from(fieldline_device::STALE_MS));
    assert!(link.now() <= limit, "{:?}", link.now());
}
