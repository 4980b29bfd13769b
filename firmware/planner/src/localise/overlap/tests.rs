//! Samples of another map against one's own.

use std::boxed::Box;
use std::vec::Vec;

use super::*;
use crate::geometry::MapFromOdom;

type Plan = Tiles<64, 128>;

/// A room of 6 × 5 m with two pillars, metres.
fn class(x: f32, y: f32) -> Class {
    let is_pillar = |px: f32, py: f32| (x - px).abs() < 0.2 && (y - py).abs() < 0.3;
    if !(-0.1..6.1).contains(&x) || !(-0.1..5.1).contains(&y) {
        Class::Unknown
    } else if (0.0..6.0).contains(&x)
        && (0.0..5.0).contains(&y)
        && !is_pillar(1.5, 3.6)
        && !is_pillar(4.4, 1.2)
    {
        Class::Free
    } else {
        Class::Obstacle
    }
}

/// Draws the world in coordinates from which `motion` leads to it.
fn drawn(motion: &MapFromOdom, world: impl Fn(f32, f32) -> Class) -> Box<Plan> {
    let mut tiles = Box::new(Plan::new());
    tiles.reset();
    for (x, y) in (-40..100).flat_map(|x| (-40..100).map(move |y| (x, y))) {
        let cell = Cell { x, y };
        let at = motion.point(cell.centre());
        let class = world(at.x_m, at.y_m);
        if class != Class::Unknown {
            tiles.set(cell, class).expect("room");
        }
    }
    tiles
}

/// Returns a sample of the whole other map, as seen with a motion from the own one.
fn sample(other: &Plan, own: &Plan, team_from_own: &MapFromOdom) -> Vec<u32> {
    let mut words = Vec::new();
    let back = team_from_own.inverse();
    for (column, row) in other.touched().collect::<Vec<_>>() {
        let [low, high] = other.planes_of(column, row).expect("touched");
        let is_floor = |cell: Cell| own.class(back.point(cell.centre()).cell()) == Class::Free;
        add_tile((column, row), &[low, high], is_floor, |word| {
            words.push(word);
        });
    }
    words.truncate(MOST_CELLS);
    words
}

fn sd(m: f32, degrees: f32) -> Symmetric {
    let rad = degrees.to_radians();
    Symmetric::diagonal(m * m, m * m, rad * rad)
}

const TRUE: MapFromOdom = MapFromOdom {
    x_m: 0.41,
    y_m: -0.33,
    yaw_rad: 0.12,
};

fn robot() -> Pose {
    Pose {
        x_m: 2.5,
        y_m: 2.5,
        yaw_rad: 0.7,
        ..Pose::default()
    }
}

#[test]
fn a_room_is_found_half_a_metre_and_seven_degrees_off() {
    let own = drawn(&TRUE, class);
    let other = drawn(&MapFromOdom::IDENTITY, class);
    let told = MapFromOdom::IDENTITY;
    let sample = sample(&other, &own, &told);
    assert!(sample.len() > 40);
    let found = overlap(
        &own,
        &sample,
        (&robot(), &robot()),
        &sd(0.3, 5.0),
        &LocaliseTuning::DEFAULT,
    );
    let Overlap::Matched { pose, covariance } = found else {
        panic!("{found:?}");
    };
    // The pose from which the true motion leads to where the robot is told to be.
    let expected = TRUE.inverse().point(robot().point());
    assert!(pose.point().distance_m(expected) < 0.05, "{pose:?}");
    assert!((pose.yaw_rad - (0.7 - 0.12)).abs() < 0.009, "{pose:?}");
    assert!(
        covariance.xx.max(covariance.yy) < 0.04 * 0.04,
        "{covariance:?}"
    );
}

#[test]
fn a_bare_corridor_says_nothing() {
    let corridor = |_: f32, y: f32| {
        if (0.0..2.0).contains(&y) {
            Class::Free
        } else if (-0.1..2.1).contains(&y) {
            Class::Obstacle
        } else {
            Class::Unknown
        }
    };
    let own = drawn(&TRUE, corridor);
    let other = drawn(&MapFromOdom::IDENTITY, corridor);
    let sample = sample(&other, &own, &TRUE);
    let at = Pose {
        y_m: 1.0,
        ..robot()
    };
    let found = overlap(
        &own,
        &sample,
        (&at, &at),
        &sd(0.3, 5.0),
        &LocaliseTuning::DEFAULT,
    );
    assert!(matches!(found, Overlap::Silent), "{found:?}");
}

#[test]
fn walls_seen_from_the_other_side_are_not_in_a_sample() {
    let own = drawn(&MapFromOdom::IDENTITY, class);
    // The outside of the room.
    let outside = |x: f32, y: f32| match class(x, y) {
        Class::Unknown => Class::Free,
        Class::Obstacle => Class::Obstacle,
        _ => Class::Unknown,
    };
    let other = drawn(&MapFromOdom::IDENTITY, outside);
    assert!(sample(&other, &own, &MapFromOdom::IDENTITY).is_empty());
}

#[test]
fn a_cell_reads_back_from_its_word() {
    for (x, y, front) in [(0, 0, 0), (-4_032, 4_031, 3), (17, -1, 2)] {
        let packed = Packed::new(Cell { x, y }, front, front == 2);
        assert_eq!(packed.cell(), Cell { x, y });
        assert_eq!(packed.front(), FRONTS[front as usize]);
        assert_eq!(packed.normal().is_some(), front == 2);
        assert!(is_of_tile(packed.0, (x >> 5, y >> 5)));
    }
}
