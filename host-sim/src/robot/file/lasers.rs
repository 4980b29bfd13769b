//! The lasers of a robot file: place, sweep, turn time, noise and mask.
//!
//! Degrees in the file, radians out of it; metres, seconds.

use fieldline_planner::LaserMount;
use serde_saphyr::Spanned;

use super::keys::{LaserKeys, NoiseKeys, Number};
use super::{Fault, or, within};
use crate::robot::laser::LaserNoise;
use crate::robot::lidar::Lidar;
use crate::robot::spec::Sweep;

/// Returns the lidars, the level one first.
pub(super) fn lidars(keys: &Spanned<Vec<Spanned<LaserKeys>>>) -> Result<Vec<Lidar>, Fault> {
    if !(1..=2).contains(&keys.value.len()) {
        let what = format!("{} lasers; give one or two", keys.value.len());
        return Err((keys.referenced, what));
    }
    let numbered = keys.value.iter().enumerate();
    numbered
        .map(|(number, keys)| lidar(keys, number == 0))
        .collect()
}

fn lidar(keys: &Spanned<LaserKeys>, is_first: bool) -> Result<Lidar, Fault> {
    let it = &keys.value;
    let sweep = sweep(keys)?;
    let level_deg = f64::from(LaserMount::LEVEL_RAD).to_degrees() - 0.01;
    let pitches = if is_first {
        -level_deg..=level_deg
    } else {
        0.0..=89.0
    };
    let pitch_deg = or("pitch", it.pitch.as_ref(), (0.0, pitches), " degrees")?;
    let yaw_deg = or("yaw", it.yaw.as_ref(), (0.0, -360.0..=360.0), " degrees")?;
    if let Some(yaw) = it
        .yaw
        .as_ref()
        .filter(|_| yaw_deg != 0.0 && pitch_deg != 0.0)
    {
        let what = "the planner knows no laser that is both turned and tilted; leave yaw or pitch \
                    out";
        return Err((yaw.referenced, what.into()));
    }
    let is_level = pitch_deg.abs() <= level_deg;
    if let Some(turn_time) = it
        .turn_time
        .as_ref()
        .filter(|it| it.value > 0.0 && !is_level)
    {
        let what = "the planner moves the beams of level lasers only; leave turn_time out, and \
                    drive slowly";
        return Err((turn_time.referenced, what.into()));
    }
    let lidar = Lidar {
        position_m: [
            within("x", &it.x, -1.99..=1.99, " m")?,
            within("y", &it.y, -1.99..=1.99, " m")?,
            within("z", &it.z, 0.01..=1.99, " m")?,
        ],
        yaw_rad: yaw_deg.to_radians(),
        pitch_rad: pitch_deg.to_radians(),
        upside_down: it.upside_down,
        clockwise: it.clockwise,
        first_rad: sweep.first_rad,
        step_rad: sweep.step_rad,
        beams: sweep.beams,
        turn_time_s: sweep.turn_time_s,
        newest_first: it.newest_first,
        least_m: or(
            "least_range",
            it.least_range.as_ref(),
            (0.02, 0.0..=sweep.most_m),
            " m",
        )?,
        most_m: sweep.most_m,
        noise: noise(it.noise.as_ref())?,
        mask: mask(it.mask.as_deref().unwrap_or_default())?,
        ignores_hull: it.ignore_hull.unwrap_or(true),
    };
    let right = lidar.rightmost_rad();
    let mut bearings = (0..lidar.beams).map(|beam| right + lidar.step_rad * beam as f64);
    if bearings.all(|bearing| lidar.is_masked(bearing)) {
        let what = "the mask covers every beam; leave some of them";
        return Err((keys.referenced, what.into()));
    }
    Ok(lidar)
}

/// Returns the sweep: by its step, or by its field of view.
fn sweep(keys: &Spanned<LaserKeys>) -> Result<Sweep, Fault> {
    let it = &keys.value;
    let beams = it.beams.value;
    let is_whole = beams.fract() == 0.0 && (4.0..=4096.0).contains(&beams);
    if !is_whole {
        let what = format!("beams is {beams}; give a whole number from 4 to 4096");
        return Err((it.beams.referenced, what));
    }
    let beams = beams as usize;
    let step_deg = match (&it.step, &it.field) {
        (Some(step), None) => within("step", step, 0.01..=120.0, " degrees")?,
        (None, Some(field)) => {
            let field_deg = within("field", field, 1.0..=360.0, " degrees")?;
            // The last beam of a whole turn is one step before the first.
            let gaps = if field_deg >= 360.0 { beams } else { beams - 1 };
            field_deg / gaps as f64
        }
        _ => {
            let what = "a laser has `step`, degrees from beam to beam, or `field`, degrees in all; \
                        give one of the two";
            return Err((keys.referenced, what.into()));
        }
    };
    let first_deg = match (&it.first, &it.field) {
        (Some(first), _) => within("first", first, -720.0..=720.0, " degrees")?,
        (None, Some(field)) if it.clockwise => 0.5 * field.value,
        (None, Some(field)) => -0.5 * field.value,
        (None, None) => {
            let what = "a laser with `step` needs `first`, the angle of its first beam; give it";
            return Err((keys.referenced, what.into()));
        }
    };
    let turn_time = (0.0, Sweep::TURN_TIMES_S);
    let sweep = Sweep {
        first_rad: first_deg.to_radians(),
        step_rad: step_deg.to_radians(),
        beams,
        most_m: within("range", &it.range, Sweep::RANGES_M, " m")?,
        turn_time_s: or("turn_time", it.turn_time.as_ref(), turn_time, " s")?,
    };
    match sweep.fault() {
        Some(fault) => Err((it.beams.referenced, fault)),
        None => Ok(sweep),
    }
}

fn noise(keys: Option<&NoiseKeys>) -> Result<LaserNoise, Fault> {
    let usual = LaserNoise::default();
    let Some(keys) = keys else {
        return Ok(usual);
    };
    let share = |key, number: Option<&Number>, usual| or(key, number, (usual, 0.0..=0.5), "");
    let sd = (usual.sigma_m, 0.0..=1.0);
    Ok(LaserNoise {
        sigma_m: or("sd", keys.sd.as_ref(), sd, " m")?,
        lost: share("lost", keys.lost.as_ref(), usual.lost)?,
        false_return: share(
            "false_return",
            keys.false_return.as_ref(),
            usual.false_return,
        )?,
    })
}

fn mask(keys: &[Spanned<[f64; 2]>]) -> Result<Vec<[f64; 2]>, Fault> {
    let span = |span: &Spanned<[f64; 2]>| {
        let [from, to] = span.value;
        let is_angle = |angle: f64| angle.abs() <= 360.0;
        if is_angle(from) && is_angle(to) && (to - from).abs() < 360.0 {
            return Ok([from.to_radians(), to.to_radians()]);
        }
        let what = format!(
            "mask is [{from}, {to}]; give bearings on the robot within 360 degrees, from the \
             right one to the left one, as in [170, -170]"
        );
        Err((span.referenced, what))
    };
    keys.iter().map(span).collect()
}
