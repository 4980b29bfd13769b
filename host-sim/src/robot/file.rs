//! Robot files: strict YAML. docs/ROBOT.md explains every key.
//!
//! ```text
//! text ─► keys (serde, unknown ones refused) ─► checks ─► RobotSpec
//! ```
//!
//! A fault names the file, the line, what is wrong and what to write. Whatever passes here is also
//! accepted by the planner. In the file metres, degrees and seconds; out of it radians.

mod keys;
mod lasers;

use core::fmt;
use core::ops::RangeInclusive;

use fieldline_planner::RobotShape;
use serde_saphyr::{Location, Spanned};

use super::drive::DriveLimits;
use super::footprint::Footprint;
use super::odometry::OdometryNoise;
use super::spec::RobotSpec;
use keys::{DriveKeys, HullKeys, Keys, Number, OdometryKeys};
use lasers::lidars;

/// Why a text is no robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotError {
    /// The file, or the name of a preset.
    pub file: String,
    /// Line of the fault, from 1; `None` if the file cannot be read.
    pub line: Option<u64>,
    /// The fault and the remedy.
    pub what: String,
}

impl fmt::Display for RobotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file, self.what),
            None => write!(f, "{}: {}", self.file, self.what),
        }
    }
}

impl core::error::Error for RobotError {}

/// A fault and its place.
type Fault = (Location, String);

/// Least clearance and greatest one that the planner accepts, metres.
const CLEARANCES_M: RangeInclusive<f64> = 0.05..=0.6;
/// Time within which the planner must be able to stop, seconds.
const REST_S: f64 = 3.0;
/// The wire rounds accelerations down by up to this.
const ROUNDING: f64 = 1.0 / 4096.0;

/// Reads the text of a robot file.
pub(super) fn read(file: &str, name: &str, text: &str) -> Result<RobotSpec, RobotError> {
    let keys = serde_saphyr::from_str::<Keys>(text).map_err(|error| {
        let line = error.location().map_or(1, |at| at.line());
        RobotError {
            file: file.into(),
            line: Some(line),
            what: format!(
                "{} in `{}`; docs/ROBOT.md explains the keys",
                plain(&error),
                line_of(text, line)
            ),
        }
    })?;
    robot(name, &keys).map_err(|(at, what)| RobotError {
        file: file.into(),
        line: Some(at.line()),
        what,
    })
}

/// Returns a line of a text, from 1, without the space around it.
fn line_of(text: &str, line: u64) -> &str {
    let index = usize::try_from(line).unwrap_or(1).saturating_sub(1);
    text.lines().nth(index).unwrap_or_default().trim()
}

/// Returns the parser's words without its own place, which the error has already.
fn plain(error: &serde_saphyr::Error) -> String {
    let words = error.without_snippet();
    let words = words.render_with_formatter(&serde_saphyr::UserMessageFormatter);
    let words = words.replace('\n', " ");
    let place = words.rfind(" at line ").unwrap_or(words.len());
    words[..place].to_owned()
}

fn robot(name: &str, keys: &Keys) -> Result<RobotSpec, Fault> {
    let hull = hull(&keys.hull)?;
    Ok(RobotSpec {
        name: name.into(),
        radius_m: clearance(keys, &hull)?,
        hull,
        drive: drive(&keys.drive)?,
        lidars: lidars(&keys.lasers)?,
        odometry: keys
            .odometry
            .as_ref()
            .map_or(Ok(OdometryNoise::default()), odometry)?,
    })
}

/// Returns a number that must lie in a range.
fn within(
    key: &str,
    number: &Number,
    range: RangeInclusive<f64>,
    unit: &str,
) -> Result<f64, Fault> {
    if range.contains(&number.value) {
        return Ok(number.value);
    }
    let (least, most) = (range.start(), range.end());
    let what = format!("{key} is {}; give {least} to {most}{unit}", number.value);
    Err((number.referenced, what))
}

/// As [`within`], with a value for a key that is missing.
fn or(
    key: &str,
    number: Option<&Number>,
    (usual, range): (f64, RangeInclusive<f64>),
    unit: &str,
) -> Result<f64, Fault> {
    number.map_or(Ok(usual), |number| within(key, number, range, unit))
}

fn hull(keys: &Spanned<HullKeys>) -> Result<Footprint, Fault> {
    let HullKeys {
        length,
        width,
        radius,
        height,
    } = &keys.value;
    let height_m = within("height", height, 0.0..=2.0, " m")?;
    match (length, width, radius) {
        (Some(length), Some(width), None) => Ok(Footprint::rectangle(
            within("length", length, 0.02..=4.0, " m")?,
            within("width", width, 0.02..=4.0, " m")?,
            height_m,
        )),
        (None, None, Some(radius)) => {
            let radius_m = within("radius", radius, 0.01..=2.0, " m")?;
            Ok(Footprint::disc(radius_m, height_m))
        }
        _ => {
            let what = "a hull is `length` and `width`, or `radius`; give one of the two";
            Err((keys.referenced, what.into()))
        }
    }
}

/// Returns the radius that paths keep clear: by default the planner's for this width.
fn clearance(keys: &Keys, hull: &Footprint) -> Result<f64, Fault> {
    let half_m = hull.half_width_m;
    if let Some(clearance) = &keys.clearance {
        let clearance_m = within("clearance", clearance, CLEARANCES_M, " m")?;
        if clearance_m < half_m {
            let what = format!(
                "clearance is {clearance_m}, less than half the width; give at least {half_m}"
            );
            return Err((clearance.referenced, what));
        }
        return Ok(clearance_m);
    }
    let shape = RobotShape::rectangle(0.0, 2.0 * half_m as f32, 0.0);
    let usual_m = f64::from(shape.planning_radius_m());
    if usual_m > *CLEARANCES_M.end() + 1e-6 {
        let what = format!(
            "the robot is {} m wide; the planner keeps at most 0.6 m clear around the centre, so \
             give a width of at most 1.1, or up to 1.2 with clearance: 0.6",
            2.0 * half_m
        );
        return Err((keys.hull.referenced, what));
    }
    Ok(usual_m.max(*CLEARANCES_M.start()))
}

fn drive(keys: &Spanned<DriveKeys>) -> Result<DriveLimits, Fault> {
    let it = &keys.value;
    if let Some(flag) = it.turns_on_the_spot.as_ref().filter(|flag| !flag.value) {
        let what = "the planner turns on the spot; a robot that steers like a car cannot follow it";
        return Err((flag.referenced, what.into()));
    }
    let track = match (&it.track, &it.effective_track) {
        (Some(track), None) | (None, Some(track)) => track,
        _ => {
            let what = "a drive has `track`, the distance between its wheels, or, if it is \
                        skid-steer, `effective_track`; give one of the two";
            return Err((keys.referenced, what.into()));
        }
    };
    let track_m = within("track", track, 0.02..=4.0, " m")?;
    let speed_mps = within("speed", &it.speed, 0.02..=2.0, " m/s")?;
    let turn_deg = within("turn_rate", &it.turn_rate, 5.0..=400.0, " degrees/s")?;
    let stops = |speed: f64| speed / REST_S + ROUNDING..=100.0;
    let stops_deg = turn_deg / REST_S + 0.1..=10_000.0;
    let acceleration_mps2 = within("acceleration", &it.acceleration, stops(speed_mps), " m/s²")?;
    let turn = &it.turn_acceleration;
    let turn_deg2 = within("turn_acceleration", turn, stops_deg, " degrees/s²")?;
    let braking = (acceleration_mps2, stops(speed_mps));
    let angular_radps = turn_deg.to_radians();
    let wheels_mps = speed_mps + 0.5 * track_m * angular_radps;
    let wheels = (wheels_mps, speed_mps..=20.0);
    Ok(DriveLimits {
        linear_mps: speed_mps,
        angular_radps,
        acceleration_mps2,
        braking_mps2: or("braking", it.braking.as_ref(), braking, " m/s²")?,
        angular_radps2: turn_deg2.to_radians(),
        side_mps: or("wheel_speed", it.wheel_speed.as_ref(), wheels, " m/s")?,
        track_m,
    })
}

fn odometry(keys: &OdometryKeys) -> Result<OdometryNoise, Fault> {
    let usual = OdometryNoise::default();
    let times = or("times", keys.times.as_ref(), (1.0, 0.0..=1000.0), "")?;
    let walk = |key, number: &Option<Number>, usual: f64| {
        or(key, number.as_ref(), (times * usual, 0.0..=1.0), "")
    };
    let scale =
        |key, number: &Option<Number>, usual: f64| or(key, number.as_ref(), (usual, 0.0..=0.2), "");
    Ok(OdometryNoise {
        turn_by_turn: walk("turn_by_turn", &keys.turn_by_turn, usual.turn_by_turn)?,
        turn_by_distance: walk(
            "turn_by_distance",
            &keys.turn_by_distance,
            usual.turn_by_distance,
        )?,
        distance_by_distance: walk(
            "distance_by_distance",
            &keys.distance_by_distance,
            usual.distance_by_distance,
        )?,
        distance_by_turn: walk(
            "distance_by_turn",
            &keys.distance_by_turn,
            usual.distance_by_turn,
        )?,
        distance_scale: scale("distance_scale", &keys.distance_scale, usual.distance_scale)?,
        turn_scale: scale("turn_scale", &keys.turn_scale, usual.turn_scale)?,
        ..usual
    })
}

#[cfg(test)]
mod tests;
