//! The sweep of a laser whose lines do not tell it, from the scans themselves.
//!
//! `FLASER 360 …` may be 180° in steps of 0.5° or a whole turn in steps of 1°. The drive tells
//! which: when the robot has moved, the points of a scan must lie where the next scan sees them.
//!
//! ```text
//! misfit(sweep) = mean over pairs of scans and beams of min(|r' − r(bearing')|, 0.5 m)
//! ```
//!
//! r' and bearing' are a beam's end of the first scan, moved by odometry into the frame of the
//! second; r is what the second scan has there, or one beam beside. A turn of θ moves the readings
//! by θ/step beams, so pairs between which the robot turned tell the step. Pairs between which it
//! drove tell which beam looks ahead.
//!
//! | reading | first beam |
//! | --- | --- |
//! | 180° | −90°, as CARMEN's lasers; 90° for one behind |
//! | 240° (Hokuyo URG), 270° (Hokuyo UTM) | half of it to the right |
//! | a turn, counter-clockwise or clockwise | behind, or ahead |
//!
//! The best reading is taken if its misfit is at most `CLEARLY` of the next one's. If none is,
//! 180, 181 and 361 beams are 180°, which no other usual laser has; another number is ambiguous.
//!
//! Units: metres, radians.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use serde::Serialize;

use super::carmen::{Beams, Form, Log, LogScan};
use super::relations::{Pose, compose, inverse};
use crate::robot::wrap;

/// Share of the next misfit below which a reading is clearly the better one. In the recorded logs
/// of `golden/replay-data.txt` the right one has less than 0.45 of the next.
const CLEARLY: f64 = 0.6;
/// Most that a beam counts, metres: a beam that meets something else tells no more than that.
const CAP_M: f64 = 0.5;
/// Pairs of scans that are looked at.
const PAIRS: usize = 60;
/// Least pairs that tell anything.
const LEAST_PAIRS: usize = 3;
/// Turn between two scans of a pair, radians. Odometry of more turning errs by itself.
const TURNS_RAD: core::ops::Range<f64> = 0.1..1.0;
/// Way between two scans of a pair, metres.
const WAY_M: f64 = 1.0;
/// Least way of a pair that tells what is ahead, metres.
const LEAST_WAY_M: f64 = 0.3;

/// How the sweep is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// The lines tell it.
    Line,
    /// `--laser` or `--robot`.
    Option,
    /// The scans agree with this sweep and with no other.
    Scans,
    /// CARMEN's lasers of this number of beams have it.
    Count,
}

/// A way to read the beams of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reading {
    /// Sweep, whole degrees.
    field_deg: u32,
    beams: Beams,
}

impl Reading {
    fn new(field_deg: u32, first_rad: f64, step_rad: f64) -> Self {
        Self {
            field_deg,
            beams: Beams {
                first_rad,
                step_rad,
                most_m: f64::INFINITY,
            },
        }
    }
}

/// Finds the sweep of a log's laser and gives it to all scans. Returns how it is known.
///
/// # Errors
/// If the sweep cannot be told: the readings that are possible, and the options that choose.
pub fn find(file: &str, log: &mut Log) -> Result<By, String> {
    let count = super::carmen::usual_beams(&log.scans).unwrap_or(0);
    if log.form == Form::Robotlaser || count == 0 {
        return Ok(By::Line);
    }
    let told = told_behind(&log.scans);
    let is_behind = log.form == Form::Rlaser && !told;
    let usual = half_turn(count, is_behind);
    let differs = |a: &Reading, b: &Reading| a.beams.step_rad != b.beams.step_rad;
    let found = clear(&fields(count, is_behind), &log.scans, turned, differs);
    let (beams, by) = match found {
        Some(reading) => (ahead(reading, count, &log.scans).beams, By::Scans),
        None if is_carmen(count) => (usual.beams, By::Count),
        None => return Err(ambiguous(file, count, &log.scans)),
    };
    for scan in &mut log.scans {
        scan.beams = beams;
    }
    Ok(by)
}

/// Returns true if no usual laser but those of 180° has this number of beams.
const fn is_carmen(count: usize) -> bool {
    matches!(count, 180 | 181 | 361)
}

/// Returns true if the log tells that its laser is turned to behind.
fn told_behind(scans: &[LogScan]) -> bool {
    let turned = |scan: &LogScan| wrap(scan.laser[2] - scan.odometry[2]).abs() > FRAC_PI_2;
    scans.first().is_some_and(turned)
}

fn half_turn(count: usize, is_behind: bool) -> Reading {
    let Beams {
        first_rad,
        step_rad,
        ..
    } = Beams::half_turn(count);
    let turn = if is_behind { PI } else { 0.0 };
    Reading::new(180, first_rad + turn, step_rad)
}

/// Returns the step of a whole turn. The last of 361 beams is the first one.
fn whole_step(count: usize) -> f64 {
    let gaps = if matches!(count, 361 | 721) {
        count - 1
    } else {
        count
    };
    TAU / gaps as f64
}

/// Returns the readings that are possible.
fn fields(count: usize, is_behind: bool) -> Vec<Reading> {
    let gaps = (count - 1) as f64;
    let centred = |field_deg: u32, step: f64| Reading::new(field_deg, -0.5 * gaps * step, step);
    let step = whole_step(count);
    let mut readings = vec![
        half_turn(count, is_behind),
        Reading::new(360, -PI, step),
        Reading::new(360, 0.0, step),
        Reading::new(360, PI, -step),
        Reading::new(360, 0.0, -step),
    ];
    if matches!(count, 270 | 271 | 540 | 541 | 810 | 811 | 1080 | 1081) {
        readings.push(centred(270, 1.5 * PI / gaps));
    }
    if (600..800).contains(&count) {
        readings.push(centred(240, TAU / 1024.0));
    }
    readings
}

/// Returns a whole turn with the beam ahead that fits the drive: the middle one, or the first. If
/// the drive does not tell, the middle one.
fn ahead(reading: Reading, count: usize, scans: &[LogScan]) -> Reading {
    if reading.field_deg != 360 {
        return reading;
    }
    let step = whole_step(count) * reading.beams.step_rad.signum();
    let seam_behind = Reading::new(360, -PI * step.signum(), step);
    let seam_ahead = Reading::new(360, 0.0, step);
    let differs = |a: &Reading, b: &Reading| a.beams != b.beams;
    clear(&[seam_behind, seam_ahead], scans, driven, differs).unwrap_or(seam_behind)
}

/// A choice of pairs: true for the motion between two scans.
type Choice = fn(Pose) -> bool;

fn turned([x, y, turn]: Pose) -> bool {
    TURNS_RAD.contains(&turn.abs()) && x.hypot(y) <= WAY_M
}

fn driven([x, y, turn]: Pose) -> bool {
    turn.abs() < TURNS_RAD.end && (LEAST_WAY_M..=WAY_M).contains(&x.hypot(y))
}

/// Returns the reading whose misfit is clearly less than that of every other one that differs.
fn clear(
    readings: &[Reading],
    scans: &[LogScan],
    is_chosen: Choice,
    differs: fn(&Reading, &Reading) -> bool,
) -> Option<Reading> {
    let pairs = pairs(scans, is_chosen);
    if pairs.len() < LEAST_PAIRS {
        return None;
    }
    let judged = readings
        .iter()
        .filter_map(|it| Some((misfit(&it.beams, &pairs)?, *it)));
    let mut judged: Vec<(f64, Reading)> = judged.collect();
    judged.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (best, reading) = judged.first()?;
    let next = judged.iter().find(|(_, other)| differs(other, reading));
    next.is_some_and(|(next, _)| *best < CLEARLY * next)
        .then_some(*reading)
}

/// A scan, a later one, and the motion of the laser between them.
type Pair<'a> = (&'a LogScan, &'a LogScan, Pose);

/// Returns the first pairs of scans whose motion is chosen. A pair begins where the last one ended.
fn pairs(scans: &[LogScan], is_chosen: Choice) -> Vec<Pair<'_>> {
    let mut pairs = Vec::new();
    let mut from: Option<&LogScan> = None;
    for scan in scans {
        let Some(begun) = from else {
            from = Some(scan);
            continue;
        };
        let [x, y, turn] = compose(inverse(begun.laser), scan.laser);
        let motion = [x, y, wrap(turn)];
        if is_chosen(motion) {
            pairs.push((begun, scan, motion));
        }
        if is_chosen(motion) || x.hypot(y) > WAY_M || motion[2].abs() >= TURNS_RAD.end {
            from = Some(scan);
        }
        if pairs.len() == PAIRS {
            break;
        }
    }
    pairs
}

/// Returns the misfit of a reading, metres; `None` if no beam can be compared.
fn misfit(beams: &Beams, pairs: &[Pair<'_>]) -> Option<f64> {
    let (mut sum_m, mut compared) = (0.0, 0_u32);
    for (before, after, motion) in pairs {
        let back = inverse(*motion);
        for (beam, &range_m) in before.ranges.iter().enumerate() {
            let Some(error_m) = error_m(beams, (beam, range_m), after, back) else {
                continue;
            };
            sum_m += error_m.min(CAP_M);
            compared += 1;
        }
    }
    (compared > 0).then(|| sum_m / f64::from(compared))
}

/// Returns by how much a beam's end is nearer or farther than the later scan has it, metres.
fn error_m(
    beams: &Beams,
    (beam, range_m): (usize, f64),
    after: &LogScan,
    back: Pose,
) -> Option<f64> {
    if !is_return(range_m) {
        return None;
    }
    let (sin, cos) = (beams.first_rad + beam as f64 * beams.step_rad).sin_cos();
    let [x, y, _] = compose(back, [range_m * cos, range_m * sin, 0.0]);
    let count = after.ranges.len() as i64;
    let along = (y.atan2(x) - beams.first_rad) * beams.step_rad.signum();
    let middle = (along.rem_euclid(TAU) / beams.step_rad.abs()).round() as i64;
    let is_whole = (count as f64 * beams.step_rad.abs() - TAU).abs() < 1e-6;
    let beside = (middle - 1..=middle + 1).filter_map(|beam| {
        let beam = if is_whole {
            beam.rem_euclid(count)
        } else {
            beam
        };
        let seen_m = *after.ranges.get(usize::try_from(beam).ok()?)?;
        is_return(seen_m).then(|| (x.hypot(y) - seen_m).abs())
    });
    beside.reduce(f64::min)
}

/// Greatest range that is compared, metres. Lasers report more for nothing.
const MOST_M: f64 = 12.0;

fn is_return(range_m: f64) -> bool {
    range_m > 0.0 && range_m < MOST_M
}

/// Returns the error of scans that fit several readings, or none.
fn ambiguous(file: &str, count: usize, scans: &[LogScan]) -> String {
    let line = scans.first().map_or(1, |scan| scan.line);
    let option = |reading: Reading| {
        let Beams {
            first_rad,
            step_rad,
            ..
        } = reading.beams;
        let round = |rad: f64| (rad.to_degrees() * 1e4).round() / 1e4;
        format!(
            "--laser {},{},{count},12",
            round(first_rad),
            round(step_rad)
        )
    };
    let half = option(half_turn(count, false));
    let whole = option(Reading::new(360, -PI, whole_step(count)));
    format!(
        "{file}:{line}: the line does not tell the field of view of its {count} beams, and the \
         scans do not show it by their turns; say {half} for 180°, {whole} for a whole turn, or \
         --robot FILE for another lidar"
    )
}

#[cfg(test)]
mod tests;
