//! The height of the ground: samples on a grid, bilinear in between.
//!
//! Sample (i, j) sits at the centre of its pixel. A grey value v is the height
//! `z_min + v / v_max (z_max − z_min)`; where 0 or the greatest value means "no surface", the remaining values span the
//! same range. A patch between four samples is ground only if all four have a surface. Metres.

use super::image::Image;

/// Ground heights.
#[derive(Clone, Debug, PartialEq)]
pub struct Elevation {
    width: usize,
    height: usize,
    resolution_m: f64,
    origin_m: [f64; 2],
    /// Metres; NaN where there is no surface. Row by row from the least y.
    heights_m: Vec<f64>,
}

/// How grey values become heights.
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
        for row in image.samples.chunks_exact(image.width).rev() {
            heights_m.extend(
                row.iter()
                    .map(|v| scale.height_m(*v, image.full).unwrap_or(f64::NAN)),
            );
        }
        Self {
            width: image.width,
            height: image.height,
            resolution_m,
            origin_m,
            heights_m,
        }
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

    /// Height of the ground at a point, metres; `None` over a hole or outside of the image. In the outermost half
    /// pixel the border's height continues level.
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

    /// Heights at the corners of the patch between samples (i, j) and (i+1, j+1): least y first, least x first.
    /// Samples beyond the border repeat the border's.
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
