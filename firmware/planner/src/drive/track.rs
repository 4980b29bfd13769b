//! The robot's own track: its last poses, along which it can drive back out of a narrow place.
//!
//! Where the hull was there is room for it, whatever the map says. So a robot that is wedged
//! follows its track backwards, up to a place where it can turn.
//!
//! ```text
//! pₙ = pₙ₋₁ ⊕ qₙ      q: the difference of two poses, rounded; in the frame of the older one
//! ```
//!
//! Only the last pose p is kept, and the differences before it. A difference is taken from the
//! rounded pose, so rounding errors do not add up.
//!
//! A straight way is one difference. `frontier`, 12 runs through three tight buildings with noisy
//! and with true odometry, and 25 generated worlds in which runs ended stuck or knew too little:
//!
//! | a straight way is | known: noisy, true, generated % |
//! | --- | --- |
//! | a difference each 5 cm | 98.0, 97.9, 97.8 |
//! | one difference | 98.0, 97.9, 98.3 |
//!
//! Invariant: the older poses are those that were recorded, within 2 mm and 0.3°, but those on a
//! straight way.
//! Units: metres, radians; odometry frame.

use crate::drive::hull::Place;
use crate::geometry::{Pose, RobotFrame, Twist};
use crate::math;

/// Differences that are kept: at least 2.8 m of way, and 28 m of straight way.
const MOST: usize = 56;
/// A pose this far from the last one is recorded, metres; or turned this much, radians. The hull's
/// corners move as far in both.
const STEP_M: f32 = 0.05;
const STEP_RAD: f32 = 0.14;
/// Units of the differences: 4 mm ahead, 1 mm aside, and 0.57°.
const UNITS: [f32; 3] = [4e-3, 1e-3, 1e-2];
/// A way is straight, and one difference, if it leads aside and turns by no more than this, metres
/// and radians.
const STRAIGHT_M: f32 = 0.005;
const STRAIGHT_RAD: f32 = 0.02;
/// Way along the track by which a retreat leaves its place, metres: that of a robot that moved.
const LEAVE_M: f32 = 0.3;
/// A pose this near is reached, metres along the track and radians.
const REACHED_M: f32 = 0.015;
const REACHED_RAD: f32 = 0.04;
/// Turn for a metre of distance from the track, radians.
const BACK_ON_TRACK: f32 = 3.0;
/// Greatest speeds back along the track.
const BACK_MPS: f32 = 0.15;
const BACK_RADPS: f32 = 0.5;

/// The last poses, as a ring of differences.
#[derive(Debug)]
pub(crate) struct Track {
    differences: [[i8; 3]; MOST],
    /// Number of differences, and the place of the next one.
    len: u8,
    next: u8,
    /// Number of differences at which a retreat has left its place.
    left: u8,
    /// The last pose; no robot was seen before the first.
    last: [f32; 3],
    has_last: bool,
}

/// Returns the difference `to` − `from`, in the frame of `from`.
fn difference([x, y, yaw]: [f32; 3], to: [f32; 3]) -> [f32; 3] {
    let (sin, cos) = math::sin_cos(yaw);
    let (dx, dy) = (to[0] - x, to[1] - y);
    [
        dx * cos + dy * sin,
        dy * cos - dx * sin,
        math::wrap(to[2] - yaw),
    ]
}

impl Track {
    /// Returns an empty track.
    pub(crate) const fn new() -> Self {
        Self {
            differences: [[0; 3]; MOST],
            len: 0,
            next: 0,
            left: 0,
            last: [0.0; 3],
            has_last: false,
        }
    }

    /// Forgets all poses.
    pub(crate) const fn clear(&mut self) {
        (self.len, self.has_last) = (0, false);
    }

    /// Records a pose, if the robot moved since the last one. A jump of half a metre, or of an
    /// eighth aside, begins a new track.
    pub(crate) fn record(&mut self, pose: &Pose) {
        let now = [pose.x_m, pose.y_m, pose.yaw_rad];
        let moved = difference(self.last, now);
        let [dx, dy, turn] = moved;
        if self.has_last && dx * dx + dy * dy < STEP_M * STEP_M && turn.abs() < STEP_RAD {
            return;
        }
        let joined = self.straight_to(now);
        if joined.is_some() {
            self.drop_last();
        }
        match joined.or_else(|| rounded(moved)).filter(|_| self.has_last) {
            None => {
                self.clear();
                (self.last, self.has_last) = (now, true);
            }
            Some(units) => {
                if let Some(place) = self.differences.get_mut(usize::from(self.next)) {
                    *place = units;
                }
                self.next = (self.next + 1) % MOST as u8;
                self.len = (self.len + 1).min(MOST as u8);
                let [dx, dy, turn] = metres(units);
                let (sin, cos) = math::sin_cos(self.last[2]);
                self.last[0] += dx * cos - dy * sin;
                self.last[1] += dx * sin + dy * cos;
                self.last[2] = math::wrap(self.last[2] + turn);
            }
        }
    }

    /// Returns the difference from the pose before the last one, if the way from there is straight.
    fn straight_to(&self, now: [f32; 3]) -> Option<[i8; 3]> {
        let way = difference(self.before_last()?, now);
        let [_, aside, turn] = way;
        let is_straight = aside.abs() <= STRAIGHT_M && turn.abs() <= STRAIGHT_RAD;
        rounded(way).filter(|_| is_straight)
    }

    /// Notes where a retreat begins.
    pub(crate) fn begin_retreat(&mut self) {
        let mut far_m = 0.0;
        let mut back = 0;
        while back < self.len && far_m < LEAVE_M {
            back += 1;
            let place = (usize::from(self.next) + MOST - usize::from(back)) % MOST;
            let units = self.differences.get(place).copied().unwrap_or_default();
            let [dx, dy, _] = metres(units);
            far_m += math::sqrt(dx * dx + dy * dy);
        }
        // The pose at the end of the way is reached when it is dropped.
        self.left = (self.len - back).saturating_sub(1);
    }

    /// Returns true if the retreat has left the place where it began: it has followed the track for
    /// [`LEAVE_M`], or to its beginning.
    pub(crate) const fn has_left(&self) -> bool {
        self.len <= self.left
    }

    /// Returns the velocity back along the track for a robot at `pose`, and drops the poses that it
    /// has reached; `None` at the track's beginning.
    pub(crate) fn back(&mut self, pose: &Pose, period_s: f32) -> Option<Twist> {
        loop {
            let place = self.place(pose)?;
            let (sin, cos) = math::sin_cos(0.5 * place.yaw_rad);
            let along = place.x_m * cos + place.y_m * sin;
            let across = place.y_m * cos - place.x_m * sin;
            let along = if along.abs() < REACHED_M { 0.0 } else { along };
            let turn = place.yaw_rad
                + if along == 0.0 {
                    0.0
                } else {
                    BACK_ON_TRACK * across * along.signum()
                };
            if along != 0.0 || turn.abs() >= REACHED_RAD {
                let seconds = (along.abs() / BACK_MPS)
                    .max(turn.abs() / BACK_RADPS)
                    .max(period_s);
                return Some(Twist {
                    linear_mps: along / seconds,
                    angular_radps: turn / seconds,
                });
            }
            self.drop_last();
        }
    }

    /// Returns the last pose, seen from a robot.
    fn place(&self, robot: &Pose) -> Option<Place> {
        let [x_m, y_m, yaw_rad] = self.last;
        let at = RobotFrame::of(robot).to_robot(crate::geometry::Point { x_m, y_m });
        self.has_last.then(|| Place {
            x_m: at.x_m,
            y_m: at.y_m,
            yaw_rad: math::wrap(yaw_rad - robot.yaw_rad),
        })
    }

    /// Returns the pose before the last one.
    fn before_last(&self) -> Option<[f32; 3]> {
        let place = (usize::from(self.next) + MOST - 1) % MOST;
        let units = self.differences.get(place).filter(|_| self.len > 0)?;
        let [dx, dy, turn] = metres(*units);
        let [x, y, yaw] = self.last;
        let yaw = math::wrap(yaw - turn);
        let (sin, cos) = math::sin_cos(yaw);
        Some([x - dx * cos + dy * sin, y - dx * sin - dy * cos, yaw])
    }

    /// Drops the last pose.
    fn drop_last(&mut self) {
        let Some(before) = self.before_last() else {
            self.clear();
            return;
        };
        self.last = before;
        self.len -= 1;
        self.next = self.next.checked_sub(1).unwrap_or(MOST as u8 - 1);
    }
}

/// Returns a difference in its units; `None` if it does not fit.
fn rounded(moved: [f32; 3]) -> Option<[i8; 3]> {
    let mut units = [0; 3];
    for ((unit, moved), size) in units.iter_mut().zip(moved).zip(UNITS) {
        *unit = i8::try_from(math::floor(moved / size + 0.5)).ok()?;
    }
    Some(units)
}

fn metres(units: [i8; 3]) -> [f32; 3] {
    let mut metres = [0.0; 3];
    for ((metre, unit), size) in metres.iter_mut().zip(units).zip(UNITS) {
        *metre = f32::from(unit) * size;
    }
    metres
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    /// Short, so that the recorded poses are dense enough to compare others with.
    const PERIOD_S: f32 = 0.02;

    /// Drives these velocities from the origin, one a period. Returns the poses, the last one last.
    fn driven(twists: impl Iterator<Item = Twist>) -> Vec<Pose> {
        let mut poses = std::vec![Pose::default()];
        for twist in twists {
            poses.push(moved(poses.last().unwrap(), twist));
        }
        poses
    }

    fn moved(pose: &Pose, twist: Twist) -> Pose {
        let (length, turn) = (twist.linear_mps * PERIOD_S, twist.angular_radps * PERIOD_S);
        let (sin, cos) = math::sin_cos(pose.yaw_rad + 0.5 * turn);
        Pose {
            x_m: pose.x_m + length * cos,
            y_m: pose.y_m + length * sin,
            yaw_rad: math::wrap(pose.yaw_rad + turn),
            ..*pose
        }
    }

    /// Curves, a turn on the spot, a piece backwards: fewer poses than a track keeps.
    fn winding() -> Vec<Pose> {
        driven((0..800).map(|k| match k {
            0..250 => Twist {
                linear_mps: 0.3,
                angular_radps: 0.6 * math::sin_cos(0.02 * k as f32).0,
            },
            250..370 => Twist {
                linear_mps: 0.0,
                angular_radps: -0.6,
            },
            370..500 => Twist {
                linear_mps: -0.15,
                angular_radps: 0.2,
            },
            _ => Twist {
                linear_mps: 0.1,
                angular_radps: -0.3,
            },
        }))
    }

    fn distance_m(a: &Pose, b: &Pose) -> f32 {
        a.point().distance_m(b.point())
    }

    #[test]
    fn a_robot_that_goes_back_stays_on_its_track_and_arrives_where_it_began() {
        let poses = winding();
        let mut track = Track::new();
        poses.iter().for_each(|pose| track.record(pose));
        let mut pose = *poses.last().unwrap();
        let mut steps = 0;
        while let Some(twist) = track.back(&pose, PERIOD_S) {
            let most = 1.0 + 1e-6;
            assert!(twist.linear_mps.abs() <= BACK_MPS * most, "{twist:?}");
            assert!(twist.angular_radps.abs() <= BACK_RADPS * most, "{twist:?}");
            pose = moved(&pose, twist);
            steps += 1;
            assert!(steps < 10_000);
            let near = |it: &&Pose| {
                distance_m(it, &pose) < 0.03 && math::wrap(it.yaw_rad - pose.yaw_rad).abs() < 0.1
            };
            assert!(poses.iter().any(|it| near(&it)), "{pose:?}");
        }
        assert!(distance_m(&pose, &poses[0]) < 0.02, "{pose:?}");
    }

    #[test]
    fn a_retreat_leaves_its_place_by_the_way_of_a_robot_that_moved() {
        let forward = Twist {
            linear_mps: 0.3,
            angular_radps: 0.0,
        };
        let turn = Twist {
            linear_mps: 0.0,
            angular_radps: 0.6,
        };
        // The turn on the spot is no way.
        let poses = driven((0..300).map(|k| if k < 200 { forward } else { turn }));
        let mut track = Track::new();
        poses.iter().for_each(|pose| track.record(pose));
        let begin = *poses.last().unwrap();
        track.begin_retreat();
        let mut pose = begin;
        while !track.has_left() {
            let twist = track.back(&pose, PERIOD_S).expect("the track is longer");
            pose = moved(&pose, twist);
        }
        let far_m = distance_m(&begin, &pose);
        // A straight piece is left as a whole.
        assert!((LEAVE_M..LEAVE_M + 0.52).contains(&far_m), "{far_m} m");
        let mut short = Track::new();
        short.record(&begin);
        short.begin_retreat();
        assert!(short.has_left(), "there is no way back");
    }

    #[test]
    fn rounding_errors_do_not_add_up() {
        let poses = winding();
        let mut track = Track::new();
        let mut recorded = Vec::new();
        for pose in &poses {
            let (before, next) = (track.last, track.next);
            track.record(pose);
            if track.last != before {
                if track.next == next {
                    // It is straight on from the pose before, in place of which it is kept.
                    recorded.pop();
                }
                recorded.push(*pose);
            }
        }
        for pose in recorded.iter().rev() {
            let place = track.place(pose).unwrap();
            assert!(
                place.x_m.abs() < 2.1e-3 && place.y_m.abs() < 1e-3,
                "{place:?}"
            );
            assert!(place.yaw_rad.abs() < 6e-3, "{place:?}");
            track.drop_last();
        }
    }

    fn at(x_m: f32, yaw_rad: f32) -> Pose {
        Pose {
            x_m,
            yaw_rad,
            ..Pose::default()
        }
    }

    #[test]
    fn a_jump_begins_a_new_track_and_a_long_one_loses_its_beginning() {
        let mut track = Track::new();
        for k in 0..300 {
            track.record(&at(0.051 * k as f32, 0.1 * (k % 2) as f32));
        }
        assert_eq!(usize::from(track.len), MOST);
        let last = at(40.0, 0.0);
        track.record(&last);
        assert_eq!((track.len, track.last[0]), (0, 40.0));
        assert!(track.back(&last, PERIOD_S).is_none());
    }

    /// A lane as narrow as the robot may be much longer than a track of poses 5 cm apart.
    #[test]
    fn the_whole_of_a_long_straight_way_is_kept() {
        let mut track = Track::new();
        (0..300).for_each(|k| track.record(&at(0.051 * k as f32, 0.004 * (k % 3) as f32)));
        assert!(usize::from(track.len) < MOST);
        while track.len > 0 {
            track.drop_last();
        }
        assert!(track.last[0].abs() < 0.01, "{}", track.last[0]);
    }
}
