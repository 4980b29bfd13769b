//! The true ground beside the robot's map: heights as colours, lit from the north-west, and ground
//! that the robot must not drive on.
//!
//! Colour shows the height, from the lowest ground of the world to the highest. Light shows the
//! slope: `1 + 0.9 (dz/dx · (−1, 1)/√2)`, clamped. Contours are 0.5 m apart, or 0.1 m if the ground
//! spans less than 1.5 m. Walls, ground that rises too steeply, and ground that falls too steeply
//! have the colours of a correct map. Unreachable ground is greyed. Units: metres.

use fieldline_planner::geometry::Cell;

use super::Frame;
use super::canvas::Canvas;
use super::palette::{self, Rgb};
use crate::metrics::{CellArea, GroundTruth, TrueClass, Truth, truth};
use crate::report::grid_map::CELL_M;
use crate::world::World;

/// Least span of heights with contours 0.5 m apart, metres.
const FINE_M: f64 = 1.5;
/// Share of grey in the colour of unreachable ground.
const GREYED: f32 = 0.72;

/// The ground of a run in an uneven world.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    world: &'a World,
    truth: &'a GroundTruth,
    start_z_m: f64,
    span_m: [f64; 2],
}

impl<'a> Ground<'a> {
    /// Makes it from a world and the true classes of its cells. Heights are relative to the start.
    #[must_use]
    pub fn new(world: &'a World, truth: &'a GroundTruth, start_z_m: f64) -> Self {
        let span_m = world.elevation().and_then(|ground| ground.span_m());
        Self {
            world,
            truth,
            start_z_m,
            span_m: span_m.unwrap_or_default().map(|z| z - start_z_m),
        }
    }

    /// Returns the map cells of the world.
    pub(super) fn area(&self) -> CellArea {
        *self.truth.area()
    }

    /// Returns the lowest and highest ground above the start, metres.
    pub(super) fn span_m(&self) -> [f64; 2] {
        self.span_m
    }

    /// Returns the distance between two contours, metres.
    pub(super) fn contour_m(&self) -> f64 {
        let [low, high] = self.span_m;
        if high - low < FINE_M { 0.1 } else { 0.5 }
    }

    fn height_m(&self, x: i32, y: i32) -> Option<f64> {
        let [x, y] = [x, y].map(|k| (f64::from(k) + 0.5) * CELL_M);
        self.world.ground_m(x, y).map(|z| z - self.start_z_m)
    }

    /// Returns the colour of a cell; `None` outside of the world.
    fn colour(&self, x: i32, y: i32) -> Option<Rgb> {
        let cell = Cell { x, y };
        self.truth.area().index(cell)?;
        if truth(self.world, cell) != Truth::Free {
            return Some(palette::OBSTACLE);
        }
        let Some(height_m) = self.height_m(x, y) else {
            return Some(palette::NEGATIVE);
        };
        let bare = self.lit(height_m, x, y);
        Some(match self.truth.class(cell) {
            TrueClass::Traversable => bare,
            TrueClass::Obstacle => palette::STEEP_UP,
            TrueClass::Negative => palette::NEGATIVE,
            TrueClass::Either => palette::STEEP_BOTH,
            TrueClass::Unjudged => greyed(bare),
        })
    }

    /// Returns the colour of a height, with light and contours.
    fn lit(&self, height_m: f64, x: i32, y: i32) -> Rgb {
        let [low, high] = self.span_m;
        let share = (height_m - low) / (high - low).max(1e-9);
        let beside = |dx: i32, dy: i32| self.height_m(x + dx, y + dy).unwrap_or(height_m);
        let east = (beside(1, 0) - beside(-1, 0)) / (2.0 * CELL_M);
        let north = (beside(0, 1) - beside(0, -1)) / (2.0 * CELL_M);
        let light = 1.0 + 0.9 * core::f64::consts::FRAC_1_SQRT_2 * (east - north);
        // Contours lie half an interval off zero, so that level ground at the height of the start
        // is not all contour.
        let band = |z: f64| (z / self.contour_m() + 0.5).floor();
        let contour = band(height_m) != band(beside(1, 0)) || band(height_m) != band(beside(0, -1));
        let light = light.clamp(0.55, 1.2) * if contour { 0.84 } else { 1.0 };
        palette::height(share as f32).lit(light as f32)
    }
}

/// Returns the colour of unreachable ground.
pub(super) fn greyed(bare: Rgb) -> Rgb {
    bare.mix(palette::UNKNOWN, GREYED)
}

/// Draws every cell of the ground.
pub(super) fn cells(canvas: &mut Canvas, frame: &Frame, ground: &Ground<'_>) {
    for row in 0..frame.rows {
        for column in 0..frame.columns {
            let (x, y) = (frame.origin_x + column, frame.origin_y + row);
            let colour = ground.colour(x, y).unwrap_or(palette::UNKNOWN);
            canvas.cell(frame.pixel(x, y), frame.cell_px, colour);
        }
    }
}
