//! Ways out of dead ends, corners and boxes made of points.

use crate::drive::CollisionChecker;
use crate::drive::direct::ALIGNED_RAD;
use crate::drive::motion::LENGTH_M;
use crate::drive::recovery::*;
use crate::drive::roll_out::ROLL_M;
use crate::geometry::{Point, Pose};
use crate::math;
use crate::robot::RobotShape;

/// Points of walls given as segments, 2 cm apart.
fn walls(segments: &[[f32; 4]]) -> std::vec::Vec<Point> {
    let mut points = std::vec::Vec::new();
    for &[x0, y0, x1, y1] in segments {
        let n = (((x1 - x0).abs() + (y1 - y0).abs()) / 0.04) as i32 + 1;
        for k in 0..=n {
            let t = k as f32 / n as f32;
            points.push(Point {
                x_m: x0 + (x1 - x0) * t,
                y_m: y0 + (y1 - y0) * t,
            });
        }
    }
    points
}

const BUDGET: SearchBudget = SearchBudget {
    poses: 100,
    points: 2_000,
};

fn search(points: &[Point], pose: Pose, heading: f32) -> Option<(Recovery, CollisionChecker)> {
    let mut scratch = std::vec![0; SCRATCH_WORDS];
    let checker = CollisionChecker::new(&RobotShape::PIONEER_3AT, &pose, points);
    let heading_at = |_: Place| Some(math::wrap(heading - pose.yaw_rad));
    let query = SearchQuery::new(&checker, heading_at, None);
    let mut search = Search::start(0.02, MotionSet::ALL, &mut scratch);
    loop {
        match search.advance(&query, BUDGET, &mut scratch) {
            SearchOutcome::Found(recovery) => return Some((recovery, checker)),
            SearchOutcome::Pending => {}
            SearchOutcome::Nothing => return None,
        }
    }
}

/// Drives a plan as far as it goes; the pose at its end and the periods it took.
fn drive_out(points: &[Point], pose: Pose, heading: f32) -> (Place, usize) {
    let (mut recovery, checker) = search(points, pose, heading).expect("a way out");
    let (mut place, mut periods) = (Place::default(), 0);
    while let Some(twist) = recovery.next(0.2) {
        place = place.after(twist.linear_mps * 0.2, twist.angular_radps * 0.2);
        assert!(checker.is_clear(place, 0.01), "touches at {place:?}");
        periods += 1;
    }
    (place, periods)
}

/// In a dead end too narrow to turn in, with nothing wider within reach, the robot backs out.
#[test]
fn it_backs_out_of_a_dead_end() {
    let dead_end = walls(&[
        [-1.2, 0.32, 0.6, 0.32],
        [-1.2, -0.32, 0.6, -0.32],
        [0.6, 0.32, 0.6, -0.32],
    ]);
    let askew = Pose {
        yaw_rad: 0.1,
        ..Pose::default()
    };
    let (end, _) = drive_out(&dead_end, askew, math::PI);
    assert!(end.yaw_rad.abs() < 0.4 && end.x_m < -0.2, "{end:?}");
}

/// Askew in a doorway of 0.65 m, with the field behind it: it straightens up before it backs out.
#[test]
fn it_straightens_up_in_a_door_before_it_backs_out() {
    let door = walls(&[[-0.3, 0.325, -0.1, 0.325], [-0.3, -0.325, -0.1, -0.325]]);
    for yaw_rad in [-0.2, 0.2] {
        let askew = Pose {
            yaw_rad,
            ..Pose::default()
        };
        let (end, periods) = drive_out(&door, askew, math::PI);
        let yaw = askew.yaw_rad + end.yaw_rad;
        assert!(yaw.abs() < ALIGNED_RAD && end.x_m < -0.15, "{end:?}");
        assert!(
            periods > 2 * (ROLL_M / LENGTH_M) as usize,
            "it only backs out"
        );
    }
}

/// Wedged at a slant in an L of 0.72 m: it gets round the corner.
#[test]
fn it_gets_round_a_tight_corner_from_a_slant() {
    let corner = walls(&[
        [-0.36, -0.36, 1.2, -0.36],
        [-0.36, -0.36, -0.36, 1.2],
        [0.36, 0.36, 1.2, 0.36],
        [0.36, 0.36, 0.36, 1.2],
    ]);
    let slant = Pose {
        yaw_rad: math::PI - 0.3,
        ..Pose::default()
    };
    let (end, _) = drive_out(&corner, slant, math::PI / 2.0);
    let yaw = slant.yaw_rad + end.yaw_rad;
    assert!(math::wrap(yaw - math::PI / 2.0).abs() < 0.25, "{yaw}");
}

#[test]
fn in_the_open_it_just_turns() {
    let (end, periods) = drive_out(&[], Pose::default(), math::PI / 2.0);
    assert!(
        end.x_m.abs() < 0.05 && (end.y_m - ROLL_M).abs() < 0.05,
        "{end:?}"
    );
    assert_eq!(
        periods,
        2 * (11 + 15),
        "82.5° are near enough, and on it goes"
    );
}

#[test]
fn a_box_has_no_way_out() {
    let closed = walls(&[
        [-0.3, -0.3, 0.3, -0.3],
        [-0.3, 0.3, 0.3, 0.3],
        [-0.3, -0.3, -0.3, 0.3],
        [0.3, -0.3, 0.3, 0.3],
    ]);
    assert!(search(&closed, Pose::default(), 0.0).is_none());
}
