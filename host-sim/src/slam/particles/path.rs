//! A particle filter over a recorded log: the path of the particle that is the best in the end.
//!
//! ```text
//! update k     pose of every particle, and the place of its parent before the comb
//! the best one at the end ─► its parent ─► … ─► a pose at each update
//! pose of a scan = pose at the last update ∘ odometry since then
//! ```
//!
//! The end judges the past: a particle that closed a loop well has the path that led there.
//!
//! Units: metres, radians.

use fieldline_protocol::message::{Laser, Observation};

use super::beside::{between, is_far};
use super::filter::Filter;
use super::scan::Scan;
use super::spec::ParticleSpec;
use crate::replay::relations::{Pose, compose};
use crate::robot::OdometryNoise;

/// Margin of the maps around what odometry passed, metres: a laser's range, and what odometry errs.
const MARGIN_M: f64 = 40.0;

/// The particles at an update.
#[derive(Debug)]
struct Generation {
    poses: Vec<Pose>,
    /// Of each particle the place of its parent; `None` if each is its own.
    parents: Option<Vec<usize>>,
}

/// Returns the pose at each observation on the path of the particle that is the best in the end.
/// It begins at the first odometry. `wheels` is the noise that the filter assumes.
#[must_use]
pub fn path(
    spec: &ParticleSpec,
    (laser, wheels): (&Laser, OdometryNoise),
    observations: &[Observation],
    seed: u64,
) -> Vec<Pose> {
    let odometry: Vec<Pose> = observations.iter().map(odometry).collect();
    let Some(&start) = odometry.first() else {
        return Vec::new();
    };
    let how = (spec.count, spec.proposal);
    let mut filter = Filter::new(how, wheels, (start, bounds_m(&odometry)), seed);
    let mut generations: Vec<Generation> = Vec::new();
    // Of each scan the number of updates before it, and the motion since the last one.
    let mut places = Vec::new();
    let (mut last, mut since) = (start, [0.0; 3]);
    for (observation, odometry) in observations.iter().zip(odometry) {
        since = compose(since, between(last, odometry));
        last = odometry;
        if let Some(level) = observation.scans.first()
            && (generations.is_empty() || is_far(since))
        {
            let parents = filter.update(since, &Scan::of(laser, &level.ranges_mm));
            since = [0.0; 3];
            generations.push(Generation {
                poses: filter.poses(),
                parents,
            });
        }
        places.push((generations.len(), since));
    }
    let poses = traced(&generations, filter.best());
    let pose = |(updates, since): (usize, Pose)| {
        let from = updates.checked_sub(1).and_then(|last| poses.get(last));
        compose(from.copied().unwrap_or(start), since)
    };
    places.into_iter().map(pose).collect()
}

fn odometry(observation: &Observation) -> Pose {
    let pose = &observation.pose;
    [pose.x, pose.y, pose.yaw].map(|it| it.to_num())
}

/// Returns the rectangle of the maps: least x, least y, greatest x, greatest y.
fn bounds_m(odometry: &[Pose]) -> [f64; 4] {
    let all = |axis: usize| odometry.iter().map(move |pose| pose[axis]);
    let least = |axis| all(axis).fold(f64::MAX, f64::min) - MARGIN_M;
    let most = |axis| all(axis).fold(f64::MIN, f64::max) + MARGIN_M;
    [least(0), least(1), most(0), most(1)]
}

/// Returns the pose at each update of the particle that ends at a place.
fn traced(generations: &[Generation], end: usize) -> Vec<Pose> {
    let mut place = end;
    let back = generations.iter().rev().map(|generation| {
        let pose = generation.poses[place];
        if let Some(parents) = &generation.parents {
            place = parents[place];
        }
        pose
    });
    let mut poses: Vec<Pose> = back.collect();
    poses.reverse();
    poses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_goes_back_over_parents() {
        let generation = |poses: [f64; 3], parents: Option<[usize; 3]>| Generation {
            poses: poses.map(|x| [x, 0.0, 0.0]).to_vec(),
            parents: parents.map(|it| it.to_vec()),
        };
        let generations = [
            generation([0.0, 0.1, 0.2], None),
            generation([1.2, 1.2, 1.0], Some([2, 2, 0])),
            generation([2.0, 2.1, 2.2], None),
        ];
        let xs = |end| traced(&generations, end).into_iter().map(|pose| pose[0]);
        assert!(xs(1).eq([0.2, 1.2, 2.1]));
        assert!(xs(2).eq([0.0, 1.0, 2.2]));
    }
}
