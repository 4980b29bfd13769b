//! The last window on uneven ground in four panels, as in \[Maffei20, fig. 3\]: measured heights,
//! classes of the map, preferences, potential.
//!
//! A window cell is a square of whole pixels. Heights have the colours of the true ground, from the
//! lowest measured height to the highest. Preferences are orange where they repel, violet where
//! they attract, and white at 0. The potential is coloured by ln q, light near a goal, with arrows
//! along −∇p.

use fieldline_protocol::message::FIELD_SIDE;

use super::canvas::{Canvas, Spot};
use super::palette::{self, Rgb};
use super::{GAP, Scene, layers};
use crate::report::MapCell;
use crate::report::grid_map::CELL_M;
use crate::trial::relief::Relief;
use crate::trial::snapshot::{Window, WindowCell};

/// Number of panels.
const PANELS: i32 = 4;
/// Least and greatest side of a window cell, pixels.
const CELL_PX: [i32; 2] = [3, 8];
/// Distance between arrows, window cells.
const ARROW_STEP: usize = 4;
/// Absolute preference at the ends of the colour scale.
const STRONGEST: f32 = 0.5;
/// Least span of heights that uses the whole colour scale, metres.
const LEAST_SPAN_M: f32 = 0.4;
/// Side of the window, cells.
const SIDE: i32 = FIELD_SIDE as i32;

/// Place of the row of panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Strip {
    left: i32,
    top: i32,
    cell_px: i32,
}

/// Place of a panel.
#[derive(Clone, Copy, Debug)]
struct Panel {
    left: i32,
    top: i32,
    cell_px: i32,
}

impl Strip {
    /// Makes a strip at a place, for a width of pixels.
    pub(super) fn under(left: i32, top: i32, width: i32) -> Self {
        let [least, most] = CELL_PX;
        let cell_px = ((width - (PANELS - 1) * GAP) / (PANELS * SIDE)).clamp(least, most);
        Self { left, top, cell_px }
    }

    /// Returns the width, pixels.
    pub(super) fn width(&self) -> i32 {
        PANELS * SIDE * self.cell_px + (PANELS - 1) * GAP
    }

    /// Returns the height, pixels.
    pub(super) fn height(&self) -> i32 {
        SIDE * self.cell_px
    }

    fn panel(&self, number: i32) -> Panel {
        let step = SIDE * self.cell_px + GAP;
        Panel {
            left: self.left + number * step,
            top: self.top,
            cell_px: self.cell_px,
        }
    }
}

impl Panel {
    /// Draws every cell of the window in the colour for its index.
    fn fill(&self, canvas: &mut Canvas, colour: impl Fn(usize) -> Rgb) {
        for index in 0..FIELD_SIDE * FIELD_SIDE {
            let (x, y) = (index as i32 % SIDE, index as i32 / SIDE);
            let corner = (
                self.left + x * self.cell_px,
                self.top + (SIDE - 1 - y) * self.cell_px,
            );
            canvas.cell(corner, self.cell_px, colour(index));
        }
    }

    /// Returns the spot of a point in window cells.
    fn spot(&self, x: f64, y: f64) -> Spot {
        let side = f64::from(self.cell_px);
        (
            (f64::from(self.left) + x * side) as f32,
            (f64::from(self.top) + (f64::from(SIDE) - y) * side) as f32,
        )
    }

    /// Draws the border, the caption and the robot.
    fn finish(&self, canvas: &mut Canvas, scene: &Scene<'_>, window: &Window, words: &str) {
        let side = f64::from(SIDE);
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
        let corners = corners.map(|(x, y)| self.spot(x, y));
        canvas.outline(&corners, 1.0, palette::HAIR.alpha(1.0));
        if let Some(robot) = scene.path.last() {
            let along = |metres: f64, origin: i32| metres / window.cell_m - f64::from(origin);
            let (x, y) = (
                along(robot.x_m, window.origin_x),
                along(robot.y_m, window.origin_y),
            );
            let inside = |at: f64| (0.0..=side).contains(&at);
            if inside(x) && inside(y) {
                layers::head(canvas, self.spot(x, y), robot.yaw_rad, 9.0);
            }
        }
        let at = (
            self.left as f32,
            (self.top + SIDE * self.cell_px) as f32 + 22.0,
        );
        canvas.text(at, 14.0, words, palette::INK);
    }
}

/// Draws all panels.
pub(super) fn draw(canvas: &mut Canvas, strip: &Strip, scene: &Scene<'_>) {
    let (Some(window), Some(relief)) = (scene.window, scene.relief) else {
        return;
    };
    let panel = |number| strip.panel(number);
    let span_m = span_m(relief);
    panel(0).fill(canvas, |index| height(relief, span_m, index));
    panel(1).fill(canvas, |index| class(scene, window, index));
    panel(2).fill(canvas, |index| preference(relief, window, index));
    let depth = depth(window);
    panel(3).fill(canvas, |index| potential(window, depth, index));
    arrows(canvas, &panel(3), window);
    let (least, most) = range(relief, window);
    let heights = format!(
        "last window: heights, {:+.2} m to {:+.2} m",
        span_m[0], span_m[1]
    );
    let preferences = format!("preferences, {least:+.2} (orange) to {most:+.2} (violet)");
    let potential = format!("potential, {:.0} decades of 1 − p", depth / 10_f64.ln());
    let words = [
        heights.as_str(),
        "classes, goals in blue",
        &preferences,
        &potential,
    ];
    for (number, words) in (0..).zip(words) {
        panel(number).finish(canvas, scene, window, words);
    }
}

/// Returns the lowest and highest height above the start, metres.
fn span_m(relief: &Relief) -> [f32; 2] {
    let known = || relief.heights_m.iter().copied().flatten();
    let low_m = known().reduce(f32::min).unwrap_or(0.0);
    [low_m, known().reduce(f32::max).unwrap_or(low_m)]
}

/// Returns the colour of a height, lit from the north-west.
fn height(relief: &Relief, [low_m, high_m]: [f32; 2], index: usize) -> Rgb {
    let (x, y) = (index % FIELD_SIDE, index / FIELD_SIDE);
    let at = |x: usize, y: usize| {
        let inside = x < FIELD_SIDE && y < FIELD_SIDE;
        let height_m = inside.then(|| relief.heights_m[y * FIELD_SIDE + x]);
        height_m.flatten()
    };
    let Some(here) = at(x, y) else {
        return palette::UNKNOWN;
    };
    let rise = |beside: Option<f32>| beside.map_or(0.0, |height_m| here - height_m);
    let (west, north) = (x.checked_sub(1).and_then(|x| at(x, y)), at(x, y + 1));
    let light = 1.0 + 3.0 * (rise(west) + rise(north));
    // A small span lies in the middle of the scale.
    let wide_m = (high_m - low_m).max(LEAST_SPAN_M);
    let share = 0.5 + (here - 0.5 * (low_m + high_m)) / wide_m;
    palette::height(share).lit(light.clamp(0.6, 1.2))
}

/// Returns the colour of the worst class of the map in a window cell.
fn class(scene: &Scene<'_>, window: &Window, index: usize) -> Rgb {
    if window.cells[index] == WindowCell::Goal {
        return palette::WINDOW;
    }
    let scale = (window.cell_m / CELL_M).round().max(1.0) as i32;
    let (x, y) = (
        (window.origin_x + index as i32 % SIDE) * scale,
        (window.origin_y + index as i32 / SIDE) * scale,
    );
    let held = (0..scale * scale).map(|k| scene.map.get(x + k % scale, y + k / scale));
    let order = |held: &MapCell| match held {
        MapCell::Unknown => 0,
        MapCell::Free => 1,
        MapCell::NegativeObstacle => 2,
        MapCell::Obstacle => 3,
    };
    match held.max_by_key(order).unwrap_or_default() {
        MapCell::Unknown => palette::UNKNOWN,
        MapCell::Free => palette::FREE,
        MapCell::Obstacle => palette::OBSTACLE,
        MapCell::NegativeObstacle => palette::NEGATIVE,
    }
}

/// Returns the colour of a preference; that of unknown cells where the field is not solved.
fn preference(relief: &Relief, window: &Window, index: usize) -> Rgb {
    match window.cells[index] {
        WindowCell::Obstacle => palette::UNKNOWN,
        _ => {
            let share = 0.5 + 0.5 * relief.preferences[index] / STRONGEST;
            palette::preference(share)
        }
    }
}

/// Returns the least and greatest preference where the field is solved.
fn range(relief: &Relief, window: &Window) -> (f32, f32) {
    let cells = relief.preferences.iter().zip(&window.cells);
    let solved = || {
        let free = cells.clone().filter(|(_, cell)| **cell == WindowCell::Free);
        free.map(|(epsilon, _)| *epsilon)
    };
    (
        solved().reduce(f32::min).unwrap_or(0.0),
        solved().reduce(f32::max).unwrap_or(0.0),
    )
}

/// Returns −ln q of the cell farthest from any goal.
fn depth(window: &Window) -> f64 {
    let reached = window.q.iter().filter(|q| **q > 0.0);
    let least = reached.fold(1.0_f32, |least, q| least.min(*q));
    (-f64::from(least).ln()).max(1e-6)
}

/// Returns the colour of a cell, by ln q.
fn potential(window: &Window, depth: f64, index: usize) -> Rgb {
    let q = window.q[index];
    match window.cells[index] {
        WindowCell::Obstacle => palette::UNKNOWN,
        WindowCell::Goal => palette::WINDOW,
        // No path to a goal.
        WindowCell::Free if q <= 0.0 => palette::UNKNOWN,
        WindowCell::Free => palette::potential((1.0 + f64::from(q).ln() / depth) as f32),
    }
}

/// Draws arrows along −∇p.
fn arrows(canvas: &mut Canvas, panel: &Panel, window: &Window) {
    let length = ARROW_STEP as f32 * 0.6 * panel.cell_px as f32;
    for y in (1..FIELD_SIDE - 1).step_by(ARROW_STEP) {
        for x in (1..FIELD_SIDE - 1).step_by(ARROW_STEP) {
            if let Some((dx, dy)) = layers::direction(window, x, y) {
                let middle = panel.spot(x as f64 + 0.5, y as f64 + 0.5);
                layers::arrow(canvas, middle, (dx, -dy), length, 1.1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{SIDE, Strip};

    #[test]
    fn a_strip_is_no_wider_than_the_maps_above_if_it_can_be() {
        for width in [1_000, 1_500, 1_872] {
            let strip = Strip::under(28, 500, width);
            assert!(strip.width() <= width, "{width}: {}", strip.width());
            assert!(strip.width() > width - 4 * SIDE - 1, "{width}");
        }
        assert_eq!(Strip::under(0, 0, 100).cell_px, 3);
        let strip = Strip::under(28, 500, 1_872);
        let last = strip.panel(3);
        assert_eq!(last.left + SIDE * last.cell_px, 28 + strip.width());
    }
}
