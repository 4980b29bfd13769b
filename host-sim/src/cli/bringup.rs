//! `host-sim bringup`: the six steps of a first day with a robot.

use core::time::Duration;

use anyhow::{Context as _, Result};
use clap::Args;
use fieldline_protocol::message::Strategy;
use host_sim::bringup::{self, Step};
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::robot::Miswiring;
use host_sim::sim::Simulator;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::world::World;

use super::common::CommonArgs;
use super::prepared::await_board;
use super::robot::RobotArgs;
use super::values::{start, wait};
use super::{note, say};

#[derive(Debug, Args)]
pub(super) struct BringupArgs {
    /// direct, loopback, qemu or serial:DEVICE[@BAUD]; the robot is the simulated one
    #[arg(long, default_value = "loopback")]
    link: LinkSpec,
    /// World in which the simulated robot stands
    #[arg(long, value_name = "WORLD", default_value = "office")]
    world: String,
    /// Index of the world's start pose, from 0; that of the default is in a room
    #[arg(
        long,
        value_name = "N",
        default_value = "1",
        value_parser = start,
        allow_negative_numbers = true
    )]
    start: usize,
    /// What is wired wrongly, as of explore
    #[arg(long, value_name = "SPEC")]
    miswire: Option<Miswiring>,
    /// Seconds to wait for a board on a serial port that still boots, at most 600
    #[arg(long, value_name = "S", default_value = "15", value_parser = wait)]
    wait: Duration,
    #[command(flatten)]
    robot: RobotArgs,
    #[command(flatten)]
    common: CommonArgs,
}

/// Makes the steps; returns true if all passed.
pub(super) fn run(args: &BringupArgs) -> Result<bool> {
    let mission = args.robot.applied(Mission {
        seed: args.common.seed,
        start: args.start,
        odometry: OdometryProfile::Noisy,
        miswiring: args.miswire.unwrap_or_default(),
        ..Mission::default()
    });
    let world = World::open(&args.world)?;
    let mut robot = Simulator::new(&world, mission.sim_config())?;
    let start = robot.start_message(Strategy::Frontier);
    let options = Options {
        tuning: args.robot.tuning(&args.link)?,
        ..Options::default()
    };
    let name = args.link.to_string();
    let mut link = args
        .link
        .open(&options)
        .with_context(|| format!("--link {name}"))?;
    if let LinkSpec::Serial { device, .. } = &args.link {
        // A board that does not answer fails in the first step, which says so.
        let _ = await_board(link.as_mut(), device, args.wait);
    }
    let mut told = Ok(());
    let passed = bringup::run(link.as_mut(), &mut robot, &start, |step| {
        let line = if args.common.json {
            json(step)
        } else {
            Ok(text(step))
        };
        if told.is_ok() {
            told = line.and_then(|line| say(&line));
        }
    });
    told?;
    if !passed {
        note("host-sim: bring-up ended at a step that failed; mend it and begin again");
    }
    Ok(passed)
}

fn json(step: &Step) -> Result<String> {
    Ok(serde_json::to_string(step)?)
}

fn text(step: &Step) -> String {
    let word = if step.passed { "pass" } else { "FAIL" };
    let mut text = format!(
        "{} {:5}  {}\n         {word}: {}",
        step.number, step.name, step.to_do, step.seen
    );
    if let Some(remedy) = &step.remedy {
        text += &format!("\n         {remedy}");
    }
    text
}
