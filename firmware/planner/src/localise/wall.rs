//! The piece of wall in a square of 5 × 5 cells: its place and its normal.
//!
//! ```text
//! C = Σ (c − c̄)(c − c̄)ᵀ / n over the obstacles c of the square
//! normal = eigenvector of the least eigenvalue of C
//! place  = mean of the obstacles of the inner 3 × 3 cells, or of the square if there are none
//! ```
//!
//! | spread of the obstacles | constraint |
//! | --- | --- |
//! | along a line of one or two cells | across the line |
//! | compact: a pole | in both directions |
//! | neither: a corner, clutter | none |
//!
//! The normal needs the whole square: a staircase of cells has no direction in three columns. The
//! two faces of a thin wall are no line in the square; there the inner cells alone are taken.
//!
//! Units: map cells, from the centre of the square.

use crate::grid::masked;
use crate::localise::symmetric::Eigen;
use crate::map::neighbourhood::SQUARE_SIDE;

/// A spread with a smaller variance along than this is compact, square cells. Three cells in a row
/// have 0.67.
const COMPACT: f32 = 0.5;
/// A spread is along a line if the variance across is at most this, square cells. Two rows have
/// 0.25.
const THICK: f32 = 0.26;
/// The inner cells of the square.
pub(super) const INNER: u32 = 0b01110 << 5 | 0b01110 << 10 | 0b01110 << 15;

/// Number of the cells of a row, sum of their columns, sum of their squared columns.
static ROWS: [[u8; 3]; 32] = rows();

#[expect(
    clippy::indexing_slicing,
    reason = "computed while compiling: an index out of range is a compile error"
)]
const fn rows() -> [[u8; 3]; 32] {
    let mut rows = [[0; 3]; 32];
    let mut row = 0;
    while row < 32 {
        let mut column = 0;
        while column < SQUARE_SIDE as u8 {
            if row >> column & 1 == 1 {
                rows[row][0] += 1;
                rows[row][1] += column;
                rows[row][2] += column * column;
            }
            column += 1;
        }
        row += 1;
    }
    rows
}

/// A piece of wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wall {
    /// Its place.
    pub(super) place: (f32, f32),
    /// Its unit normal; `None` for a pole.
    pub(super) normal: Option<(f32, f32)>,
}

/// Moments of cells: number, and sums over columns and rows.
#[derive(Clone, Copy, Default)]
struct Moments {
    n: i32,
    x: i32,
    y: i32,
    xx: i32,
    xy: i32,
    yy: i32,
}

/// The direction of a spread.
enum Direction {
    /// A line with this normal.
    Normal(f32, f32),
    Compact,
    Neither,
}

impl Moments {
    fn of(square: u32) -> Self {
        let mut sum = Self::default();
        for row in 0..SQUARE_SIDE {
            let bits = square >> (SQUARE_SIDE * row) & 31;
            let [n, x, xx] = masked(&ROWS, bits as usize).map(i32::from);
            sum.n += n;
            sum.x += x;
            sum.y += row * n;
            sum.xx += xx;
            sum.xy += row * x;
            sum.yy += row * row * n;
        }
        sum
    }

    /// Returns the mean from the centre of the square.
    fn mean(&self) -> (f32, f32) {
        let middle = (SQUARE_SIDE / 2) as f32;
        let part = 1.0 / self.n as f32;
        (self.x as f32 * part - middle, self.y as f32 * part - middle)
    }

    fn direction(&self) -> Direction {
        let part = 1.0 / (self.n * self.n) as f32;
        let spread = |sum: i32, a: i32, b: i32| (self.n * sum - a * b) as f32 * part;
        let eigen = Eigen::of([
            spread(self.xx, self.x, self.x),
            spread(self.xy, self.x, self.y),
            spread(self.yy, self.y, self.y),
        ]);
        if eigen.greatest() <= COMPACT {
            return Direction::Compact;
        }
        if eigen.least() > THICK || eigen.root < 0.5 * COMPACT {
            return Direction::Neither;
        }
        let [x, y] = eigen.least_direction();
        Direction::Normal(x, y)
    }
}

/// Returns the wall in a square; `None` without obstacles, and if they have no direction.
pub(super) fn wall(square: u32) -> Option<Wall> {
    if square == 0 {
        return None;
    }
    let (all, inner) = (Moments::of(square), Moments::of(square & INNER));
    let direction = match all.direction() {
        Direction::Neither => match inner.n {
            // A part of a corner is no pole.
            0..3 => return None,
            _ => match inner.direction() {
                Direction::Compact => return None,
                direction => direction,
            },
        },
        direction => direction,
    };
    let normal = match direction {
        Direction::Normal(x, y) => Some((x, y)),
        Direction::Compact => None,
        Direction::Neither => return None,
    };
    let place = if inner.n > 0 { inner } else { all }.mean();
    Some(Wall { place, normal })
}

#[cfg(test)]
mod tests {
    use super::wall;

    /// Returns the square of a picture, least y first.
    fn square(rows: [&str; 5]) -> u32 {
        let cells = rows.iter().flat_map(|row| row.bytes());
        (0..)
            .zip(cells)
            .map(|(k, cell)| u32::from(cell == b'#') << k)
            .sum()
    }

    #[test]
    fn a_straight_wall_constrains_across_it() {
        let east_west =
            wall(square([".....", ".....", ".....", "#####", "....."])).expect("a wall");
        assert_eq!(east_west.place, (0.0, 1.0));
        let (x, y) = east_west.normal.expect("a line");
        assert!(x.abs() < 1e-6 && (y.abs() - 1.0).abs() < 1e-6);
        let north_south =
            wall(square(["..#..", "..#..", "..#..", "..#..", "..#.."])).expect("a wall");
        let (x, y) = north_south.normal.expect("a line");
        assert!((x.abs() - 1.0).abs() < 1e-6 && y.abs() < 1e-6);
        let diagonal = wall(square(["#....", ".#...", "..#..", "...#.", "....#"])).expect("a wall");
        let (x, y) = diagonal.normal.expect("a line");
        assert!((x + y).abs() < 1e-5, "{x} {y}");
    }

    #[test]
    fn the_other_face_of_a_thin_wall_does_not_shift_the_place() {
        let thin = wall(square(["#####", ".....", "#####", ".....", "....."])).expect("a wall");
        assert_eq!(thin.place, (0.0, 0.0));
    }

    #[test]
    fn a_pole_constrains_in_both_directions_and_a_corner_in_none() {
        let pole = wall(square([".....", ".....", "..#..", ".....", "....."])).expect("a pole");
        assert_eq!((pole.place, pole.normal), ((0.0, 0.0), None));
        assert_eq!(
            wall(square(["..###", "..#..", "..#..", ".....", "....."])),
            None
        );
        assert_eq!(wall(square(["#####"; 5])), None);
        assert_eq!(wall(0), None);
    }

    /// The normal agrees with the direct solution in f64 for every square of one thick line.
    #[test]
    fn the_normal_is_the_least_eigenvector() {
        for degrees in 0..180_u32 {
            let angle = f64::from(degrees).to_radians();
            let (sin, cos) = angle.sin_cos();
            let cells = (0..25).filter(|k| {
                let (x, y) = (f64::from(k % 5 - 2), f64::from(k / 5 - 2));
                (y * cos - x * sin).abs() <= 0.5
            });
            let square = cells.map(|k| 1_u32 << k).sum();
            let Some((x, y)) = wall(square).and_then(|it| it.normal) else {
                panic!("a line at {degrees}")
            };
            let off = (f64::from(x) * cos + f64::from(y) * sin).abs();
            assert!(off < 0.25, "{degrees}: {off}");
        }
    }
}
