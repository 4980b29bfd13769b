//! The drive beside other robots and before a tight gap, and a retreat before a wall.

use super::direct::CREEP_MPS;
use super::*;
use crate::geometry::{Point, Pose};
use crate::robot::RobotShape;

/// Returns the speed of a robot that has a recovery backwards and free ground ahead, with
/// another robot 2 m beside it.
fn speed_mps(peer_may_move: bool) -> f32 {
    let config = Config::pioneer_3at(heapless::Vec::new());
    let mut checker = CollisionChecker::empty(&RobotShape::PIONEER_3AT);
    let beside = Point { x_m: 0.0, y_m: 2.0 };
    checker.keep_off_hull(&Pose::default(), core::iter::once(beside), peer_may_move);
    let mut query = SearchQuery::new(&checker, |_: Place| Some(0.0), None);
    let mut drive = Drive::new();
    for _ in 0..8 {
        drive
            .recovery
            .motions
            .push(motion::BACKWARD)
            .expect("there is room");
    }
    let mut scratch = std::vec![0; SCRATCH_WORDS];
    drive
        .follow(&config, &mut query, Twist::default(), &mut scratch)
        .linear_mps
}

/// Returns the first velocity of a retreat from a place 0.5 m along a straight track, with a
/// wall so far behind the hull, and the drive after it.
fn retreats(behind_m: f32, now: Twist) -> (Twist, Drive) {
    retreats_from(CollisionChecker::see, behind_m, now)
}

/// As [`retreats`], from a thing that a checker is told of.
fn retreats_from(
    tell: impl FnOnce(&mut CollisionChecker, &Pose, &[Point]),
    behind_m: f32,
    now: Twist,
) -> (Twist, Drive) {
    let config = Config::pioneer_3at(heapless::Vec::new());
    let mut drive = Drive::new();
    let at = |x_m: f32| {
        MapPose(Pose {
            x_m,
            ..Pose::default()
        })
    };
    (0..=10).for_each(|k| drive.note_pose(&at(0.05 * k as f32)));
    let pose = at(0.52);
    let wall_m = RobotShape::PIONEER_3AT.half_length_m + behind_m;
    let wall = Point {
        x_m: pose.0.x_m - wall_m,
        y_m: 0.0,
    };
    let mut checker = CollisionChecker::empty(&RobotShape::PIONEER_3AT);
    tell(&mut checker, &pose.0, &[wall]);
    drive.begin_retreat(&checker, true);
    assert!(drive.is_retreating());
    let twist = drive.retreat(&config, &pose, &checker, now);
    (twist, drive)
}

#[test]
fn a_retreat_goes_slower_where_it_could_not_stop_and_ends_where_it_cannot_go() {
    let rest = Twist::default();
    let (free, _) = retreats(1.0, rest);
    assert!(free.linear_mps < 0.0);
    // Room for a part of the way of the faster ones.
    let (slow, drive) = retreats(LEAST_MARGIN_M + 0.009, rest);
    assert!(slow.linear_mps < 0.0, "{slow:?}");
    assert!(slow.linear_mps > free.linear_mps, "{slow:?}");
    assert!(drive.is_retreating());
    let (slowest, drive) = retreats(LEAST_MARGIN_M, rest);
    assert!(slowest.linear_mps < 0.0 && drive.is_retreating());
    assert!(slowest.linear_mps > 0.3 * free.linear_mps, "{slowest:?}");
    let (none, drive) = retreats(0.0, rest);
    assert_eq!(none, rest);
    assert!(!drive.is_retreating());
    let back = Twist {
        linear_mps: -0.15,
        ..rest
    };
    let (none, drive) = retreats(0.0, back);
    assert_eq!(none, rest, "it brakes first");
    assert!(drive.is_retreating());
}

/// Noise does not bring it nearer, as it does a wall.
#[test]
fn a_retreat_keeps_off_a_robot_behind() {
    let tell = |checker: &mut CollisionChecker, pose: &Pose, points: &[Point]| {
        checker.keep_off_hull(pose, points.iter().copied(), false);
    };
    let (twist, drive) = retreats_from(tell, LEAST_MARGIN_M, Twist::default());
    assert_eq!(twist, Twist::default());
    assert!(!drive.is_retreating());
}

#[test]
fn a_recovery_ends_when_a_robot_that_drives_on_has_left_the_way_open() {
    assert!(speed_mps(true) > CREEP_MPS);
    assert!(speed_mps(false) < 0.0, "walls do not leave");
}

/// Returns the speed of a robot that creeps towards a gap so wide, which the field leads through.
fn speed_before_gap(width_m: f32, is_careful: bool) -> f32 {
    let config = Config::pioneer_3at(heapless::Vec::new());
    let places = (0..40).flat_map(|k| {
        [-0.5, 0.5].map(|part| Point {
            x_m: 0.3 + 0.025 * k as f32,
            y_m: part * width_m,
        })
    });
    let points: std::vec::Vec<Point> = places.collect();
    let checker = CollisionChecker::new(&RobotShape::PIONEER_3AT, &Pose::default(), &points);
    let mut query = SearchQuery::new(&checker, |place: Place| Some(-place.yaw_rad), None);
    query.is_careful = is_careful;
    let now = Twist {
        linear_mps: 0.14,
        angular_radps: 0.0,
    };
    let mut scratch = std::vec![0; SCRATCH_WORDS];
    Drive::new()
        .follow(&config, &mut query, now, &mut scratch)
        .linear_mps
}

#[test]
fn a_careful_robot_goes_through_no_gap_that_leaves_it_little_clearance() {
    let width_m = 2.0 * RobotShape::PIONEER_3AT.half_width_m;
    for (room_m, careful, other) in [
        (0.08, false, true),
        (0.12, true, true),
        (0.02, false, false),
    ] {
        let goes = |is_careful| speed_before_gap(width_m + room_m, is_careful) > 0.0;
        assert_eq!((goes(true), goes(false)), (careful, other), "{room_m} m");
    }
}
