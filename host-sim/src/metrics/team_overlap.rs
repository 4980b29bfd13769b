//! Share of a team's path that was driven twice, and by whom.
//!
//! As [`super::Overlap`], over the paths of all robots: a piece of path counts if a robot passed
//! within [`NEAR_M`] of it before. *Again* counts earlier passes by any robot, one's own if they
//! are [`EARLIER_M`] of path earlier. *After another* counts passes by other robots only. Robots
//! that start side by side have no earlier pass of each other then.

use std::collections::BTreeMap;

use super::overlap::{EARLIER_M, NEAR_M};
use crate::robot::distance_m;

/// Length of path between two samples, metres.
const SAMPLE_M: f64 = 0.05;

/// A robot was here.
#[derive(Clone, Copy, Debug)]
struct Pass {
    robot: usize,
    at_m: [f64; 2],
    /// Metres of its path until here.
    along_m: f64,
}

/// The paths so far.
#[derive(Clone, Debug)]
pub struct TeamOverlap {
    buckets: BTreeMap<[i32; 2], Vec<Pass>>,
    /// Of each robot: last place, metres until the last sample, metres since.
    robots: Vec<(Option<[f64; 2]>, f64, f64)>,
    length_m: f64,
    again_m: f64,
    after_another_m: f64,
}

impl TeamOverlap {
    /// No paths of so many robots.
    #[must_use]
    pub fn new(robots: usize) -> Self {
        Self {
            buckets: BTreeMap::new(),
            robots: vec![(None, 0.0, 0.0); robots],
            length_m: 0.0,
            again_m: 0.0,
            after_another_m: 0.0,
        }
    }

    /// Adds a robot's position, metres. Call it in the order of time.
    pub fn add(&mut self, robot: usize, at_m: [f64; 2]) {
        let Some((last, along_m, since_m)) = self.robots.get_mut(robot) else {
            return;
        };
        *since_m += distance_m(last.unwrap_or(at_m), at_m);
        *last = Some(at_m);
        if *since_m < SAMPLE_M {
            return;
        }
        let piece_m = core::mem::take(since_m);
        *along_m += piece_m;
        let pass = Pass {
            robot,
            at_m,
            along_m: *along_m,
        };
        self.length_m += piece_m;
        let (mut again, mut after_another) = (false, false);
        for earlier in self.near(at_m) {
            let is_own = earlier.robot == robot;
            again |= !is_own || pass.along_m - earlier.along_m >= EARLIER_M;
            after_another |= !is_own;
        }
        self.again_m += if again { piece_m } else { 0.0 };
        self.after_another_m += if after_another { piece_m } else { 0.0 };
        self.buckets.entry(bucket(at_m)).or_default().push(pass);
    }

    /// Share of the path that a robot of the team had driven before, 0 to 1.
    #[must_use]
    pub fn again(&self) -> f64 {
        share(self.again_m, self.length_m)
    }

    /// Share of the path that another robot had driven before, 0 to 1.
    #[must_use]
    pub fn after_another(&self) -> f64 {
        share(self.after_another_m, self.length_m)
    }

    fn near(&self, at_m: [f64; 2]) -> impl Iterator<Item = &Pass> {
        let [column, row] = bucket(at_m);
        (row - 1..=row + 1)
            .flat_map(move |row| (column - 1..=column + 1).map(move |column| [column, row]))
            .filter_map(|bucket| self.buckets.get(&bucket))
            .flatten()
            .filter(move |pass| distance_m(pass.at_m, at_m) <= NEAR_M)
    }
}

fn share(part_m: f64, whole_m: f64) -> f64 {
    if whole_m > 0.0 { part_m / whole_m } else { 0.0 }
}

fn bucket(at_m: [f64; 2]) -> [i32; 2] {
    at_m.map(|m| (m / NEAR_M).floor() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drives robots along straight lines, all at the same time, in steps of 1 cm.
    fn drive(lines: &[[[f64; 2]; 2]]) -> (f64, f64) {
        let mut overlap = TeamOverlap::new(lines.len());
        for step in 0..=1_000 {
            let t = f64::from(step) / 1_000.0;
            for (robot, [from, to]) in lines.iter().enumerate() {
                overlap.add(robot, [0, 1].map(|k| from[k] + t * (to[k] - from[k])));
            }
        }
        (overlap.again(), overlap.after_another())
    }

    #[test]
    fn a_robot_alone_overlaps_as_a_run_does_and_with_no_other() {
        let mut overlap = TeamOverlap::new(1);
        let mut single = crate::metrics::Overlap::default();
        for k in 0..4_000 {
            let x = f64::from(if k < 2_000 { k } else { 4_000 - k }) * 0.01;
            overlap.add(0, [x, 0.0]);
            single.add(x, 0.0);
        }
        assert!((overlap.again() - single.fraction()).abs() < 1e-9);
        assert_eq!(overlap.after_another(), 0.0);
    }

    #[test]
    fn robots_that_cross_or_follow_overlap() {
        let lanes = drive(&[[[0.0, 0.0], [10.0, 0.0]], [[0.0, 1.0], [10.0, 1.0]]]);
        assert_eq!(lanes, (0.0, 0.0));
        // They meet in the middle: each drives the second half after the other.
        let head_on = drive(&[[[0.0, 0.0], [10.0, 0.0]], [[10.0, 0.0], [0.0, 0.0]]]);
        assert!(
            (head_on.1 - 0.5).abs() < 0.06 && head_on.0 == head_on.1,
            "{head_on:?}"
        );
    }
}
