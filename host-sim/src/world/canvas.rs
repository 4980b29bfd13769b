//! Drawing of floor plans: a grid that is filled with rectangles, discs and seeded scatter, in metres.
//!
//! A cell takes a shape's class if its centre lies inside the shape. The same calls give the same cells everywhere: only
//! sums, products and comparisons are used.

use super::occupancy::{Class, GridCell, Occupancy};

/// The grid being drawn.
pub(super) struct Canvas {
    grid: Occupancy,
}

impl Canvas {
    /// Cells of 5 cm.
    const RESOLUTION_M: f64 = 0.05;

    /// A plan of `width_m` × `height_m` with its lower left corner at the frame's origin, all of one class.
    pub(super) fn new(width_m: f64, height_m: f64, class: Class) -> Self {
        let cells = |m: f64| (m / Self::RESOLUTION_M).round() as usize;
        Self {
            grid: Occupancy::filled(
                cells(width_m),
                cells(height_m),
                Self::RESOLUTION_M,
                [0.0, 0.0],
                class,
            ),
        }
    }

    /// Fills every cell whose centre satisfies `inside(x, y)`.
    pub(super) fn fill(&mut self, class: Class, inside: impl Fn(f64, f64) -> bool) {
        for j in 0..self.grid.height() as i64 {
            for i in 0..self.grid.width() as i64 {
                let cell = GridCell { i, j };
                let [x, y] = self.grid.centre(cell);
                if inside(x, y) {
                    self.grid.set(cell, class);
                }
            }
        }
    }

    /// A rectangle from (x0, y0) to (x1, y1).
    pub(super) fn rect(&mut self, class: Class, [x0, y0, x1, y1]: [f64; 4]) {
        self.fill(class, |x, y| x > x0 && x < x1 && y > y0 && y < y1);
    }

    /// Free floor.
    pub(super) fn floor(&mut self, corners: [f64; 4]) {
        self.rect(Class::Free, corners);
    }

    /// A wall, a cupboard, a desk.
    pub(super) fn block(&mut self, corners: [f64; 4]) {
        self.rect(Class::Wall, corners);
    }

    /// A round pillar, a chair, a plant.
    pub(super) fn disc(&mut self, class: Class, [cx, cy]: [f64; 2], radius: f64) {
        self.fill(class, |x, y| {
            (x - cx) * (x - cx) + (y - cy) * (y - cy) < radius * radius
        });
    }

    /// The plan.
    pub(super) fn finish(self) -> Occupancy {
        self.grid
    }
}
