//! Tests of a robot that drives over uneven ground: both lasers are cast over a ground that a
//! formula gives, and the classes of the map are compared.

use std::boxed::Box;
use std::vec::Vec;

use crate::config::{Config, UnevenGround};
use crate::geometry::{Cell, Point, Pose, Twist};
use crate::ground::ray::{Attitude, Mount};
use crate::input::{Input, NO_RETURN_MM};
use crate::map::{Class, Map};
use crate::math;
use crate::robot::LaserMount;

type Ground = dyn Fn(f32, f32) -> f32;

fn config() -> Config {
    let lasers = [
        LaserMount::level(0.10, 0.40),
        LaserMount::tilted(0.15, 0.45, 0.349),
    ];
    Config {
        ground: Some(UnevenGround::TABLE_I),
        ..Config::pioneer_3at(lasers.into_iter().collect())
    }
}

/// Returns the pose of the robot on the ground, facing east.
fn pose(ground: &Ground, x_m: f32) -> Pose {
    let rise = (ground(x_m + 0.13, 0.0) - ground(x_m - 0.13, 0.0)) / 0.26;
    Pose {
        x_m,
        z_m: ground(x_m, 0.0) - ground(0.0, 0.0),
        pitch_rad: -math::atan2(rise, 1.0),
        ..Pose::default()
    }
}

/// Returns the ranges of a scan over the ground, by steps of 1 cm.
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

/// Returns the map after a drive east from 0 to `to_m`, 8 cm a step.
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

/// Returns the classes along the robot's path, one letter a cell.
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
fn a_rising_slope_is_free() {
    // 16.7° from x = 2.5 m on, 1.8 m high.
    let ground = |x: f32, _: f32| (0.3 * (x - 2.5)).clamp(0.0, 1.8);
    let map = drive(&ground, 4.5);
    assert_eq!(count(&map, Class::Obstacle), 0);
    assert_eq!(classes(&map, 0.0, 5.0), ".".repeat(50));
}

#[test]
fn a_valley_deeper_than_a_hole_is_free() {
    // 1 m down and up again, at most 12° steep.
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
fn the_rim_of_a_cliff_is_negative_before_the_robot_reaches_it() {
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
fn beams_without_a_return_mark_a_drop() {
    let ground = |x: f32, _: f32| if x > 3.0 { -90.0 } else { 0.0 };
    let seen = classes(&drive(&ground, 2.4), 2.0, 3.5);
    assert!(
        seen.starts_with("........") && seen[11..].starts_with("vvvv"),
        "{seen}"
    );
}

#[test]
fn a_kerb_is_an_obstacle_from_below_and_a_drop_from_above() {
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
    // An edge of 5 cm is free.
    let low = |x: f32, _: f32| if x > 3.0 { 0.05 } else { 0.0 };
    assert_eq!(classes(&drive(&low, 2.4), 0.0, 3.6), ".".repeat(36));
}

#[test]
fn a_wall_is_an_obstacle_and_the_ground_before_it_is_free() {
    let ground = |x: f32, _: f32| if x > 3.0 { 1.5 } else { 0.0 };
    let seen = classes(&drive(&ground, 2.4), 2.0, 3.2);
    assert!(
        seen.starts_with(".........") && seen[9..11].contains('#'),
        "{seen}"
    );
}

#[test]
fn uneven_ground_lends_tiles_and_flat_ground_does_not() {
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
