//! A robot: its hull, its drive, its lidars and the errors of its odometry.
//!
//! ```text
//! robot.yaml or preset ─► RobotSpec ─► simulator (speeds, contact, beams)
//!                                  └─► start message (hull, radius, speeds, lasers)
//! ```
//!
//! Metres, radians, seconds.

use core::f64::consts::TAU;
use std::fs;
use std::path::Path;

use fieldline_planner::LaserMount;

use super::drive::DriveLimits;
use super::file::{self, RobotError};
use super::footprint::Footprint;
use super::laser::{self, LaserNoise};
use super::lidar::Lidar;
use super::odometry::OdometryNoise;
use super::presets::{self, DEFAULT};
use super::{RADIUS_M, Sectors};
use crate::near;
use crate::spec::{self, SpecError};

/// A robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// Name of the preset, or of the file without its extension.
    pub name: String,
    /// The hull.
    pub hull: Footprint,
    /// Radius around the robot's centre that the planner keeps clear, metres.
    pub radius_m: f64,
    /// Limits of the drive.
    pub drive: DriveLimits,
    /// One lidar or two; the first is level.
    pub lidars: Vec<Lidar>,
    /// Errors of odometry that is noisy.
    pub odometry: OdometryNoise,
}

impl Default for RobotSpec {
    /// The Pioneer 3-AT with two scanners.
    fn default() -> Self {
        Self {
            name: DEFAULT.into(),
            hull: Footprint::PIONEER_3AT,
            radius_m: RADIUS_M,
            drive: DriveLimits::default(),
            lidars: usual_lidars(),
            odometry: OdometryNoise::default(),
        }
    }
}

/// The two scanners of the usual robot.
#[must_use]
pub fn usual_lidars() -> Vec<Lidar> {
    [laser::level(), laser::tilted()]
        .map(|laser| Lidar::announced(&laser, LaserNoise::default()))
        .into()
}

impl RobotSpec {
    /// Returns a preset, or the robot of a file.
    ///
    /// # Errors
    /// [`RobotError`] with file, line, fault and remedy.
    pub fn open(name: &str) -> Result<Self, RobotError> {
        if let Some(preset) = presets::find(name) {
            return Self::read(preset.name, preset.name, preset.yaml);
        }
        let text = fs::read_to_string(name).map_err(|error| RobotError {
            file: name.into(),
            line: None,
            what: format!(
                "cannot read this robot ({error}); give a robot file, or a preset: {}{}",
                presets::names().join(", "),
                near::hint(name, presets::names())
            ),
        })?;
        let stem = Path::new(name).file_stem().unwrap_or_default();
        Self::read(name, &stem.to_string_lossy(), &text)
    }

    /// Reads the text of a robot file.
    ///
    /// # Errors
    /// [`RobotError`] with file, line, fault and remedy.
    pub fn read(file: &str, name: &str, text: &str) -> Result<Self, RobotError> {
        file::read(file, name, text)
    }

    /// The robot with another sweep of its level lidar, counter-clockwise and upright. Its place,
    /// its yaw, its mask and its errors stay.
    #[must_use]
    pub fn with_sweep(mut self, sweep: &Sweep) -> Self {
        if let Some(level) = self.lidars.first_mut() {
            level.first_rad = sweep.first_rad;
            level.step_rad = sweep.step_rad;
            level.beams = sweep.beams;
            level.most_m = sweep.most_m;
            level.least_m = level.least_m.min(sweep.most_m);
            (level.turn_time_s, level.newest_first) = (sweep.turn_time_s, false);
            (level.clockwise, level.upside_down) = (false, false);
        }
        self
    }

    /// The lidars as the wire has them.
    pub fn sectors(&self) -> impl Iterator<Item = Sectors> {
        let lidars = self.lidars.iter();
        lidars.map(|lidar| Sectors::new(lidar, &self.hull))
    }
}

/// The sweep of a lidar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Angle of the first beam, radians.
    pub first_rad: f64,
    /// Angle from one beam to the next, radians.
    pub step_rad: f64,
    /// Number of beams.
    pub beams: usize,
    /// Greatest range, metres.
    pub most_m: f64,
    /// Time from the first beam to the last one, seconds.
    pub turn_time_s: f64,
}

impl Sweep {
    /// Beams of a lidar.
    pub const BEAMS: core::ops::RangeInclusive<usize> = 4..=4096;
    /// Times from the first beam to the last one, seconds: those of the planner.
    pub const TURN_TIMES_S: core::ops::RangeInclusive<f64> =
        0.0..=LaserMount::MAX_TURN_MS as f64 / 1000.0;
    /// Greatest range of a lidar, metres.
    pub const RANGES_M: core::ops::RangeInclusive<f64> = 0.1..=100.0;

    /// Returns the fault of this sweep and its remedy, if it has one.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        let turn = self.step_rad * self.beams.saturating_sub(1) as f64;
        if !Self::BEAMS.contains(&self.beams) {
            return Some(format!("{} beams; give 4 to 4096", self.beams));
        }
        if !(-2.0 * TAU..=2.0 * TAU).contains(&self.first_rad) {
            return Some("the first angle must be within two turns".into());
        }
        let is_sweep = self.step_rad > 0.0 && turn <= TAU * (1.0 - 1e-6);
        if !is_sweep {
            return Some(format!(
                "{} beams with a step of {:.3} degrees sweep {:.1} degrees; give a step above 0 \
                 and less than a turn in all",
                self.beams,
                self.step_rad.to_degrees(),
                turn.to_degrees()
            ));
        }
        if !Self::RANGES_M.contains(&self.most_m) {
            return Some(format!(
                "the range must be 0.1 to 100 m, not {}",
                self.most_m
            ));
        }
        if !Self::TURN_TIMES_S.contains(&self.turn_time_s) {
            return Some(format!(
                "the turn time must be 0 to {} s, not {}",
                Self::TURN_TIMES_S.end(),
                self.turn_time_s
            ));
        }
        None
    }
}

/// Parses `FIRST,STEP,BEAMS,RANGE` or `FIRST,STEP,BEAMS,RANGE,TURN_TIME`, in degrees, metres and
/// seconds.
impl core::str::FromStr for Sweep {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let form = "give FIRST,STEP,BEAMS,RANGE in degrees and metres, as in -135,0.5,541,12; a \
                    fifth number is the turn time in seconds";
        let is_number = |part: &&str| spec::numbers(part).is_some_and(|it| it.len() == 1);
        if let Some(part) = text.split(',').map(str::trim).find(|part| !is_number(part)) {
            let reason = format!("'{part}' is not a number; {form}");
            return Err(SpecError::new(reason));
        }
        let (first, step, beams, most_m, turn_time_s) = match spec::numbers(text).as_deref() {
            Some(&[first, step, beams, most_m]) => (first, step, beams, most_m, 0.0),
            Some(&[first, step, beams, most_m, turn_time]) => {
                (first, step, beams, most_m, turn_time)
            }
            _ => return Err(SpecError::new(form)),
        };
        if beams.fract() != 0.0 || beams < 0.0 {
            let reason = format!("'{beams}' is no number of beams; {form}");
            return Err(SpecError::new(reason));
        }
        let sweep = Self {
            first_rad: first.to_radians(),
            step_rad: step.to_radians(),
            beams: beams as usize,
            most_m,
            turn_time_s,
        };
        sweep
            .fault()
            .map_or(Ok(sweep), |fault| Err(SpecError::new(fault)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_is_four_numbers_and_a_turn_time() {
        let sweep: Sweep = "-135, 0.5,541,12".parse().expect("a sweep");
        assert_eq!((sweep.beams, sweep.most_m), (541, 12.0));
        assert_eq!(sweep.turn_time_s, 0.0);
        let turning: Sweep = "0,1,360,12,0.2".parse().expect("a sweep");
        assert_eq!(turning.turn_time_s, 0.2);
        assert!((sweep.first_rad.to_degrees() + 135.0).abs() < 1e-9);
        for (text, word) in [
            ("", "as in"),
            ("0,1,360", "as in"),
            ("x,1,360,12", "'x'"),
            ("0,1,3.5,12", "'3.5'"),
            ("0,1,3,12", "4 to 4096"),
            ("0,0.05,4097,12", "4 to 4096"),
            ("0,2,360,12", "less than a turn"),
            ("0,0,360,12", "above 0"),
            ("9999,1,360,12", "two turns"),
            ("0,1,360,0", "0.1 to 100"),
            ("0,nan,360,12", "'nan'"),
            ("0,1,360,12,200", "0 to 0.5 s, not 200"),
            ("0,1,360,12,0.1,1", "as in"),
        ] {
            let error = text.parse::<Sweep>().expect_err(text).to_string();
            assert!(error.contains(word), "{text}: {error}");
        }
        assert!("0,1,360,3.5".parse::<Sweep>().is_ok());
    }

    #[test]
    fn another_sweep_keeps_the_mount() {
        let sweep: Sweep = "0,0.8,450,8".parse().expect("a sweep");
        let robot = RobotSpec::default().with_sweep(&sweep);
        let usual = RobotSpec::default();
        assert_eq!(robot.lidars[1], usual.lidars[1]);
        assert_eq!(robot.lidars[0].position_m, usual.lidars[0].position_m);
        assert_eq!(robot.lidars[0].beams, 450);
        assert_eq!(robot.lidars[0].turn_time_s, 0.0);
        // Also of a lidar that turned the other way: −90° to 90° is ahead.
        let ahead: Sweep = "-90,1,181,8".parse().expect("a sweep");
        let round = RobotSpec::open("round-0.35").expect("a preset");
        let right_rad = round.with_sweep(&ahead).lidars[0].rightmost_rad();
        assert!((right_rad.to_degrees() + 90.0).abs() < 1e-9);
    }
}
