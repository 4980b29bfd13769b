//! Direct velocity: the velocity along a heading that needs no recovery.
//!
//! The heading is the field's. Where the robot would creep along the field, a lane replaces it.
//!
//! With `error`, the angle from the robot's front to the heading, the wish is
//!
//! ```text
//! v = v_max · cos²(error)        0 for an error above 0.9 rad
//! ω = 2/s · error                at most 0.6 of the greatest turn rate
//! ```
//!
//! The candidates are tried in this order, and the first admissible one is driven:
//!
//! 1. ahead: the wished speed, half of it, a fifth of it; for each speed the wished turn rate, then
//!    turn rates up to 0.6 rad/s beside it. At creeping speed a roll-out must lead on as well;
//! 2. a turn on the spot towards the heading, if there is room for all of it;
//! 3. back, if the robot's back nearly points along the heading;
//! 4. on a slope too steep to turn fully: a turn of the robot's back towards the heading.
//!
//! Invariant: until the robot has braked to a stop it keeps 6 cm from every obstacle point, or
//! 2.5 cm if it creeps or turns on the spot. It approaches a point that is nearer already by no
//! more than the slack of the collision checker. It begins no turn on the spot that it cannot
//! finish.
//!
//! Units: metres, seconds, radians; robot frame, x forward.

use crate::config::Config;
use crate::drive::collision::CollisionChecker;
use crate::drive::hull::Place;
use crate::drive::lane::Lane;
use crate::drive::roll_out::roll_out;
use crate::drive::search_query::SearchQuery;
use crate::geometry::Twist;
use crate::math;

/// Clearance at speed, metres: three sigma of a range and one of the odometry between two scans.
const MARGIN_M: f32 = 0.06;
/// Clearance while creeping through a narrow place, metres: two sigma of a range.
pub(super) const CREEP_MARGIN_M: f32 = 0.025;
/// Greatest speed that counts as creeping, and the speed of reversing, metres per second.
pub(super) const CREEP_MPS: f32 = 0.15;
/// Wished turn rate per radian of error, 1/s.
const TURN_GAIN: f32 = 2.0;
/// Greatest wished turn rate, as a part of the robot's.
const TURN_PART: f32 = 0.6;
/// Slower turn rate that is tried next, as a part of the wished one.
const SLOW_TURN_PART: f32 = 0.4;
/// Least error for which the robot turns on the spot first, radians.
const TURN_FIRST_RAD: f32 = 0.9;
/// Greatest error that needs no turn on the spot, radians.
pub(super) const ALIGNED_RAD: f32 = 0.12;
/// Speeds of the candidates ahead, as parts of the wished one, in the order of trial.
const SPEED_PARTS: [f32; 3] = [1.0, 0.5, 0.2];
/// Turn rates of the candidates ahead beside the wished one, radians per second, in the order of
/// trial for each speed.
const TURN_OFFSETS_RADPS: [f32; 5] = [0.0, 0.25, -0.25, 0.6, -0.6];
/// Greatest difference of the error to half a turn for driving straight back, radians.
const REVERSE_RAD: f32 = 0.35;
/// Turn rate while reversing, per radian of that difference, 1/s.
const REVERSE_GAIN: f32 = 0.5;

/// Returns the first admissible velocity for a heading that is `error` to the left. With `rolls`,
/// the robot creeps ahead only where a roll-out leads on.
pub(super) fn velocity<H: Fn(Place) -> Option<f32>>(
    config: &Config,
    error: f32,
    now: Twist,
    query: &SearchQuery<'_, H>,
    rolls: bool,
) -> Option<Twist> {
    let checker = query.checker;
    let admits = |&twist: &Twist| is_admitted(config, twist, now, checker);
    // A turn that the robot cannot finish would wedge it.
    let can_turn = |turn| checker.is_arc_clear(Place::default(), 0.0, turn, CREEP_MARGIN_M);
    let turn = |error| turns(config, error).into_iter().flatten().find(admits);
    let opposite = math::wrap(error + math::PI);
    // A gap that the robot cannot follow the field through would wedge it.
    let may_go_on = |&twist: &Twist| {
        !rolls || twist.linear_mps > CREEP_MPS || {
            roll_out(
                query,
                (Place::default(), false),
                query.least_margin_m(),
                &mut 0,
                (&|_| true, &|_| false),
            )
            .is_ok()
        }
    };
    let wish = ahead(config, error).find(admits);
    wish.filter(may_go_on)
        .or_else(|| turn(error).filter(|_| can_turn(error)))
        .or_else(|| back(opposite).filter(admits))
        .or_else(|| {
            let turns_back = checker.is_steep() && can_turn(opposite);
            turns_back.then(|| turn(opposite)).flatten()
        })
}

/// Returns the first admissible velocity ahead, whatever the field's heading.
pub(super) fn straight(config: &Config, now: Twist, checker: &CollisionChecker) -> Option<Twist> {
    ahead(config, 0.0).find(|&twist| is_admitted(config, twist, now, checker))
}

/// Returns true if the checker admits a velocity with the clearance for its speed.
fn is_admitted(config: &Config, twist: Twist, now: Twist, checker: &CollisionChecker) -> bool {
    let creeps = twist.linear_mps.abs() <= CREEP_MPS;
    let margin_m = if creeps { CREEP_MARGIN_M } else { MARGIN_M };
    checker.admits(twist, now, config, margin_m)
}

/// Returns true if the robot can follow the field's heading faster than it creeps.
pub(super) fn is_open(config: &Config, field: f32, now: Twist, checker: &CollisionChecker) -> bool {
    ahead(config, field)
        .filter(|twist| twist.linear_mps > CREEP_MPS)
        .any(|twist| checker.admits(twist, now, config, MARGIN_M))
}

/// Returns the lane to follow, if there is one and the robot would creep ahead. Beside another
/// robot and on slopes that bound the headings there is none.
pub(super) fn lane(
    config: &Config,
    field: f32,
    now: Twist,
    (checker, least_m): (&CollisionChecker, f32),
) -> Option<Lane> {
    let is_free = !checker.has_company() && !checker.bounds_headings();
    let turns_first = field.abs() > TURN_FIRST_RAD;
    if !is_free || turns_first || is_open(config, field, now, checker) {
        return None;
    }
    Lane::find(checker, field, least_m)
}

/// Returns the candidates ahead, the wish first; none if the robot has to turn first.
fn ahead(config: &Config, error: f32) -> impl Iterator<Item = Twist> {
    let wish_radps = turn_rate(config, error);
    let (_, cos) = math::sin_cos(error);
    let wish_mps = if error.abs() > TURN_FIRST_RAD {
        0.0
    } else {
        config.max_linear_mps * cos * cos
    };
    let most = config.max_angular_radps;
    let speeds = SPEED_PARTS.into_iter().filter(move |_| wish_mps > 0.0);
    speeds.flat_map(move |part| {
        TURN_OFFSETS_RADPS.map(|offset| Twist {
            linear_mps: wish_mps * part,
            angular_radps: (wish_radps + offset).clamp(-most, most),
        })
    })
}

/// Returns the turns on the spot towards the heading, the quick one first; none if it is aligned.
fn turns(config: &Config, error: f32) -> Option<[Twist; 2]> {
    let quick = turn_rate(config, error);
    (error.abs() > ALIGNED_RAD).then(|| {
        [quick, SLOW_TURN_PART * quick].map(|angular_radps| Twist {
            linear_mps: 0.0,
            angular_radps,
        })
    })
}

/// Returns the velocity straight back, if `opposite`, the error of the robot's back, is small.
fn back(opposite: f32) -> Option<Twist> {
    (opposite.abs() < REVERSE_RAD).then_some(Twist {
        linear_mps: -CREEP_MPS,
        angular_radps: REVERSE_GAIN * opposite,
    })
}

/// Returns the wished turn rate, radians per second.
fn turn_rate(config: &Config, error: f32) -> f32 {
    let most = TURN_PART * config.max_angular_radps;
    (TURN_GAIN * error).clamp(-most, most)
}
