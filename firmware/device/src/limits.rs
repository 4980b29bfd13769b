//! Which parameters a session may have.

use fieldline_planner::map::Tiles;
use fieldline_protocol::message::{
    Laser, MAX_BEAMS, NO_RETURN_MM, Observation, Parameter, Refusal, Start, Terrain,
};
use fixed::types::{I4F12, I16F16};

/// A turn, radians, rounded up.
const TURN: I16F16 = I16F16::lit("6.2832");
/// A right angle, radians, rounded down.
const RIGHT_ANGLE: I4F12 = I4F12::lit("1.5705");
/// How far a level laser may tilt, radians: 12 m away it then looks 0.6 m off.
const LEVEL: I4F12 = I4F12::lit("0.05");
/// Strongest preference; beyond it the relaxation diverges.
const STRONGEST: I4F12 = I4F12::lit("2");
/// Steepest slope, radians: 45°.
const STEEPEST: I4F12 = I4F12::lit("0.7855");
/// How far from the centre a laser may sit, metres.
const REACH: I4F12 = I4F12::lit("2");
/// Radii that a robot may have, millimetres.
const RADII_MM: core::ops::RangeInclusive<u16> = 50..=2000;
/// Time in which a robot must come to rest from its greatest speed, seconds: the drive looks four seconds ahead, a period and
/// the braking after it.
const REST_S: i32 = 3;
/// Periods that a session may have, milliseconds: at most the stale limit less what a retry takes, and long enough to step in.
const PERIODS_MS: core::ops::RangeInclusive<u16> = 100..=400;
const _: () = assert!(*PERIODS_MS.end() < crate::STALE_MS);

/// Whether a session may run with these parameters in a map of this size.
///
/// # Errors
/// The first parameter that is out of its range.
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
    match &start.terrain {
        Some(terrain) => check_terrain(terrain, start.lasers.len()),
        None => Ok(()),
    }
}

fn check_terrain(terrain: &Terrain, lasers: usize) -> Result<(), Refusal> {
    let zero = I4F12::ZERO;
    first_broken(&[
        (
            (-STRONGEST..=zero).contains(&terrain.least)
                && (zero..=STRONGEST).contains(&terrain.most),
            Parameter::Preference,
        ),
        (
            terrain.height_scale >= zero
                && terrain.global_scale >= I16F16::ZERO
                && terrain.obstacle > zero
                && terrain.near > zero
                && terrain.hole < zero
                && terrain.step > zero
                && terrain.climb > zero
                && terrain.climb <= STEEPEST
                && terrain.roll > zero
                && terrain.roll <= STEEPEST
                && lasers == 2,
            Parameter::Terrain,
        ),
    ])
}

/// Whether this acceleration brakes from this speed within [`REST_S`].
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

/// Whether an observation has one scan for each laser, of as many ranges as it has beams.
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
mod tests {
    use fieldline_protocol::message::{
        Laser, Observation, Parameter, Refusal, Scan, Start, Terrain,
    };
    use fixed::types::{I4F12, I16F16};

    use super::{check_start, matches};
    use crate::pilot::tests::start;

    fn with_laser(change: impl Fn(&mut Laser)) -> Start {
        let mut start = start();
        change(&mut start.lasers[1]);
        start
    }

    #[test]
    fn good_parameters_pass() {
        assert_eq!(check_start::<4, 400>(&start()), Ok(()));
        let slow = Start {
            linear_accel: I4F12::lit("0.234"),
            angular_accel: I4F12::lit("0.814"),
            period_ms: 400,
            ..start()
        };
        assert_eq!(check_start::<4, 400>(&slow), Ok(()));
        let upward = |laser: &mut Laser| laser.bearing_step = I16F16::lit("0.0349");
        assert_eq!(check_start::<4, 400>(&with_laser(upward)), Ok(()));
    }

    #[test]
    fn every_limit_is_kept() {
        let bad = |parameter| Err(Refusal::BadParameter(parameter));
        let cases: &[(Start, Parameter)] = &[
            (
                Start {
                    lasers: heapless::Vec::new(),
                    ..start()
                },
                Parameter::Lasers,
            ),
            (
                Start {
                    robot_radius_mm: 49,
                    ..start()
                },
                Parameter::Radius,
            ),
            (
                Start {
                    robot_radius_mm: 2001,
                    ..start()
                },
                Parameter::Radius,
            ),
            (
                Start {
                    max_linear: I4F12::ZERO,
                    ..start()
                },
                Parameter::MaxLinear,
            ),
            (
                Start {
                    max_angular: -I4F12::DELTA,
                    ..start()
                },
                Parameter::MaxAngular,
            ),
            (
                Start {
                    // 0.7 m/s in a hair more than 3 s.
                    linear_accel: I4F12::lit("0.233"),
                    ..start()
                },
                Parameter::LinearAccel,
            ),
            (
                Start {
                    linear_accel: I4F12::MIN,
                    ..start()
                },
                Parameter::LinearAccel,
            ),
            (
                Start {
                    angular_accel: I4F12::lit("0.813"),
                    ..start()
                },
                Parameter::AngularAccel,
            ),
            (
                Start {
                    period_ms: 99,
                    ..start()
                },
                Parameter::Period,
            ),
            (
                Start {
                    period_ms: 401,
                    ..start()
                },
                Parameter::Period,
            ),
            (with_laser(|laser| laser.beams = 0), Parameter::Beams),
            (with_laser(|laser| laser.beams = 182), Parameter::Beams),
            (
                with_laser(|laser| laser.range_limit_mm = 0),
                Parameter::RangeLimit,
            ),
            (
                with_laser(|laser| laser.range_limit_mm = 16_383),
                Parameter::RangeLimit,
            ),
            (
                with_laser(|laser| laser.bearing_step = I16F16::ZERO),
                Parameter::Bearing,
            ),
            (
                with_laser(|laser| laser.bearing_step = I16F16::lit("0.04")),
                Parameter::Bearing,
            ),
            (
                with_laser(|laser| laser.bearing_step = I16F16::MAX),
                Parameter::Bearing,
            ),
            (
                with_laser(|laser| laser.first_bearing = I16F16::lit("-7")),
                Parameter::Bearing,
            ),
            (
                with_laser(|laser| laser.pitch = I4F12::lit("-0.1")),
                Parameter::Pitch,
            ),
            (
                with_laser(|laser| laser.pitch = I4F12::lit("1.6")),
                Parameter::Pitch,
            ),
            (with_laser(|laser| laser.z = I4F12::ZERO), Parameter::Mount),
            (with_laser(|laser| laser.x = I4F12::MIN), Parameter::Mount),
        ];
        for (start, parameter) in cases {
            assert_eq!(check_start::<4, 400>(start), bad(*parameter), "{start:?}");
        }
        let mut tilted = start();
        tilted.lasers[0].pitch = I4F12::lit("0.35");
        assert_eq!(check_start::<4, 400>(&tilted), bad(Parameter::Pitch));
    }

    #[test]
    fn the_limits_of_uneven_ground_are_kept() {
        let good = Terrain {
            obstacle: I4F12::lit("0.3"),
            near: I4F12::lit("1.5"),
            hole: I4F12::lit("-0.6"),
            least: I4F12::lit("-2"),
            most: I4F12::lit("2"),
            climb: I4F12::lit("0.35"),
            roll: I4F12::lit("0.26"),
            step: I4F12::lit("0.07"),
            ..Terrain::default()
        };
        let check = |change: &dyn Fn(&mut Terrain)| {
            let mut terrain = good;
            change(&mut terrain);
            check_start::<4, 400>(&Start {
                terrain: Some(terrain),
                ..start()
            })
        };
        assert_eq!(check(&|_| {}), Ok(()));
        type Change = &'static dyn Fn(&mut Terrain);
        let bad: [(Change, Parameter); 9] = [
            (&|t| t.most = I4F12::lit("2.001"), Parameter::Preference),
            (&|t| t.most = -I4F12::DELTA, Parameter::Preference),
            (&|t| t.least = I4F12::lit("-2.001"), Parameter::Preference),
            (&|t| t.least = I4F12::DELTA, Parameter::Preference),
            (&|t| t.hole = I4F12::ZERO, Parameter::Terrain),
            (&|t| t.climb = I4F12::ONE, Parameter::Terrain),
            (&|t| t.roll = I4F12::ONE, Parameter::Terrain),
            (&|t| t.roll = I4F12::ZERO, Parameter::Terrain),
            (&|t| t.height_scale = -I4F12::DELTA, Parameter::Terrain),
        ];
        for (change, parameter) in bad {
            assert_eq!(check(change), Err(Refusal::BadParameter(parameter)));
        }
        let one_laser = Start {
            terrain: Some(good),
            lasers: start().lasers.into_iter().take(1).collect(),
            ..start()
        };
        let refused = Err(Refusal::BadParameter(Parameter::Terrain));
        assert_eq!(check_start::<4, 400>(&one_laser), refused);
    }

    #[test]
    fn the_box_fits_the_slots() {
        for (box_tiles, fits) in [
            ((20, 20), true),
            ((30, 12), true),
            ((100, 4), true),
            ((4, 4), true),
            ((21, 19), false),
            ((22, 20), false),
            ((0, 20), false),
            ((20, 0), false),
            ((2, 100), false),
            ((254, 255), false),
        ] {
            let start = Start {
                box_tiles,
                ..start()
            };
            let expected = if fits { Ok(()) } else { Err(Refusal::BadBox) };
            assert_eq!(check_start::<4, 400>(&start), expected, "{box_tiles:?}");
        }
    }

    #[test]
    fn scans_must_match_the_lasers() {
        let scan = |beams: usize| Scan {
            ranges_mm: (0..beams).map(|_| 1000).collect(),
        };
        let seen = |scans: &[usize], beams: &[u16]| {
            let observation = Observation {
                scans: scans.iter().map(|beams| scan(*beams)).collect(),
                ..Observation::default()
            };
            matches(&observation, beams.iter().copied())
        };
        assert!(seen(&[3, 4], &[3, 4]));
        assert!(!seen(&[3, 4], &[4, 3]));
        assert!(!seen(&[3], &[3, 4]));
        assert!(!seen(&[3, 4], &[3]));
        assert!(!seen(&[2], &[3]));
        assert!(!seen(&[], &[3]));
    }
}
