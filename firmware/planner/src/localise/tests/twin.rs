//! The equations of the match against a naive twin: single cells, in f64.

use std::boxed::Box;
use std::vec::Vec;

use super::State;
use crate::config::LocaliseTuning;
use crate::geometry::{CELL_M, Cell, Point};
use crate::grid::Class;
use crate::localise::alignment::constraints;
use crate::localise::scan_points::ScanPoint;
use crate::map::Tiles;

/// The system of equations, from single cells and in f64.
#[test]
fn the_constraints_are_those_of_a_naive_twin() {
    let mut tiles = Box::new(Tiles::<16, 64>::new());
    tiles.reset();
    for (x, y) in (-30..30).flat_map(|x| (-30..30).map(move |y| (x, y))) {
        let stands = x == 20 || y == -18 || (y == 12 + x / 3 && x < 5) || (x, y) == (8, 4);
        let class = if stands { Class::Obstacle } else { Class::Free };
        tiles.set(Cell { x, y }, class).expect("room");
    }
    let point = |k: i32| ScanPoint {
        end: Point {
            x_m: 0.031 * (k % 13) as f32 * 5.0 - 0.4,
            y_m: 0.027 * (k % 17) as f32 * 6.0 - 1.5,
        },
        normal: (k % 3 != 0).then(|| {
            let (sin, cos) = (0.41 * k as f32).sin_cos();
            (cos, sin)
        }),
    };
    let points: Vec<ScanPoint> = (0..150).map(point).collect();
    let at = [1.3_f32, -2.1, 0.37];
    let tuning = &LocaliseTuning {
        least_information: 0.0,
        ..LocaliseTuning::DEFAULT
    };
    let found = constraints(&tiles, &points, at, tuning);
    let twin = twin(&tiles, &points, at.map(f64::from), tuning);
    let h = [
        found.h.xx, found.h.xy, found.h.yy, found.h.xt, found.h.yt, found.h.tt,
    ];
    let all = h.iter().chain(&found.b).zip(&twin);
    for (found, wanted) in all {
        let scale = wanted.abs().max(1.0);
        assert!(
            (f64::from(*found) - wanted).abs() < 1e-3 * scale,
            "{found} {wanted}"
        );
    }
}

/// Returns H and b.
fn twin(
    tiles: &Tiles<16, 64>,
    points: &[ScanPoint],
    [x, y, yaw]: State,
    tuning: &LocaliseTuning,
) -> [f64; 9] {
    let cell_m = f64::from(CELL_M);
    let turn = |a: f64, b: f64| {
        let (sin, cos) = yaw.sin_cos();
        [cos * a - sin * b, sin * a + cos * b]
    };
    let mut sum = [0.0; 9];
    for point in points {
        let end = point.end;
        let arm = turn(f64::from(end.x_m) / cell_m, f64::from(end.y_m) / cell_m);
        let Some((value, mut g)) = field(tiles, [x + arm[0], y + arm[1]]) else {
            continue;
        };
        if let Some((a, b)) = point.normal {
            let n = turn(f64::from(a), f64::from(b));
            let slope = n[0] * g[0] + n[1] * g[1];
            g = n.map(|it| slope * it);
        }
        let r = 1.0 - value;
        let half = f64::from(tuning.robust_cells);
        let weight = f64::from(tuning.beam_information) / (1.0 + r * r / (half * half));
        let j = [g[0], g[1], g[1] * arm[0] - g[0] * arm[1]];
        let products = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
        for (sum, (a, b)) in sum.iter_mut().zip(products) {
            *sum += weight * j[a] * j[b];
        }
        for (sum, j) in sum[6..].iter_mut().zip(j) {
            *sum += weight * r * j;
        }
    }
    sum
}

/// Returns the value and the gradient of the map's field: a sum of tents.
fn field(tiles: &Tiles<16, 64>, end: [f64; 2]) -> Option<(f64, [f64; 2])> {
    let cell = end.map(|it| it.floor() as i32);
    let (mut value, mut gradient) = (0.0, [0.0; 2]);
    let mut any = false;
    for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
        let near = Cell {
            x: cell[0] + dx,
            y: cell[1] + dy,
        };
        let off = [
            end[0] - f64::from(near.x) - 0.5,
            end[1] - f64::from(near.y) - 0.5,
        ];
        let tent = off.map(|it| 1.0 - it.abs());
        if tiles.class(near) != Class::Obstacle || tent[0] <= 0.0 || tent[1] <= 0.0 {
            continue;
        }
        any = true;
        value += tent[0] * tent[1];
        gradient[0] -= off[0].signum() * tent[1];
        gradient[1] -= off[1].signum() * tent[0];
    }
    any.then_some((value, gradient))
}
