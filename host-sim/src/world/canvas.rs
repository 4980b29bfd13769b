//! Floor plans: a grid that is filled with rectangles, discs and seeded scatter, in metres.
//!
//! A cell takes a shape's class if its centre lies inside the shape. Only sums, products and
//! comparisons are used: the same calls give the same cells on every machine.

use super::occupancy::{Class, GridCell, Occupancy};

/// Pseudo-random number from two numbers: multiply, shift and mix.
pub(super) fn hash(a: u32, b: u32) -> u32 {
    let mut value = a
        .wrapping_mul(0x9e37_79b1)
        .wrapping_add(b.wrapping_mul(0x85eb_ca77));
    for _ in 0..2 {
        value ^= value >> 15;
        value = value.wrapping_mul(0xd168_aaad);
        value ^= value >> 13;
        value = value.wrapping_mul(0xaf72_3597);
    }
    value ^ value >> 16
}

/// Smooth noise in [−1, 1] over the plane, with features of about 1 m, and of 0.4 m at half the
/// height.
pub(super) fn roughness(x_m: f64, y_m: f64) -> f64 {
    (value_noise(x_m, y_m) + 0.5 * value_noise(2.5 * x_m + 17.0, 2.5 * y_m + 31.0)) / 1.5
}

/// Random values on the whole numbers, joined smoothly.
fn value_noise(x: f64, y: f64) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
    let (fx, fy) = (smooth(x - i), smooth(y - j));
    let at = |di: f64, dj: f64| {
        let bits = hash((i + di) as i64 as u32, (j + dj) as i64 as u32);
        f64::from(bits) / f64::from(u32::MAX) * 2.0 - 1.0
    };
    let low = at(0.0, 0.0) * (1.0 - fx) + at(1.0, 0.0) * fx;
    let high = at(0.0, 1.0) * (1.0 - fx) + at(1.0, 1.0) * fx;
    low * (1.0 - fy) + high * fy
}

/// The grid being drawn.
pub(super) struct Canvas {
    grid: Occupancy,
}

impl Canvas {
    /// Side of a cell, metres.
    pub(super) const RESOLUTION_M: f64 = 0.05;

    /// A plan of `width_m` × `height_m` in one class; its lower left corner is the frame's origin.
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
        let [width, height] = self.size_m();
        self.fill_within(class, [0.0, 0.0, width, height], inside);
    }

    /// Fills every cell that touches the rectangle from (x0, y0) to (x1, y1) and whose centre
    /// satisfies `inside(x, y)`.
    pub(super) fn fill_within(
        &mut self,
        class: Class,
        [x0, y0, x1, y1]: [f64; 4],
        inside: impl Fn(f64, f64) -> bool,
    ) {
        let (low, high) = (self.grid.cell_at(x0, y0), self.grid.cell_at(x1, y1));
        for j in low.j.max(0)..=high.j.min(self.grid.height() as i64 - 1) {
            for i in low.i.max(0)..=high.i.min(self.grid.width() as i64 - 1) {
                let cell = GridCell { i, j };
                let [x, y] = self.grid.centre(cell);
                if inside(x, y) {
                    self.grid.set(cell, class);
                }
            }
        }
    }

    /// Fills the rectangle from (x0, y0) to (x1, y1).
    pub(super) fn rect(&mut self, class: Class, [x0, y0, x1, y1]: [f64; 4]) {
        self.fill(class, |x, y| x > x0 && x < x1 && y > y0 && y < y1);
    }

    /// Clears a rectangle of free floor.
    pub(super) fn floor(&mut self, corners: [f64; 4]) {
        self.rect(Class::Free, corners);
    }

    /// Puts up a rectangular wall, cupboard or desk.
    pub(super) fn block(&mut self, corners: [f64; 4]) {
        self.rect(Class::Wall, corners);
    }

    /// Fills a disc: a pillar, a chair, a plant.
    pub(super) fn disc(&mut self, class: Class, [cx, cy]: [f64; 2], radius: f64) {
        self.fill(class, |x, y| {
            (x - cx) * (x - cx) + (y - cy) * (y - cy) < radius * radius
        });
    }

    /// Puts a wall all around the plan.
    pub(super) fn border(&mut self, thickness: f64) {
        let [width, height] = self.size_m();
        self.fill(Class::Wall, |x, y| {
            x < thickness || y < thickness || x > width - thickness || y > height - thickness
        });
    }

    /// Fills the cell that holds a point: a leg of a chair.
    pub(super) fn dot(&mut self, class: Class, [x, y]: [f64; 2]) {
        let cell = self.grid.cell_at(x, y);
        self.grid.set(cell, class);
    }

    /// Width and height, metres.
    pub(super) fn size_m(&self) -> [f64; 2] {
        [self.grid.width(), self.grid.height()].map(|cells| cells as f64 * Self::RESOLUTION_M)
    }

    /// The finished plan.
    pub(super) fn finish(self) -> Occupancy {
        self.grid
    }
}
