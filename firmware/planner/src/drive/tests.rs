//! The drive beside other robots, and a retreat before a wall.

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
    let config = Config::pioneer_3at(heapless::Vec::new());
    let mut drive = Drive::new();
    let at = |x_m: f32| {
        OdomPose(Pose {
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
    let checker = CollisionChecker::new(&RobotShape::PIONEER_3AT, &pose.0, &[wall]);
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
    let (none, drive) = retreats(LEAST_MARGIN_M, rest);
    assert_eq!(none, rest);
    assert!(!drive.is_retreating());
    let back = Twist {
        linear_mps: -0.15,
        ..rest
    };
    let (none, drive) = retreats(LEAST_MARGIN_M, back);
    assert_eq!(none, rest, "it brakes first");
    assert!(drive.is_retreating());
}

#[test]
fn a_recovery_ends_when_a_robot_that_drives_on_has_left_the_way_open() {
    assert!(speed_mps(true) > CREEP_MPS);
    assert!(speed_mps(false) < 0.0, "walls do not leave");
}
