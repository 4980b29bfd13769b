//! Points that come, stay and go.

use super::*;
use crate::drive::CollisionChecker;
use crate::geometry::Twist;
use crate::input::{INVALID_MM, NO_RETURN_MM};

const ROBOT: RobotShape = RobotShape::PIONEER_3AT;
const CONFIG: Config = Config::pioneer_3at(Vec::new());

const LASER: LaserMount = LaserMount::level(0.0, 0.4);
const NOBODY: fn(Point) -> bool = |_| false;

#[test]
fn a_lone_false_return_is_not_kept() {
    let mut obstacles = ObstaclePoints::new();
    let mut scan = [NO_RETURN_MM; 181];
    scan[90] = 500;
    obstacles.update(&CONFIG, &Pose::default(), (&LASER, &scan), NOBODY);
    assert!(obstacles.points().is_empty());
}

/// Returns a scan that meets one thing, 4 beams wide, at a bearing (degrees) and a range.
fn thing(bearing: i32, range_mm: u16) -> [u16; 181] {
    let mut scan = [NO_RETURN_MM; 181];
    for k in -2..2 {
        scan[(bearing + 90 + k) as usize] = range_mm;
    }
    scan
}

#[test]
fn a_point_is_remembered_behind_the_robot_and_forgotten_when_seen_through() {
    let mut obstacles = ObstaclePoints::new();
    let here = Pose::default();
    obstacles.update(&CONFIG, &here, (&LASER, &thing(0, 800)), NOBODY);
    assert!(!obstacles.points().is_empty());
    let turned = Pose {
        yaw_rad: math::PI,
        ..here
    };
    obstacles.update(&CONFIG, &turned, (&LASER, &[NO_RETURN_MM; 181]), NOBODY);
    assert!(!obstacles.points().is_empty(), "out of view");
    obstacles.update(&CONFIG, &here, (&LASER, &[NO_RETURN_MM; 181]), NOBODY);
    assert!(obstacles.points().is_empty(), "seen through");
}

/// It drives on while nobody looks. In view, its points are as good as all others.
#[test]
fn a_point_where_another_robot_is_goes_once_it_is_out_of_view() {
    let mut obstacles = ObstaclePoints::new();
    let here = Pose::default();
    let is_robot = |point: Point| point.x_m > 0.5;
    for _ in 0..3 {
        obstacles.update(&CONFIG, &here, (&LASER, &thing(0, 800)), is_robot);
        assert!(!obstacles.points().is_empty(), "in view");
    }
    let turned = Pose {
        yaw_rad: math::PI,
        ..here
    };
    obstacles.update(&CONFIG, &turned, (&LASER, &[NO_RETURN_MM; 181]), is_robot);
    assert!(obstacles.points().is_empty());
}

/// Beams pass over what the hull met.
#[test]
fn a_felt_point_stays_until_it_is_out_of_reach() {
    let mut obstacles = ObstaclePoints::new();
    let here = Pose::default();
    let felt = |x_m| [Point { x_m, y_m: 0.1 }].into_iter();
    obstacles.feel(here.point(), felt(-0.3), false);
    obstacles.feel(here.point(), felt(0.3), false);
    obstacles.update(&CONFIG, &here, (&LASER, &[NO_RETURN_MM; 181]), NOBODY);
    assert!(
        obstacles.points().iter().copied().eq(felt(0.3)),
        "seen through, and felt last"
    );
    let away = Pose { x_m: -1.0, ..here };
    obstacles.update(&CONFIG, &away, (&LASER, &[NO_RETURN_MM; 181]), NOBODY);
    assert!(obstacles.points().is_empty());
}

#[test]
fn only_a_trap_opens_and_only_once() {
    let mut obstacles = ObstaclePoints::new();
    let here = Pose::default();
    let felt = || [Point { x_m: 0.3, y_m: 0.1 }].into_iter();
    obstacles.update(&CONFIG, &here, (&LASER, &thing(0, 800)), NOBODY);
    let seen = obstacles.points().len();
    obstacles.feel(here.point(), felt(), false);
    assert!(
        !obstacles.open_trap(&Pose::default(), &ROBOT),
        "it lies on one side"
    );
    assert_eq!(obstacles.points().len(), seen + 1);
    obstacles.feel(here.point(), felt(), true);
    assert!(obstacles.open_trap(&Pose::default(), &ROBOT));
    assert_eq!(obstacles.points().len(), seen, "what was seen stays");
    assert!(!obstacles.open_trap(&Pose::default(), &ROBOT));
}

#[test]
fn a_hidden_point_stays_and_a_far_one_goes() {
    let mut obstacles = ObstaclePoints::new();
    let here = Pose::default();
    obstacles.update(&CONFIG, &here, (&LASER, &thing(0, 1000)), NOBODY);
    let count = obstacles.points().len();
    obstacles.update(&CONFIG, &here, (&LASER, &thing(0, 500)), NOBODY);
    assert!(
        obstacles.points().len() > count,
        "hidden behind the nearer thing"
    );
    let away = Pose { x_m: -2.0, ..here };
    obstacles.update(&CONFIG, &away, (&LASER, &[INVALID_MM; 181]), NOBODY);
    assert!(obstacles.points().is_empty());
}

#[test]
fn a_wall_is_thinned_and_the_store_never_overflows() {
    let mut obstacles = ObstaclePoints::new();
    for k in 0..400 {
        let pose = Pose {
            yaw_rad: k as f32 * 0.7,
            ..Pose::default()
        };
        obstacles.update(
            &CONFIG,
            &pose,
            (&LASER, &[400 + (k % 7) as u16 * 100; 181]),
            NOBODY,
        );
        assert!(obstacles.points().len() <= MAX_POINTS);
    }
}

/// Returns the clearance between the robot and a row of cells of a class across its path.
fn room_before(class: Class) -> f32 {
    let mut tiles = Tiles::<16, 64>::new();
    tiles.reset();
    for (x, y) in (-10..=6).flat_map(|x| (-10..10).map(move |y| (x, y))) {
        let class = if x == 6 { class } else { Class::Free };
        tiles.set(Cell { x, y }, class).expect("room");
    }
    let pose = Pose {
        x_m: 0.05,
        y_m: 0.05,
        ..Pose::default()
    };
    let mut checker = CollisionChecker::empty(&ROBOT);
    checker.keep_off(
        &pose,
        inflated_border_cells(&tiles, pose.point(), &Tuning::DEFAULT),
    );
    checker.clearance_m()
}

/// A hit is marked behind the beam's end, so an obstacle begins before its cell.
#[test]
fn the_robot_keeps_three_centimetres_more_off_what_stands_than_off_what_is_gone() {
    let [stands_m, gone_m, unknown_m] =
        [Class::Obstacle, Class::Negative, Class::Unknown].map(room_before);
    // To the near side of the cell right ahead.
    assert!(
        (gone_m - (0.55 - ROBOT.half_length_m)).abs() < 1e-4,
        "{gone_m}"
    );
    assert_eq!(unknown_m, gone_m);
    assert!((gone_m - stands_m - 0.03).abs() < 1e-4, "{stands_m}");
}

/// The laser looks ahead from the middle of the hull: what lies beside and behind it stays unseen.
#[test]
fn unseen_points_go_when_a_beam_passes_or_the_robot_is_wedged() {
    let surrounded = || {
        let mut obstacles = ObstaclePoints::new();
        obstacles.surround(&Pose::default(), &ROBOT);
        obstacles.update(
            &CONFIG,
            &Pose::default(),
            (&LASER, &[NO_RETURN_MM; 181]),
            NOBODY,
        );
        obstacles
    };
    let mut obstacles = surrounded();
    let is_behind = |point: &Point| point.x_m < 0.01;
    assert!(obstacles.points().len() > 20);
    assert!(obstacles.points().iter().all(is_behind));
    for (x_m, expected) in [(0.0, true), (0.2, true), (0.4, false)] {
        let pose = Pose {
            x_m,
            ..Pose::default()
        };
        assert_eq!(obstacles.is_surrounded(&pose, &ROBOT), expected, "{x_m}");
    }
    let checker = CollisionChecker::new(&ROBOT, &Pose::default(), obstacles.points());
    let admits = |linear_mps, angular_radps| {
        let told = Twist {
            linear_mps,
            angular_radps,
        };
        checker.admits(told, Twist::default(), &CONFIG, 0.025)
    };
    assert!(admits(0.4, 0.0), "ahead");
    assert!(!admits(-0.15, 0.0), "back");
    assert!(!admits(0.0, 0.6), "a turn");
    assert!(obstacles.open_trap(&Pose::default(), &ROBOT));
    assert!(obstacles.points().is_empty() && !obstacles.open_trap(&Pose::default(), &ROBOT));
    let mut obstacles = surrounded();
    let turned = Pose {
        yaw_rad: math::PI,
        ..Pose::default()
    };
    obstacles.update(&CONFIG, &turned, (&LASER, &[NO_RETURN_MM; 181]), NOBODY);
    assert!(obstacles.points().len() < 6, "{:?}", obstacles.points());
}

#[test]
fn a_return_takes_the_place_of_an_unseen_point() {
    let mut obstacles = ObstaclePoints::new();
    obstacles.surround(&Pose::default(), &ROBOT);
    let wall_mm = ((ROBOT.half_length_m + UNSEEN_M) * 1e3) as u16 + 10;
    obstacles.update(
        &CONFIG,
        &Pose::default(),
        (&LASER, &thing(0, wall_mm)),
        NOBODY,
    );
    let ahead = |point: &&Point| point.x_m > 0.2 && point.y_m.abs() < 0.01;
    let nearest = obstacles.points().iter().find(ahead).expect("a point");
    assert!((nearest.x_m - 1e-3 * f32::from(wall_mm)).abs() < 0.002);
}
