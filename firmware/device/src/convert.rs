//! Conversions between the wire's quantities and the planner's. No other file mixes `fixed` and
//! `f32`.
//!
//! To the planner the conversion is exact for an `I4F12` (16 bits; f32 has 24). It rounds an
//! `I16F16` beyond ±128 m to nearest: to 2⁻¹⁶ m or better up to 256 m. To the wire it rounds to
//! nearest and saturates, and a NaN becomes zero. Both directions are integer arithmetic and give
//! the same bits on every machine.

use fieldline_planner::config::{self, Config};
use fieldline_planner::config::{PreferenceMode, UnevenGround};
use fieldline_planner::geometry::{CELL_M, Pose, Twist};
use fieldline_planner::input::Input;
use fieldline_planner::math;
use fieldline_planner::robot;
use fieldline_planner::status::{self, Residue};
use fieldline_protocol::message as wire;
use fixed::traits::{Fixed, LossyInto};

/// Returns a wire quantity as f32.
fn float(quantity: impl LossyInto<f32>) -> f32 {
    quantity.lossy_into()
}

/// Returns the nearest wire quantity; zero for a NaN.
#[must_use]
pub fn quantity<F: Fixed>(value: f32) -> F {
    if value.is_nan() {
        F::ZERO
    } else {
        F::saturating_from_num(value)
    }
}

/// Converts a pose from the wire.
#[must_use]
pub fn pose(pose: &wire::Pose) -> Pose {
    Pose {
        x_m: float(pose.x),
        y_m: float(pose.y),
        z_m: float(pose.z),
        roll_rad: float(pose.roll),
        pitch_rad: float(pose.pitch),
        yaw_rad: float(pose.yaw),
    }
}

/// Converts a velocity from the wire.
#[must_use]
pub fn twist(twist: &wire::Twist) -> Twist {
    Twist {
        linear_mps: float(twist.linear),
        angular_radps: float(twist.angular),
    }
}

/// Converts an observation from the wire. A missing scan is empty.
#[must_use]
pub fn input(observation: &wire::Observation) -> Input<'_> {
    let scan = |number: usize| match observation.scans.get(number) {
        Some(scan) => scan.ranges_mm.as_slice(),
        None => &[],
    };
    Input {
        time_ms: observation.time_ms,
        pose: pose(&observation.pose),
        velocity: twist(&observation.velocity),
        scans: [scan(0), scan(1)],
    }
}

/// Converts a velocity for the wire.
#[must_use]
pub fn wire_twist(twist: &Twist) -> wire::Twist {
    wire::Twist {
        linear: quantity(twist.linear_mps),
        angular: quantity(twist.angular_radps),
    }
}

fn laser(laser: &wire::Laser) -> robot::LaserMount {
    robot::LaserMount {
        x_m: float(laser.x),
        y_m: float(laser.y),
        z_m: float(laser.z),
        pitch_rad: float(laser.pitch),
        first_bearing_rad: float(laser.first_bearing),
        bearing_step_rad: float(laser.bearing_step),
        beams: laser.beams,
        range_limit_mm: laser.range_limit_mm,
    }
}

fn uneven_ground(ground: &wire::UnevenGround) -> UnevenGround {
    // At most 45°: `limits::check_start` refuses steeper slopes.
    let tangent = |angle: fixed::types::I4F12| {
        let (sin, cos) = math::sin_cos(float(angle));
        sin / cos
    };
    UnevenGround {
        mode: match ground.preference {
            wire::Preference::Off => PreferenceMode::Off,
            wire::Preference::Height => PreferenceMode::Height,
            wire::Preference::Global => PreferenceMode::Global,
            wire::Preference::Both => PreferenceMode::Both,
        },
        obstacle_m: float(ground.obstacle),
        near_m: float(ground.near),
        hole_m: float(ground.hole),
        least_preference: float(ground.least),
        most_preference: float(ground.most),
        height_scale: float(ground.height_scale),
        global_scale: float(ground.global_scale),
        climb: tangent(ground.climb),
        roll: tangent(ground.roll),
        step_m: float(ground.step),
    }
}

/// Converts the parameters of a session from the wire.
///
/// On uneven ground the maximum speed is limited to one map cell per period, so that the tilted
/// laser sweeps every cell.
#[must_use]
pub fn config(start: &wire::Start) -> Config {
    let default = Config::pioneer_3at(start.lasers.iter().map(laser).collect());
    let period_s = f32::from(start.period_ms) / 1000.0;
    let max_linear_mps = float(start.max_linear);
    let robot_radius_m = f32::from(start.robot_radius_mm) / 1000.0;
    Config {
        strategy: match start.strategy {
            wire::Strategy::Frontier => config::Strategy::Frontier,
            wire::Strategy::Ouroboros => config::Strategy::Ouroboros,
            wire::Strategy::Tdbvp { patrol_s } => config::Strategy::Tdbvp { patrol_s },
        },
        box_tiles: start.box_tiles,
        robot_radius_m,
        // The tight radius is the same part of the radius for every robot.
        tight_radius_m: robot_radius_m * (default.tight_radius_m / default.robot_radius_m),
        max_linear_mps: if start.uneven_ground.is_some() {
            max_linear_mps.min(CELL_M / period_s)
        } else {
            max_linear_mps
        },
        max_angular_radps: float(start.max_angular),
        linear_accel_mps2: float(start.linear_accel),
        angular_accel_radps2: float(start.angular_accel),
        period_s,
        ground: start.uneven_ground.as_ref().map(uneven_ground),
        ..default
    }
}

/// Converts the planner's status for the wire.
pub(crate) fn wire_status(status: status::Status) -> wire::Status {
    match status {
        status::Status::Exploring => wire::Status::Exploring,
        status::Status::Finished(finish) => wire::Status::Finished(match finish {
            status::Finish::Explored => wire::Finish::Explored,
            status::Finish::BoxedIn => wire::Finish::BoxedIn,
        }),
        status::Status::Fault(fault) => wire::Status::Fault(match fault {
            status::Fault::StartBlocked => wire::Fault::StartBlocked,
            status::Fault::MapFull => wire::Fault::MapFull,
            status::Fault::OutOfBox => wire::Fault::OutOfBox,
            status::Fault::BadObservation => wire::Fault::BadObservation,
            status::Fault::Stuck => wire::Fault::Stuck,
        }),
    }
}

/// Converts a residual frontier for the wire.
#[must_use]
pub fn wire_frontier(frontier: &status::Frontier) -> wire::ResidualFrontier {
    let short = |cell: i32| cell.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
    wire::ResidualFrontier {
        x: short(frontier.cell.x),
        y: short(frontier.cell.y),
        cells: frontier.cells,
        reason: match frontier.reason {
            Residue::Unreachable => wire::ResidualReason::Unreachable,
            Residue::Unobservable => wire::ResidualReason::Unobservable,
            Residue::OutOfBounds => wire::ResidualReason::OutOfBounds,
            Residue::NoProgress => wire::ResidualReason::NoProgress,
        },
    }
}

#[cfg(test)]
mod tests {
    use fieldline_planner::geometry::{Cell, Twist};
    use fieldline_planner::status::{Frontier, Residue};
    use fieldline_protocol::message as wire;
    use fixed::types::{I4F12, I16F16};

    use super::{config, float, quantity, wire_frontier, wire_twist};

    #[test]
    fn a_session_takes_its_limits_from_the_host() {
        let start = wire::Start {
            box_tiles: (30, 12),
            robot_radius_mm: 250,
            max_linear: I4F12::lit("0.5"),
            max_angular: I4F12::lit("1.5"),
            linear_accel: I4F12::lit("0.25"),
            angular_accel: I4F12::lit("0.75"),
            period_ms: 125,
            ..wire::Start::default()
        };
        let config = config(&start);
        assert_eq!(config.box_tiles, (30, 12));
        assert_eq!(
            [
                config.robot_radius_m,
                config.max_linear_mps,
                config.max_angular_radps,
                config.linear_accel_mps2,
                config.angular_accel_radps2,
                config.period_s,
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
        let frontier = Frontier {
            cell: Cell {
                x: 40_000,
                y: -40_000,
            },
            cells: 7,
            reason: Residue::OutOfBounds,
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
}
