//! Limits of the parameters of a session, and of its observations.

use fieldline_planner::map::Tiles;
use fieldline_planner::roadmap::configuration_space::MOST_RADIUS;
use fieldline_protocol::message::{
    Laser, MAX_BEAMS, NO_RETURN_MM, Observation, Parameter, Refusal, Start, UnevenGround,
};
use fixed::types::{I4F12, I16F16};

/// One turn, radians, rounded up.
const TURN: I16F16 = I16F16::lit("6.2832");
/// A right angle, radians, rounded down.
const RIGHT_ANGLE: I4F12 = I4F12::lit("1.5705");
/// Maximum pitch of a level laser, radians. At 12 m its beam is then 0.6 m too high or too low.
const LEVEL: I4F12 = I4F12::lit("0.05");
/// Greatest preference; beyond it the relaxation diverges.
const STRONGEST: I4F12 = I4F12::lit("2");
/// Steepest accepted slope, radians: 45°.
const STEEPEST: I4F12 = I4F12::lit("0.7855");
/// Maximum distance of a laser from the centre along each axis, metres.
const REACH: I4F12 = I4F12::lit("2");
/// Side of a map cell, millimetres.
const CELL_MM: u16 = 100;
/// Accepted robot radii, millimetres: half a cell to the largest disc in the planner's
/// configuration space. The planner would treat a radius outside this range as the nearest one
/// inside.
const RADII_MM: core::ops::RangeInclusive<u16> = CELL_MM / 2..=MOST_RADIUS as u16 * CELL_MM;
// The wire's specification and the text of the refusal name this limit.
const _: () = assert!(*RADII_MM.start() == 50 && *RADII_MM.end() == 600);
/// Time within which a robot must stop from its maximum speed, seconds. The drive looks four
/// seconds ahead: one period and the braking after it.
const REST_S: i32 = 3;
/// Accepted periods, milliseconds. A shorter period leaves too little time for a step. A longer one
/// leaves too little time for a retry before the command is stale.
const PERIODS_MS: core::ops::RangeInclusive<u16> = 100..=400;
const _: () = assert!(*PERIODS_MS.end() < crate::STALE_MS);

/// Checks the parameters of a session in a map with `TILES` tiles and `SLOTS` tile slots.
///
/// # Errors
/// [`Refusal`] with the first parameter that is out of its range.
pub fn check_start<const TILES: usize, const SLOTS: usize>(start: &Start) -> Result<(), Refusal> {
    let (across, up) = start.box_tiles;
    if !Tiles::<TILES, SLOTS>::fits(across, up) {
        return Err(Refusal::BadBox);
    }
    let limits = [
        (!start.lasers.is_empty(), Parameter::Lasers),
        (RADII_MM.contains(&start.robot_radius_mm), Parameter::Radius),
        (start.max_linear > I4F12::ZERO, Parameter::MaxLinear),
        (start.max_angular > I4F12::ZERO, Parameter::MaxAngular),
        (
            comes_to_rest(start.max_linear, start.linear_accel),
            Parameter::LinearAccel,
        ),
        (
            comes_to_rest(start.max_angular, start.angular_accel),
            Parameter::AngularAccel,
        ),
        (PERIODS_MS.contains(&start.period_ms), Parameter::Period),
    ];
    first_broken(&limits)?;
    for (number, laser) in start.lasers.iter().enumerate() {
        check_laser(laser, number == 0)?;
    }
    match &start.uneven_ground {
        Some(ground) => check_uneven_ground(ground, start.lasers.len()),
        None => Ok(()),
    }
}

fn check_uneven_ground(ground: &UnevenGround, lasers: usize) -> Result<(), Refusal> {
    let zero = I4F12::ZERO;
    first_broken(&[
        (
            (-STRONGEST..=zero).contains(&ground.least)
                && (zero..=STRONGEST).contains(&ground.most),
            Parameter::Preference,
        ),
        (
            ground.height_scale >= zero
                && ground.global_scale >= I16F16::ZERO
                && ground.obstacle > zero
                && ground.near > zero
                && ground.hole < zero
                && ground.step > zero
                && ground.climb > zero
                && ground.climb <= STEEPEST
                && ground.roll > zero
                && ground.roll <= STEEPEST
                && lasers == 2,
            Parameter::UnevenGround,
        ),
    ])
}

/// Returns true if this acceleration stops the robot from this speed within [`REST_S`].
fn comes_to_rest(speed: I4F12, acceleration: I4F12) -> bool {
    i32::from(acceleration.to_bits()) * REST_S >= i32::from(speed.to_bits())
}

fn check_laser(laser: &Laser, level: bool) -> Result<(), Refusal> {
    let beams = (1..=MAX_BEAMS).contains(&usize::from(laser.beams));
    let sweep = i64::from(laser.bearing_step.to_bits()) * i64::from(laser.beams.saturating_sub(1));
    let within_reach = |offset: I4F12| (-REACH..=REACH).contains(&offset);
    let pitch = if level {
        (-LEVEL..=LEVEL).contains(&laser.pitch)
    } else {
        (I4F12::ZERO..RIGHT_ANGLE).contains(&laser.pitch)
    };
    first_broken(&[
        (beams, Parameter::Beams),
        (
            (1..NO_RETURN_MM).contains(&laser.range_limit_mm),
            Parameter::RangeLimit,
        ),
        (
            laser.bearing_step > I16F16::ZERO
                && (-TURN..=TURN).contains(&laser.first_bearing)
                && sweep <= i64::from(TURN.to_bits()),
            Parameter::Bearing,
        ),
        (pitch, Parameter::Pitch),
        (
            within_reach(laser.x)
                && within_reach(laser.y)
                && laser.z > I4F12::ZERO
                && laser.z <= REACH,
            Parameter::Mount,
        ),
    ])
}

fn first_broken(limits: &[(bool, Parameter)]) -> Result<(), Refusal> {
    match limits.iter().find(|(kept, _)| !kept) {
        Some((_, parameter)) => Err(Refusal::BadParameter(*parameter)),
        None => Ok(()),
    }
}

/// Returns true if an observation has one scan per laser, with one range per beam.
#[must_use]
pub fn matches(observation: &Observation, beams: impl ExactSizeIterator<Item = u16>) -> bool {
    observation.scans.len() == beams.len()
        && observation
            .scans
            .iter()
            .zip(beams)
            .all(|(scan, beams)| scan.ranges_mm.len() == usize::from(beams))
}

#[cfg(test)]
mod tests;
