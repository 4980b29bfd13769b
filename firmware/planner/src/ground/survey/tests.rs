//! Tests of single beams into a window of level ground, with a wall across it or with nothing
//! behind an edge.
//!
//! Units: metres, map cells.

use crate::config::UnevenGround;
use crate::geometry::{Cell, Point, Pose, Twist};
use crate::ground::elevation::tests::OwnedWindow;
use crate::ground::ray::Ray;
use crate::ground::survey::Survey;
use crate::input::Input;

/// Column of the wall's cells. The wall's face is at x = 2 m.
const WALL: i32 = 20;
/// The last column of ground before it.
const BEFORE: Cell = Cell { x: WALL - 1, y: 0 };
/// The robot stands upright at the origin.
const AT_REST: Input<'_> = Input {
    time_ms: 0,
    pose: Pose::ORIGIN,
    velocity: Twist::STILL,
    scans: [&[], &[]],
};

/// Returns a beam straight ahead.
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

/// Returns the mean height and the count of the ground right before the wall. It was measured
/// twice, and then hit by a beam of the tilted laser that ends 1 cm before the wall's face at the
/// height `z_m`. `is_wall_known` says if the window has the wall's marks.
fn before_wall(is_wall_known: bool, z_m: f32) -> (f32, u8) {
    let mut owned = OwnedWindow::new(Cell::default());
    let mut window = owned.write();
    for (x, y) in (-5..=WALL).flat_map(|x| (-20..=20).map(move |y| (x, y))) {
        for _ in 0..2 {
            match (x < WALL, is_wall_known) {
                (true, _) => window.measure(Cell { x, y }, 0.0),
                (false, true) => window.mark_obstacle(Cell { x, y }),
                (false, false) => {}
            }
        }
    }
    let (from_z_m, length_m) = (0.45, 0.1 * WALL as f32 - 0.01 - 0.15);
    let ray = ahead(from_z_m, (z_m - from_z_m) / length_m, length_m);
    let mut survey = Survey::new(&mut window, &UnevenGround::TABLE_I, &AT_REST);
    survey.process_return(&ray, false, true);
    let heights = window.read();
    let height_m = heights.height_m(BEFORE).expect("it was measured");
    (height_m, heights.count(BEFORE))
}

/// The range errs by 1 cm, so the beam ends in the cell before the wall's. It hit the wall.
#[test]
fn the_foot_of_a_wall_raises_no_ground_before_it() {
    assert_eq!(before_wall(true, 0.12), (0.0, 2));
}

#[test]
fn the_same_rise_without_a_wall_is_ground() {
    let (height_m, count) = before_wall(false, 0.12);
    assert!((height_m - 0.12 / 3.0).abs() < 0.002, "{height_m}");
    assert_eq!(count, 3);
}

#[test]
fn a_small_rise_before_a_wall_is_ground() {
    let (height_m, count) = before_wall(true, 0.02);
    assert!((height_m - 0.02 / 3.0).abs() < 0.002, "{height_m}");
    assert_eq!(count, 3);
}

/// Returns if the first cell behind an edge is a drop, and if it is a possible drop. Level ground
/// ends 2 m from the origin; a tilted beam passes `over_m` above its last cell and ends `gap_m`
/// behind that.
fn behind_an_edge(over_m: f32, gap_m: f32, slack_m: f32) -> (bool, bool) {
    let mut owned = OwnedWindow::new(Cell::default());
    let mut window = owned.write();
    for (x, y) in (-5..WALL).flat_map(|x| (-20..=20).map(move |y| (x, y))) {
        window.measure(Cell { x, y }, 0.0);
        window.measure(Cell { x, y }, 0.0);
    }
    let (slope, last_m) = (-0.4, 1.8);
    let ray = ahead(over_m - slope * last_m, slope, last_m + gap_m);
    let mut survey = Survey::new(&mut window, &UnevenGround::TABLE_I, &AT_REST);
    survey.slack_m = slack_m;
    survey.process_return(&ray, false, true);
    let (heights, behind) = (window.read(), Cell { x: WALL, y: 0 });
    (heights.is_drop(behind), heights.is_possible_drop(behind))
}

#[test]
fn a_kerb_is_a_drop_and_a_possible_brow_is_a_possible_drop() {
    const DROP: (bool, bool) = (true, false);
    const POSSIBLE: (bool, bool) = (false, true);
    assert_eq!(behind_an_edge(0.0, 0.4, 0.0), DROP, "near");
    assert_eq!(behind_an_edge(0.0, 0.7, 0.0), DROP, "steeper than a slope");
    assert_eq!(behind_an_edge(0.05, 0.8, 0.0), POSSIBLE);
    assert_eq!(behind_an_edge(0.05, 0.8, 0.05), DROP, "a noisy attitude");
    assert_eq!(behind_an_edge(0.02, 1.8, 0.0), DROP, "a hole");
    assert_eq!(
        behind_an_edge(0.05, 0.2, 0.0),
        (false, false),
        "level ground"
    );
}
