//! The height of the ground: samples on a grid, bilinear between them.
//!
//! Sample (i, j) lies at the centre of its pixel. A grey value v is the height
//! `z_min + v / v_max (z_max − z_min)`. If 0 or the greatest value means "no surface", the
//! remaining values span the same range. A transparent pixel has no surface either. A patch
//! between four samples is ground only if all four have a surface. Metres.
//!
//! For rays, patches are grouped into blocks of [`BLOCK`] × [`BLOCK`], and the highest point of
//! each block is stored.

use super::image::Image;
use super::occupancy::{Class, GridCell, Occupancy};

/// Patches on a side of a block.
pub(super) const BLOCK: usize = 8;

/// Ground heights.
#[derive(Clone, Debug, PartialEq)]
pub struct Elevation {
    width: usize,
    height: usize,
    resolution_m: f64,
    origin_m: [f64; 2],
    /// Metres; NaN where there is no surface. Row by row from the least y.
    heights_m: Vec<f64>,
    /// Highest point of each block; −∞ where it has no surface at all. Row by row from the least y.
    ceilings_m: Vec<f64>,
    /// Blocks in a row.
    stride: usize,
}

/// The conversion from grey values to heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightScale {
    /// Height of the least value, metres.
    pub z_min_m: f64,
    /// Height of the greatest value, metres.
    pub z_max_m: f64,
    /// The value that means "no surface".
    pub no_data: Option<u32>,
}

impl HeightScale {
    /// Height of a value in an image whose white is `full`, or `None` for "no surface".
    #[must_use]
    pub fn height_m(&self, value: u32, full: u32) -> Option<f64> {
        let (first, last) = match self.no_data {
            Some(no_data) if no_data == value => return None,
            Some(0) => (1, full),
            Some(no_data) if no_data == full => (0, full - 1),
            _ => (0, full),
        };
        let share = f64::from(value - first) / f64::from((last - first).max(1));
        Some(self.z_min_m + share * (self.z_max_m - self.z_min_m))
    }
}

impl Elevation {
    /// Reads a grey image.
    #[must_use]
    pub fn from_image(
        image: &Image,
        scale: HeightScale,
        resolution_m: f64,
        origin_m: [f64; 2],
    ) -> Self {
        let mut heights_m = Vec::with_capacity(image.samples.len());
        for row in (0..image.height).rev() {
            let pixels = row * image.width..(row + 1) * image.width;
            heights_m.extend(pixels.map(|k| {
                let height_m = scale.height_m(image.samples[k], image.full);
                let seen = height_m.filter(|_| !image.is_transparent(k));
                seen.unwrap_or(f64::NAN)
            }));
        }
        Self::new(
            [image.width, image.height],
            resolution_m,
            origin_m,
            heights_m,
        )
    }

    /// Ground from a function of x and y, sampled at the centre of every pixel; NaN is a hole.
    /// `size` is columns and rows.
    #[must_use]
    pub fn from_fn(
        size: [usize; 2],
        resolution_m: f64,
        origin_m: [f64; 2],
        height_m: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let centre = |k: usize, axis: usize| origin_m[axis] + (k as f64 + 0.5) * resolution_m;
        let heights_m = (0..size[0] * size[1])
            .map(|k| height_m(centre(k % size[0], 0), centre(k / size[0], 1)))
            .collect();
        Self::new(size, resolution_m, origin_m, heights_m)
    }

    fn new(
        [width, height]: [usize; 2],
        resolution_m: f64,
        origin_m: [f64; 2],
        heights_m: Vec<f64>,
    ) -> Self {
        let mut elevation = Self {
            width,
            height,
            resolution_m,
            origin_m,
            heights_m,
            ceilings_m: Vec::new(),
            // Along each axis there is one patch more than samples.
            stride: (width + 1).div_ceil(BLOCK),
        };
        let rows = (height + 1).div_ceil(BLOCK);
        elevation.ceilings_m = (0..elevation.stride * rows)
            .map(|k| elevation.highest(k % elevation.stride, k / elevation.stride))
            .collect();
        elevation
    }

    /// Height of the highest corner of a block's patches.
    fn highest(&self, column: usize, row: usize) -> f64 {
        let first = [column, row].map(|block| (block * BLOCK) as i64 - 1);
        let mut highest_m = f64::NEG_INFINITY;
        for j in first[1]..first[1] + BLOCK as i64 {
            for i in first[0]..first[0] + BLOCK as i64 {
                // `f64::max` of a number and NaN is the number.
                highest_m = self.patch(i, j).into_iter().fold(highest_m, f64::max);
            }
        }
        highest_m
    }

    /// Height of the highest point of a block of patches; −∞ outside. Block (0, 0) begins with
    /// patch (−1, −1).
    #[inline(always)]
    pub(super) fn ceiling_m(&self, [column, row]: [i64; 2]) -> f64 {
        let inside = (0..self.stride as i64).contains(&column) && row >= 0;
        let index = row * self.stride as i64 + column;
        match self.ceilings_m.get(index as usize) {
            Some(highest_m) if inside => *highest_m,
            _ => f64::NEG_INFINITY,
        }
    }

    /// Least and greatest height of the samples, metres; `None` if no sample has a surface.
    #[must_use]
    pub fn span_m(&self) -> Option<[f64; 2]> {
        let surface = || self.heights_m.iter().copied().filter(|h| !h.is_nan());
        Some([surface().reduce(f64::min)?, surface().reduce(f64::max)?])
    }

    /// Share of the samples that have no surface.
    #[must_use]
    pub fn missing(&self) -> f64 {
        let missing = self.heights_m.iter().filter(|height| height.is_nan());
        missing.count() as f64 / self.heights_m.len().max(1) as f64
    }

    /// Share of a map's free cells that lie beyond the image.
    #[must_use]
    pub fn uncovered(&self, map: &Occupancy) -> f64 {
        let (mut free, mut bare) = (0, 0);
        for j in 0..map.height() as i64 {
            for i in 0..map.width() as i64 {
                let cell = GridCell { i, j };
                free += usize::from(!map.is_solid(cell));
                bare += usize::from(!map.is_solid(cell) && !self.covers(map.centre(cell)));
            }
        }
        bare as f64 / free.max(1) as f64
    }

    fn covers(&self, [x_m, y_m]: [f64; 2]) -> bool {
        let u = (x_m - self.origin_m[0]) / self.resolution_m;
        let v = (y_m - self.origin_m[1]) / self.resolution_m;
        (0.0..=self.width as f64).contains(&u) && (0.0..=self.height as f64).contains(&v)
    }

    /// A map of the same frame that is free everywhere.
    #[must_use]
    pub fn floor(&self) -> Occupancy {
        let (width, height) = (self.width, self.height);
        Occupancy::filled(width, height, self.resolution_m, self.origin_m, Class::Free)
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Side of a pixel, metres.
    #[must_use]
    pub fn resolution_m(&self) -> f64 {
        self.resolution_m
    }

    /// Corner of least x and y of the first pixel, metres.
    #[must_use]
    pub fn origin_m(&self) -> [f64; 2] {
        self.origin_m
    }

    /// Height of the ground at a point, metres; `None` over a hole or outside of the image. In the
    /// outermost half pixel the border's height continues level.
    #[must_use]
    pub fn ground_m(&self, x_m: f64, y_m: f64) -> Option<f64> {
        let u = (x_m - self.origin_m[0]) / self.resolution_m;
        let v = (y_m - self.origin_m[1]) / self.resolution_m;
        if !(0.0..=self.width as f64).contains(&u) || !(0.0..=self.height as f64).contains(&v) {
            return None;
        }
        let (i, j) = ((u - 0.5).floor(), (v - 0.5).floor());
        let (fx, fy) = (u - 0.5 - i, v - 0.5 - j);
        let [a, b, c, d] = self.patch(i as i64, j as i64);
        let height = (a * (1.0 - fx) + b * fx) * (1.0 - fy) + (c * (1.0 - fx) + d * fx) * fy;
        (!height.is_nan()).then_some(height)
    }

    /// Heights at the corners of the patch between samples (i, j) and (i+1, j+1): least y first,
    /// then least x first. Samples beyond the border repeat the border's.
    pub(super) fn patch(&self, i: i64, j: i64) -> [f64; 4] {
        let column = |i: i64| i.clamp(0, self.width as i64 - 1) as usize;
        let row = |j: i64| j.clamp(0, self.height as i64 - 1) as usize * self.width;
        let (left, right, low, high) = (column(i), column(i + 1), row(j), row(j + 1));
        [
            self.heights_m[low + left],
            self.heights_m[low + right],
            self.heights_m[high + left],
            self.heights_m[high + right],
        ]
    }
}
