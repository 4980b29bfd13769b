//! The shifts of a search, and the counts of its bit planes.

use std::boxed::Box;

use super::{Counts, PLANES, SIDE, beside, count, most, nearest};
use crate::geometry::{Cell, Point, Pose};
use crate::grid::Class;
use crate::localise::scan_points::ScanPoint;
use crate::map::Tiles;

#[test]
fn the_nearest_shift_is_nearest() {
    assert_eq!(nearest(1 << 16), 0);
    assert_eq!(nearest(1 << 15 | 1 << 18), -1);
    assert_eq!(nearest(1 << 10 | 1 << 18), 2);
    assert_eq!(nearest(1), -16);
}

#[test]
fn the_shifts_of_one_place_are_up_to_three_cells_away() {
    for dx in -SIDE / 2..SIDE / 2 {
        let near = (dx - 3).max(-SIDE / 2)..=(dx + 3).min(SIDE / 2 - 1);
        let bits = near.fold(0_u32, |bits, at| bits | 1 << (at + SIDE / 2));
        assert_eq!(beside(dx), bits, "{dx}");
    }
}

#[test]
fn counts_are_those_of_single_cells() {
    let mut tiles = Box::new(Tiles::<16, 64>::new());
    tiles.reset();
    let mut seed = 7_u32;
    for (x, y) in (-60..60).flat_map(|x| (-60..60).map(move |y| (x, y))) {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let class = if seed >> 30 == 0 {
            Class::Obstacle
        } else {
            Class::Free
        };
        tiles.set(Cell { x, y }, class).expect("room");
    }
    let point = |k: i32| ScanPoint {
        end: Point {
            x_m: k as f32 * 0.07 - 1.0,
            y_m: 1.5 - k as f32 * 0.05,
        },
        normal: None,
    };
    let points: std::vec::Vec<ScanPoint> = (0..60).map(point).collect();
    let pose = Pose {
        x_m: 0.33,
        y_m: -0.21,
        yaw_rad: 0.4,
        ..Pose::default()
    };
    let counts: Counts = count(&tiles, &points, &pose);
    for (dy, planes) in (-SIDE / 2..).zip(&counts) {
        let direct = |dx: i32| {
            let cells = points
                .iter()
                .map(|it| pose.to_map(it.end).cell().offset(dx, dy));
            cells
                .filter(|&cell| tiles.class(cell) == Class::Obstacle)
                .count() as u32
        };
        for dx in -SIDE / 2..SIDE / 2 {
            let bit = dx + SIDE / 2;
            let kept: u32 = (0..PLANES).map(|k| (planes[k] >> bit & 1) << k).sum();
            assert_eq!(kept, direct(dx), "{dx} {dy}");
        }
        let greatest = (-SIDE / 2..SIDE / 2).map(direct).max();
        assert_eq!(Some(most(planes).0), greatest);
    }
}
