//! `run.png`: the map, the skeleton, the field of the last window, and the path coloured by time,
//! with a legend.
//!
//! Loops and rails are drawn if the strategy has them. In an uneven world the true ground lies
//! beside the map at the same scale, and below both the planner's view of the last window.
//!
//! A map cell is a square of whole pixels (2 to 6; up to 14 for a small map), so the map is crisp.
//! All else is antialiased. North is up.

mod canvas;
pub mod film;
mod ground;
mod layers;
mod legend;
mod loops;
mod palette;
mod panels;
mod team;
mod text;

use crate::metrics::CellArea;
use crate::report::GridMap;
use crate::report::tum::Stamped;
use crate::trial::planned_path::PlannedPath;
use crate::trial::relief::Relief;
use crate::trial::snapshot::Window;
use canvas::{Canvas, Spot};
use panels::Strip;

pub use canvas::Pixels;
pub use ground::Ground;
pub use team::{TeamScene, team_png};

/// Pixels around everything.
const MARGIN: i32 = 28;
/// Pixels for the two lines of title.
const HEADER: i32 = 78;
/// Pixels for the scale bar under the map.
const FOOTER: i32 = 46;
/// Pixels for the legend to the right.
const PANEL: i32 = 236;
/// Least height of the legend without and with the keys of the ground, pixels.
const PANEL_HEIGHT: [i32; 2] = [470, 770];
/// Pixels from one line of the legend to the next.
const LINE: i32 = 29;
/// Pixels between two maps side by side.
const GAP: i32 = 24;
/// Least width of the part with the map, pixels, so that the title fits.
const LEAST_WIDTH: i32 = 420;
/// Width of the rim of unknown cells around the map, cells.
const RIM: i32 = 3;
/// Side of the picture that a large map should fit, pixels.
const GOOD_SIDE: i32 = 1_500;
/// Side of the picture that each of two maps side by side should fit, pixels.
const GOOD_SIDE_OF_TWO: i32 = 1_000;

/// Contents of the picture.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// First line.
    pub title: &'a str,
    /// Second line.
    pub subtitle: &'a str,
    /// Map of the robot.
    pub map: &'a GridMap,
    /// Path of the robot.
    pub path: &'a [Stamped],
    /// The path as the device believed it while it drove; empty if no loops are closed.
    pub believed: &'a [Stamped],
    /// The path as the closed loops corrected it; empty if no loops are closed.
    pub corrected: &'a [Stamped],
    /// The last window.
    pub window: Option<&'a Window>,
    /// Heights and preferences in it.
    pub relief: Option<&'a Relief>,
    /// Residual frontiers, metres.
    pub residual: &'a [(f64, f64)],
    /// Residual frontiers that are not worth the trip, metres.
    pub not_worth_it: &'a [(f64, f64)],
    /// Path to the goal, tractor point and shield.
    pub planned_path: Option<&'a PlannedPath>,
    /// Places where loops were given up, metres.
    pub given_up: &'a [(f64, f64)],
    /// The true ground, in an uneven world.
    pub ground: Option<Ground<'a>>,
    /// A map that must fit on the page too, so that all pictures of a series have one size.
    pub room_for: Option<&'a GridMap>,
}

impl<'a> Scene<'a> {
    /// Makes a scene with a map and a path on it, and nothing else.
    #[must_use]
    pub const fn plain(title: &'a str, map: &'a GridMap, path: &'a [Stamped]) -> Self {
        Self {
            title,
            subtitle: "",
            map,
            path,
            believed: &[],
            corrected: &[],
            window: None,
            relief: None,
            residual: &[],
            not_worth_it: &[],
            planned_path: None,
            given_up: &[],
            ground: None,
            room_for: None,
        }
    }
}

/// The cells of a map.
fn area(map: &GridMap) -> CellArea {
    CellArea {
        x: map.origin_x,
        y: map.origin_y,
        width: map.width,
        height: map.height,
    }
}

/// Place of the map on the page.
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
    /// Makes a frame around cells; it fits `good_side` pixels unless its cells become too small.
    fn around(area: CellArea, good_side: i32) -> Self {
        let side = |cells: usize| cells.max(1) as i32 + 2 * RIM;
        let (columns, rows) = (side(area.width), side(area.height));
        let longest = columns.max(rows);
        // A small map is drawn larger, so that its marks do not cover it.
        let cell_px = (good_side / longest)
            .clamp(2, 6)
            .max((LEAST_WIDTH / longest).min(14));
        Self {
            left: MARGIN + (LEAST_WIDTH - columns * cell_px).max(0) / 2,
            top: HEADER,
            cell_px,
            origin_x: area.x - RIM,
            origin_y: area.y - RIM,
            columns,
            rows,
        }
    }

    /// Makes the frame of a scene.
    fn of(scene: &Scene<'_>) -> Self {
        let map = area(scene.map);
        let map = scene.room_for.map_or(map, |room| map.with(area(room)));
        match scene.ground {
            None => Self::around(map, GOOD_SIDE),
            Some(ground) => Self::around(map.with(ground.area()), GOOD_SIDE_OF_TWO),
        }
    }

    /// Makes the same frame to the right of this one.
    fn beside(&self) -> Self {
        Self {
            left: self.left + self.width() + GAP,
            ..*self
        }
    }

    fn width(&self) -> i32 {
        self.columns * self.cell_px
    }

    fn height(&self) -> i32 {
        self.rows * self.cell_px
    }

    /// Returns the upper left pixel of a map cell.
    fn pixel(&self, x: i32, y: i32) -> (i32, i32) {
        (
            self.left + (x - self.origin_x) * self.cell_px,
            self.top + (self.rows - 1 - (y - self.origin_y)) * self.cell_px,
        )
    }

    /// Returns the spot of a point in map cells (not metres).
    fn spot(&self, x: f64, y: f64) -> Spot {
        let side = f64::from(self.cell_px);
        (
            (f64::from(self.left) + (x - f64::from(self.origin_x)) * side) as f32,
            (f64::from(self.top) + (f64::from(self.rows + self.origin_y) - y) * side) as f32,
        )
    }

    /// Returns true if a spot lies on the map.
    fn holds(&self, (x, y): Spot) -> bool {
        let within =
            |v: f32, from: i32, length: i32| v >= from as f32 && v <= (from + length) as f32;
        within(x, self.left, self.width()) && within(y, self.top, self.height())
    }

    /// Returns the spot of a point in metres.
    fn metres(&self, x_m: f64, y_m: f64) -> Spot {
        let cell_m = crate::report::grid_map::CELL_M;
        self.spot(x_m / cell_m, y_m / cell_m)
    }

    /// Returns the pixels per metre.
    fn metre_px(&self) -> f32 {
        self.cell_px as f32 / crate::report::grid_map::CELL_M as f32
    }
}

/// Draws the PNG file of a run; empty only if the page does not fit into memory.
#[must_use]
pub fn run_png(scene: &Scene<'_>) -> Vec<u8> {
    let page = page(scene);
    page.and_then(|page| page.png()).unwrap_or_default()
}

/// Draws a run; `None` only if the page does not fit into memory.
#[must_use]
pub fn run_pixels(scene: &Scene<'_>) -> Option<Pixels> {
    page(scene).map(Canvas::into_pixels)
}

/// Draws the page of a run.
fn page(scene: &Scene<'_>) -> Option<Canvas> {
    let frame = Frame::of(scene);
    let beside = scene.ground.map(|ground| (frame.beside(), ground));
    let right = beside.map_or(frame, |(frame, _)| frame);
    let under = HEADER + frame.height() + FOOTER;
    let strip = beside.map(|_| Strip::under(MARGIN, under, right.left + right.width() - MARGIN));
    let maps = (right.left + right.width()).max(MARGIN + LEAST_WIDTH);
    let maps = strip.map_or(maps, |strip| maps.max(MARGIN + strip.width()));
    let width = maps + PANEL + MARGIN;
    let more = loops::keys(scene).len() as i32 * LINE;
    let keys = PANEL_HEIGHT[usize::from(beside.is_some())] + more;
    let drawn = strip.map_or(under, |strip| under + strip.height() + FOOTER);
    let height = drawn.max(HEADER + keys) + MARGIN;
    let mut canvas = Canvas::new(width.unsigned_abs(), height.unsigned_abs(), palette::PAGE)?;
    robots_map(&mut canvas, &frame, scene);
    if let Some((frame, ground)) = &beside {
        ground::cells(&mut canvas, frame, ground);
        layers::path(&mut canvas, frame, scene.path);
        layers::ends(&mut canvas, frame, scene.path);
        legend::caption(&mut canvas, frame, "true ground");
    }
    if let Some(strip) = &strip {
        panels::draw(&mut canvas, strip, scene);
    }
    legend::lines(&mut canvas, scene.title, scene.subtitle);
    legend::scale_bar(&mut canvas, &frame);
    legend::panel(&mut canvas, maps + 32, scene);
    Some(canvas)
}

/// Draws the map of the robot and all that lies on it.
fn robots_map(canvas: &mut Canvas, frame: &Frame, scene: &Scene<'_>) {
    layers::map(canvas, frame, scene.map);
    if let Some(window) = scene.window {
        layers::field(canvas, frame, window, scene.map);
    }
    loops::rails(canvas, frame, scene.map);
    layers::skeleton(canvas, frame, scene.map);
    if let Some(window) = scene.window {
        layers::arrows(canvas, frame, window);
    }
    layers::path(canvas, frame, scene.path);
    layers::line(canvas, frame, scene.believed, palette::BELIEVED);
    layers::line(canvas, frame, scene.corrected, palette::CORRECTED);
    layers::residual(canvas, frame, scene.residual);
    for &(x_m, y_m) in scene.not_worth_it {
        layers::hollow_diamond(canvas, frame.metres(x_m, y_m));
    }
    if let Some(planned_path) = scene.planned_path {
        loops::planned_path(canvas, frame, planned_path);
    }
    loops::given_up(canvas, frame, scene.given_up);
    layers::ends(canvas, frame, scene.path);
}

#[cfg(test)]
mod tests;
