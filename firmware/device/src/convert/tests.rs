//! Every limit, just inside and just outside.

use std::string::ToString;
use std::vec::Vec;

use fieldline_planner::{
    Cell, Config, LaserMount, ResidualFrontier, ResidualReason, RobotShape, Tuning, Twist,
};
use fieldline_protocol::message as wire;
use fieldline_protocol::message::{
    Control, Hull, Laser, Observation, Order, Parameter, Refusal, Scan, Start, Team, UnevenGround,
};
use fixed::types::{I4F12, I16F16};

use super::{config, float, input, quantity, wire_frontier, wire_twist};
use crate::pilot::Pilot;
use crate::pilot::tests::{Bench, start};

/// Returns what the device answers to these parameters.
fn checked(start: &Start) -> Result<(), Refusal> {
    let start = Control::Start(start.clone());
    let started = Pilot::new().control(&mut Bench::new().memory(), &start);
    started.map(drop)
}

fn with_laser(change: impl Fn(&mut Laser)) -> Start {
    let mut start = start();
    change(&mut start.lasers[1]);
    start
}

#[test]
fn good_parameters_are_accepted() {
    assert_eq!(checked(&start()), Ok(()));
    let slow = Start {
        linear_accel: I4F12::lit("0.234"),
        angular_accel: I4F12::lit("0.814"),
        period_ms: 400,
        ..start()
    };
    assert_eq!(checked(&slow), Ok(()));
    let upward = |laser: &mut Laser| laser.bearing_step = I16F16::lit("0.0349");
    assert_eq!(checked(&with_laser(upward)), Ok(()));
}

fn with(change: impl Fn(&mut Start)) -> Start {
    let mut start = start();
    change(&mut start);
    start
}

/// Asserts that each start is refused for its parameter.
fn are_refused(cases: &[(Start, Parameter)]) {
    for (start, parameter) in cases {
        let refused = Err(Refusal::BadParameter(*parameter));
        assert_eq!(checked(start), refused, "{start:?}");
    }
}

#[test]
fn every_limit_of_the_robot_is_checked() {
    are_refused(&[
        (with(|it| it.lasers.clear()), Parameter::Lasers),
        (with(|it| it.hull.width_mm = 0), Parameter::Hull),
        (with(|it| it.hull.length_mm = 4001), Parameter::Hull),
        (with(|it| it.robot_radius_mm = 49), Parameter::Radius),
        (with(|it| it.robot_radius_mm = 601), Parameter::Radius),
        (with(|it| it.max_linear = I4F12::ZERO), Parameter::MaxLinear),
        (
            with(|it| it.max_angular = -I4F12::DELTA),
            Parameter::MaxAngular,
        ),
        (
            // 0.7 m/s in slightly more than 3 s.
            with(|it| it.linear_accel = I4F12::lit("0.233")),
            Parameter::LinearAccel,
        ),
        (
            with(|it| it.linear_accel = I4F12::MIN),
            Parameter::LinearAccel,
        ),
        (
            with(|it| it.angular_accel = I4F12::lit("0.813")),
            Parameter::AngularAccel,
        ),
        (with(|it| it.period_ms = 99), Parameter::Period),
        (with(|it| it.period_ms = 401), Parameter::Period),
    ]);
}

#[test]
fn every_limit_of_the_strategy_and_the_team_is_checked() {
    are_refused(&[
        (
            with(|it| it.loops.detour = -I16F16::DELTA),
            Parameter::LoopLimits,
        ),
        (
            with(|it| {
                it.order = Order::Gain {
                    worth: -I4F12::DELTA,
                };
            }),
            Parameter::Worth,
        ),
        (
            with(|it| {
                it.team = Some(Team {
                    origin: (I16F16::from_num(401), I16F16::ZERO),
                    ..Team::default()
                });
            }),
            Parameter::Team,
        ),
    ]);
}

#[test]
fn every_limit_of_a_laser_is_checked() {
    are_refused(&[
        (with_laser(|it| it.beams = 0), Parameter::Beams),
        (with_laser(|it| it.beams = 182), Parameter::Beams),
        (
            with_laser(|it| it.range_limit_mm = 0),
            Parameter::RangeLimit,
        ),
        (
            with_laser(|it| it.range_limit_mm = 16_383),
            Parameter::RangeLimit,
        ),
        (
            with_laser(|it| it.bearing_step = I16F16::ZERO),
            Parameter::Bearing,
        ),
        (
            with_laser(|it| it.bearing_step = I16F16::lit("0.04")),
            Parameter::Bearing,
        ),
        (
            with_laser(|it| it.bearing_step = I16F16::MAX),
            Parameter::Bearing,
        ),
        (
            with_laser(|it| it.first_bearing = I16F16::lit("-7")),
            Parameter::Bearing,
        ),
        (
            with_laser(|it| it.pitch = I4F12::lit("-0.1")),
            Parameter::Pitch,
        ),
        (
            with_laser(|it| it.pitch = I4F12::lit("1.6")),
            Parameter::Pitch,
        ),
        (with_laser(|it| it.turn_time_ms = 501), Parameter::TurnTime),
        (with_laser(|it| it.z = I4F12::ZERO), Parameter::Mount),
        (with_laser(|it| it.x = I4F12::MIN), Parameter::Mount),
        (
            with(|it| it.lasers[0].pitch = I4F12::lit("0.35")),
            Parameter::Pitch,
        ),
    ]);
}

/// The planner holds radii of 50 to 600 mm. The wire accepts the same radii and no others.
#[test]
fn the_radius_is_limited_to_what_the_planner_holds() {
    let check = |robot_radius_mm| {
        checked(&Start {
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
        checked(&Start {
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
    let refused = Err(Refusal::BadParameter(Parameter::Lasers));
    assert_eq!(checked(&one_laser), refused);
}

/// The wire and the planner write the events down twice.
#[test]
fn the_events_of_the_wire_are_the_planners() {
    let mut events = fieldline_planner::Events::default();
    for event in fieldline_planner::Event::ALL {
        events.add(event);
        let heard: Vec<_> = wire::Events(events.bits()).iter().collect();
        let own: Vec<_> = events.iter().collect();
        assert_eq!(std::format!("{heard:?}"), std::format!("{own:?}"));
    }
    assert_eq!(wire::Event::ALL.len(), fieldline_planner::Event::ALL.len());
}

/// The wire and the planner write the default worth down twice.
#[test]
fn the_default_order_of_a_strategy_is_the_planners() {
    let tdbvp = wire::Strategy::Tdbvp {
        patrol_s: 10,
        impatience_s: Some(60),
    };
    for strategy in [wire::Strategy::Frontier, wire::Strategy::Ouroboros, tdbvp] {
        let start = Start {
            strategy,
            order: strategy.order(),
            ..start()
        };
        let heard = config(&start, &Tuning::DEFAULT).expect("valid");
        let own = Config::builder(RobotShape::PIONEER_3AT)
            .strategy(heard.strategy())
            .laser(LaserMount::level(0.1, 0.4))
            .build()
            .expect("valid");
        assert_eq!(heard.order(), own.order());
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
        let laser = |&beams: &u16| LaserMount {
            beams,
            ..LaserMount::level(0.1, 0.4)
        };
        let lasers: Vec<LaserMount> = beams.iter().map(laser).collect();
        input(&observation, &lasers).is_some()
    };
    assert!(seen(&[3, 4], &[3, 4]));
    assert!(!seen(&[3, 4], &[4, 3]));
    assert!(!seen(&[3], &[3, 4]));
    assert!(!seen(&[3, 4], &[3]));
    assert!(!seen(&[2], &[3]));
    assert!(!seen(&[], &[3]));
}

#[test]
fn a_session_takes_its_limits_from_the_host() {
    let start = Start {
        robot_radius_mm: 250,
        max_linear: I4F12::lit("0.5"),
        max_angular: I4F12::lit("1.5"),
        linear_accel: I4F12::lit("0.25"),
        angular_accel: I4F12::lit("0.75"),
        period_ms: 125,
        hull: Hull {
            length_mm: 900,
            width_mm: 600,
            height_mm: 400,
        },
        lasers: start().lasers,
        ..Start::default()
    };
    let config = config(&start, &Tuning::DEFAULT).expect("valid");
    assert_eq!(*config.robot(), RobotShape::rectangle(0.9, 0.6, 0.4));
    assert_eq!(
        [
            config.radius_m(),
            config.max_speed().linear_mps,
            config.max_speed().angular_radps,
            config.acceleration().0,
            config.acceleration().1,
            config.period_s(),
        ],
        [0.25, 0.5, 1.5, 0.25, 0.75, 0.125]
    );
}

#[test]
fn every_short_quantity_round_trips() {
    for bits in i16::MIN..=i16::MAX {
        let short = I4F12::from_bits(bits);
        assert_eq!(quantity::<I4F12>(float(short)), short);
    }
}

#[test]
fn long_quantities_round_trip_within_128_m() {
    for bits in (-(1 << 23)..=1 << 23).step_by(997) {
        let long = I16F16::from_bits(bits);
        assert_eq!(quantity::<I16F16>(float(long)), long);
    }
}

#[test]
fn quantities_saturate_and_nan_becomes_zero() {
    let twist = |linear_mps, angular_radps| {
        let twist = wire_twist(&Twist {
            linear_mps,
            angular_radps,
        });
        (twist.linear, twist.angular)
    };
    assert_eq!(twist(9.0, -9.0), (I4F12::MAX, I4F12::MIN));
    assert_eq!(
        twist(f32::INFINITY, f32::NEG_INFINITY),
        (I4F12::MAX, I4F12::MIN)
    );
    assert_eq!(twist(f32::NAN, -f32::NAN), (I4F12::ZERO, I4F12::ZERO));
}

#[test]
fn distant_cells_saturate() {
    let frontier = ResidualFrontier {
        cell: Cell {
            x: 40_000,
            y: -40_000,
        },
        cells: 7,
        reason: ResidualReason::OutOfBounds,
    };
    assert_eq!(
        wire_frontier(&frontier),
        wire::ResidualFrontier {
            x: i16::MAX,
            y: i16::MIN,
            cells: 7,
            reason: wire::ResidualReason::OutOfBounds,
        }
    );
}
