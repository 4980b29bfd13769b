//! How well the maps of a team's robots agree: the error of the motion between two of them.
//!
//! ```text
//! Eᵢ = estimateᵢ ∘ truthᵢ⁻¹           a robot's map over the true world, where the robot is
//! error = |Eⱼ(q) − Eᵢ(q)|, yaw(Eⱼ) − yaw(Eᵢ)     at the place q of robot j
//! ```
//!
//! It counts over the steps in which both robots explore and say tiles, so that both maps should
//! lie in the team's coordinates: the later robot has *met* the team.
//!
//! Metres, degrees, milliseconds.

use core::f64::consts::{PI, TAU};

use super::super::record::Step;
use super::member::Member;
use crate::report::team::Agreement;

/// Returns the agreement of all pairs; `None` if no robot corrects its pose, or none met another.
pub(super) fn agreement(members: &[Member<'_>]) -> Option<Agreement> {
    let mut errors = Vec::new();
    for (k, second) in members.iter().enumerate() {
        for first in &members[..k] {
            errors.extend(pair(first, second));
        }
    }
    if errors.is_empty() {
        return None;
    }
    let of = |part: fn(&[f64; 2]) -> f64| {
        let mut values: Vec<f64> = errors.iter().map(part).collect();
        values.sort_by(f64::total_cmp);
        [values[values.len() / 2], values[values.len() - 1]]
    };
    let ([median_m, max_m], [median_deg, max_deg]) = (of(|it| it[0]), of(|it| it[1]));
    Some(Agreement {
        median_m,
        max_m,
        median_deg,
        max_deg,
    })
}

/// Returns the errors of a pair of robots, in the steps in which both have met.
fn pair(first: &Member<'_>, second: &Member<'_>) -> Vec<[f64; 2]> {
    let Some(since_ms) = first.met_ms.zip(second.met_ms).map(|(a, b)| a.max(b)) else {
        return Vec::new();
    };
    let mut others = first
        .record
        .steps
        .iter()
        .filter(|step| has_met(step, since_ms))
        .peekable();
    let mut errors = Vec::new();
    for step in second
        .record
        .steps
        .iter()
        .filter(|step| has_met(step, since_ms))
    {
        while others
            .next_if(|other| other.truth.time_ms < step.truth.time_ms)
            .is_some()
        {}
        let beside = others
            .peek()
            .filter(|other| other.truth.time_ms == step.truth.time_ms);
        errors.extend(beside.map(|other| between(other, step)));
    }
    errors
}

fn has_met(step: &Step, since_ms: u32) -> bool {
    step.command.location.is_some() && step.truth.time_ms > since_ms
}

/// Returns the error of the motion between the maps of two robots, where the second one is.
fn between(first: &Step, second: &Step) -> [f64; 2] {
    let turn = |step: &Step| step.estimate.yaw_rad - step.truth.yaw_rad;
    let (sin, cos) = turn(first).sin_cos();
    let [dx, dy] = [
        second.truth.x_m - first.truth.x_m,
        second.truth.y_m - first.truth.y_m,
    ];
    let place = [
        first.estimate.x_m + cos * dx - sin * dy,
        first.estimate.y_m + sin * dx + cos * dy,
    ];
    let off_m = (second.estimate.x_m - place[0]).hypot(second.estimate.y_m - place[1]);
    let yaw = (turn(second) - turn(first) + PI).rem_euclid(TAU) - PI;
    [off_m, yaw.abs().to_degrees()]
}
