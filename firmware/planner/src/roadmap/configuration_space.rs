//! The configuration space: cells whose centre is at least the robot's radius away from the centre
//! of every obstacle cell.
//!
//! A cell is *passable* if no obstacle cell lies in the disc of the robot's radius around it, or if
//! the robot has been there; unknown cells obstruct nothing. All planning (skeleton, local grid)
//! works on passable cells. A cell that the fence forbids is an obstacle. So a gap that the robot
//! does not fit through is no way, and a door of 0.8 m keeps a lane of two or three cells.
//!
//! Bit-parallel: 32 columns at a time over rows of 64 bits.
//!
//! Units: map cells.

use crate::geometry::CELL_M;
use crate::grid::{wrapped, wrapped_mut};
use crate::map::Tiles;
use crate::map::rows::{HALO, Line};
use crate::math;

/// Greatest radius of a footprint, cells; less than a line's halo.
pub const MOST_RADIUS: usize = 6;
/// Rows kept at a time: those of a disc, rounded up to a power of two.
const RING: usize = (2 * MOST_RADIUS + 1).next_power_of_two();

/// The rows of the map around the present one.
#[derive(Debug, Default)]
struct Ring {
    lines: [Line; RING],
    /// The last row that was put and has an obstacle, if any has.
    last: Option<i32>,
}

/// The robot's footprint for planning: a disc. Its row dy covers the columns −h..=h.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    /// The half widths h, by |dy|.
    half_widths: [Option<u8>; MOST_RADIUS + 1],
    reach: i32,
}

impl Footprint {
    /// Makes the disc of the cells whose centres are nearer than `radius_m`, at most
    /// [`MOST_RADIUS`] cells.
    #[must_use]
    #[inline(never)]
    pub fn new(radius_m: f32) -> Self {
        let radius = (radius_m / CELL_M).clamp(0.5, MOST_RADIUS as f32);
        // A little less, so that 0.30 m is three cells and not a rounding error more.
        let radius2 = radius * radius - 1e-3;
        let mut half_widths = [None; MOST_RADIUS + 1];
        let mut reach = 0;
        for (dy, half) in half_widths.iter_mut().enumerate() {
            let rest = radius2 - (dy * dy) as f32;
            if rest >= 0.0 {
                *half = u8::try_from(math::floor(math::sqrt(rest))).ok();
                reach = dy as i32;
            }
        }
        Self { half_widths, reach }
    }

    /// Returns how far the disc reaches up and down, cells.
    #[must_use]
    pub const fn reach(&self) -> i32 {
        self.reach
    }

    /// Returns half the disc's width `dy` cells up or down; `None` beyond it.
    #[must_use]
    pub fn half_width(&self, dy: i32) -> Option<i32> {
        let row = usize::try_from(dy.abs()).ok()?;
        self.half_widths.get(row)?.map(i32::from)
    }

    /// Returns the cells of a row whose disc holds one of some cells. `rows` returns those of the
    /// two rows so many rows away. The disc's rows get narrower from its middle outwards: the cells
    /// found so far are widened by the difference, and by the rest at the end.
    #[inline(always)]
    pub(crate) fn near(&self, rows: impl Fn(usize) -> u64) -> u64 {
        let (mut found, mut half) = (0, 0);
        for (dy, &width) in (0..=self.reach as usize).zip(&self.half_widths) {
            let width = width.unwrap_or(0);
            found = widen(found, half.max(width) - width);
            half = width;
            found |= rows(dy);
        }
        widen(found, half)
    }
}

impl Ring {
    #[inline(always)]
    fn get(&self, row: i32) -> Line {
        *wrapped(&self.lines, row as usize)
    }

    #[inline(always)]
    fn put(&mut self, row: i32, line: Line) {
        *wrapped_mut(&mut self.lines, row as usize) = line;
        if line.around != 0 {
            self.last = Some(row);
        }
    }

    /// Returns the cells of a row whose disc holds an obstacle. In open space no row near has one.
    #[inline(always)]
    fn blocked(&self, row: i32, footprint: &Footprint) -> u64 {
        match self.last {
            Some(last) if last >= row - footprint.reach => self.blocked_near(row, footprint),
            _ => 0,
        }
    }

    /// Returns the same as [`Self::blocked`]. It is long and called from three places, so it is not
    /// inlined.
    #[inline(never)]
    fn blocked_near(&self, row: i32, footprint: &Footprint) -> u64 {
        footprint.near(|dy| {
            let dy = dy as i32;
            self.get(row - dy).around | self.get(row + dy).around
        })
    }
}

#[inline(always)]
fn widen(row: u64, by: u8) -> u64 {
    if row == 0 {
        return 0;
    }
    (0..by).fold(row, |wide, _| wide | wide << 1 | wide >> 1)
}

/// The classes of 32 cells of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Strip {
    /// The robot's centre may be in the cell.
    pub passable: u32,
    /// The cell was never measured.
    pub unknown: u32,
    /// The cell is an obstacle or a drop.
    pub obstacle: u32,
}

/// Calls `visit` with the rows `y..y + height` of the 32 columns from `x` on, in order.
pub fn for_each_strip<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    footprint: &Footprint,
    (x, y): (i32, i32),
    height: i32,
    mut visit: impl FnMut(i32, Strip),
) {
    let mut reader = tiles.reader(x - HALO);
    let mut ring = Ring::default();
    for row in y - footprint.reach..y + footprint.reach {
        ring.put(row, reader.line(row));
    }
    for row in y..y + height {
        ring.put(row + footprint.reach, reader.line(row + footprint.reach));
        let here = ring.get(row);
        let blocked = (ring.blocked(row, footprint) >> HALO) as u32;
        visit(
            row,
            Strip {
                passable: !blocked | (here.visited & !here.obstacle()),
                unknown: here.unknown,
                obstacle: here.obstacle(),
            },
        );
    }
}

/// Returns true if the robot's centre may be in a cell: [`for_each_strip`] for one cell, slower.
pub fn is_passable<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    footprint: &Footprint,
    cell: crate::geometry::Cell,
) -> bool {
    let stands = |cell| !tiles.planned_class(cell).is_open();
    if tiles.row(cell.x, cell.y).visited() & 1 == 1 {
        return !stands(cell);
    }
    (-footprint.reach..=footprint.reach).all(|dy| {
        let half = footprint
            .half_widths
            .get(dy.unsigned_abs() as usize)
            .copied()
            .flatten();
        half.is_none_or(|half| {
            (-i32::from(half)..=i32::from(half)).all(|dx| {
                let near = crate::geometry::Cell {
                    x: cell.x + dx,
                    y: cell.y + dy,
                };
                !stands(near)
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Cell;
    use crate::map::Class;

    fn scattered() -> Tiles<9, 24> {
        let mut tiles = Tiles::new();
        tiles.reset();
        let mut seed = 1u32;
        for _ in 0..300 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let cell = Cell {
                x: (seed >> 8) as i32 % 90 - 40,
                y: (seed >> 20) as i32 % 60 - 30,
            };
            let class = if seed >> 4 & 3 == 0 {
                Class::Obstacle
            } else {
                Class::Free
            };
            let _ = tiles.set(cell, class);
        }
        tiles
    }

    #[test]
    fn strips_agree_with_the_cell_by_cell_twin() {
        let mut tiles = scattered();
        strips_agree(&tiles);
        let corners = [(-1.3, -2.0), (3.1, 0.4), (1.7, 2.2)];
        let corners = corners.map(|(x_m, y_m)| crate::geometry::Point { x_m, y_m });
        tiles.set_fence(&crate::fence::Fence::new().no_go(&corners));
        strips_agree(&tiles);
    }

    fn strips_agree(tiles: &Tiles<9, 24>) {
        for radius in [0.1, 0.15, 0.2, 0.3, 0.35, 0.45] {
            let footprint = Footprint::new(radius);
            for x in [-40, -7, 32] {
                for_each_strip(tiles, &footprint, (x, -31), 62, |y, strip| {
                    for k in 0..32 {
                        let cell = Cell { x: x + k, y };
                        assert_eq!(
                            strip.passable >> k & 1 == 1,
                            is_passable(tiles, &footprint, cell),
                            "radius {radius}, {cell:?}"
                        );
                        assert_eq!(
                            strip.unknown >> k & 1 == 1,
                            tiles.planned_class(cell) == Class::Unknown
                        );
                    }
                });
            }
        }
    }

    /// With the 3-AT's radius, a gap of n free cells between two walls leaves n − 4 lanes.
    #[test]
    fn doors_of_five_cells_and_more_stay_open() {
        for gap in 3..9 {
            let mut tiles: Tiles<9, 24> = Tiles::new();
            tiles.reset();
            for x in 0..30 {
                let open = (10..10 + gap).contains(&x);
                tiles
                    .set(
                        Cell { x, y: 5 },
                        if open { Class::Free } else { Class::Obstacle },
                    )
                    .unwrap();
            }
            let mut lanes = 0;
            for_each_strip(&tiles, &Footprint::new(0.30), (0, 5), 1, |_, strip| {
                lanes = (strip.passable & 0x3fff_ffff & !3).count_ones() as i32;
            });
            assert_eq!(lanes, (gap - 4).max(0), "gap {gap}");
        }
    }
}
