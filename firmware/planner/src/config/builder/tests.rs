//! Every parameter has a range, and an error names the parameter.

use std::string::ToString;

use super::{ConfigBuilder, RADII_M};
use crate::config::{
    Area, Config, LoopLimits, Parameter, SolverConfig, SpaceField, Strategy, UnevenGround,
};
use crate::geometry::Cell;
use crate::robot::{LaserMount, RobotShape};

fn flat() -> ConfigBuilder {
    Config::builder(RobotShape::PIONEER_3AT).laser(LaserMount::level(0.1, 0.4))
}

fn uneven(ground: UnevenGround) -> ConfigBuilder {
    flat()
        .laser(LaserMount::tilted(0.15, 0.45, 0.349))
        .uneven_ground(ground)
}

/// Returns the parameter that a builder's `build` refuses.
fn refused(builder: ConfigBuilder) -> Option<Parameter> {
    builder.build().err().map(|error| error.parameter)
}

#[test]
fn the_defaults_are_the_pioneer() {
    let built = flat().build().expect("the defaults are valid");
    assert!(built.localises(), "every odometry drifts");
    let built = flat().localise(false).build();
    let built = built.expect("the defaults are valid");
    let lasers = built.lasers.clone();
    let pioneer = Config::pioneer_3at(lasers);
    assert_eq!(std::format!("{built:?}"), std::format!("{pioneer:?}"));
}

#[test]
fn lasers_are_counted_and_checked() {
    let none = Config::builder(RobotShape::PIONEER_3AT);
    assert_eq!(refused(none), Some(Parameter::Lasers));
    let level = || LaserMount::level(0.1, 0.4);
    assert_eq!(
        refused(flat().laser(level()).laser(level())),
        Some(Parameter::Lasers)
    );
    let with = |laser: LaserMount| refused(flat().laser(laser));
    assert_eq!(
        with(LaserMount {
            beams: 0,
            ..level()
        }),
        Some(Parameter::Beams)
    );
    assert_eq!(
        with(LaserMount {
            beams: 182,
            ..level()
        }),
        Some(Parameter::Beams)
    );
    let range_limit_mm = 16_383;
    let far = LaserMount {
        range_limit_mm,
        ..level()
    };
    assert_eq!(with(far), Some(Parameter::RangeLimit));
    let wide = LaserMount {
        bearing_step_rad: 0.05,
        ..level()
    };
    assert_eq!(with(wide), Some(Parameter::Sweep));
    let high = LaserMount {
        z_m: 2.1,
        ..level()
    };
    assert_eq!(with(high), Some(Parameter::LaserHeight));
    let slow = LaserMount::MAX_TURN_MS;
    assert_eq!(with(level().turning(slow)), None);
    assert_eq!(with(level().turning(slow + 1)), Some(Parameter::TurnTime));
    // The beams of a tilted laser leave its plane when they are moved.
    let tilted = LaserMount::tilted(0.15, 0.45, 0.349);
    assert_eq!(with(tilted), None);
    assert_eq!(with(tilted.turning(1)), Some(Parameter::TurnTime));
    let up = LaserMount {
        pitch_rad: -0.01,
        ..level()
    };
    assert_eq!(with(up), Some(Parameter::Pitch));
    let tilted =
        Config::builder(RobotShape::PIONEER_3AT).laser(LaserMount::tilted(0.15, 0.45, 0.349));
    assert_eq!(refused(tilted), Some(Parameter::Pitch));
}

#[test]
fn motion_must_stop_within_three_seconds() {
    assert_eq!(refused(flat().acceleration(0.234, 0.814)), None);
    let slow = flat().acceleration(0.2, 1.75);
    let error = slow.build().expect_err("0.7 m/s takes 3.5 s");
    assert_eq!(error.parameter, Parameter::LinearAccel);
    assert!((error.least - 0.7 / 3.0).abs() < 1e-6, "{error}");
    assert_eq!(
        refused(flat().acceleration(0.3, 0.8)),
        Some(Parameter::AngularAccel)
    );
    assert_eq!(
        refused(flat().max_speed(0.0, 1.0)),
        Some(Parameter::MaxLinear)
    );
    assert_eq!(
        refused(flat().max_speed(0.5, f32::NAN)),
        Some(Parameter::MaxAngular)
    );
}

#[test]
fn radius_period_and_hull_have_limits() {
    for (radius_m, expected) in [
        (RADII_M.0 - 0.001, Some(Parameter::Radius)),
        (RADII_M.0, None),
        (RADII_M.1, None),
        (RADII_M.1 + 0.001, Some(Parameter::Radius)),
        (f32::INFINITY, Some(Parameter::Radius)),
    ] {
        assert_eq!(refused(flat().radius_m(radius_m)), expected, "{radius_m}");
    }
    assert_eq!(
        refused(flat().period_s(Config::PERIODS_S.1 + 0.01)),
        Some(Parameter::Period)
    );
    let flat_hull = RobotShape::rectangle(0.5, 0.0, 0.3);
    let builder = Config::builder(flat_hull).laser(LaserMount::level(0.1, 0.4));
    assert_eq!(refused(builder), Some(Parameter::HalfWidth));
}

#[test]
fn uneven_ground_needs_two_lasers_and_a_slow_robot() {
    let table = UnevenGround::TABLE_I;
    assert_eq!(
        refused(flat().uneven_ground(table)),
        Some(Parameter::Lasers)
    );
    let config = uneven(table).build().expect("valid");
    assert_eq!(config.max_linear_mps, 0.1 / 0.2);
    let strong = UnevenGround {
        least_preference: -2.1,
        ..table
    };
    assert_eq!(refused(uneven(strong)), Some(Parameter::LeastPreference));
    let steep = UnevenGround {
        climb: 1.1,
        ..table
    };
    assert_eq!(refused(uneven(steep)), Some(Parameter::UnevenGround));
}

#[test]
fn an_area_has_a_size_and_a_target() {
    let with = |across, up, x, until_permille| {
        let area = Area {
            least: Cell { x, y: 0 },
            across,
            up,
        };
        let field = SpaceField {
            until_permille,
            ..SpaceField::over(area)
        };
        [Strategy::Sbpf(field), Strategy::Esbpf(field)]
            .map(|strategy| refused(flat().strategy(strategy)))
    };
    assert_eq!(with(1, Area::MOST_CELLS, -32_000, 1), [None; 2]);
    assert_eq!(with(100, 80, 0, 1_000), [None; 2]);
    let area = [Some(Parameter::Area); 2];
    assert_eq!(with(0, 80, 0, 1_000), area);
    assert_eq!(with(100, Area::MOST_CELLS + 1, 0, 1_000), area);
    assert_eq!(with(100, 80, 32_001, 1_000), area);
    for until_permille in [0, 1_001] {
        let refusals = with(100, 80, 0, until_permille);
        assert_eq!(refusals, [Some(Parameter::Coverage); 2]);
    }
}

#[test]
fn loops_and_solver_have_limits() {
    let backwards = LoopLimits {
        least_m: -1.0,
        ..LoopLimits::default()
    };
    assert_eq!(
        refused(flat().loops(backwards)),
        Some(Parameter::LoopLimits)
    );
    let never = SolverConfig {
        max_cycles: 0,
        ..SolverConfig::default()
    };
    let error = flat()
        .solver(never)
        .build()
        .expect_err("no cycle, no field");
    assert_eq!(error.parameter, Parameter::Solver);
    assert!(
        error
            .to_string()
            .starts_with("parameter of the solver is 0;"),
        "{error}"
    );
}
