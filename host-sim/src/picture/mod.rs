//! `run.png`: the map, the skeleton, the last window's field and the path coloured by time, with a legend.
//!
//! A map cell is a square of whole pixels, two to six but for the smallest maps, so that the map stays crisp; everything else is antialiased. North
//! is up.

mod canvas;
mod layers;
mod legend;
mod palette;
mod text;

use crate::report::GridMap;
use crate::report::tum::Stamped;
use crate::trial::snapshot::Window;
use canvas::{Canvas, Spot};

/// Pixels around everything.
const MARGIN: i32 = 28;
/// Pixels for the two lines of title.
const HEADER: i32 = 78;
/// Pixels for the scale bar under the map.
const FOOTER: i32 = 46;
/// Pixels for the legend to the right.
const PANEL: i32 = 236;
/// The legend's least height, pixels.
const PANEL_HEIGHT: i32 = 470;
/// The least width of the map's part, so that the title fits.
const LEAST_WIDTH: i32 = 420;
/// Cells of unknown around the map.
const RIM: i32 = 3;
/// The picture's side that a map of any size should not pass by much, pixels.
const GOOD_SIDE: i32 = 1_500;

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// First line.
    pub title: &'a str,
    /// Second line.
    pub subtitle: &'a str,
    /// The robot's map.
    pub map: &'a GridMap,
    /// Where the robot went.
    pub path: &'a [Stamped],
    /// The last window.
    pub window: Option<&'a Window>,
    /// Frontiers that were left, metres.
    pub residue: &'a [(f64, f64)],
}

/// Where the map lies on the page.
#[derive(Clone, Copy, Debug)]
struct Frame {
    left: i32,
    top: i32,
    cell_px: i32,
    origin_x: i32,
    origin_y: i32,
    columns: i32,
    rows: i32,
}

impl Frame {
    fn around(map: &GridMap) -> Self {
        let side = |cells: usize| cells.max(1) as i32 + 2 * RIM;
        let (columns, rows) = (side(map.width), side(map.height));
        let longest = columns.max(rows);
        // A closet is drawn larger, so that its marks do not cover it.
        let cell_px = (GOOD_SIDE / longest)
            .clamp(2, 6)
            .max((LEAST_WIDTH / longest).min(14));
        Self {
            left: MARGIN + (LEAST_WIDTH - columns * cell_px).max(0) / 2,
            top: HEADER,
            cell_px,
            origin_x: map.origin_x - RIM,
            origin_y: map.origin_y - RIM,
            columns,
            rows,
        }
    }

    fn width(&self) -> i32 {
        self.columns * self.cell_px
    }

    fn height(&self) -> i32 {
        self.rows * self.cell_px
    }

    /// The upper left pixel of a map cell.
    fn pixel(&self, x: i32, y: i32) -> (i32, i32) {
        (
            self.left + (x - self.origin_x) * self.cell_px,
            self.top + (self.rows - 1 - (y - self.origin_y)) * self.cell_px,
        )
    }

    /// A point in map cells (not metres).
    fn spot(&self, x: f64, y: f64) -> Spot {
        let side = f64::from(self.cell_px);
        (
            (f64::from(self.left) + (x - f64::from(self.origin_x)) * side) as f32,
            (f64::from(self.top) + (f64::from(self.rows + self.origin_y) - y) * side) as f32,
        )
    }

    /// Whether a spot lies on the map.
    fn holds(&self, (x, y): Spot) -> bool {
        let within =
            |v: f32, from: i32, length: i32| v >= from as f32 && v <= (from + length) as f32;
        within(x, self.left, self.width()) && within(y, self.top, self.height())
    }

    /// A point in metres.
    fn metres(&self, x_m: f64, y_m: f64) -> Spot {
        let cell_m = crate::report::grid_map::CELL_M;
        self.spot(x_m / cell_m, y_m / cell_m)
    }

    /// Pixels of a metre.
    fn metre_px(&self) -> f32 {
        self.cell_px as f32 / crate::report::grid_map::CELL_M as f32
    }
}

/// The PNG file of a run; empty only if the page is too large for memory.
#[must_use]
pub fn run_png(scene: &Scene<'_>) -> Vec<u8> {
    let frame = Frame::around(scene.map);
    let width = 2 * MARGIN + frame.width().max(LEAST_WIDTH) + PANEL;
    let height = HEADER + (frame.height() + FOOTER).max(PANEL_HEIGHT) + MARGIN;
    let page = Canvas::new(width.unsigned_abs(), height.unsigned_abs(), palette::PAGE);
    let Some(mut canvas) = page else {
        return Vec::new();
    };
    layers::map(&mut canvas, &frame, scene.map);
    if let Some(window) = scene.window {
        layers::field(&mut canvas, &frame, window, scene.map);
    }
    layers::skeleton(&mut canvas, &frame, scene.map);
    if let Some(window) = scene.window {
        layers::arrows(&mut canvas, &frame, window);
    }
    layers::path(&mut canvas, &frame, scene.path);
    layers::residue(&mut canvas, &frame, scene.residue);
    layers::ends(&mut canvas, &frame, scene.path);
    legend::title(&mut canvas, scene);
    legend::scale_bar(&mut canvas, &frame);
    legend::panel(&mut canvas, width - MARGIN - PANEL + 32, scene);
    canvas.png().unwrap_or_default()
}

#[cfg(test)]
mod tests;
