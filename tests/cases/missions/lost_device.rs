//! A device that is lost stops the robot and ends the run with a typed fault.

use core::time::Duration;

use fieldline_protocol::message::{Command, Observation, Strategy, Twist};
use fieldline_tests::worlds;
use host_sim::link::Link;
use host_sim::report::tum::Stamped;
use host_sim::robot::Velocity;
use host_sim::sim::{SimConfig, Simulator};
use host_sim::trial::itinerary::Orders;
use host_sim::trial::{self, Body, Cast, Record, Setup, Survey};
use host_sim::world::World;

use crate::links::faulty;

/// A robot that notes every period.
struct Witness<'w> {
    robot: Simulator<'w>,
    periods: Vec<Period>,
}

/// One period.
struct Period {
    begin_ms: u32,
    commanded: bool,
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
            commanded: velocity.is_some(),
            after: self.robot.velocity(),
        });
    }
    fn truth(&self) -> Stamped {
        Body::truth(&self.robot)
    }
}

/// A survey that does nothing.
struct Nobody;

impl Survey for Nobody {
    fn note(&mut self, _: &Observation, _: &Stamped, _: &Command) -> f64 {
        0.0
    }
}

/// Makes a run over `link`; returns the record and all periods.
fn witnessed(link: &mut dyn Link, world: &World) -> (Record, Vec<Period>) {
    let robot = Simulator::new(world, SimConfig::default()).expect("the start is free");
    let setup = Setup {
        start: robot.start_message(Strategy::Frontier),
        time_limit_ms: 600_000,
        check_field: false,
        snapshots: 0,
        resumes: false,
        orders: Orders::default(),
        corrects: false,
        known: None,
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
            watch: &mut (),
            corrector: &mut (),
            keeper: &mut (),
        },
    );
    assert_eq!(body.robot.safety().collisions, 0);
    (record, body.periods)
}

/// Asserts that the robot keeps its last command no longer than the stale limit, then brakes until
/// it stands.
fn assert_stopped(periods: &[Period]) {
    let last_command_ms = periods
        .iter()
        .rfind(|period| period.commanded)
        .map_or(0, |period| period.begin_ms);
    let config = SimConfig::default();
    let stale_ms = last_command_ms + config.stale_ms;
    let speed = |period: &Period| period.after.linear_mps.abs();
    let late: Vec<&Period> = periods
        .iter()
        .filter(|period| period.begin_ms >= stale_ms)
        .collect();
    assert!(late.len() > 5, "the run must go on until the robot stands");
    for pair in late.windows(2) {
        assert!(
            speed(pair[1]) < speed(pair[0]) || speed(pair[0]) == 0.0,
            "it must brake"
        );
    }
    let limits = config.limits;
    let braking_s =
        (limits.linear_mps / limits.braking_mps2).max(limits.angular_radps / limits.angular_radps2);
    let still_ms = stale_ms + (braking_s * 1000.0) as u32;
    for period in late.iter().filter(|period| period.begin_ms >= still_ms) {
        assert_eq!(period.after, Velocity::default(), "it must stand");
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
            "{faults}: the robot must drive before it stops"
        );
        assert_stopped(&periods);
    }
}

/// By the line's own clock, no more than the stale limit passes while the device is silent.
#[test]
fn the_host_gives_up_within_the_stale_limit() {
    let world = worlds::builtin("loop");
    let mut link = faulty("silent@200", 3);
    let (record, _) = witnessed(&mut link, &world);
    assert_eq!(record.ending.reason(), "link-silent");
    let limit = Duration::from_millis(u64::from(fieldline_device::STALE_MS));
    assert!(link.now() <= limit, "{:?}", link.now());
}
