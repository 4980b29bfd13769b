//! A grid of cells that are free, wall or unknown.
//!
//! Cell (i, j) covers [i, i+1) × [j, j+1) times the resolution, counted from the origin; row 0 is
//! the least y. Unknown cells and everything outside count as solid: the map does not say that a
//! robot can be there.

use super::image::Image;

/// Content of a cell of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Nothing: a robot may stand here, and a laser beam passes.
    Free,
    /// A wall.
    Wall,
    /// Not known to the map; solid.
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

impl GridCell {
    /// Index of this cell in a grid of `[columns, rows]`, row by row; `None` outside.
    #[must_use]
    pub(crate) fn index(self, [width, height]: [usize; 2]) -> Option<usize> {
        let i = usize::try_from(self.i).ok().filter(|i| *i < width)?;
        let j = usize::try_from(self.j).ok().filter(|j| *j < height)?;
        Some(j * width + i)
    }
}

/// Thresholds of a pixel's occupancy, in the `map_server` convention; unknown lies between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    /// A pixel with more occupancy is wall.
    pub occupied: f64,
    /// A pixel with less occupancy is free.
    pub free: f64,
    /// True if white is occupied.
    pub negate: bool,
    /// True if values of 0 to 100 are occupancies in percent, and any other is unknown.
    pub is_raw: bool,
}

/// A grid of classes.
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
    /// `width` and `height` are in cells, `resolution_m` is the side of a cell, and `origin_m` is
    /// the corner of least x and y.
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

    /// Reads an image: `occupancy = 1 − shade` (or the shade if negated), compared with the
    /// thresholds.
    #[must_use]
    pub fn from_image(
        image: &Image,
        thresholds: Thresholds,
        resolution_m: f64,
        origin_m: [f64; 2],
    ) -> Self {
        let (width, height) = (image.width, image.height);
        let mut grid = Self::filled(width, height, resolution_m, origin_m, Class::Unknown);
        // A raw value is the mean of the channels.
        let scale = if thresholds.is_raw {
            image.channels.max(1)
        } else {
            1
        };
        for row in 0..height {
            for i in 0..width {
                let pixel = row * width + i;
                if !image.is_transparent(pixel) {
                    let class = thresholds.class(image.samples[pixel] / scale, image.full);
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

    /// Index of a cell in [`Self::classes`], or `None` outside.
    #[must_use]
    pub fn index(&self, cell: GridCell) -> Option<usize> {
        cell.index([self.width, self.height])
    }

    /// Class of a cell; unknown outside.
    #[must_use]
    pub fn class(&self, cell: GridCell) -> Class {
        self.index(cell)
            .map_or(Class::Unknown, |index| self.classes[index])
    }

    /// Returns true if a cell is wall, unknown or outside.
    #[must_use]
    pub fn is_solid(&self, cell: GridCell) -> bool {
        self.class(cell) != Class::Free
    }

    /// Classes of all cells, row by row from the least y.
    #[must_use]
    pub fn classes(&self) -> &[Class] {
        &self.classes
    }

    /// Returns the bounds of the free cells, metres: least x and y, greatest x and y; `None` if
    /// there are none.
    #[must_use]
    pub fn free_bounds_m(&self) -> Option<[f64; 4]> {
        let free = self.classes.iter().enumerate();
        let free = free.filter(|(_, class)| **class == Class::Free);
        let cells = free.map(|(k, _)| [k % self.width, k / self.width]);
        let bounds = cells.fold(None, |bounds, [i, j]| {
            let [i0, j0, i1, j1] = bounds.unwrap_or([i, j, i, j]);
            Some([i0.min(i), j0.min(j), i1.max(i), j1.max(j)])
        });
        let [x, y] = self.origin_m;
        bounds.map(|[i0, j0, i1, j1]| {
            let side = |origin: f64, cells: usize| origin + cells as f64 * self.resolution_m;
            [side(x, i0), side(y, j0), side(x, i1 + 1), side(y, j1 + 1)]
        })
    }

    /// Returns the part that is not unknown with a rim of one cell; all of it if all is unknown.
    ///
    /// Every cell keeps its place. Outside of a grid is unknown too, so nothing is lost.
    #[must_use]
    pub fn known_part(&self) -> Self {
        let known = |(_, class): &(usize, &Class)| **class != Class::Unknown;
        let places = self.classes.iter().enumerate().filter(known);
        let places = places.map(|(k, _)| [k % self.width, k / self.width]);
        let bounds = places.fold(None, |bounds, [i, j]| {
            let [i0, j0, i1, j1] = bounds.unwrap_or([i, j, i, j]);
            Some([i0.min(i), j0.min(j), i1.max(i), j1.max(j)])
        });
        let Some([i0, j0, i1, j1]) = bounds else {
            return self.clone();
        };
        let (i0, j0) = (i0.saturating_sub(1), j0.saturating_sub(1));
        let (i1, j1) = ((i1 + 2).min(self.width), (j1 + 2).min(self.height));
        let row = |j: usize| &self.classes[j * self.width + i0..j * self.width + i1];
        let corner = [i0, j0].map(|cells| cells as f64 * self.resolution_m);
        Self {
            width: i1 - i0,
            height: j1 - j0,
            resolution_m: self.resolution_m,
            origin_m: [0, 1].map(|k| self.origin_m[k] + corner[k]),
            classes: (j0..j1).flat_map(row).copied().collect(),
        }
    }

    /// Returns the grid turned counter-clockwise about a point, with cells along the axes again.
    /// Each new cell has the class of the old one that its centre lies in.
    #[must_use]
    pub fn turned(&self, about_m: [f64; 2], yaw_rad: f64) -> Self {
        let (sin, cos) = yaw_rad.sin_cos();
        let turn = |sin: f64, [x, y]: [f64; 2]| {
            let (dx, dy) = (x - about_m[0], y - about_m[1]);
            [
                about_m[0] + cos * dx - sin * dy,
                about_m[1] + sin * dx + cos * dy,
            ]
        };
        let sides = [self.width, self.height].map(|cells| cells as f64 * self.resolution_m);
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[u, v]| {
            let corner = [
                self.origin_m[0] + u * sides[0],
                self.origin_m[1] + v * sides[1],
            ];
            turn(sin, corner)
        });
        let least = [0, 1].map(|k| corners.iter().map(|it| it[k]).fold(f64::INFINITY, f64::min));
        let most = [0, 1].map(|k| {
            corners
                .iter()
                .map(|it| it[k])
                .fold(f64::NEG_INFINITY, f64::max)
        });
        // A corner that is a rounding error beyond a cell needs no cell more.
        let cells =
            [0, 1].map(|k| ((most[k] - least[k]) / self.resolution_m - 1e-6).ceil() as usize);
        let mut grid = Self::filled(cells[0], cells[1], self.resolution_m, least, Class::Unknown);
        for j in 0..cells[1] as i64 {
            for i in 0..cells[0] as i64 {
                let cell = GridCell { i, j };
                let [x, y] = turn(-sin, grid.centre(cell));
                grid.set(cell, self.class(self.cell_at(x, y)));
            }
        }
        grid
    }

    /// Changes a cell; does nothing outside.
    pub fn set(&mut self, cell: GridCell, class: Class) {
        if let Some(index) = self.index(cell) {
            self.classes[index] = class;
        }
    }
}

impl Thresholds {
    /// Class of a sample, of which `full` is white.
    pub(super) fn class(&self, sample: u32, full: u32) -> Class {
        let dark = if self.negate { sample } else { full - sample };
        let occupancy = match (self.is_raw, sample) {
            (true, 0..=100) => f64::from(sample) / 100.0,
            (true, _) => return Class::Unknown,
            (false, _) => f64::from(dark) / f64::from(full),
        };
        if occupancy > self.occupied {
            Class::Wall
        } else if occupancy < self.free {
            Class::Free
        } else {
            Class::Unknown
        }
    }
}
