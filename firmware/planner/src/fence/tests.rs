//! Tests of [`crate::fence`].

use std::vec::Vec;

use super::Fence;
use crate::geometry::{CELL_M, Cell, Point};

fn points(corners: &[(f32, f32)]) -> Vec<Point> {
    let point = |&(x_m, y_m): &(f32, f32)| Point { x_m, y_m };
    corners.iter().map(point).collect()
}

fn allowed(fence: &Fence, cells: core::ops::Range<i32>) -> Vec<(i32, i32)> {
    let all = cells
        .clone()
        .flat_map(|y| cells.clone().map(move |x| (x, y)));
    all.filter(|&(x, y)| fence.allows(Cell { x, y })).collect()
}

#[test]
fn a_fence_without_polygons_forbids_nothing() {
    assert!(Fence::new().is_empty());
    assert_eq!(allowed(&Fence::new(), -3..3).len(), 36);
}

#[test]
fn bounds_on_the_borders_of_cells_lose_no_cell() {
    for at in [0.0, 1.3, -7.7, 300.1] {
        let (least, most) = (at, at + 0.5);
        let square = points(&[(least, least), (most, least), (most, most), (least, most)]);
        let first = (at / CELL_M).round() as i32;
        let expected: Vec<_> = (first..first + 5)
            .flat_map(|y| (first..first + 5).map(move |x| (x, y)))
            .collect();
        let near = first - 4..first + 9;
        assert_eq!(
            allowed(&Fence::new().bounds(&square), near.clone()),
            expected,
            "{at}"
        );
        let outside = allowed(&Fence::new().no_go(&square), near.clone());
        assert_eq!(outside.len(), near.len() * near.len() - 25, "{at}");
    }
}

/// Each cell is allowed if it has no point in common with what is forbidden, on a grid of points.
#[test]
fn a_cell_is_allowed_only_as_a_whole() {
    let l_shape = points(&[
        (-1.52, -1.48),
        (1.33, -0.92),
        (0.71, 0.34),
        (0.25, -0.13),
        (-0.31, 1.57),
    ]);
    let thin = points(&[(0.51, -0.62), (0.52, -0.63), (-0.93, 0.41)]);
    for fence in [
        Fence::new().bounds(&l_shape),
        Fence::new().no_go(&l_shape),
        Fence::new().bounds(&l_shape).no_go(&thin),
    ] {
        let mut wrong = 0;
        for cell in (-20..20).flat_map(|y| (-20..20).map(move |x| Cell { x, y })) {
            let inner = (1..50).flat_map(|j| (1..50).map(move |i| (i as f32, j as f32)));
            let is_whole = inner.into_iter().all(|(i, j)| {
                let at = Point {
                    x_m: (cell.x as f32 + i / 50.0) * CELL_M,
                    y_m: (cell.y as f32 + j / 50.0) * CELL_M,
                };
                fence
                    .polygons()
                    .all(|(corners, is_bounds)| is_bounds == is_inside(corners, at))
            });
            // The grid of points may miss a cell's outermost two millimetres.
            wrong += i32::from(fence.allows(cell) && !is_whole);
            let is_missed = !fence.allows(cell) && is_whole && !is_touched(&fence, cell);
            wrong += i32::from(is_missed);
        }
        assert_eq!(wrong, 0, "{fence:?}");
    }
}

/// Returns true if a side passes through a cell.
fn is_touched(fence: &Fence, cell: Cell) -> bool {
    fence.polygons().any(|(corners, _)| {
        (0..corners.len()).any(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            (0..=4_000).any(|part| {
                let part = part as f32 / 4_000.0;
                let at = Point {
                    x_m: a.x_m + part * (b.x_m - a.x_m),
                    y_m: a.y_m + part * (b.y_m - a.y_m),
                };
                at.cell() == cell
            })
        })
    })
}

fn is_inside(corners: &[Point], at: Point) -> bool {
    let crossed = (0..corners.len()).filter(|&k| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        let part = (at.y_m - a.y_m) / (b.y_m - a.y_m);
        (a.y_m > at.y_m) != (b.y_m > at.y_m) && a.x_m + part * (b.x_m - a.x_m) < at.x_m
    });
    crossed.count() % 2 == 1
}

#[test]
fn rows_that_no_side_passes_through_are_steady() {
    let square = points(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
    let fence = Fence::new().bounds(&square);
    assert_eq!(fence.steady_row((32, 32), 32), Some(0));
    assert_eq!(fence.steady_row((-128, 32), 32), Some(u64::MAX));
    assert_eq!(fence.steady_row((-32, 32), 32), None);
    assert_eq!(fence.row(-32, 32), u64::MAX >> 32);
}

#[test]
fn rims_are_the_forbidden_cells_beside_allowed_ones() {
    let square = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
    let fence = Fence::new().no_go(&square);
    let mut rims = Vec::new();
    fence.for_each_rim(Cell { x: 0, y: 0 }, 30, |cell| rims.push(cell));
    assert_eq!(rims.len(), 36);
    assert!(rims.iter().all(|cell| !fence.allows(*cell)));
    assert_eq!(rims[0].y, 0, "the nearest row comes first");
    let mut near = 0;
    fence.for_each_rim(Cell { x: -3, y: 5 }, 4, |_| near += 1);
    assert_eq!(near, 10);
}
