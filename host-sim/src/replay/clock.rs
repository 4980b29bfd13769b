//! The offset between the clocks of relations and log.
//!
//! A relation over a short time is a motion that the log's own odometry has seen too. So relations
//! belong to a log if, at some offset, both tell the same motions:
//!
//! ```text
//! misfit(offset) = Σ error of the log's odometry / Σ length of the relations
//! ```
//!
//! Units: metres, seconds.

use super::relations::{Pose, Relation};

/// Longest relation that odometry can judge, seconds.
const SHORT_S: f64 = 5.0;
/// Greatest misfit of relations that belong to a log. Odometry of 11 % is bad odometry.
const FITS: f64 = 0.35;
/// Least share of the relations whose times the log has.
const LEAST_SHARE: f64 = 0.5;
/// Relations that a search looks at.
const SAMPLE: usize = 200;
/// Steps of the search, seconds: coarse and fine.
const STEPS_S: [f64; 2] = [0.1, 0.001];

/// Returns by how much the relations' clock is ahead of the log's, in seconds; 0 if they fit so.
/// `None` if they are not of this log.
#[must_use]
pub fn offset(relations: &[Relation], poses: &[(f64, Pose)]) -> Option<f64> {
    let short = relations
        .iter()
        .filter(|it| (it.to - it.from).abs() < SHORT_S);
    let short: Vec<Relation> = short.copied().collect();
    let sample = short.iter().step_by(short.len().div_ceil(SAMPLE).max(1));
    let sample: Vec<Relation> = sample.copied().collect();
    let fits = |offset: f64| misfit(&short, poses, offset).is_some_and(|it| it < FITS);
    if fits(0.0) {
        return Some(0.0);
    }
    let (began, ended) = (poses.first()?.0, poses.last()?.0);
    let least = short.iter().map(|it| it.from).reduce(f64::min)? - ended;
    let most = short.iter().map(|it| it.to).reduce(f64::max)? - began;
    let coarse = best(&sample, poses, (least, most), STEPS_S[0])?;
    let around = (coarse - STEPS_S[0], coarse + STEPS_S[0]);
    let fine = best(&sample, poses, around, STEPS_S[1])?;
    fits(fine).then_some(fine)
}

fn best(
    relations: &[Relation],
    poses: &[(f64, Pose)],
    (least, most): (f64, f64),
    step: f64,
) -> Option<f64> {
    let steps = ((most - least) / step).ceil().max(0.0) as u32;
    let offsets = (0..=steps).map(|k| least + step * f64::from(k));
    let judged = offsets.filter_map(|at| Some((misfit(relations, poses, at)?, at)));
    judged.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at)| at)
}

/// Returns the misfit; `None` if the log has too few of the relations' times.
fn misfit(relations: &[Relation], poses: &[(f64, Pose)], offset: f64) -> Option<f64> {
    let (mut error, mut length, mut used) = (0.0, 0.0, 0_u32);
    for relation in relations {
        if let Some(found) = relation.shifted(offset).error(poses) {
            error += found.translation_m;
            length += relation.delta[0].hypot(relation.delta[1]);
            used += 1;
        }
    }
    let enough = f64::from(used) >= LEAST_SHARE * relations.len() as f64 && used > 0;
    (enough && length > 0.0).then(|| error / length)
}

#[cfg(test)]
mod tests {
    use super::super::relations::{compose, inverse, pose_at};
    use super::*;

    /// A robot that speeds up, slows down and turns at times that do not repeat.
    fn poses() -> Vec<(f64, Pose)> {
        let mut pose = [0.0; 3];
        let step = |k: u32| {
            let t = 0.2 * f64::from(k);
            let speed = 0.3 + 0.3 * (t * t * 0.01).sin();
            pose = compose(pose, [0.2 * speed, 0.0, 0.1 * (t * 0.37).sin()]);
            (t, pose)
        };
        (0..500).map(step).collect()
    }

    fn relations(ahead: f64) -> Vec<Relation> {
        let poses = poses();
        let at = |t: f64| pose_at(&poses, t, 0.0).unwrap();
        let relation = |k: u32| {
            let t = 3.0 + 0.9 * f64::from(k);
            Relation {
                from: t + ahead,
                to: t + 0.9 + ahead,
                delta: compose(inverse(at(t)), at(t + 0.9)),
            }
        };
        (0..100).map(relation).collect()
    }

    #[test]
    fn the_offset_is_found() {
        assert_eq!(offset(&relations(0.0), &poses()), Some(0.0));
        let found = offset(&relations(1211.353), &poses()).unwrap();
        assert!((found - 1211.353).abs() < 0.01, "{found}");
    }

    #[test]
    fn relations_of_another_log_have_none() {
        let other = relations(0.0).into_iter().map(|relation| Relation {
            delta: [-0.1, relation.from.sin(), 1.0],
            ..relation
        });
        assert_eq!(offset(&other.collect::<Vec<_>>(), &poses()), None);
        assert_eq!(offset(&[], &poses()), None);
    }
}
