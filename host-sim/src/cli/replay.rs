//! `host-sim replay`: a recorded log through the device's localisation and mapping.

mod input;

use std::path::{Path, PathBuf};

use anyhow::{Error, Result, bail};
use clap::Args;

use fieldline_protocol::message::Status;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::live::About;
use host_sim::replay::carmen;
use host_sim::replay::report::{Files, ReplayReport};
use host_sim::replay::run::Replayed;
use host_sim::report::folder;
use host_sim::robot::{RobotSpec, Sweep};
use host_sim::slam::SlamPlace;
use host_sim::slam::particles::ParticleSpec;
use host_sim::trial::wording;

use super::along::Along;
use super::common::{CommonArgs, FolderArgs};
use super::live::LiveArg;
use super::recording::{self, Recorder};
use super::robot::{self as robots, TuneArgs, robot};
use super::values::{live as live_place, slam_place};
use super::{made_by, note, note_build, say};
use input::{Input, laser};

#[derive(Clone, Debug, Args)]
pub(super) struct ReplayArgs {
    /// CARMEN log with FLASER or ROBOTLASER1 lines, plain or gzip; or a recording of explore
    /// --record, whose requests are made again
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// True motions between poses of the log, lines of `t1 t2 x y z roll pitch yaw`
    #[arg(long, value_name = "FILE")]
    relations: Option<PathBuf>,
    /// Seconds by which the relations' clock is ahead of the log's [default: found by the log's
    /// odometry]
    #[arg(
        long,
        value_name = "S",
        value_parser = finite,
        requires = "relations",
        allow_negative_numbers = true
    )]
    relations_offset: Option<f64>,
    /// Make odometry that drifts from the log's poses, which are corrected ones: the usual noise
    /// with variances times this [default: the log's own odometry]
    #[arg(long, value_name = "K", value_parser = factor, allow_negative_numbers = true)]
    degrade: Option<f64>,
    /// Robot that made the log, a robot file or a preset: its first laser's mount, sweep, range and
    /// mask, its hull and its speeds [default: the laser as the log tells it]
    #[arg(long, value_name = "FILE|PRESET", value_parser = robot)]
    robot: Option<RobotSpec>,
    /// Sweep of the laser: first angle and step in degrees, beams, range in metres, as in
    /// -180,1,360,12; and, of a lidar that turns, seconds from the first beam to the last one
    /// [default: told by the lines, or found by the scans; no turn time]
    #[arg(
        long,
        value_name = "FIRST,STEP,BEAMS,RANGE[,TURN]",
        value_parser = robots::sweep,
        allow_hyphen_values = true
    )]
    laser: Option<Sweep>,
    /// Close loops by a pose graph: off, or host, beside the device
    #[arg(long, value_name = "WHERE", default_value = "off", value_parser = slam_place)]
    slam: SlamPlace,
    /// Variances of the odometry's random walk that the graph expects, as a multiple of the usual
    /// ones [default: that of --degrade, or 20]
    #[arg(long, value_name = "K", value_parser = factor, allow_negative_numbers = true)]
    slam_noise: Option<f64>,
    /// A particle filter over the same scans, which judges them and changes nothing, as in `300` or
    /// `300,proposal=motion,noise=4`; noise as that of --slam-noise
    #[arg(long, value_name = "SPEC")]
    particles: Option<ParticleSpec>,
    /// direct, loopback, qemu or serial:DEVICE[@BAUD] [default: loopback]
    #[arg(long)]
    link: Option<LinkSpec>,
    /// Record the session into FILE.mcap, as explore --record does; --force replaces a file that is
    /// there
    #[arg(long, value_name = "FILE.mcap")]
    record: Option<PathBuf>,
    /// Serve a page that shows the session, at ADDR:PORT, else at 127.0.0.1:8047; as explore
    /// --live, but nothing can be asked of a robot that has driven long ago
    #[arg(
        long,
        value_name = "ADDR:PORT",
        num_args = 0..=1,
        default_missing_value = "usual",
        value_parser = live_place
    )]
    live: Option<LiveArg>,
    #[command(flatten)]
    folder: FolderArgs,
    #[command(flatten)]
    tune: TuneArgs,
    #[command(flatten)]
    common: CommonArgs,
}

/// Replays a log; returns true if the device went on up to the end.
pub(super) fn run(args: &ReplayArgs) -> Result<bool> {
    if recording::is_recording(&args.log) {
        return run_again(args);
    }
    let text = carmen::read(&args.log).map_err(Error::msg)?;
    let mut log = carmen::log(&args.log.display().to_string(), &text).map_err(Error::msg)?;
    note_late(args, &log);
    let (laser, known) = laser(args, &mut log)?;
    let input = Input::new(args, log, laser)?;
    let link = args.tune.link(args.link.as_ref()).cloned();
    let link = link.unwrap_or_default();
    let tuning = args.tune.tuning(&link)?;
    let folder = args
        .folder
        .out
        .clone()
        .unwrap_or_else(|| usual_folder(args));
    let robot = args.robot.as_ref().map_or("", |robot| &robot.name);
    let made_by = made_by::of_run(robot, &[]);
    args.folder.check(&folder, &made_by)?;
    folder::make(&folder)?;
    let mut along = Along::begin(about(args, &link), args.live)?;
    let record = args.record.as_ref();
    let record = record.map(|file| Recorder::open(file, &made_by, args.folder.force));
    along.record(record.transpose()?);
    note_build(&link);
    let replayed = match input.replay(&link, tuning, &mut along) {
        Ok(replayed) => replayed,
        Err(error) => {
            along.end(Err::<&ReplayReport, _>(format!("{error:#}")), "");
            return Err(error);
        }
    };
    let report = input.report(&link, tuning, (made_by, known), &replayed);
    let written = write(&input, &report, &replayed, &folder);
    along.end(Ok(&report), &report.to_text());
    written?;
    Ok(replayed.status == Status::Exploring)
}

/// Returns what a page says of a replay.
fn about(args: &ReplayArgs, link: &LinkSpec) -> About {
    let log = args.log.file_name().unwrap_or_default();
    About {
        world: log.to_string_lossy().into_owned(),
        strategy: "replay".into(),
        link: link.to_string(),
        seed: args.common.seed,
    }
}

/// Runs the device of a recording again.
fn run_again(args: &ReplayArgs) -> Result<bool> {
    let others = [
        ("--relations", args.relations.is_some()),
        ("--degrade", args.degrade.is_some()),
        ("--robot", args.robot.is_some()),
        ("--laser", args.laser.is_some()),
        ("--slam", args.slam != SlamPlace::Off),
        ("--slam-noise", args.slam_noise.is_some()),
        ("--particles", args.particles.is_some()),
        ("--record", args.record.is_some()),
        ("--out", args.folder.out.is_some()),
    ];
    if let Some((name, _)) = others.iter().find(|(_, is_given)| *is_given) {
        bail!(
            "{name} is for CARMEN logs, and {} is a recording, whose requests are made again as \
             they were; leave it out",
            args.log.display()
        );
    }
    let link = args.tune.link(args.link.as_ref()).cloned();
    let link = link.unwrap_or_default();
    let options = Options {
        tuning: args.tune.tuning(&link)?,
        ..Options::default()
    };
    let mut along = Along::begin(about(args, &link), args.live)?;
    let replayed = recording::replay(&args.log, &link, &options, args.common.json, &mut along);
    let told = match &replayed {
        Ok(false) => Err("the device's answers differ from the recorded ones".into()),
        Ok(true) => Ok(&true),
        Err(error) => Err(format!("{error:#}")),
    };
    along.end(told, "the recorded session was made again");
    replayed
}

/// Writes the files of a replay, and says how it went.
fn write(
    input: &Input<'_>,
    report: &ReplayReport,
    replayed: &Replayed,
    folder: &Path,
) -> Result<()> {
    let args = input.args;
    let errors = input.errors(&replayed.poses);
    let files = Files {
        report,
        scans: &input.log.scans,
        replayed,
        relations: errors.as_deref(),
    };
    files.write(folder)?;
    say(&if args.common.json {
        report.to_json_line()
    } else {
        report.to_text()
    })?;
    let log = args.log.display();
    if replayed.status != Status::Exploring {
        note(&format!(
            "host-sim: {log}: the device ended with {}; the rest of the path is odometry",
            wording::status(replayed.status)
        ));
    }
    note(&format!("{log}: files in {}", folder.display()));
    Ok(())
}

/// Says that scans were sorted, if so.
fn note_late(args: &ReplayArgs, log: &carmen::Log) {
    if log.late > 0 {
        note(&format!(
            "{}: the times of {} scans go back, by {:.2} s at most; sorted",
            args.log.display(),
            log.late,
            log.late_s
        ));
    }
}

fn usual_folder(args: &ReplayArgs) -> PathBuf {
    let name = args.log.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.split('.').next().unwrap_or_default();
    Path::new("out").join(format!("{stem}-replay-{}", args.common.seed))
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "give a number of seconds, as in 1211.353".into())
}

fn factor(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (0.0..=1000.0).contains(number));
    number.ok_or_else(|| "give a number from 0 to 1000".into())
}
