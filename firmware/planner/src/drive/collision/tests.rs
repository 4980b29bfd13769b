//! Motions that touch, and motions that do not.

use super::*;

const ROBOT: RobotShape = RobotShape::PIONEER_3AT;

fn config() -> Config {
    Config::pioneer_3at(Vec::new())
}

fn wall_ahead(distance_m: f32) -> CollisionChecker {
    let points: std::vec::Vec<Point> = (-10..=10)
        .map(|k| Point {
            x_m: distance_m,
            y_m: k as f32 * 0.05,
        })
        .collect();
    CollisionChecker::new(&ROBOT, &Pose::default(), &points)
}

#[test]
fn a_wall_is_admitted_only_beyond_the_braking_distance() {
    let full = Twist {
        linear_mps: 0.7,
        angular_radps: 0.0,
    };
    // 0.14 m in the period and 0.7²/(2·0.3) = 0.82 m of braking.
    let needs = ROBOT.half_length_m + 0.14 + 0.82 + 0.06;
    assert!(wall_ahead(needs + 0.03).admits(full, full, &config(), 0.06));
    assert!(!wall_ahead(needs - 0.03).admits(full, full, &config(), 0.06));
}

#[test]
fn a_turn_on_the_spot_needs_the_diagonal() {
    let turn = |distance| wall_ahead(distance).is_arc_clear(Place::default(), 0.0, math::PI, 0.0);
    assert!(turn(0.36));
    assert!(!turn(0.34));
}

#[test]
fn a_point_too_near_may_be_left_but_not_approached() {
    let near = wall_ahead(ROBOT.half_length_m + 0.01);
    assert!(near.is_arc_clear(Place::default(), -0.1, 0.0, 0.05));
    assert!(!near.is_arc_clear(Place::default(), 0.1, 0.0, 0.05));
}

/// A wall 0.1 m behind the hull: obstacle points in its left half, map cells in all of it,
/// which begin half a cell earlier.
#[test]
fn map_cells_behind_the_robot_stop_it_where_there_is_no_point() {
    let back = -ROBOT.half_length_m - 0.1;
    let wall = |y: i32| Point {
        x_m: back,
        y_m: 0.1 * y as f32,
    };
    let half: std::vec::Vec<Point> = (1..4).map(wall).collect();
    let mut checker = CollisionChecker::new(&ROBOT, &Pose::default(), &half);
    checker.remember(&Pose::default(), (-3..4).map(wall));
    assert_eq!(checker.points(), 3 + 4, "cells with a point are left out");
    assert!(checker.is_arc_clear(Place::default(), -0.04, 0.0, 0.0));
    assert!(!checker.is_arc_clear(Place::default(), -0.08, 0.0, 0.0));
    let mut right = CollisionChecker::empty(&ROBOT);
    right.remember(&Pose::default(), (-3..0).map(wall));
    assert!(!right.is_arc_clear(Place::default(), -0.08, 0.0, 0.0));
}

/// Map cells ahead are in view of the laser; a cell under the robot is no obstacle.
#[test]
fn cells_in_view_or_under_the_robot_are_not_remembered() {
    let mut checker = CollisionChecker::empty(&ROBOT);
    let at = |x_m, y_m| Point { x_m, y_m };
    let cells = [at(0.4, 0.0), at(0.15, 0.3), at(0.0, 0.2), at(-0.2, 0.0)];
    checker.remember(&Pose::default(), cells.into_iter());
    assert_eq!(checker.points(), 0);
}

/// The same with a border of the bounds ahead, at 45° and not; and a hull that a correction of the
/// pose put over the border.
#[test]
fn a_fence_stops_the_hull_and_lets_it_back_in() {
    let fence = |most_x_m: f32| {
        let corners = [(-9.0, -9.0), (most_x_m, -9.0), (most_x_m, 9.0), (-9.0, 9.0)];
        Fence::new().bounds(&corners.map(|(x_m, y_m)| Point { x_m, y_m }))
    };
    let checker = |most_x_m: f32, yaw_rad: f32| {
        let pose = Pose {
            yaw_rad,
            ..Pose::default()
        };
        let mut checker = CollisionChecker::empty(&ROBOT);
        checker.fence_off(&pose, &fence(most_x_m), 15);
        checker
    };
    let at = |length| Place::default().after(length, 0.0);
    let half = ROBOT.half_length_m;
    let near = checker(1.0, 0.0);
    assert!(near.points() > 20);
    assert!(near.is_clear(at(1.0 - half - 0.03), 0.016));
    assert!(!near.is_clear(at(1.0 - half + 0.01), 0.016));
    let turned = checker(1.0, 0.25 * math::PI);
    let room = (1.0 - half * math::sqrt(2.0)) * math::sqrt(2.0);
    assert!(turned.is_clear(at(room - 0.08), 0.016));
    assert!(!turned.is_clear(at(room + 0.06), 0.016));
    let over = checker(0.2, 0.0);
    assert!(over.is_arc_clear(Place::default(), -0.1, 0.0, 0.016));
    assert!(!over.is_arc_clear(Place::default(), 0.1, 0.0, 0.016));
}
