//! The layers of the map picture, from the bottom up: cells, field, skeleton, arrows, path, marks.

use fieldline_protocol::message::FIELD_SIDE;

use super::canvas::{Canvas, Spot};
use super::{Frame, palette};
use crate::report::GridMap;
use crate::report::grid_map::{CELL_M, MapCell};
use crate::report::tum::Stamped;
use crate::trial::snapshot::{Window, WindowCell};

/// Distance between grid lines, cells: 5 m.
const GRID_CELLS: i32 = 50;
/// Distance between arrows, window cells.
const ARROW_STEP: usize = 3;
/// Width of the paths that were believed and corrected, pixels.
pub(super) const THIN: f32 = 1.2;
/// Number of colours of the path.
const PATH_SHADES: usize = 192;

/// Draws the cells: free cells with a grid of 5 m, and tinted where no new loop
/// starts.
pub(super) fn map(canvas: &mut Canvas, frame: &Frame, map: &GridMap) {
    for row in 0..frame.rows {
        for column in 0..frame.columns {
            let (x, y) = (frame.origin_x + column, frame.origin_y + row);
            let on_grid = x.rem_euclid(GRID_CELLS) == 0 || y.rem_euclid(GRID_CELLS) == 0;
            let colour = match map.get(x, y) {
                MapCell::Unknown => palette::UNKNOWN,
                MapCell::Free if on_grid => palette::GRID,
                MapCell::Free if map.is_in_closed_region(x, y) => palette::CLOSED,
                MapCell::Free if map.is_in_given_up_region(x, y) => palette::GIVEN_UP,
                MapCell::Free => palette::FREE,
                MapCell::Obstacle => palette::OBSTACLE,
                MapCell::NegativeObstacle => palette::NEGATIVE,
            };
            canvas.cell(frame.pixel(x, y), frame.cell_px, colour);
        }
    }
}

/// Tints the cells of the window by ln q, darker near a goal. Obstacles of the map stay visible.
pub(super) fn field(canvas: &mut Canvas, frame: &Frame, window: &Window, map: &GridMap) {
    let steepness = |q: f32| f64::from(q).max(1e-300).ln();
    let lowest = window.q.iter().filter(|q| **q > 0.0);
    let lowest = lowest.fold(1.0_f32, |least, q| least.min(*q));
    let depth = (-steepness(lowest)).max(1e-6);
    let cells = (window.cell_m / CELL_M).round().max(1.0) as i32;
    for (i, (&q, &kind)) in window.q.iter().zip(&window.cells).enumerate() {
        if kind == WindowCell::Obstacle || q <= 0.0 {
            continue;
        }
        let colour = match kind {
            WindowCell::Goal => palette::WINDOW,
            _ => palette::field((1.0 + steepness(q) / depth) as f32),
        };
        let (x, y) = window_cell(window, i);
        for (dx, dy) in (0..cells * cells).map(|k| (k % cells, k / cells)) {
            let (x, y) = (x * cells + dx, y * cells + dy);
            if matches!(map.get(x, y), MapCell::Free | MapCell::Unknown) && in_frame(frame, x, y) {
                canvas.cell(frame.pixel(x, y), frame.cell_px, colour);
            }
        }
    }
}

/// Draws arrows along −∇p, and the border of the window.
pub(super) fn arrows(canvas: &mut Canvas, frame: &Frame, window: &Window) {
    let cells = window.cell_m / CELL_M;
    let length = (ARROW_STEP as f64 * cells * 0.62 * f64::from(frame.cell_px)) as f32;
    let thickness = (frame.cell_px as f32 * 0.2).max(0.8);
    for y in (1..FIELD_SIDE - 1).step_by(ARROW_STEP) {
        for x in (1..FIELD_SIDE - 1).step_by(ARROW_STEP) {
            let Some((dx, dy)) = direction(window, x, y) else {
                continue;
            };
            let (column, row) = window_cell(window, y * FIELD_SIDE + x);
            let centre = |cell: i32| (f64::from(cell) + 0.5) * cells;
            let middle = frame.spot(centre(column), centre(row));
            if frame.holds(middle) {
                arrow(canvas, middle, (dx, -dy), length, thickness);
            }
        }
    }
    let corner = |x: i32, y: i32| frame.spot(f64::from(x) * cells, f64::from(y) * cells);
    let side = FIELD_SIDE as i32;
    let (x, y) = (window.origin_x, window.origin_y);
    let border = [
        corner(x, y),
        corner(x + side, y),
        corner(x + side, y + side),
        corner(x, y + side),
    ];
    let clipped = border.map(|(x, y)| {
        (
            x.clamp(frame.left as f32, (frame.left + frame.width()) as f32),
            y.clamp(frame.top as f32, (frame.top + frame.height()) as f32),
        )
    });
    canvas.outline(&clipped, 1.2, palette::WINDOW.alpha(0.7));
}

/// Draws an arrow of `length` pixels, centred on a spot, along a unit vector of the page.
pub(super) fn arrow(
    canvas: &mut Canvas,
    (x, y): Spot,
    (dx, dy): Spot,
    length: f32,
    thickness: f32,
) {
    let colour = palette::WINDOW.alpha(0.75);
    let half = length / 2.0;
    let (tip, tail) = (
        (x + dx * half, y + dy * half),
        (x - dx * half, y - dy * half),
    );
    let head = (length * 0.42).max(2.5);
    let wing = |side: f32| {
        (
            tip.0 - head * dx + side * 0.45 * head * dy,
            tip.1 - head * dy - side * 0.45 * head * dx,
        )
    };
    let neck = (tip.0 - head * 0.8 * dx, tip.1 - head * 0.8 * dy);
    canvas.line(&[tail, neck], thickness, colour);
    canvas.polygon(&[tip, wing(1.0), wing(-1.0)], colour);
}

/// Returns the unit vector of ∇q in a free cell; `None` where q is flat.
pub(super) fn direction(window: &Window, x: usize, y: usize) -> Option<(f32, f32)> {
    let at = |x: usize, y: usize| f64::from(window.q[y * FIELD_SIDE + x]);
    if window.cells[y * FIELD_SIDE + x] != WindowCell::Free {
        return None;
    }
    let (gx, gy) = (at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1));
    let norm = gx.hypot(gy);
    (norm > 0.0).then(|| ((gx / norm) as f32, (gy / norm) as f32))
}

/// Draws the skeleton: a line between neighbouring skeleton cells of 20 cm.
pub(super) fn skeleton(canvas: &mut Canvas, frame: &Frame, map: &GridMap) {
    let colour = palette::SKELETON.alpha(1.0);
    let width = (frame.cell_px as f32 * 0.3).max(1.3);
    for ends in links(frame, map) {
        let line = ends.map(|(x, y)| skeleton_middle(frame, x, y));
        canvas.line(&line, width, colour);
    }
}

/// Returns the pairs of neighbouring skeleton cells, in units of 20 cm.
pub(super) fn links<'a>(
    frame: &Frame,
    map: &'a GridMap,
) -> impl Iterator<Item = [(i32, i32); 2]> + use<'a> {
    let on =
        |x: i32, y: i32| map.on_skeleton(2 * x, 2 * y) && map.get(2 * x, 2 * y) == MapCell::Free;
    let (x0, y0) = (frame.origin_x.div_euclid(2), frame.origin_y.div_euclid(2));
    let (x1, y1) = (x0 + frame.columns / 2, y0 + frame.rows / 2);
    let cells = (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| (x, y)));
    cells
        .filter(move |&(x, y)| on(x, y))
        .flat_map(move |(x, y)| {
            let to = [(1, 0), (0, 1), (1, 1), (-1, 1)].into_iter();
            to.filter(move |&(dx, dy)| {
                // A diagonal is a link only if no corner cell joins its ends.
                let round = dx * dy != 0 && (on(x + dx, y) || on(x, y + dy));
                on(x + dx, y + dy) && !round
            })
            .map(move |(dx, dy)| [(x, y), (x + dx, y + dy)])
        })
}

/// Returns the middle of a skeleton cell.
pub(super) fn skeleton_middle(frame: &Frame, x: i32, y: i32) -> Spot {
    frame.spot(f64::from(2 * x + 1), f64::from(2 * y + 1))
}

/// Draws the path, coloured by time, with a white outline.
pub(super) fn path(canvas: &mut Canvas, frame: &Frame, path: &[Stamped]) {
    let spots: Vec<Spot> = path.iter().map(|p| frame.metres(p.x_m, p.y_m)).collect();
    let width = (frame.cell_px as f32 * 0.5).clamp(1.6, 3.0);
    canvas.line(&spots, width + 2.0, palette::PAGE.alpha(0.75));
    let last = path.last().map_or(1.0, |p| f64::from(p.time_ms)).max(1.0);
    let piece = spots.len().div_ceil(PATH_SHADES).max(1);
    for start in (0..spots.len().saturating_sub(1)).step_by(piece) {
        let end = (start + piece + 1).min(spots.len());
        let share = f64::from(path[start].time_ms) / last;
        canvas.line(
            &spots[start..end],
            width,
            palette::time(share as f32).alpha(1.0),
        );
    }
}

/// Draws another path as a thin line.
pub(super) fn line(canvas: &mut Canvas, frame: &Frame, path: &[Stamped], colour: palette::Rgb) {
    let spots: Vec<Spot> = path.iter().map(|p| frame.metres(p.x_m, p.y_m)).collect();
    canvas.line(&spots, THIN, colour.alpha(1.0));
}

/// Draws a diamond on every residual frontier.
pub(super) fn residual(canvas: &mut Canvas, frame: &Frame, residual: &[(f64, f64)]) {
    for &(x_m, y_m) in residual {
        diamond(canvas, frame.metres(x_m, y_m));
    }
}

/// Draws the mark of a residual frontier.
pub(super) fn diamond(canvas: &mut Canvas, spot: Spot) {
    canvas.polygon(&rhomb(spot, 7.0), palette::PAGE.alpha(1.0));
    canvas.polygon(&rhomb(spot, 5.2), palette::RESIDUE.alpha(1.0));
}

/// Draws the mark of a residual frontier that is not worth the trip.
pub(super) fn hollow_diamond(canvas: &mut Canvas, spot: Spot) {
    diamond(canvas, spot);
    canvas.polygon(&rhomb(spot, 2.8), palette::PAGE.alpha(1.0));
}

fn rhomb((x, y): Spot, r: f32) -> [Spot; 4] {
    [(x, y - r), (x + r, y), (x, y + r), (x - r, y)]
}

/// Draws a ring at the start and an arrowhead at the end of the path.
pub(super) fn ends(canvas: &mut Canvas, frame: &Frame, path: &[Stamped]) {
    if let (Some(first), Some(last)) = (path.first(), path.last()) {
        let size = (frame.metre_px() * 0.25).clamp(6.0, 12.0);
        ring(canvas, frame.metres(first.x_m, first.y_m), size * 0.72);
        head(canvas, frame.metres(last.x_m, last.y_m), last.yaw_rad, size);
    }
}

/// Draws the mark of the start.
pub(super) fn ring(canvas: &mut Canvas, spot: Spot, radius: f32) {
    canvas.disc(spot, radius + 2.0, palette::PAGE.alpha(1.0));
    canvas.disc(spot, radius, palette::START.alpha(1.0));
    canvas.disc(spot, radius * 0.45, palette::PAGE.alpha(1.0));
}

/// Draws the mark of the end, in the direction of the robot.
pub(super) fn head(canvas: &mut Canvas, (x, y): Spot, yaw_rad: f64, size: f32) {
    let point = |turn: f64, reach: f32| {
        let (s, c) = (yaw_rad + turn).sin_cos();
        (x + reach * c as f32, y - reach * s as f32)
    };
    let shape = [
        point(0.0, size),
        point(2.5, size * 0.9),
        point(core::f64::consts::PI, size * 0.35),
        point(-2.5, size * 0.9),
    ];
    canvas.outline(&shape, 4.0, palette::PAGE.alpha(1.0));
    canvas.polygon(&shape, palette::INK.alpha(1.0));
}

fn window_cell(window: &Window, i: usize) -> (i32, i32) {
    (
        window.origin_x + (i % FIELD_SIDE) as i32,
        window.origin_y + (i / FIELD_SIDE) as i32,
    )
}

fn in_frame(frame: &Frame, x: i32, y: i32) -> bool {
    (0..frame.columns).contains(&(x - frame.origin_x))
        && (0..frame.rows).contains(&(y - frame.origin_y))
}
