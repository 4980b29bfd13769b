//! The six steps: what is done, what is seen, and what a wrong one means.
//!
//! `judge` compares the witnesses of a motion. Units: metres, radians, seconds.

use fieldline_protocol::message::{
    Control, INVALID_MM, Identity, Mistake, NO_RETURN_MM, Observation, Start, Status,
};

use super::judge::{QUARTER_RAD, WAY_M, judge_turn, judge_way};
use super::{Bench, Finding, Step, Stopped, config, measure, shift_m, turned_rad};
use crate::link::Link;
use crate::robot::wrap;
use crate::trial::wiring_advice::wiring_advice;

/// Speeds of the steps: slow enough to step aside.
const TURN_RADPS: f64 = 0.6;
const SPEED_MPS: f64 = 0.3;
/// Time that the robot stands, seconds.
const STAND_S: f64 = 2.0;
/// Least share of the beams that return.
const LEAST_RETURNS: f64 = 0.1;
/// What odometry may move while the robot stands, metres and radians.
const STILL: (f64, f64) = (0.01, 0.01);
/// Turn and way between the scans that are compared.
const LEG: (f64, f64) = (0.35, 0.24);
/// Free floor ahead beyond the way, metres.
const ROOM_M: f64 = 0.3;
/// Periods until a command is driven: one to hear it and two to begin.
const DELAY: f64 = 3.0;
/// A robot stands if it goes less in a period, metres.
const STANDS_M: f64 = 0.001;

/// Name, what to do, and how a step is made.
type Make = fn(&mut Bench<'_>) -> Result<Finding, Stopped>;

/// The steps after the first.
pub(super) const STEPS: [(&str, &str, Make); 5] = [
    (
        "scan",
        "put the robot in a room and a box on its left; it stands",
        scan,
    ),
    ("stand", "leave it standing, motors on", stand),
    (
        "turn",
        "keep half a metre around it free; it turns left by a quarter, and back",
        turn,
    ),
    (
        "drive",
        "keep a metre ahead of it free; it drives half a metre ahead",
        drive,
    ),
    (
        "stop",
        "keep the way behind it free; it drives back, and stops",
        stop,
    ),
];

/// Says hello, starts a session and pauses it.
pub(super) fn link(
    link: &mut dyn Link,
    start: &Start,
) -> (Step, Option<fieldline_planner::Config>) {
    let greeted = link.hello().and_then(|identity| {
        link.control(&Control::Start(start.clone()))?;
        link.control(&Control::Pause)
            .map(|status| (identity, status))
    });
    let (seen, remedy) = match greeted {
        Ok((identity, Status::Paused)) => (device(&identity), None),
        Ok((identity, Status::EmergencyStop)) => (
            device(&identity),
            Some("the emergency stop is pressed: release it".into()),
        ),
        Ok((identity, status)) => (
            format!("{}; its session is {status:?}", device(&identity)),
            Some("reset the device".into()),
        ),
        Err(error) => ("no device that can be used".into(), Some(error.to_string())),
    };
    let config = config(start);
    let step = Step {
        number: 1,
        name: "link",
        to_do: "connect the device and switch it on",
        passed: remedy.is_none(),
        seen,
        remedy,
    };
    (step, config)
}

fn device(identity: &Identity) -> String {
    format!(
        "protocol {}, build {}, boot {}, {} map tiles",
        identity.version, identity.build, identity.boots, identity.tile_pool
    )
}

/// Returns the ranges of the first laser.
fn level(observation: &Observation) -> &[u16] {
    let scan = observation.scans.first();
    scan.map_or(&[], |scan| scan.ranges_mm.as_slice())
}

/// Looks at a scan of a robot that stands.
fn scan(bench: &mut Bench<'_>) -> Result<Finding, Stopped> {
    let observation = bench.observe()?;
    let Some(laser) = bench.config.lasers().first() else {
        return Ok((
            "the robot has no laser".into(),
            Some("name one in the robot file".into()),
        ));
    };
    let ranges = level(&observation);
    let limit_mm = laser.range_limit_mm;
    let count = |is_so: &dyn Fn(u16) -> bool| ranges.iter().filter(|it| is_so(**it)).count();
    let returns = count(&|mm| mm != INVALID_MM && mm < limit_mm);
    let (blind, nothing) = (count(&|mm| mm == INVALID_MM), count(&|mm| mm >= limit_mm));
    let nearest = (0_u16..)
        .zip(ranges)
        .filter(|(_, mm)| **mm != INVALID_MM && **mm < limit_mm);
    let nearest = nearest.min_by_key(|(_, mm)| **mm).map(|(number, mm)| {
        let bearing = laser.first_bearing_rad + f32::from(number) * laser.bearing_step_rad;
        let bearing = wrap(bearing.into());
        let side = if bearing < 0.0 { "right" } else { "left" };
        let deg = bearing.to_degrees().abs();
        format!(
            "; nearest {:.2} m at {deg:.0} degrees to the {side}",
            f32::from(*mm) / 1e3
        )
    });
    let period_s = f64::from(bench.body.period_ms()) * 1e-3;
    let seen = format!(
        "{} beams at {:.1} Hz: {returns} returns, {nothing} without a return, {blind} without \
         information{}",
        ranges.len(),
        1.0 / period_s,
        nearest.unwrap_or_default()
    );
    let is_short = |mm: &u16| *mm == INVALID_MM || *mm >= limit_mm || *mm <= limit_mm / 1000;
    let remedy = if returns > 0 && ranges.iter().all(is_short) {
        Some(wiring_advice(Mistake::RangesTooShort).into())
    } else if (returns as f64) < LEAST_RETURNS * ranges.len() as f64 {
        let codes = if blind > nothing {
            "most beams carry no information: are ranges below least_range, NaN or 0?"
        } else {
            "most beams return nothing: put it in a room; are millimetres given as metres?"
        };
        Some(format!(
            "{codes} ({NO_RETURN_MM} is the code of no return, {INVALID_MM} of no information)"
        ))
    } else {
        None
    };
    Ok((seen, remedy))
}

/// Looks at odometry and clock of a robot that stands.
fn stand(bench: &mut Bench<'_>) -> Result<Finding, Stopped> {
    let seen = bench.drive((0.0, 0.0), STAND_S)?;
    let (Some(first), Some(last)) = (seen.first(), seen.last()) else {
        return Ok(("nothing".into(), Some("no observation came".into())));
    };
    let [ahead, left] = shift_m(first, last);
    let (way_m, turn_rad) = (ahead.hypot(left), turned_rad(&seen));
    let reports = seen.len().saturating_sub(1).max(1);
    let period_ms = f64::from(last.time_ms.wrapping_sub(first.time_ms)) / reports as f64;
    let due_ms = f64::from(bench.body.period_ms());
    let text = format!(
        "odometry moved {:.1} mm and {:.2} degrees; the clock goes on by {period_ms:.0} ms a \
         report",
        1e3 * way_m,
        turn_rad.to_degrees()
    );
    let remedy = if period_ms == 0.0 {
        Some(wiring_advice(Mistake::ClockStands).into())
    } else if period_ms >= 50.0 * due_ms {
        Some(wiring_advice(Mistake::ClockFast).into())
    } else if !(0.5 * due_ms..=2.0 * due_ms).contains(&period_ms) {
        Some(format!(
            "a report is due each {due_ms:.0} ms, in milliseconds"
        ))
    } else if way_m > STILL.0 || turn_rad.abs() > STILL.1 {
        Some(
            "odometry moves while the robot stands: does it roll, does an inertial unit drift, is \
             an encoder's line open?"
                .into(),
        )
    } else {
        None
    };
    Ok((text, remedy))
}

/// Returns the part of a run of observations at which each leg ends.
fn legs(seen: &[Observation], told: f64, leg: f64, moving: usize) -> Vec<&Observation> {
    let count = (told.abs() / leg).ceil().max(1.0) as usize;
    let stride = (moving / count).max(1);
    let mut ends: Vec<&Observation> = seen.iter().take(moving).step_by(stride).collect();
    ends.extend(seen.last());
    ends
}

/// Turns left by a quarter, and back.
fn turn(bench: &mut Bench<'_>) -> Result<Finding, Stopped> {
    let rate = TURN_RADPS.min(bench.start.max_angular.to_num());
    let seconds = QUARTER_RAD / rate;
    let seen = bench.drive((0.0, rate), seconds)?;
    let odometry = turned_rad(&seen);
    let moving = (seconds * 1e3 / f64::from(bench.body.period_ms())).round() as usize;
    let ends = legs(&seen, QUARTER_RAD, LEG.0, moving);
    let laser = bench.config.lasers().first();
    let parts = ends.windows(2).map(|pair| {
        let scans = (laser?, level(pair.first()?), level(pair.get(1)?));
        measure::turn_rad(scans).map(f64::from)
    });
    let scan: Option<f64> = parts.sum();
    bench.drive((0.0, -rate), seconds)?;
    let text = format!(
        "command 90 degrees, odometry {:.0}, scan {}",
        odometry.to_degrees(),
        scan.map_or("undecided".into(), |it| format!("{:.0}", it.to_degrees()))
    );
    Ok((text, judge_turn(odometry, scan)))
}

/// Returns the free way ahead of the hull, metres; infinite if no beam meets anything.
fn room_m(bench: &Bench<'_>, observation: &Observation) -> f64 {
    let Some(laser) = bench.config.lasers().first() else {
        return 0.0;
    };
    let half_width = f64::from(bench.start.hull.width_mm) * 0.5e-3 + 0.05;
    let half_length = f64::from(bench.start.hull.length_mm) * 0.5e-3;
    let returned = |(_, mm): &(u16, &u16)| **mm != INVALID_MM && **mm < laser.range_limit_mm;
    let ends = (0_u16..)
        .zip(level(observation))
        .filter(returned)
        .map(|(number, mm)| {
            let bearing = laser.first_bearing_rad + f32::from(number) * laser.bearing_step_rad;
            let range_m = f64::from(*mm) * 1e-3;
            let (sin, cos) = (libm::sin(bearing.into()), libm::cos(bearing.into()));
            (
                f64::from(laser.x_m) + range_m * cos,
                f64::from(laser.y_m) + range_m * sin,
            )
        });
    let ahead = ends.filter(|(x, y)| *x > half_length && y.abs() < half_width);
    ahead
        .map(|(x, _)| x - half_length)
        .fold(f64::INFINITY, f64::min)
}

/// Drives half a metre ahead.
fn drive(bench: &mut Bench<'_>) -> Result<Finding, Stopped> {
    let observation = bench.observe()?;
    let room_m = room_m(bench, &observation);
    if room_m < WAY_M + ROOM_M {
        return Ok((
            format!("{room_m:.2} m are free ahead"),
            Some(format!(
                "turn it to where {:.1} m are free, and begin again",
                WAY_M + ROOM_M
            )),
        ));
    }
    let speed = SPEED_MPS.min(bench.start.max_linear.to_num());
    let seconds = WAY_M / speed;
    let seen = bench.drive((speed, 0.0), seconds)?;
    let (Some(first), Some(last)) = (seen.first(), seen.last()) else {
        return Ok(("nothing".into(), Some("no observation came".into())));
    };
    let odometry = shift_m(first, last);
    let moving = (seconds * 1e3 / f64::from(bench.body.period_ms())).round() as usize;
    let ends = legs(&seen, WAY_M, LEG.1, moving);
    let laser = bench.config.lasers().first();
    let mut scan = Some([0.0; 2]);
    for pair in ends.windows(2) {
        let part = laser
            .zip(pair.first().zip(pair.get(1)))
            .and_then(|(laser, (from, to))| measure::shift_m((laser, level(from), level(to)), 0.0));
        scan = scan
            .zip(part)
            .map(|(sum, part)| [sum[0] + f64::from(part[0]), sum[1] + f64::from(part[1])]);
    }
    let words = |[ahead, left]: [f64; 2]| {
        // Adding 0 turns a negative zero into a positive one.
        let rounded = |metres: f64| (100.0 * metres).round() / 100.0 + 0.0;
        let (ahead, left) = (rounded(ahead), rounded(left));
        format!("{ahead:.2} m ahead and {left:.2} m left")
    };
    let text = format!(
        "command 0.50 m ahead, odometry {}, scan {}",
        words(odometry),
        scan.map_or("undecided".into(), words)
    );
    Ok((text, judge_way(odometry, scan)))
}

/// Drives back, and measures the time until it stands after the command.
fn stop(bench: &mut Bench<'_>) -> Result<Finding, Stopped> {
    let speed = SPEED_MPS.min(bench.start.max_linear.to_num());
    let period_s = f64::from(bench.body.period_ms()) * 1e-3;
    let seconds = WAY_M / speed;
    let seen = bench.drive((-speed, 0.0), seconds)?;
    let told = (seconds / period_s).round() as usize;
    let moves = |pair: &[Observation]| {
        let shift = pair
            .first()
            .zip(pair.get(1))
            .map(|(from, to)| shift_m(from, to));
        shift.is_some_and(|[x, y]| x.hypot(y) >= STANDS_M)
    };
    let last = seen.windows(2).rposition(moves).map_or(0, |at| at + 1);
    let stop_s = last.saturating_sub(told) as f64 * period_s;
    let braking: f64 = bench.start.linear_accel.to_num();
    let due_s = speed / braking + DELAY * period_s;
    let text = format!(
        "it stands {stop_s:.1} s after the command, from {speed:.2} m/s; the slowest answer of the \
         link took {:.0} ms",
        bench.slowest_ms
    );
    let remedy = (stop_s > due_s).then(|| {
        format!(
            "it must stand within {due_s:.1} s: lower drive.braking in the robot file to what it \
             does, or look for a queue of commands"
        )
    });
    Ok((text, remedy))
}
