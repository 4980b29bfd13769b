//! The fence: where the robot may be, by order of its user and not for what stands there.
//!
//! ```text
//! forbidden = cells that a polygon's side passes through
//!           ∪ cells outside of the bounds  ∪ cells inside of a no-go polygon
//! ```
//!
//! A cell is allowed only as a whole, so no polygon is too thin to be kept off. To planning a
//! forbidden cell is an obstacle ([`crate::map::Tiles::reader`]), with the same clearance; the map
//! itself, which localises the robot, has what the lasers see there. Nothing in a forbidden cell is
//! left to explore.
//!
//! A polygon is a list of corners, in either direction, without crossings. Inside is where a line
//! to the west crosses an odd number of sides.
//!
//! Invariant: a fence without polygons forbids nothing.
//! Units: metres of the map's frame, which is that of the odometry, or of the team; map cells.

use heapless::Vec;

use crate::geometry::{CELL_M, Cell, Point};
use crate::math;

/// A corner or a side that comes this near to a cell's border lies on it, cells. Corners are given
/// in f32 or in 2⁻¹⁶ m.
const ROUNDING: f32 = 0.01;

/// A polygon: its corners lie before `end` in the list, after those of the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Ring {
    end: u8,
    is_bounds: bool,
}

/// Bounds that the robot must not leave, and polygons that it must not enter.
///
/// ```
/// use fieldline_planner::{Cell, Fence, Point};
///
/// let corners = |least: f32, most: f32| {
///     [(least, least), (most, least), (most, most), (least, most)]
///         .map(|(x_m, y_m)| Point { x_m, y_m })
/// };
/// let fence = Fence::new().bounds(&corners(0.0, 6.0)).no_go(&corners(2.0, 3.0));
/// assert!(fence.allows(Cell { x: 0, y: 0 }) && fence.allows(Cell { x: 59, y: 19 }));
/// assert!(!fence.allows(Cell { x: -1, y: 0 }), "outside");
/// assert!(!fence.allows(Cell { x: 20, y: 29 }), "no go");
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fence {
    corners: Vec<Point, { Self::MOST_CORNERS }>,
    rings: Vec<Ring, { Self::MOST_POLYGONS }>,
    /// Corners and polygons that did not fit.
    left_out: bool,
}

impl Fence {
    /// Greatest number of corners of all polygons together.
    pub const MOST_CORNERS: usize = 32;
    /// Greatest number of polygons: each has three corners at least.
    pub const MOST_POLYGONS: usize = Self::MOST_CORNERS / 3;

    /// Returns a fence that forbids nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            corners: Vec::new(),
            rings: Vec::new(),
            left_out: false,
        }
    }

    /// Adds bounds: the robot stays inside of this polygon, and inside of every other one.
    #[must_use]
    pub fn bounds(self, corners: &[Point]) -> Self {
        self.with(corners, true)
    }

    /// Adds a polygon that the robot stays out of.
    #[must_use]
    pub fn no_go(self, corners: &[Point]) -> Self {
        self.with(corners, false)
    }

    fn with(mut self, corners: &[Point], is_bounds: bool) -> Self {
        let fits = self.corners.extend_from_slice(corners).is_ok();
        let end = self.corners.len() as u8;
        self.left_out |= !fits || self.rings.push(Ring { end, is_bounds }).is_err();
        self
    }

    /// Returns true if the fence forbids nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rings.is_empty()
    }

    /// Returns true if there were more corners than [`MOST_CORNERS`](Self::MOST_CORNERS), or more
    /// polygons than [`MOST_POLYGONS`](Self::MOST_POLYGONS).
    pub(crate) const fn left_out(&self) -> bool {
        self.left_out
    }

    /// Returns the polygons: the corners of each, and true for bounds.
    pub fn polygons(&self) -> impl Iterator<Item = (&[Point], bool)> {
        let mut from = 0;
        self.rings.iter().map(move |ring| {
            let end = usize::from(ring.end);
            let corners = self.corners.get(from..end).unwrap_or_default();
            from = end;
            (corners, ring.is_bounds)
        })
    }

    /// Returns true if the robot may be in a cell.
    #[must_use]
    pub fn allows(&self, cell: Cell) -> bool {
        self.is_empty() || self.row(cell.x, cell.y) & 1 == 0
    }

    /// Returns the forbidden ones of the 64 cells of row `y` from column `x` on, in the lowest bit
    /// the first.
    #[inline(never)]
    pub(crate) fn row(&self, x: i32, y: i32) -> u64 {
        let (left, low) = (x as f32, y as f32);
        let mut forbidden = 0;
        for (corners, is_bounds) in self.polygons() {
            let mut inside = 0;
            for side in sides(corners, low, low + 1.0) {
                inside ^= side.crossed(left, low + 0.5);
                if !side.is_west(left) && !side.is_east(left) {
                    forbidden |= side.touched(left, low);
                }
            }
            forbidden |= if is_bounds { !inside } else { inside };
        }
        forbidden
    }

    /// Returns a row of the 64 × `height` cells from (x, y) on if all their rows are alike: no side
    /// passes through them.
    #[inline(never)]
    pub(crate) fn steady_row(&self, (x, y): (i32, i32), height: i32) -> Option<u64> {
        let (left, low) = (x as f32, y as f32);
        let (right, top) = (left + 64.0, low + height as f32);
        let mut sides = self
            .polygons()
            .flat_map(|(corners, _)| sides(corners, low, top));
        let passes = sides.any(|Side { from, to }| {
            from.x_m.max(to.x_m) >= left
                && from.x_m.min(to.x_m) <= right
                && from.y_m.max(to.y_m) >= low
                && from.y_m.min(to.y_m) <= top
        });
        (!passes).then(|| self.row(x, y))
    }

    /// Calls `each` with the forbidden cells that border on allowed ones, in the square that
    /// reaches `reach` cells from a cell to all sides, at most 30: the rows nearest to it first.
    pub(crate) fn for_each_rim(&self, middle: Cell, reach: i32, mut each: impl FnMut(Cell)) {
        let reach = reach.clamp(0, 30);
        // The square begins in bit 1.
        let x = middle.x - reach - 1;
        let across = ((1_u64 << (2 * reach + 1)) - 1) << 1;
        for k in 0..=2 * reach {
            let dy = (k + 1) / 2 * if k % 2 == 0 { 1 } else { -1 };
            let y = middle.y + dy;
            let here = self.row(x, y);
            if here & across == 0 {
                continue;
            }
            let around = here << 1 & here >> 1 & self.row(x, y - 1) & self.row(x, y + 1);
            let mut rims = here & !around & across;
            while rims != 0 {
                let bit = rims.trailing_zeros() as i32;
                each(Cell { x: x + bit, y });
                rims &= rims - 1;
            }
        }
    }
}

/// A side of a polygon, map cells.
#[derive(Clone, Copy, Debug)]
struct Side {
    from: Point,
    to: Point,
}

/// Returns the sides of a polygon that pass through the rows from `low` to `top`, and maybe some
/// within a cell of these. The others are told in metres, which saves their divisions.
fn sides(corners: &[Point], low: f32, top: f32) -> impl Iterator<Item = Side> + '_ {
    let (low_m, top_m) = ((low - 1.0) * CELL_M, (top + 1.0) * CELL_M);
    let mut last = corners.last().copied().unwrap_or_default();
    let sides = corners
        .iter()
        .map(move |to| (core::mem::replace(&mut last, *to), *to));
    let near = sides.filter(move |(from, to)| {
        let (is_below, is_above) = (|it: &Point| it.y_m < low_m, |it: &Point| it.y_m > top_m);
        !(is_below(from) && is_below(to) || is_above(from) && is_above(to))
    });
    near.map(|(from, to)| Side {
        from: in_cells(from),
        to: in_cells(to),
    })
}

fn in_cells(point: Point) -> Point {
    Point {
        x_m: point.x_m / CELL_M,
        y_m: point.y_m / CELL_M,
    }
}

impl Side {
    /// Returns true if the side lies to the west of the 64 cells from `left` on, with one to spare.
    const fn is_west(&self, left: f32) -> bool {
        self.from.x_m.max(self.to.x_m) < left - 1.0
    }

    /// Returns true if the side lies to the east of the 64 cells from `left` on, with one to spare.
    const fn is_east(&self, left: f32) -> bool {
        self.from.x_m.min(self.to.x_m) > left + 65.0
    }

    /// Returns where the side, which is not level, crosses a level line.
    fn x_at(&self, y: f32) -> f32 {
        let part = (y - self.from.y_m) / (self.to.y_m - self.from.y_m);
        self.from.x_m + part * (self.to.x_m - self.from.x_m)
    }

    /// Returns the cells of the line at `y` whose centres lie to the east of the side.
    fn crossed(&self, left: f32, y: f32) -> u64 {
        if (self.from.y_m > y) == (self.to.y_m > y) || self.is_east(left) {
            return 0;
        }
        if self.is_west(left) {
            return u64::MAX;
        }
        from_bit(math::floor(self.x_at(y) - left + 0.5))
    }

    /// Returns the cells of the row from `low` on through which the side passes. A side on a cell's
    /// border passes through none.
    fn touched(&self, left: f32, low: f32) -> u64 {
        let (least, most) = (
            self.from.y_m.min(self.to.y_m),
            self.from.y_m.max(self.to.y_m),
        );
        if most <= low + ROUNDING || least >= low + 1.0 - ROUNDING {
            return 0;
        }
        let ends = if most - least < ROUNDING {
            [self.from.x_m, self.to.x_m]
        } else {
            [least.max(low), most.min(low + 1.0)].map(|y| self.x_at(y))
        };
        let (west, east) = (ends[0].min(ends[1]) - left, ends[0].max(ends[1]) - left);
        let first = math::floor(west + ROUNDING);
        // The last cell that begins before the side's end.
        let last = -math::floor(ROUNDING - east) - 1;
        from_bit(first) & !from_bit(last + 1)
    }
}

/// Returns the bits from `bit` on.
const fn from_bit(bit: i32) -> u64 {
    if bit <= 0 {
        u64::MAX
    } else if bit >= 64 {
        0
    } else {
        u64::MAX << bit
    }
}

#[cfg(test)]
mod tests;
