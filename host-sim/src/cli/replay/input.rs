//! A log made ready to be replayed, and the figures of its replay.

use std::path::Path;

use anyhow::{Context as _, Error, Result, bail};

use fieldline_planner::config::Tuning;
use fieldline_slam::Motion;
use host_sim::link::Link;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::replay::relations::{self, Pose, Relation, RelationError};
use host_sim::replay::report::{self, ParticlePath, ReadLaser, RelationErrors, ReplayReport};
use host_sim::replay::run::{self, Replayed};
use host_sim::replay::sweep::{self, By};
use host_sim::replay::wire::LogLaser;
use host_sim::replay::{carmen, clock};
use host_sim::report::{MadeBy, QualityShares};
use host_sim::robot::OdometryNoise;
use host_sim::slam::SlamPlace;
use host_sim::slam::particles::{self, ParticleSpec};

use super::super::along::Along;
use super::super::note;
use super::ReplayArgs;

/// Variances of the random walk of wheels that nothing is known of, as a multiple of the usual
/// ones: those of the papers' odometry.
const UNKNOWN_WHEELS: f64 = 20.0;

/// A log made ready to be replayed.
pub(super) struct Input<'a> {
    pub(super) args: &'a ReplayArgs,
    pub(super) log: carmen::Log,
    laser: LogLaser,
    odometry: Vec<Pose>,
    truth: Option<Vec<Relation>>,
    /// Variances of the odometry's random walk, as a multiple of the usual ones.
    noise: f64,
}

impl<'a> Input<'a> {
    /// Makes the odometry, and reads the relations.
    pub(super) fn new(args: &'a ReplayArgs, log: carmen::Log, laser: LogLaser) -> Result<Self> {
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

    /// Makes the session.
    pub(super) fn replay(
        &self,
        link: &LinkSpec,
        tuning: Option<&'static Tuning>,
        along: &mut Along,
    ) -> Result<Replayed> {
        let options = Options {
            tuning,
            ..Options::default()
        };
        let context = || format!("--link {link}");
        let planner = link.open(&options).with_context(context)?;
        let mut planner: Box<dyn Link> = match along.recorder() {
            Some(recorder) => recorder.tap(planner),
            None => planner,
        };
        let motion = Motion::WHEELS.times(self.noise as f32);
        let slam = (self.args.slam == SlamPlace::Host).then_some(motion);
        let (laser, scans) = (&self.laser, &self.log.scans);
        let link = planner.as_mut();
        let replayed = run::run(laser, scans, &self.odometry, link, slam, along);
        let replayed = replayed.with_context(context)?;
        if replayed.poses.len() < scans.len() {
            bail!("interrupted after {} scans", replayed.poses.len());
        }
        Ok(replayed)
    }

    /// Returns the figures of the replay.
    pub(super) fn report(
        &self,
        link: &LinkSpec,
        tuning: Option<&'static Tuning>,
        (made_by, known): (MadeBy, By),
        replayed: &Replayed,
    ) -> ReplayReport {
        let (args, log) = (self.args, &self.log);
        let errors = self.errors(&replayed.poses);
        ReplayReport {
            log: args.log.display().to_string(),
            link: link.to_string(),
            seed: args.common.seed,
            degrade: args.degrade,
            steps: log.scans.len(),
            relations: errors.as_deref().and_then(spread),
            occupied_cells_5cm: report::occupied_cells(&self.laser, &log.scans, &replayed.poses),
            quality: QualityShares::of(&replayed.qualities),
            input_faults: replayed.input_faults,
            late_scans: log.late,
            skipped: log.left_out.clone(),
            resampled: log.resampled,
            laser: ReadLaser::of(&self.laser, known),
            map_full_at: self.map_full_at(replayed, tuning),
            slam: replayed.slam.clone(),
            made_by: Some(made_by),
            particles: args.particles.as_ref().map(|spec| self.particles(spec)),
        }
    }

    /// Returns the errors of a path against the relations, if there are any.
    pub(super) fn errors(&self, poses: &[Pose]) -> Option<Vec<(Relation, RelationError)>> {
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
pub(super) fn laser(args: &ReplayArgs, log: &mut carmen::Log) -> Result<(LogLaser, By)> {
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

/// Returns the errors against relations; `None` if there are none.
fn spread(errors: &[(Relation, RelationError)]) -> Option<RelationErrors> {
    let errors: Vec<RelationError> = errors.iter().map(|(_, error)| *error).collect();
    RelationErrors::of(&errors)
}
