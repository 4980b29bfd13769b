//! What stands where: a grid of cells that are free, wall or unknown.
//!
//! Cell (i, j) covers [i, i+1) × [j, j+1) times the resolution, counted from the origin; row 0 is the least y.
//! Unknown cells and everything outside count as solid: a robot cannot be judged on what the map does not say.

use super::image::Image;

/// What a cell of the world holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Nothing: a robot may stand here and a laser sees through.
    Free,
    /// A wall.
    Wall,
    /// The map does not say; solid.
    Unknown,
}

/// A column and row of the world's own grid, which may lie outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridCell {
    /// Column, grows with x.
    pub i: i64,
    /// Row, grows with y.
    pub j: i64,
}

/// Shades between which a pixel is unknown, in the `map_server` convention.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    /// Darker than this is wall: occupancy above it.
    pub occupied: f64,
    /// Lighter than this is free: occupancy below it.
    pub free: f64,
    /// White is occupied.
    pub negate: bool,
}

/// The grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Occupancy {
    width: usize,
    height: usize,
    resolution_m: f64,
    origin_m: [f64; 2],
    classes: Vec<Class>,
}

impl Occupancy {
    /// A grid of one class.
    ///
    /// `width` and `height` in cells, `resolution_m` the side of a cell, `origin_m` the corner of least x and y.
    #[must_use]
    pub fn filled(
        width: usize,
        height: usize,
        resolution_m: f64,
        origin_m: [f64; 2],
        class: Class,
    ) -> Self {
        Self {
            width,
            height,
            resolution_m,
            origin_m,
            classes: vec![class; width * height],
        }
    }

    /// Reads an image: `occupancy = 1 − shade` (or the shade itself where negated), compared with the thresholds.
    #[must_use]
    pub fn from_image(
        image: &Image,
        thresholds: Thresholds,
        resolution_m: f64,
        origin_m: [f64; 2],
    ) -> Self {
        let (width, height) = (image.width, image.height);
        let mut grid = Self::filled(width, height, resolution_m, origin_m, Class::Unknown);
        for row in 0..height {
            for i in 0..width {
                let pixel = row * width + i;
                if !image.is_transparent(pixel) {
                    let class = thresholds.class(image.samples[pixel], image.full);
                    grid.classes[(height - 1 - row) * width + i] = class;
                }
            }
        }
        grid
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

    /// Side of a cell, metres.
    #[must_use]
    pub fn resolution_m(&self) -> f64 {
        self.resolution_m
    }

    /// Corner of least x and y, metres.
    #[must_use]
    pub fn origin_m(&self) -> [f64; 2] {
        self.origin_m
    }

    /// The cell that holds a point.
    #[must_use]
    pub fn cell_at(&self, x_m: f64, y_m: f64) -> GridCell {
        GridCell {
            i: ((x_m - self.origin_m[0]) / self.resolution_m).floor() as i64,
            j: ((y_m - self.origin_m[1]) / self.resolution_m).floor() as i64,
        }
    }

    /// The centre of a cell, metres.
    #[must_use]
    pub fn centre(&self, cell: GridCell) -> [f64; 2] {
        [
            self.origin_m[0] + (cell.i as f64 + 0.5) * self.resolution_m,
            self.origin_m[1] + (cell.j as f64 + 0.5) * self.resolution_m,
        ]
    }

    /// Where a cell is stored, or `None` outside.
    #[must_use]
    pub fn index(&self, cell: GridCell) -> Option<usize> {
        let i = usize::try_from(cell.i).ok().filter(|i| *i < self.width)?;
        let j = usize::try_from(cell.j).ok().filter(|j| *j < self.height)?;
        Some(j * self.width + i)
    }

    /// What a cell holds; unknown outside.
    #[must_use]
    pub fn class(&self, cell: GridCell) -> Class {
        self.index(cell)
            .map_or(Class::Unknown, |index| self.classes[index])
    }

    /// Is a cell wall, unknown or outside?
    #[must_use]
    pub fn is_solid(&self, cell: GridCell) -> bool {
        self.class(cell) != Class::Free
    }

    /// All cells, row by row from the least y.
    #[must_use]
    pub fn classes(&self) -> &[Class] {
        &self.classes
    }

    /// Changes a cell; outside nothing happens.
    pub fn set(&mut self, cell: GridCell, class: Class) {
        if let Some(index) = self.index(cell) {
            self.classes[index] = class;
        }
    }
}

impl Thresholds {
    fn class(&self, sample: u32, full: u32) -> Class {
        let dark = if self.negate { sample } else { full - sample };
        let occupancy = f64::from(dark) / f64::from(full);
        if occupancy > self.occupied {
            Class::Wall
        } else if occupancy < self.free {
            Class::Free
        } else {
            Class::Unknown
        }
    }
}
