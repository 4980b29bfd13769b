//! Single beams into a window of level ground with a wall across it, or with nothing behind an edge: what each raises, and what it says is gone.
//!
//! Units: metres, map cells.

use std::vec;

use crate::config::UnevenGround;
use crate::geometry::{Cell, Point, Pose, Twist};
use crate::ground::elevation::WINDOW_CELLS;
use crate::ground::ray::Ray;
use crate::ground::survey::{Elevation, Survey};
use crate::input::Input;

/// Column of the wall's cells: its face is at x = 2 m.
const WALL: i32 = 20;
/// The last column of ground before it.
const BEFORE: Cell = Cell { x: WALL - 1, y: 0 };
/// The robot stands upright at the origin.
const AT_REST: Input<'_> = Input {
    time_ms: 0,
    pose: Pose {
        x_m: 0.0,
        y_m: 0.0,
        z_m: 0.0,
        roll_rad: 0.0,
        pitch_rad: 0.0,
        yaw_rad: 0.0,
    },
    velocity: Twist {
        linear_mps: 0.0,
        angular_radps: 0.0,
    },
    scans: [&[], &[]],
};

/// A beam straight ahead.
const fn ahead(from_z_m: f32, slope: f32, length_m: f32) -> Ray {
    Ray {
        from: Point {
            x_m: 0.15,
            y_m: 0.05,
        },
        from_z_m,
        along: (1.0, 0.0),
        slope,
        length_m,
    }
}

/// Mean height and count of the ground right before the wall, measured twice and then met by a beam of the tilted laser that ends a centimetre
/// before the wall's face, `z_m` high. Whether anything is known to stand is said by `walled`.
fn before_wall(walled: bool, z_m: f32) -> (f32, u8) {
    let (mut heights, mut marks) = (vec![0; 2 * WINDOW_CELLS], vec![0; WINDOW_CELLS]);
    let mut origin = Cell::default();
    let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
    window.follow(Cell::default());
    for (x, y) in (-5..=WALL).flat_map(|x| (-20..=20).map(move |y| (x, y))) {
        for _ in 0..2 {
            match (x < WALL, walled) {
                (true, _) => window.measure(Cell { x, y }, 0.0),
                (false, true) => window.mark_obstacle(Cell { x, y }),
                (false, false) => {}
            }
        }
    }
    let (from_z_m, length_m) = (0.45, 0.1 * WALL as f32 - 0.01 - 0.15);
    let ray = ahead(from_z_m, (z_m - from_z_m) / length_m, length_m);
    let mut survey = Survey::new(&mut window, &UnevenGround::TABLE_I, &AT_REST);
    survey.process_return(&ray, (false, true));
    let heights = window.read();
    let height_m = heights.height_m(BEFORE).expect("it was measured");
    (height_m, heights.count(BEFORE))
}

/// The beam ends in the cell before the wall's, for its range is off by a centimetre; what it met is the wall.
#[test]
fn the_foot_of_a_wall_raises_no_ground_before_it() {
    assert_eq!(before_wall(true, 0.12), (0.0, 2));
}

#[test]
fn what_rises_as_much_where_nothing_stands_is_ground() {
    let (height_m, count) = before_wall(false, 0.12);
    assert!((height_m - 0.12 / 3.0).abs() < 0.002, "{height_m}");
    assert_eq!(count, 3);
}

#[test]
fn ground_that_hardly_rises_is_measured_up_to_the_wall() {
    let (height_m, count) = before_wall(true, 0.02);
    assert!((height_m - 0.02 / 3.0).abs() < 0.002, "{height_m}");
    assert_eq!(count, 3);
}

/// What is said of the first cell behind level ground that ends 2 m from the origin, by a tilted beam that passes so high over its last
/// cell and meets something so far behind that: gone, or suspected to be.
fn behind_an_edge(over_m: f32, gap_m: f32, slack_m: f32) -> (bool, bool) {
    let (mut heights, mut marks) = (vec![0; 2 * WINDOW_CELLS], vec![0; WINDOW_CELLS]);
    let mut origin = Cell::default();
    let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
    window.follow(Cell::default());
    for (x, y) in (-5..WALL).flat_map(|x| (-20..=20).map(move |y| (x, y))) {
        window.measure(Cell { x, y }, 0.0);
        window.measure(Cell { x, y }, 0.0);
    }
    let (slope, last_m) = (-0.4, 1.8);
    let ray = ahead(over_m - slope * last_m, slope, last_m + gap_m);
    let mut survey = Survey::new(&mut window, &UnevenGround::TABLE_I, &AT_REST);
    survey.slack_m = slack_m;
    survey.process_return(&ray, (false, true));
    let (heights, behind) = (window.read(), Cell { x: WALL, y: 0 });
    (heights.is_drop(behind), heights.is_possible_drop(behind))
}

#[test]
fn behind_a_kerb_the_ground_is_gone_and_behind_what_may_be_a_brow_it_is_suspected() {
    const GONE: (bool, bool) = (true, false);
    const SUSPECTED: (bool, bool) = (false, true);
    assert_eq!(behind_an_edge(0.0, 0.4, 0.0), GONE, "near");
    assert_eq!(behind_an_edge(0.0, 0.7, 0.0), GONE, "steeper than a slope");
    assert_eq!(behind_an_edge(0.05, 0.8, 0.0), SUSPECTED);
    assert_eq!(
        behind_an_edge(0.05, 0.8, 0.05),
        GONE,
        "an attitude that errs"
    );
    assert_eq!(behind_an_edge(0.02, 1.8, 0.0), GONE, "a hole");
    assert_eq!(
        behind_an_edge(0.05, 0.2, 0.0),
        (false, false),
        "level ground"
    );
}
