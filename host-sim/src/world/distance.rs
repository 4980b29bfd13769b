//! The exact squared distance from every cell's centre to the nearest solid cell.
//!
//! For two cells at offsets (u, v), whole numbers, the gap from the centre of one to the square of
//! the other is `½ √(H(u) + H(v))` cell sides with `H(u) = max(2|u| − 1, 0)²`. So the squared
//! field is an integer and exact. The transform runs over the columns and then over the rows, by
//! the lower envelope of the shifted copies of H: [Meijster00] with this metric instead of u².
//! H is convex, so each copy overtakes its left neighbour once; bisection finds the place.
//!
//! Everything outside of the grid is solid, so the field is also the distance to the border.
//!
//! [Meijster00]: A. Meijster, J. B. T. M. Roerdink, W. H. Hesselink, "A general algorithm for
//! computing distance transforms in linear time", 2000.

use super::occupancy::{GridCell, Occupancy};

/// Distances to the nearest solid cell.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceField {
    width: usize,
    height: usize,
    resolution_m: f64,
    /// Squared distances in half cell sides; 0 on solid cells. Row by row from the least y.
    squared: Vec<u32>,
}

/// Squared gap along one axis, in half cells, to a cell `offset` cells away.
fn gap(offset: i64) -> i64 {
    let half_cells = (2 * offset.abs() - 1).max(0);
    half_cells * half_cells
}

impl DistanceField {
    /// Computes the distances of a grid.
    #[must_use]
    pub fn new(grid: &Occupancy) -> Self {
        let (width, height) = (grid.width(), grid.height());
        let columns = column_distances(grid);
        let mut squared = Vec::with_capacity(width * height);
        let mut envelope = Envelope::default();
        for row in columns.chunks_exact(width) {
            envelope.row(row, &mut squared);
        }
        Self {
            width,
            height,
            resolution_m: grid.resolution_m(),
            squared,
        }
    }

    /// Metres from a cell's centre to the nearest solid cell; 0 on solid cells and outside.
    #[must_use]
    pub fn from_centre_m(&self, cell: GridCell) -> f64 {
        self.half_cells(cell) * 0.5 * self.resolution_m
    }

    /// A lower bound, in metres, of the distance from any point of a cell to the nearest solid
    /// cell.
    #[must_use]
    pub fn from_anywhere_m(&self, cell: GridCell) -> f64 {
        (self.half_cells(cell) - core::f64::consts::SQRT_2).max(0.0) * 0.5 * self.resolution_m
    }

    fn half_cells(&self, cell: GridCell) -> f64 {
        let index = cell.index([self.width, self.height]);
        index.map_or(0.0, |index| f64::from(self.squared[index]).sqrt())
    }
}

/// Cells from each cell to the nearest solid one in its column; the border counts as solid.
fn column_distances(grid: &Occupancy) -> Vec<u32> {
    let (width, height) = (grid.width(), grid.height());
    let mut nearest = vec![0_u32; width * height];
    for (index, class) in grid.classes().iter().enumerate() {
        let below = if index < width {
            0
        } else {
            nearest[index - width]
        };
        nearest[index] = if *class == super::Class::Free {
            below + 1
        } else {
            0
        };
    }
    for index in (0..width * height).rev() {
        let above = nearest.get(index + width).copied().unwrap_or(0);
        nearest[index] = nearest[index].min(above + 1);
    }
    nearest
}

/// Lower envelope of one row: the columns that are nearest somewhere, and where each begins.
#[derive(Default)]
struct Envelope {
    /// (column, squared gap within the column, first cell where it is nearest).
    parts: Vec<(i64, i64, i64)>,
}

impl Envelope {
    fn row(&mut self, distances: &[u32], squared: &mut Vec<u32>) {
        let width = distances.len() as i64;
        self.parts.clear();
        // The first of the two columns of solid cells just outside.
        self.push(-1, 0, width);
        for (column, distance) in distances.iter().enumerate() {
            self.push(column as i64, gap(i64::from(*distance)), width);
        }
        self.push(width, 0, width);
        let mut part = 0;
        for x in 0..width {
            while self.parts.get(part + 1).is_some_and(|next| next.2 <= x) {
                part += 1;
            }
            let (column, base, _) = self.parts[part];
            squared.push(u32::try_from(gap(x - column) + base).unwrap_or(u32::MAX));
        }
    }

    fn push(&mut self, column: i64, base: i64, width: i64) {
        while let Some(&(other, other_base, start)) = self.parts.last() {
            let nearer = |x: i64| gap(x - column) + base < gap(x - other) + other_base;
            if nearer(start) {
                self.parts.pop();
                continue;
            }
            if nearer(width - 1) {
                // The new column is nearer at `high` and not at `low`.
                let (mut low, mut high) = (start, width - 1);
                while high - low > 1 {
                    let middle = low + (high - low) / 2;
                    if nearer(middle) {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                self.parts.push((column, base, high));
            }
            return;
        }
        self.parts.push((column, base, 0));
    }
}

#[cfg(test)]
mod tests {
    use super::super::occupancy::Class;
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    /// The definition, computed cell by cell.
    fn brute(grid: &Occupancy, cell: GridCell) -> f64 {
        let (width, height) = (grid.width() as i64, grid.height() as i64);
        let mut best = i64::MAX;
        for j in -1..=height {
            for i in -1..=width {
                if grid.is_solid(GridCell { i, j }) {
                    best = best.min(gap(i - cell.i) + gap(j - cell.j));
                }
            }
        }
        (best as f64).sqrt() * 0.5 * grid.resolution_m()
    }

    #[test]
    fn it_equals_the_definition_on_random_grids() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for round in 0..60 {
            let (width, height) = (1 + rng.next_u32() % 37, 1 + rng.next_u32() % 23);
            let (width, height) = (width as usize, height as usize);
            let mut grid = Occupancy::filled(width, height, 0.05, [1.0, -2.0], Class::Free);
            for _ in 0..round {
                let i = i64::from(rng.next_u32()) % width as i64;
                let j = i64::from(rng.next_u32()) % height as i64;
                grid.set(GridCell { i, j }, Class::Wall);
            }
            let field = DistanceField::new(&grid);
            for j in -1..=height as i64 {
                for i in -1..=width as i64 {
                    let cell = GridCell { i, j };
                    assert_eq!(field.from_centre_m(cell), brute(&grid, cell), "{cell:?}");
                }
            }
        }
    }

    #[test]
    fn the_bound_is_below_the_distance_from_every_corner() {
        let mut grid = Occupancy::filled(9, 9, 0.1, [0.0, 0.0], Class::Free);
        grid.set(GridCell { i: 4, j: 4 }, Class::Unknown);
        let field = DistanceField::new(&grid);
        let cell = GridCell { i: 6, j: 6 };
        // The near corner of cell (6, 6) is 0.1·√2 away from the far corner of cell (4, 4).
        let corner = 0.1 * core::f64::consts::SQRT_2;
        assert!(field.from_anywhere_m(cell) <= corner);
        assert!((field.from_anywhere_m(cell) - corner).abs() < 1e-12);
    }
}
