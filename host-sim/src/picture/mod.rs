//! `run.png`: the map, the skeleton, the last window's field and the path coloured by time, with a legend; what is known of loops
//! and rails; in an uneven world the true ground beside it, in the same frame, and under both what the planner made of the last
//! window.
//!
//! A map cell is a square of whole pixels, two to six but for the smallest maps, so that the map stays crisp; everything else is antialiased. North
//! is up.

mod canvas;
mod ground;
mod layers;
mod legend;
mod loops;
mod palette;
mod panels;
mod text;

use crate::report::GridMap;
use crate::report::tum::Stamped;
use crate::trial::relief::Relief;
use crate::trial::route::Route;
use crate::trial::snapshot::Window;
use canvas::{Canvas, Spot};
use panels::Strip;

pub use ground::Ground;

/// Pixels around everything.
const MARGIN: i32 = 28;
/// Pixels for the two lines of title.
const HEADER: i32 = 78;
/// Pixels for the scale bar under the map.
const FOOTER: i32 = 46;
/// Pixels for the legend to the right.
const PANEL: i32 = 236;
/// The legend's least height, pixels; and with the ground's keys.
const PANEL_HEIGHT: [i32; 2] = [470, 770];
/// Pixels from one line of the legend to the next.
const LINE: i32 = 29;
/// Pixels between two maps side by side.
const GAP: i32 = 24;
/// The least width of the map's part, so that the title fits.
const LEAST_WIDTH: i32 = 420;
/// Cells of unknown around the map.
const RIM: i32 = 3;
/// The picture's side that a map of any size should not pass by much, pixels.
const GOOD_SIDE: i32 = 1_500;
/// The same where two maps lie side by side.
const GOOD_SIDE_OF_TWO: i32 = 1_000;

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
    /// Heights and preferences in it.
    pub relief: Option<&'a Relief>,
    /// Frontiers that were left, metres.
    pub residue: &'a [(f64, f64)],
    /// Where the planner was going.
    pub route: Option<&'a Route>,
    /// Where loops were given up, metres.
    pub given_up: &'a [(f64, f64)],
    /// The true ground, in an uneven world.
    pub ground: Option<Ground<'a>>,
    /// A map that the page must have room for too, so that the pictures of a series are of one size.
    pub room_for: Option<&'a GridMap>,
}

/// A rectangle of map cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Extent {
    x: i32,
    y: i32,
    width: i32,
    height: i32,
}

impl Extent {
    fn of(map: &GridMap) -> Self {
        Self {
            x: map.origin_x,
            y: map.origin_y,
            width: map.width as i32,
            height: map.height as i32,
        }
    }

    fn is_empty(self) -> bool {
        self.width == 0 || self.height == 0
    }

    /// The least rectangle around two; one without cells counts for nothing.
    fn with(self, other: Self) -> Self {
        if self.is_empty() {
            return other;
        } else if other.is_empty() {
            return self;
        }
        let (x, y) = (self.x.min(other.x), self.y.min(other.y));
        Self {
            x,
            y,
            width: (self.x + self.width).max(other.x + other.width) - x,
            height: (self.y + self.height).max(other.y + other.height) - y,
        }
    }
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
    /// A map of this extent, drawn so that `good_side` pixels are enough for it if they can be.
    fn around(extent: Extent, good_side: i32) -> Self {
        let side = |cells: i32| cells.max(1) + 2 * RIM;
        let (columns, rows) = (side(extent.width), side(extent.height));
        let longest = columns.max(rows);
        // A closet is drawn larger, so that its marks do not cover it.
        let cell_px = (good_side / longest)
            .clamp(2, 6)
            .max((LEAST_WIDTH / longest).min(14));
        Self {
            left: MARGIN + (LEAST_WIDTH - columns * cell_px).max(0) / 2,
            top: HEADER,
            cell_px,
            origin_x: extent.x - RIM,
            origin_y: extent.y - RIM,
            columns,
            rows,
        }
    }

    /// The frame of what is drawn.
    fn of(scene: &Scene<'_>) -> Self {
        let map = Extent::of(scene.map);
        let map = scene
            .room_for
            .map_or(map, |room| map.with(Extent::of(room)));
        match scene.ground {
            None => Self::around(map, GOOD_SIDE),
            Some(ground) => Self::around(map.with(ground.extent()), GOOD_SIDE_OF_TWO),
        }
    }

    /// The same to the right of this one.
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
    let page = Canvas::new(width.unsigned_abs(), height.unsigned_abs(), palette::PAGE);
    let Some(mut canvas) = page else {
        return Vec::new();
    };
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
    legend::title(&mut canvas, scene);
    legend::scale_bar(&mut canvas, &frame);
    legend::panel(&mut canvas, maps + 32, scene);
    canvas.png().unwrap_or_default()
}

/// What the robot made of it.
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
    layers::residue(canvas, frame, scene.residue);
    if let Some(route) = scene.route {
        loops::route(canvas, frame, route);
    }
    loops::given_up(canvas, frame, scene.given_up);
    layers::ends(canvas, frame, scene.path);
}

#[cfg(test)]
mod tests;
