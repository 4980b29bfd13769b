//! What a robot that drives towards things makes of them: both lasers cast over a ground given by its formula.

use std::boxed::Box;
use std::vec::Vec;

use crate::config::Config;
use crate::config::UnevenGround;
use crate::geometry::{Cell, Point, Pose, Twist};
use crate::ground::classify;
use crate::ground::elevation::{Elevation, WINDOW_CELLS};
use crate::ground::ray::{Attitude, Mount};
use crate::input::{Input, NO_RETURN_MM};
use crate::map::{Class, Map};
use crate::math;
use crate::robot::LaserMount;

type Ground = dyn Fn(f32, f32) -> f32;

fn laser(x_m: f32, z_m: f32, pitch_rad: f32) -> LaserMount {
    LaserMount {
        x_m,
        y_m: 0.0,
        z_m,
        pitch_rad,
        first_bearing_rad: -0.5 * math::PI,
        bearing_step_rad: math::PI / 180.0,
        beams: 181,
        range_limit_mm: 12_000,
    }
}

fn config() -> Config {
    let lasers = [laser(0.10, 0.40, 0.0), laser(0.15, 0.45, 0.349)];
    Config {
        ground: Some(UnevenGround::TABLE_I),
        ..Config::pioneer_3at(lasers.into_iter().collect())
    }
}

/// The robot on the ground, facing east.
fn pose(ground: &Ground, x_m: f32) -> Pose {
    let rise = (ground(x_m + 0.13, 0.0) - ground(x_m - 0.13, 0.0)) / 0.26;
    Pose {
        x_m,
        z_m: ground(x_m, 0.0) - ground(0.0, 0.0),
        pitch_rad: -math::atan2(rise, 1.0),
        ..Pose::default()
    }
}

/// Ranges over the ground, by steps of a centimetre.
fn scan(ground: &Ground, pose: &Pose, laser: &LaserMount) -> Vec<u16> {
    let attitude = Attitude::of(pose);
    let mount = Mount::new(&attitude, laser);
    let datum = ground(0.0, 0.0);
    let range = |number: usize| {
        let ray = attitude.ray(&mount, number, 12.0)?;
        let steps = (ray.length_m / 0.01) as u32;
        let met = (1..steps).find(|&step| {
            let s_m = step as f32 * 0.01;
            let at = ray.at(s_m);
            ray.height_m(s_m) <= ground(at.x_m, at.y_m) - datum
        })?;
        Some((met as f32 * 0.01 / ray.length_m * 12_000.0) as u16)
    };
    (0..181)
        .map(|number| range(number).unwrap_or(NO_RETURN_MM))
        .collect()
}

/// Drive east from 0 to `to_m`, 8 cm a step.
fn drive(ground: &Ground, to_m: f32) -> Box<Map<152, 400>> {
    let config = config();
    let mut map = Box::new(Map::new());
    map.begin(&config);
    for step in 0..=(to_m / 0.08) as u32 {
        let pose = pose(ground, step as f32 * 0.08);
        let scans: Vec<Vec<u16>> = config
            .lasers
            .iter()
            .map(|laser| scan(ground, &pose, laser))
            .collect();
        map.observe(
            &config,
            &Input {
                time_ms: step * 200,
                pose,
                velocity: Twist::default(),
                scans: [&scans[0], &scans[1]],
            },
        );
    }
    map
}

/// Classes along the robot's way, a letter a cell.
fn classes(map: &Map<152, 400>, from_m: f32, to_m: f32) -> std::string::String {
    let cells = (from_m * 10.0) as i32..(to_m * 10.0) as i32;
    cells
        .map(|x| match map.class(Cell { x, y: 0 }) {
            Class::Unknown => '?',
            Class::Free => '.',
            Class::Obstacle => '#',
            Class::Negative => 'v',
        })
        .collect()
}

fn count(map: &Map<152, 400>, class: Class) -> usize {
    let cells = (-40..120).flat_map(|x| (-30..30).map(move |y| Cell { x, y }));
    cells.filter(|&cell| map.class(cell) == class).count()
}

#[test]
fn a_slope_that_rises_is_no_wall() {
    // 16.7°, from 2.5 m on, 1.8 m high.
    let ground = |x: f32, _: f32| (0.3 * (x - 2.5)).clamp(0.0, 1.8);
    let map = drive(&ground, 4.5);
    assert_eq!(count(&map, Class::Obstacle), 0);
    assert_eq!(classes(&map, 0.0, 5.0), ".".repeat(50));
}

#[test]
fn a_valley_deeper_than_a_hole_is_none() {
    // Down by 1 m and up again, nowhere steeper than 12°.
    let ground = |x: f32, _: f32| {
        let (_, cos) = math::sin_cos((x * 0.42).clamp(0.0, 4.0 * math::PI));
        0.5 * cos
    };
    let map = drive(&ground, 8.0);
    assert_eq!(count(&map, Class::Negative), 0);
    assert_eq!(count(&map, Class::Obstacle), 0);
    assert_eq!(classes(&map, 0.0, 8.5), ".".repeat(85));
}

#[test]
fn the_rim_of_a_cliff_is_negative_before_the_robot_is_there() {
    let ground = |x: f32, _: f32| if x > 3.0 { -1.5 } else { 0.0 };
    let map = drive(&ground, 2.4);
    let seen = classes(&map, 2.0, 3.5);
    assert!(seen.starts_with("........"), "{seen}");
    assert!(
        seen[9..].starts_with('v') || seen[10..].starts_with('v'),
        "{seen}"
    );
    assert!(seen[11..].starts_with("vvvv"), "{seen}");
    assert_eq!(count(&map, Class::Obstacle), 0);
}

#[test]
fn where_nothing_comes_back_there_is_no_ground() {
    let ground = |x: f32, _: f32| if x > 3.0 { -90.0 } else { 0.0 };
    let seen = classes(&drive(&ground, 2.4), 2.0, 3.5);
    assert!(
        seen.starts_with("........") && seen[11..].starts_with("vvvv"),
        "{seen}"
    );
}

#[test]
fn a_kerb_is_an_obstacle_from_below_and_a_rim_from_above() {
    let up = |x: f32, _: f32| if x > 3.0 { 0.2 } else { 0.0 };
    let seen = classes(&drive(&up, 2.4), 2.5, 3.6);
    assert!(
        seen.starts_with("....") && seen[4..7].contains('#'),
        "{seen}"
    );
    let down = |x: f32, _: f32| if x > 3.0 { -0.2 } else { 0.0 };
    let seen = classes(&drive(&down, 2.4), 2.5, 3.6);
    assert!(
        seen.starts_with("...") && seen[4..8].contains('v'),
        "{seen}"
    );
    // 5 cm is none.
    let low = |x: f32, _: f32| if x > 3.0 { 0.05 } else { 0.0 };
    assert_eq!(classes(&drive(&low, 2.4), 0.0, 3.6), ".".repeat(36));
}

#[test]
fn a_wall_is_an_obstacle_and_the_ground_before_it_free() {
    let ground = |x: f32, _: f32| if x > 3.0 { 1.5 } else { 0.0 };
    let seen = classes(&drive(&ground, 2.4), 2.0, 3.2);
    assert!(
        seen.starts_with(".........") && seen[9..11].contains('#'),
        "{seen}"
    );
}

/// What is given up at the corner of a hole is gone, though ground lies on two sides of it; in a gap of level ground it is free.
#[test]
fn a_corner_is_not_led_over_and_a_gap_is() {
    for (corner, expected) in [(true, false), (false, true)] {
        let mut heights = std::vec![0; 2 * WINDOW_CELLS];
        let mut marks = std::vec![0; WINDOW_CELLS];
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell::default());
        let all = (-30..30).flat_map(|y| (-30..30).map(move |x| Cell { x, y }));
        let gone = |cell: &Cell| (0..if corner { 25 } else { 6 }).contains(&cell.x);
        let gone = |cell: &Cell| gone(cell) && (!corner || cell.y >= 0);
        for cell in all.filter(|cell| !gone(cell)) {
            window.measure(cell, 0.0);
        }
        let asked = Cell { x: 2, y: 2 };
        let leads = classify::spans_gap(&window.read(), &UnevenGround::TABLE_I, asked, 0.0);
        assert_eq!(leads, expected, "corner: {corner}");
    }
}

/// Ground by the column, with a gap of eight cells that was never measured; whether the gap is led over in its middle.
fn spans_gap(slack_m: f32, height_m: impl Fn(f32) -> f32) -> bool {
    let mut heights = std::vec![0; 2 * WINDOW_CELLS];
    let mut marks = std::vec![0; WINDOW_CELLS];
    let mut origin = Cell::default();
    let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
    window.follow(Cell::default());
    let all = (-30..30).flat_map(|y| (-30..30).map(move |x| Cell { x, y }));
    for cell in all.filter(|cell| !(0..8).contains(&cell.x)) {
        window.measure(cell, height_m(cell.centre().x_m));
    }
    let asked = Cell { x: 4, y: 2 };
    classify::spans_gap(&window.read(), &UnevenGround::TABLE_I, asked, slack_m)
}

/// From above both look alike across the gap, a fifth of a metre down; beside it they do not.
#[test]
fn a_brow_is_led_over_and_a_kerb_in_a_gap_is_not() {
    let leads = |height_m: fn(f32) -> f32| spans_gap(0.0, height_m);
    assert!(leads(|x| -0.15 * x * x.max(0.0)), "a brow");
    assert!(leads(|x| -0.2 * x), "a slope");
    assert!(!leads(|x| if x > 0.4 { -0.2 } else { 0.0 }));
    assert!(leads(|x| if x > 0.4 { -0.05 } else { 0.0 }), "low");
    let steep = |x: f32| -0.33 * x;
    assert!(leads(steep), "a slope that may be climbed");
    assert!(
        !spans_gap(0.001, steep),
        "as steep as a shadow, and an attitude that errs"
    );
}

/// Whether the middle of a gap of eight by eight cells in level ground is led over, of which one cell beside the gap was first measured half a
/// metre too high, and then `again` times.
fn spans_beside_a_false_height(slack_m: f32, again: u32) -> bool {
    let mut heights = std::vec![0; 2 * WINDOW_CELLS];
    let mut marks = std::vec![0; WINDOW_CELLS];
    let mut origin = Cell::default();
    let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
    window.follow(Cell::default());
    let wrong = Cell { x: 8, y: 4 };
    let all = (-30..30).flat_map(|y| (-30..30).map(move |x| Cell { x, y }));
    let gap = 0..8;
    for cell in all.filter(|cell| !(gap.contains(&cell.x) && gap.contains(&cell.y))) {
        if cell != wrong {
            window.measure(cell, 0.0);
            window.measure(cell, 0.0);
        }
    }
    for _ in 0..=again {
        window.measure(wrong, 0.5);
    }
    let asked = Cell { x: 4, y: 4 };
    classify::spans_gap(&window.read(), &UnevenGround::TABLE_I, asked, slack_m)
}

#[test]
fn one_height_beside_a_gap_may_be_a_false_return_and_forbids_nothing() {
    assert!(spans_beside_a_false_height(0.0, 0));
    assert!(!spans_beside_a_false_height(0.0, 1));
    assert!(
        !spans_beside_a_false_height(0.05, 0),
        "an attitude that errs"
    );
}

/// A slope of 0.2 that the attitude's errors lift by 4 cm before the gap and let down by 4 cm behind it.
#[test]
fn errors_of_the_attitude_do_not_make_ground_be_gone() {
    let lift_m = |x: f32| {
        if (-0.2..=1.0).contains(&x) {
            -0.04 * x.signum()
        } else {
            0.0
        }
    };
    let slope = |x: f32| -0.2 * x + lift_m(x);
    let steep = |x: f32| if x > 0.4 { -0.5 } else { 0.0 };
    assert!(!spans_gap(0.0, slope));
    assert!(spans_gap(0.085, slope));
    assert!(!spans_gap(0.085, steep), "a drop of half a metre");
}

#[test]
fn flat_ground_needs_all_tiles_and_uneven_ground_lends_some() {
    let point = |tile: f32| Point {
        x_m: 3.2 * tile,
        y_m: 1.6,
    };
    let mut map = Box::<Map<20, 400>>::default();
    let flat = Config {
        ground: None,
        ..config()
    };
    for (config, expected) in [(flat, 20), (config(), 4)] {
        map.begin(&config);
        for tile in 0..20 {
            map.free_footprint(point(tile as f32 + 0.5), 0.2);
        }
        assert_eq!(map.tiles().used(), expected);
        assert_eq!(map.pool_full(), expected < 20);
    }
}
