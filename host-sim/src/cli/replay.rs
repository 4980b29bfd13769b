//! `host-sim replay`: a recorded log through the device's localisation and mapping.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Error, Result, bail};
use clap::Args;

use fieldline_planner::config::Tuning;
use fieldline_protocol::message::Status;
use fieldline_slam::Motion;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::replay::relations::{self, Pose, Relation, RelationError};
use host_sim::replay::report::{
    self, Files, ParticlePath, ReadLaser, RelationErrors, ReplayReport,
};
use host_sim::replay::run::Replayed;
use host_sim::replay::sweep::{self, By};
use host_sim::replay::wire::LogLaser;
use host_sim::replay::{carmen, clock, run};
use host_sim::report::{QualityShares, folder};
use host_sim::robot::{OdometryNoise, RobotSpec, Sweep};
use host_sim::slam::SlamPlace;
use host_sim::slam::particles::{self, ParticleSpec};
use host_sim::trial::wording;

use super::common::{CommonArgs, FolderArgs};
use super::progress::Interrupt;
use super::recording;
use super::robot::{self as robots, TuneArgs, robot};
use super::values::slam_place;
use super::{made_by, note, note_build, say};

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
    #[command(flatten)]
    folder: FolderArgs,
    #[command(flatten)]
    tune: TuneArgs,
    #[command(flatten)]
    common: CommonArgs,
}

/// Variances of the random walk of wheels that nothing is known of, as a multiple of the usual
/// ones: those of the papers' odometry.
const UNKNOWN_WHEELS: f64 = 20.0;

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
    let interrupt = Interrupt::listen()?;
    let robot = args.robot.as_ref().map_or("", |robot| &robot.name);
    let made_by = made_by::of_run(robot, &[]);
    args.folder.check(&folder, &made_by)?;
    folder::make(&folder)?;
    note_build(&link);
    let replayed = input.replay(&link, tuning, &interrupt)?;
    let errors = input.errors(&replayed.poses);
    let report = ReplayReport {
        log: args.log.display().to_string(),
        link: link.to_string(),
        seed: args.common.seed,
        degrade: args.degrade,
        steps: input.log.scans.len(),
        relations: errors.as_deref().and_then(spread),
        occupied_cells_5cm: report::occupied_cells(&input.laser, &input.log.scans, &replayed.poses),
        quality: QualityShares::of(&replayed.qualities),
        input_faults: replayed.input_faults,
        late_scans: input.log.late,
        skipped: input.log.left_out.clone(),
        resampled: input.log.resampled,
        laser: ReadLaser::of(&input.laser, known),
        map_full_at: input.map_full_at(&replayed, tuning),
        slam: replayed.slam.clone(),
        made_by: Some(made_by),
        particles: args.particles.as_ref().map(|spec| input.particles(spec)),
    };
    write(&input, &report, &replayed, errors.as_deref(), &folder)?;
    Ok(replayed.status == Status::Exploring)
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
    recording::replay(&args.log, &link, &options, args.common.json)
}

/// Writes the files of a replay, and says how it went.
fn write(
    input: &Input<'_>,
    report: &ReplayReport,
    replayed: &Replayed,
    relations: Option<&[(Relation, RelationError)]>,
    folder: &Path,
) -> Result<()> {
    let args = input.args;
    let files = Files {
        report,
        scans: &input.log.scans,
        replayed,
        relations,
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

/// A log made ready to be replayed.
struct Input<'a> {
    args: &'a ReplayArgs,
    log: carmen::Log,
    laser: LogLaser,
    odometry: Vec<Pose>,
    truth: Option<Vec<Relation>>,
    /// Variances of the odometry's random walk, as a multiple of the usual ones.
    noise: f64,
}

impl<'a> Input<'a> {
    fn new(args: &'a ReplayArgs, log: carmen::Log, laser: LogLaser) -> Result<Self> {
        let own = log.scans.iter().map(|scan| (scan.time, scan.odometry));
        let own: Vec<(f64, Pose)> = own.collect();
        let truth = args.relations.as_ref();
        let truth = truth.map(|file| with_times(args, file, &own)).transpose()?;
        let noise = args.slam_noise.or(args.degrade).unwrap_or(UNKNOWN_WHEELS);
        Ok(Self {
            odometry: run::odometry(&log.scans, args.degrade, args.common.seed),
            args,
            log,
            laser,
            truth,
            noise: noise.max(1.0),
        })
    }

    fn replay(
        &self,
        link: &LinkSpec,
        tuning: Option<&'static Tuning>,
        interrupt: &Interrupt,
    ) -> Result<Replayed> {
        let options = Options {
            tuning,
            ..Options::default()
        };
        let context = || format!("--link {link}");
        let mut planner = link.open(&options).with_context(context)?;
        let mut step = |_| !interrupt.pressed();
        let motion = Motion::WHEELS.times(self.noise as f32);
        let slam = (self.args.slam == SlamPlace::Host).then_some(motion);
        let (laser, scans) = (&self.laser, &self.log.scans);
        let link = planner.as_mut();
        let replayed = run::run(laser, scans, &self.odometry, link, slam, &mut step);
        let replayed = replayed.with_context(context)?;
        if replayed.poses.len() < scans.len() {
            bail!("interrupted after {} scans", replayed.poses.len());
        }
        Ok(replayed)
    }

    /// Returns the errors of a path against the relations, if there are any.
    fn errors(&self, poses: &[Pose]) -> Option<Vec<(Relation, RelationError)>> {
        let times = self.log.scans.iter().map(|scan| scan.time);
        let path: Vec<(f64, Pose)> = times.zip(poses.iter().copied()).collect();
        let truth = self.truth.as_ref()?;
        Some(relations::errors(truth, &path))
    }

    fn particles(&self, spec: &ParticleSpec) -> ParticlePath {
        let (laser, scans) = (&self.laser, &self.log.scans);
        let wheels = OdometryNoise::default().times(spec.noise.unwrap_or(self.noise));
        let observations = run::observations(laser, scans, &self.odometry);
        let told = (laser.announced(), wheels);
        let poses = particles::path(spec, told, &observations, self.args.common.seed);
        ParticlePath {
            filter: spec.to_string(),
            relations: self.errors(&poses).as_deref().and_then(spread),
            occupied_cells_5cm: report::occupied_cells(laser, scans, &poses),
        }
    }

    fn map_full_at(&self, replayed: &Replayed, tuning: Option<&'static Tuning>) -> Option<usize> {
        if !run::is_default_pool(replayed.tile_pool) {
            return None;
        }
        let tuning = tuning.unwrap_or(&Tuning::DEFAULT);
        run::map_full_at(&self.laser, &self.log.scans, &self.odometry, tuning)
    }
}
/// Returns the laser that made the scans, and how its sweep is known.
fn laser(args: &ReplayArgs, log: &mut carmen::Log) -> Result<(LogLaser, By)> {
    let file = args.log.display();
    let laser = match (&args.robot, &args.laser) {
        (None, None) => {
            let known = sweep::find(&file.to_string(), log).map_err(Error::msg)?;
            return Ok((LogLaser::of(&log.scans), known));
        }
        (None, Some(sweep)) => LogLaser::of_sweep(&log.scans, sweep)
            .map_err(Error::msg)
            .with_context(|| file.to_string()),
        (Some(robot), told) => {
            let name = robot.name.clone();
            let robot = robot.clone();
            let robot = match told {
                Some(sweep) => robot.with_sweep(sweep),
                None => robot,
            };
            LogLaser::of_robot(&log.scans, &robot)
                .map_err(Error::msg)
                .with_context(|| format!("{file} with --robot {name}"))
        }
    };
    Ok((laser?, By::Option))
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

/// Reads the relations, with the log's times.
fn with_times(args: &ReplayArgs, file: &Path, own: &[(f64, Pose)]) -> Result<Vec<Relation>> {
    let name = file.display();
    let text = carmen::read(file).map_err(Error::msg)?;
    let read = relations::read(&name.to_string(), &text).map_err(Error::msg)?;
    let offset = args.relations_offset.or_else(|| clock::offset(&read, own));
    let Some(offset) = offset else {
        bail!(
            "{name}:1: these motions are not in the odometry of {}; give the relations of this \
             log, or --relations-offset if its odometry is bad",
            args.log.display()
        );
    };
    let shifted: Vec<Relation> = read.iter().map(|it| it.shifted(offset)).collect();
    if relations::errors(&shifted, own).is_empty() {
        bail!(
            "{name}:1: no relation has its times in {}; give the relations of this log, or another \
             --relations-offset",
            args.log.display()
        );
    }
    if offset != 0.0 {
        note(&format!("{name}: {offset:.3} s ahead of the log"));
    }
    Ok(shifted)
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

/// Returns the errors against relations; `None` if there are none.
fn spread(errors: &[(Relation, RelationError)]) -> Option<RelationErrors> {
    let errors: Vec<RelationError> = errors.iter().map(|(_, error)| *error).collect();
    RelationErrors::of(&errors)
}

fn factor(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (0.0..=1000.0).contains(number));
    number.ok_or_else(|| "give a number from 0 to 1000".into())
}
