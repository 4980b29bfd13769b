//! Errors of a trajectory against known relations between its poses (Kümmerle et al. 2009).
//!
//! The error of a relation is `inverse(true delta) ∘ estimated delta`, where the estimated delta
//! is `inverse(pose at its first time) ∘ pose at its second`. Its translation and its rotation
//! are judged apart, as absolute values: mean, standard deviation, maximum.

use serde::Serialize;

use crate::robot::wrap;

/// x, y in metres, heading in radians.
pub type Pose = [f64; 3];

/// The true motion from the pose at time `from` to the pose at time `to`, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relation {
    /// Time of the first pose, in seconds.
    pub from: f64,
    /// Time of the second pose, in seconds.
    pub to: f64,
    /// True motion in the frame of the first pose.
    pub delta: Pose,
}

impl Relation {
    /// Returns the relation with earlier times.
    #[must_use]
    pub fn shifted(self, offset: f64) -> Self {
        Self {
            from: self.from - offset,
            to: self.to - offset,
            ..self
        }
    }

    /// Returns the error by these poses; `None` if one of its times has no pose.
    #[must_use]
    pub fn error(&self, poses: &[(f64, Pose)]) -> Option<RelationError> {
        let at = |time| pose_at(poses, time, GAP_S);
        Some(error(self.delta, at(self.from)?, at(self.to)?))
    }
}

/// Greatest time between the end of a trajectory and a relation that its last pose still answers,
/// seconds.
const GAP_S: f64 = 0.5;

/// Absolute errors of one relation: metres and degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelationError {
    /// Metres.
    pub translation_m: f64,
    /// Degrees.
    pub rotation_deg: f64,
}

/// Mean, standard deviation of the whole set, and maximum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation, divided by n.
    pub sd: f64,
    /// Greatest value.
    pub max: f64,
}

/// Returns `a ∘ b`.
#[must_use]
pub fn compose(a: Pose, b: Pose) -> Pose {
    let (sin, cos) = a[2].sin_cos();
    [
        a[0] + cos * b[0] - sin * b[1],
        a[1] + sin * b[0] + cos * b[1],
        a[2] + b[2],
    ]
}

/// Returns the inverse motion.
#[must_use]
pub fn inverse(a: Pose) -> Pose {
    let (sin, cos) = a[2].sin_cos();
    [-cos * a[0] - sin * a[1], sin * a[0] - cos * a[1], -a[2]]
}

/// Returns the relations whose times the poses have, with their errors.
#[must_use]
pub fn errors(relations: &[Relation], poses: &[(f64, Pose)]) -> Vec<(Relation, RelationError)> {
    let judged = relations.iter().map(|it| Some((*it, it.error(poses)?)));
    judged.flatten().collect()
}

/// Error of one relation whose two poses were estimated.
#[must_use]
pub fn error(truth: Pose, from: Pose, to: Pose) -> RelationError {
    let rest = compose(inverse(truth), compose(inverse(from), to));
    RelationError {
        translation_m: rest[0].hypot(rest[1]),
        rotation_deg: wrap(rest[2]).abs().to_degrees(),
    }
}

/// Spread of absolute values, `None` of an empty set.
#[must_use]
pub fn spread(values: &[f64]) -> Option<Spread> {
    let n = values.len() as f64;
    let max = values.iter().copied().reduce(f64::max)?;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / n;
    Some(Spread {
        mean,
        sd: variance.sqrt(),
        max,
    })
}

/// The pose at a time, linear between the two poses around it. `poses` ascend in time.
///
/// Before the first and after the last pose these hold, at most `gap` seconds away.
#[must_use]
pub fn pose_at(poses: &[(f64, Pose)], time: f64, gap: f64) -> Option<Pose> {
    let after = poses.partition_point(|pose| pose.0 < time);
    let last = poses.get(after.checked_sub(1).unwrap_or(after))?;
    let next = poses.get(after).unwrap_or(last);
    if time < last.0 - gap || time > next.0 + gap {
        return None;
    }
    let span = next.0 - last.0;
    let part = if span > 0.0 {
        (time - last.0) / span
    } else {
        0.0
    };
    let turn = wrap(next.1[2] - last.1[2]);
    let between = |axis: usize| last.1[axis] + part * (next.1[axis] - last.1[axis]);
    Some([between(0), between(1), last.1[2] + part * turn])
}

/// Reads `t1 t2 x y z roll pitch yaw` lines.
///
/// # Errors
/// The file, the line and the remedy.
pub fn read(file: &str, text: &str) -> Result<Vec<Relation>, String> {
    let mut found = Vec::new();
    for (index, line) in text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty())
    {
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        match numbers.as_deref() {
            Ok(&[from, to, x, y, _, _, _, yaw])
                if [from, to, x, y, yaw]
                    .iter()
                    .all(|number| number.is_finite()) =>
            {
                let delta = [x, y, yaw];
                found.push(Relation { from, to, delta });
            }
            _ => {
                let at = index + 1;
                return Err(format!(
                    "{file}:{at}: a relation is eight finite numbers; mend it"
                ));
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn a_hand_made_graph_has_the_errors_of_the_equations() {
        // Drawn: 1 m ahead, quarter turn left, then 2 m ahead. Estimated: 2.3 m, and 10° too far.
        let graph = [(0.0, [5.0, 5.0, 0.0]), (1.0, [6.0, 5.0, FRAC_PI_2])];
        let end = [6.0, 7.3, FRAC_PI_2 + 10_f64.to_radians()];
        let first = error([1.0, 0.0, FRAC_PI_2], graph[0].1, graph[1].1);
        let second = error([2.0, 0.0, 0.0], graph[1].1, end);
        assert!(first.translation_m < 1e-12 && first.rotation_deg < 1e-9);
        assert!((second.translation_m - 0.3).abs() < 1e-12);
        assert!((second.rotation_deg - 10.0).abs() < 1e-9);
        let all = spread(&[first.translation_m, second.translation_m]).unwrap();
        assert!((all.mean - 0.15).abs() < 1e-12 && (all.sd - 0.15).abs() < 1e-12);
        assert!((all.max - 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_turn_past_half_a_circle_is_the_short_way() {
        let short = error([0.0, 0.0, PI - 0.01], [0.0; 3], [0.0, 0.0, -PI + 0.01]);
        assert!((short.rotation_deg - 0.02_f64.to_degrees()).abs() < 1e-9);
    }

    #[test]
    fn times_outside_the_log_have_no_pose() {
        let poses = [(0.0, [1.0; 3]), (1.0, [2.0; 3])];
        assert_eq!(pose_at(&poses, 0.5, 0.1), Some([1.5; 3]));
        assert_eq!(pose_at(&poses, 1.1, 0.5), Some([2.0; 3]));
        assert_eq!(pose_at(&poses, -0.1, 0.5), Some([1.0; 3]));
        assert_eq!(pose_at(&poses, 9.0, 0.5), None);
        assert_eq!(pose_at(&[], 0.0, 0.5), None);
    }

    #[test]
    fn a_broken_relation_names_file_and_line() {
        let good = "10 11 1 2 0 0 0 0.5\n";
        assert_eq!(read("r", good).unwrap()[0].shifted(9.0).from, 1.0);
        assert!(
            read("r", &format!("{good}1 2 NaN 0 0 0 0 0"))
                .unwrap_err()
                .starts_with("r:2:")
        );
    }
}
