//! Lane: the straight way through a gap that is hardly wider than the hull.
//!
//! In such a gap the robot has to be aligned before it enters. The field leads to the gap from
//! aside and bends into it too late. A lane is a straight strip ahead without obstacle points, as
//! wide as the hull. A robot that follows one is drawn to its middle line first:
//!
//! ```text
//! u, v: metres along the lane and to its left
//! clearance = min |v of a point, 0 ≤ u ≤ 0.8 m, − v of the middle line| − half the hull's width
//! lane      = the one of the greatest clearance, up to 5 cm, less 2 cm/rad · |turn from the
//!             field| and less a fiftieth of the distance of its middle line
//! heading   = the lane's − 4/m · v
//! ```
//!
//! Where the field's own heading has more than 10 cm of clearance, there is none. Measured:
//! docs/MEASURED.md, "Lanes through gaps".
//!
//! Units: metres, radians; robot frame.

use crate::drive::collision::CollisionChecker;
use crate::drive::hull::Place;
use crate::geometry::Point;
use crate::math;

/// Length of a lane from the robot's centre, metres: its front reaches a gap's far side.
const LENGTH_M: f32 = 0.8;
/// Directions to each side of the field's, and the angle between two, radians.
const TURNS: i32 = 24;
const TURN_RAD: f32 = 0.025;
/// Middle lines to each side of the robot's centre, bins.
const OFFSETS: i32 = 15;
/// Width of a bin across a lane, metres, and the number of bins to each side.
const BIN_M: f32 = 0.01;
const BINS: i32 = 64;
/// Clearance above which no lane is needed, metres.
const WIDE_M: f32 = 0.1;
/// Clearance that is enough, metres.
const ENOUGH_M: f32 = 0.05;
/// Loss of clearance that a radian aside, and a metre aside, are worth: m/rad, m/m.
const TURN_COST: f32 = 0.02;
const OFFSET_COST: f32 = 0.02;
/// Turn for a metre of distance from the middle line, and the greatest one, radians.
const PURSUIT: f32 = 4.0;
const MOST_PURSUIT_RAD: f32 = 0.6;

/// A lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lane {
    yaw_rad: f32,
    /// Distance of its middle line from the robot's centre, to the left.
    across_m: f32,
}

impl Lane {
    /// Returns the best lane about the field's heading; `None` if there is room without one, or
    /// none with this clearance.
    #[inline(never)]
    pub(super) fn find(checker: &CollisionChecker, heading: f32, least_m: f32) -> Option<Self> {
        if clearance_m(checker, occupied(checker, heading), 0) > WIDE_M {
            return None;
        }
        let mut best: Option<(f32, Self)> = None;
        for turn in -TURNS..=TURNS {
            let turn_rad = turn as f32 * TURN_RAD;
            let yaw_rad = heading + turn_rad;
            let bins = occupied(checker, yaw_rad);
            for offset in -OFFSETS..=OFFSETS {
                let clearance_m = clearance_m(checker, bins, offset);
                let across_m = offset as f32 * BIN_M;
                let worth_m = clearance_m.min(ENOUGH_M)
                    - TURN_COST * turn_rad.abs()
                    - OFFSET_COST * across_m.abs();
                if clearance_m >= least_m && best.is_none_or(|(most_m, _)| worth_m > most_m) {
                    best = Some((worth_m, Self { yaw_rad, across_m }));
                }
            }
        }
        best.map(|(_, lane)| lane)
    }

    /// Returns the heading of a robot at a place that follows the lane; `None` beyond its end.
    pub(super) fn heading_at(&self, place: Place) -> Option<f32> {
        let (sin, cos) = math::sin_cos(self.yaw_rad);
        let along_m = place.x_m * cos + place.y_m * sin;
        let left_m = place.y_m * cos - place.x_m * sin - self.across_m;
        let back = (PURSUIT * left_m).clamp(-MOST_PURSUIT_RAD, MOST_PURSUIT_RAD);
        (along_m < LENGTH_M).then(|| math::wrap(self.yaw_rad - back))
    }
}

/// Returns the bins across a strip in a direction that have an obstacle point; bit [`BINS`] begins
/// at the robot's centre. It is called from two places, so it is not inlined.
#[inline(never)]
fn occupied(checker: &CollisionChecker, yaw_rad: f32) -> u128 {
    let (sin, cos) = math::sin_cos(yaw_rad);
    let bin = |Point { x_m, y_m }| {
        let (along_m, left_m) = (x_m * cos + y_m * sin, y_m * cos - x_m * sin);
        let bin = BINS + math::floor(left_m / BIN_M);
        let is_beside = (0.0..LENGTH_M).contains(&along_m) && (0..2 * BINS).contains(&bin);
        if is_beside { 1 << bin } else { 0 }
    };
    checker
        .places_of_points()
        .map(bin)
        .fold(0, |bins, bit| bins | bit)
}

/// Returns the distance of the hull's sides from the nearest point, on the middle line so many bins
/// to the left of the robot's centre.
fn clearance_m(checker: &CollisionChecker, bins: u128, offset: i32) -> f32 {
    let middle = (BINS + offset) as u32;
    let left = (bins >> middle).trailing_zeros();
    let right = (bins << (2 * BINS as u32 - middle)).leading_zeros();
    left.min(right) as f32 * BIN_M - checker.half_width_m()
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::config::Config;
    use crate::drive::{Drive, SCRATCH_WORDS, SearchQuery};
    use crate::geometry::{MapPose, Pose, RobotFrame, Twist};
    use crate::robot::RobotShape;

    const PERIOD_S: f32 = 0.2;

    /// Points every 2 cm on a wall of 10 cm along y, from x = 0, with a gap about y = 0.
    fn gate(width_m: f32) -> Vec<Point> {
        let faces = (0..50).flat_map(|k| {
            let y_m = 0.5 * width_m + 0.02 * k as f32;
            [(0.0, y_m), (0.0, -y_m), (0.1, y_m), (0.1, -y_m)]
        });
        let jambs = (1..5).flat_map(|k| [0.5, -0.5].map(|side| (0.02 * k as f32, side * width_m)));
        let points = faces.chain(jambs);
        points.map(|(x_m, y_m)| Point { x_m, y_m }).collect()
    }

    fn checker(width_m: f32, pose: &Pose) -> CollisionChecker {
        CollisionChecker::new(&RobotShape::PIONEER_3AT, pose, &gate(width_m))
    }

    /// Returns the velocity after a period in which the robot was told another one.
    fn next(config: &Config, now: Twist, told: Twist) -> Twist {
        let towards = crate::drive::collision::towards;
        let (linear, angular) = (config.linear_accel_mps2, config.angular_accel_radps2);
        Twist {
            linear_mps: towards(now.linear_mps, told.linear_mps, linear * PERIOD_S),
            angular_radps: towards(now.angular_radps, told.angular_radps, angular * PERIOD_S),
        }
    }

    /// Drives through a gate, along a field that leads into its middle. Returns the periods it
    /// took; `None` after 80 s.
    fn periods_through(width_m: f32, from: Pose) -> Option<u32> {
        let config = Config::pioneer_3at(heapless::Vec::new());
        let (mut drive, mut pose, mut now) = (Drive::new(), from, Twist::default());
        let mut scratch = std::vec![0; SCRATCH_WORDS];
        for period in 0..400 {
            let checker = checker(width_m, &pose);
            let at = |place: Place| RobotFrame::of(&pose).to_map(place.point());
            let heading_at = |place: Place| {
                let at = at(place);
                let field = math::atan2(-at.y_m, (0.15 - at.x_m).max(0.1));
                Some(math::wrap(field - pose.yaw_rad))
            };
            // In a passage as wide as the robot, q doubles in about 0.1 m.
            let potential_at = |place: Place| math::powf(2.0, 8.0 * at(place).x_m);
            let mut query = SearchQuery::new(&checker, heading_at, Some(&potential_at));
            drive.note_pose(&MapPose(pose));
            let told = if drive.is_retreating() {
                let told = drive.retreat(&config, &MapPose(pose), &checker, now);
                drive.end_retreat(&checker, true);
                told
            } else {
                drive.follow(&config, &mut query, now, &mut scratch)
            };
            now = next(&config, now, told);
            let place = Place {
                x_m: pose.x_m,
                y_m: pose.y_m,
                yaw_rad: pose.yaw_rad,
            };
            let place = place.after(now.linear_mps * PERIOD_S, now.angular_radps * PERIOD_S);
            (pose.x_m, pose.y_m, pose.yaw_rad) = (place.x_m, place.y_m, place.yaw_rad);
            if pose.x_m > 0.45 {
                return Some(period);
            }
        }
        None
    }

    #[test]
    fn a_gap_of_57_cm_is_passed_from_everywhere_before_it() {
        let mut periods = Vec::new();
        for (x_m, k) in [-0.3, -0.5]
            .into_iter()
            .flat_map(|x| (0..35).map(move |k| (x, k)))
        {
            let pose = Pose {
                x_m,
                y_m: 0.1 * (k % 5 - 2) as f32,
                yaw_rad: 0.3 * (k / 5 - 3) as f32,
                ..Pose::default()
            };
            if checker(0.57, &pose).clearance_m() > 0.02 {
                let passed = periods_through(0.57, pose);
                periods.push(passed.unwrap_or_else(|| panic!("stays before the gap: {pose:?}")));
            }
        }
        let mean = periods.iter().sum::<u32>() as f32 / periods.len() as f32;
        assert!(
            periods.len() > 50 && mean < 85.0,
            "{mean} of {}",
            periods.len()
        );
    }

    #[test]
    fn a_lane_leads_to_the_middle_of_the_gap() {
        let pose = Pose {
            x_m: -0.45,
            y_m: 0.08,
            yaw_rad: -0.2,
            ..Pose::default()
        };
        let lane = Lane::find(&checker(0.56, &pose), 0.0, 0.012).expect("a lane");
        let in_gap = RobotFrame::of(&pose).to_robot(Point {
            x_m: 0.05,
            y_m: 0.0,
        });
        let (sin, cos) = math::sin_cos(lane.yaw_rad);
        let left_m = in_gap.y_m * cos - in_gap.x_m * sin - lane.across_m;
        assert!(left_m.abs() < 0.02, "{left_m} m beside {lane:?}");
        let at_robot = lane
            .heading_at(Place::default())
            .expect("the lane begins here");
        assert!(at_robot.is_finite() && (at_robot - lane.yaw_rad) * lane.across_m > 0.0);
    }

    #[test]
    fn there_is_no_lane_where_there_is_room_or_none() {
        let pose = Pose {
            x_m: -0.45,
            ..Pose::default()
        };
        assert!(Lane::find(&checker(0.75, &pose), 0.0, 0.012).is_none());
        assert!(Lane::find(&checker(0.50, &pose), 0.0, 0.012).is_none());
        assert!(Lane::find(&CollisionChecker::empty(&RobotShape::PIONEER_3AT), 0.0, 0.0).is_none());
    }
}
