//! Cells, frames and motions of poses.

use super::{CELL_M, Cell, MapFromOdom, MapPose, OdomPose, Point, Pose};
use crate::math;

#[test]
fn the_motion_between_two_poses_takes_one_to_the_other() {
    let at = |x_m, y_m, yaw_rad| Pose {
        x_m,
        y_m,
        yaw_rad,
        ..Pose::default()
    };
    let odom = OdomPose(Pose {
        z_m: 0.5,
        ..at(12.0, -7.0, 3.0)
    });
    let map = MapPose(at(10.0, -9.0, -2.5));
    let found = MapFromOdom::between(&odom, &map).apply(&odom).0;
    assert!(found.point().distance_m(map.0.point()) < 1e-5, "{found:?}");
    assert!((found.yaw_rad + 2.5).abs() < 1e-5 && found.z_m == 0.5);
    let same = MapFromOdom::default().apply(&odom).0;
    assert_eq!(same, odom.0);
}

#[test]
fn motions_are_chained_and_undone() {
    let motion = |x_m, y_m, yaw_rad| MapFromOdom { x_m, y_m, yaw_rad };
    let (first, second) = (motion(3.0, -1.0, 0.5), motion(-7.0, 2.0, -2.9));
    let place = Point {
        x_m: 12.0,
        y_m: -20.0,
    };
    let chained = second.after(&first).point(place);
    let expected = second.point(first.point(place));
    assert!(chained.distance_m(expected) < 1e-4, "{chained:?}");
    let back = first.inverse().point(first.point(place));
    assert!(back.distance_m(place) < 1e-4, "{back:?}");
}

#[test]
fn the_two_frames_are_inverse() {
    let pose = Pose {
        x_m: 1.0,
        y_m: -2.0,
        yaw_rad: math::PI / 2.0,
        ..Pose::default()
    };
    let ahead = Point { x_m: 3.0, y_m: 1.0 };
    let map = pose.to_map(ahead);
    assert!(
        map.distance2(Point { x_m: 0.0, y_m: 1.0 }) < 1e-10,
        "{map:?}"
    );
    assert!(pose.to_robot(map).distance2(ahead) < 1e-10);
}

#[test]
fn distances_of_cells_are_those_of_their_centres() {
    let (a, b) = (Cell { x: 1, y: 5 }, Cell { x: -2, y: 9 });
    assert!((a.distance_m(b) - 5.0 * CELL_M).abs() < 1e-6);
    assert!((a.distance2(b) - a.centre().distance2(b.centre())).abs() < 1e-6);
}
