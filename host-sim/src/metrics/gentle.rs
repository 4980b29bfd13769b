//! Gentle ground: cells whose own ground is within the limits, and cells with level ground around.
//!
//! Metres, radians.

use fieldline_planner::geometry::Cell;

use super::cell_area::CellArea;
use super::coverage::{MAP_CELL_M, Truth, centre_m, truth};
use crate::robot::Limits;
use crate::world::World;

/// Distance over which the slope of a cell is measured, metres.
const SLOPE_M: f64 = 0.1;
/// Distance from the robot's centre to which the ground matters, cells.
const NEAR_CELLS: i32 = 4;

/// Returns true if a cell is free of walls, no steeper than the climb limit, and has no edge.
#[must_use]
pub(super) fn is_gentle(world: &World, cell: Cell, limits: &Limits) -> bool {
    let [x, y] = centre_m(cell);
    let Some(here_m) = world.ground_m(x, y) else {
        return false;
    };
    let inside = |x: f64, y: f64| {
        let grid = world.occupancy();
        grid.index(grid.cell_at(x, y)).is_some()
    };
    // Beyond the border the ground counts as level; a hole inside is an edge.
    let beside = |dx: f64, dy: f64| match world.ground_m(x + dx, y + dy) {
        None if inside(x + dx, y + dy) => f64::NAN,
        height_m => height_m.unwrap_or(here_m),
    };
    let d = SLOPE_M;
    let gx = (beside(d, 0.0) - beside(-d, 0.0)) / (2.0 * d);
    let gy = (beside(0.0, d) - beside(0.0, -d)) / (2.0 * d);
    let edge_m = limits.step_m.max(limits.drop_m);
    let smooth = (0..8).all(|k| {
        let bearing = f64::from(k) * core::f64::consts::FRAC_PI_4;
        let rise_m = beside(d * libm::cos(bearing), d * libm::sin(bearing)) - here_m;
        rise_m.abs() <= edge_m
    });
    // A comparison with the NaN of a hole is false.
    smooth
        && (gx * gx + gy * gy).sqrt() <= libm::tan(limits.climb_rad) + 1e-9
        && truth(world, cell) == Truth::Free
}

/// True for each cell around which the ground rises too little for a slope or an edge beyond the
/// limits.
pub(super) fn level(world: &World, area: &CellArea, limits: &Limits) -> Vec<bool> {
    // Over the wheelbase and over the track; less by a fifth for the ground between the samples.
    let slopes = [
        0.268 * libm::tan(limits.climb_rad),
        0.394 * libm::tan(limits.roll_rad),
    ];
    let little_m = 0.8
        * slopes[0]
            .min(slopes[1])
            .min(limits.step_m)
            .min(limits.drop_m);
    let spans = spans_m(world, area);
    let across = widened(&spans, area, [1, 0]);
    let around = widened(&across, area, [0, 1]);
    around
        .into_iter()
        .map(|[low_m, high_m]| high_m - low_m <= little_m)
        .collect()
}

/// Least and greatest height of each cell; infinite at a hole.
fn spans_m(world: &World, area: &CellArea) -> Vec<[f64; 2]> {
    let points: Vec<[f64; 2]> = (0..25)
        .map(|k| [k % 5, k / 5].map(|k| f64::from(k) * 0.25 * MAP_CELL_M))
        .collect();
    (0..area.len())
        .map(|index| {
            let cell = area.cell(index);
            let corner = [cell.x, cell.y].map(|k| f64::from(k) * MAP_CELL_M);
            points.iter().fold(
                [f64::INFINITY, f64::NEG_INFINITY],
                |[low, high], [x, y]| match world.ground_m(corner[0] + x, corner[1] + y) {
                    Some(z) => [low.min(z), high.max(z)],
                    None => [f64::NEG_INFINITY, f64::INFINITY],
                },
            )
        })
        .collect()
}

/// Spans over all cells within [`NEAR_CELLS`] along an axis, as far as the area goes.
fn widened(spans: &[[f64; 2]], area: &CellArea, [ax, ay]: [i32; 2]) -> Vec<[f64; 2]> {
    (0..area.len())
        .map(|index| {
            let cell = area.cell(index);
            (-NEAR_CELLS..=NEAR_CELLS)
                .filter_map(|k| area.beside(cell, [k * ax, k * ay]))
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], other| {
                    [low.min(spans[other][0]), high.max(spans[other][1])]
                })
        })
        .collect()
}
