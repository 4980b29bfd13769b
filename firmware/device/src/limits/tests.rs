//! Every limit, just inside and just outside.

use std::string::ToString;

use fieldline_protocol::message::{
    Laser, Observation, Parameter, Refusal, Scan, Start, UnevenGround,
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
fn good_parameters_are_accepted() {
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
fn every_limit_is_checked() {
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
                robot_radius_mm: 601,
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
                // 0.7 m/s in slightly more than 3 s.
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

/// The planner holds radii of 50 to 600 mm. The wire accepts the same radii and no others.
#[test]
fn the_radius_is_limited_to_what_the_planner_holds() {
    let check = |robot_radius_mm| {
        check_start::<4, 400>(&Start {
            robot_radius_mm,
            ..start()
        })
    };
    for accepted in [50, 300, 600] {
        assert_eq!(check(accepted), Ok(()), "{accepted} mm");
    }
    for refused in [0, 49, 601, 2000, u16::MAX] {
        let error = check(refused).unwrap_err();
        assert_eq!(
            error,
            Refusal::BadParameter(Parameter::Radius),
            "{refused} mm"
        );
        assert!(error.to_string().contains("radius must be 50 to 600 mm"));
    }
}

#[test]
fn limits_of_uneven_ground_are_checked() {
    let good = UnevenGround {
        obstacle: I4F12::lit("0.3"),
        near: I4F12::lit("1.5"),
        hole: I4F12::lit("-0.6"),
        least: I4F12::lit("-2"),
        most: I4F12::lit("2"),
        climb: I4F12::lit("0.35"),
        roll: I4F12::lit("0.26"),
        step: I4F12::lit("0.07"),
        ..UnevenGround::default()
    };
    let check = |change: &dyn Fn(&mut UnevenGround)| {
        let mut ground = good;
        change(&mut ground);
        check_start::<4, 400>(&Start {
            uneven_ground: Some(ground),
            ..start()
        })
    };
    assert_eq!(check(&|_| {}), Ok(()));
    type Change = &'static dyn Fn(&mut UnevenGround);
    let bad: [(Change, Parameter); 9] = [
        (&|t| t.most = I4F12::lit("2.001"), Parameter::Preference),
        (&|t| t.most = -I4F12::DELTA, Parameter::Preference),
        (&|t| t.least = I4F12::lit("-2.001"), Parameter::Preference),
        (&|t| t.least = I4F12::DELTA, Parameter::Preference),
        (&|t| t.hole = I4F12::ZERO, Parameter::UnevenGround),
        (&|t| t.climb = I4F12::ONE, Parameter::UnevenGround),
        (&|t| t.roll = I4F12::ONE, Parameter::UnevenGround),
        (&|t| t.roll = I4F12::ZERO, Parameter::UnevenGround),
        (&|t| t.height_scale = -I4F12::DELTA, Parameter::UnevenGround),
    ];
    for (change, parameter) in bad {
        assert_eq!(check(change), Err(Refusal::BadParameter(parameter)));
    }
    let one_laser = Start {
        uneven_ground: Some(good),
        lasers: start().lasers.into_iter().take(1).collect(),
        ..start()
    };
    let refused = Err(Refusal::BadParameter(Parameter::UnevenGround));
    assert_eq!(check_start::<4, 400>(&one_laser), refused);
}

#[test]
fn the_box_must_fit_the_slots() {
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
