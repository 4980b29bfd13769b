//! The area's cells and their potential levels \[Kenealy15, 3.1\].
//!
//! ```text
//! never sensed (0)  <  covered by a sensor  <  visited by a robot
//! obstacle: one of its map cells is an obstacle
//! ```
//!
//! A cell is covered if at least half of its map cells are known. The map gives both planes, so a
//! cell that a peer covered counts as soon as the peer's tile is in the map.
//!
//! Departs from \[Kenealy15, 3.1\]: a level does not count how often a cell was covered, because no
//! equation of the paper uses the number.
//!
//! Units: cells of the area, numbered from its least corner; metres where a name says so.

use crate::config::Area;
use crate::geometry::{CELL_M, Point};
use crate::grid::masked;
use crate::map::Tiles;
use crate::map::rows::RowReader;
use crate::math;

/// Most cells of the area along a side: the bits of a row.
pub(super) const SIDE: usize = 64;

/// Most rows of 64 map cells that are read in a step, which bounds its time: an area of 32 × 32 m.
const MOST_ROWS: i32 = 1_600;

/// A bit of each cell: row by row, least x in the lowest bit.
pub(super) type Plane = [u64; SIDE];

/// The levels of an area.
#[derive(Debug)]
pub(crate) struct Levels {
    area: Area,
    /// Map cells along a side of a cell.
    scale: i32,
    /// Cells along x and y.
    across: i32,
    up: i32,
    /// The next row to take over: strip by strip, and row by row in a strip.
    next: i32,
    covered: Plane,
    obstacle: Plane,
    visited: Plane,
}

impl Levels {
    /// Returns the levels of an area that nothing has sensed, with cells of at least `least_scale`
    /// map cells along a side.
    pub(super) const fn new(area: Area, least_scale: i32) -> Self {
        let (across, up) = (area.across as i32, area.up as i32);
        let longest = if across > up { across } else { up };
        let needed = (longest + SIDE as i32 - 1) / SIDE as i32;
        let scale = if needed > least_scale {
            needed
        } else {
            least_scale
        };
        Self {
            area,
            scale,
            across: (across + scale - 1) / scale,
            up: (up + scale - 1) / scale,
            next: 0,
            covered: [0; SIDE],
            obstacle: [0; SIDE],
            visited: [0; SIDE],
        }
    }

    /// Forgets which cells a robot visited. The map says what is covered.
    pub(super) const fn forget_visits(&mut self) {
        self.visited = [0; SIDE];
    }

    /// Returns the side of a cell, metres.
    pub(super) const fn cell_m(&self) -> f32 {
        self.scale as f32 * CELL_M
    }

    /// Returns the number of cells.
    pub(super) const fn cells(&self) -> u32 {
        (self.across * self.up) as u32
    }

    /// Returns the number of cells with a level.
    pub(super) fn covered_cells(&self) -> u32 {
        self.covered.iter().map(|row| row.count_ones()).sum()
    }

    /// Returns the place of a point, in cells from the area's least corner.
    pub(super) fn place(&self, point: Point) -> Place {
        let corner = self.area.least.corner();
        Place {
            x: (point.x_m - corner.x_m) / self.cell_m(),
            y: (point.y_m - corner.y_m) / self.cell_m(),
        }
    }

    /// Returns the rows of the area.
    pub(super) fn rows(&self) -> core::ops::Range<i32> {
        0..self.up
    }

    /// Returns the cells of a row that are covered, obstacles included.
    pub(super) fn covered(&self, y: i32) -> u64 {
        row(&self.covered, y)
    }

    /// Returns the obstacles of a row.
    pub(super) fn obstacle(&self, y: i32) -> u64 {
        row(&self.obstacle, y)
    }

    /// Returns the cells of a row that a robot visited.
    pub(super) fn visited(&self, y: i32) -> u64 {
        row(&self.visited, y)
    }

    /// Returns the cells of a row that nothing has sensed.
    pub(super) fn never_sensed(&self, y: i32) -> u64 {
        !self.covered(y) & (u64::MAX >> (SIDE as i32 - self.across))
    }

    /// Raises the level of the cell in which a robot is: this one or a peer.
    pub(super) fn visit(&mut self, robot: Point) {
        let at = self.place(robot);
        let (x, y) = (math::floor(at.x), math::floor(at.y));
        if (0..self.across).contains(&x)
            && let Some(row) = row_mut(&mut self.visited, y)
        {
            *row |= 1 << x;
        }
    }

    /// Takes over what the map knows of the area, or of as much of it as a step has time for: a
    /// large area takes several steps.
    pub(super) fn update<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
    ) {
        // Cells of the area in 64 map cells.
        let strip = SIDE as i32 / self.scale;
        let strips = (self.across + strip - 1) / strip;
        let mut left = (MOST_ROWS / self.scale).min(strips * self.up);
        while left > 0 {
            let (x, from) = (self.next / self.up * strip, self.next % self.up);
            let rows = from..self.up.min(from + left);
            left -= rows.end - from;
            self.next = (self.next + rows.end - from) % (strips * self.up);
            self.update_strip(tiles, (x, strip.min(self.across - x)), rows);
        }
    }

    /// Takes over what the map knows of `width` columns of the area from `x` on.
    fn update_strip<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        (x, width): (i32, i32),
        rows: core::ops::Range<i32>,
    ) {
        let mut reader = tiles.reader(self.area.least.x + x * self.scale);
        let strip = (u64::MAX >> (SIDE as i32 - width)) << x;
        for y in rows {
            let (covered, obstacle) = self.row_of(&mut reader, y, width);
            for (plane, bits) in [(&mut self.covered, covered), (&mut self.obstacle, obstacle)] {
                if let Some(row) = row_mut(plane, y) {
                    *row = *row & !strip | bits << x;
                }
            }
        }
    }

    /// Returns the covered cells and the obstacles of a row, from the reader's column on.
    fn row_of<const TILES: usize, const SLOTS: usize>(
        &self,
        reader: &mut RowReader<'_, TILES, SLOTS>,
        y: i32,
        width: i32,
    ) -> (u64, u64) {
        let first = self.area.least.y + y * self.scale;
        let mut known = [0_u32; SIDE];
        let mut stones = 0;
        for row in (first..first + self.scale).map(|row| reader.row(row)) {
            stones |= row.obstacle();
            let counts = known.iter_mut().zip(pieces(!row.unknown(), self.scale));
            counts
                .take(width as usize)
                .for_each(|(count, bits)| *count += bits.count_ones());
        }
        let enough = (self.scale * self.scale) as u32;
        let (mut covered, mut obstacle) = (0, 0);
        let cells = known.iter().zip(pieces(stones, self.scale));
        for (k, (known, stone)) in cells.take(width as usize).enumerate() {
            let is_obstacle = stone != 0;
            obstacle |= u64::from(is_obstacle) << k;
            covered |= u64::from(is_obstacle || 2 * known >= enough) << k;
        }
        (covered, obstacle)
    }
}

/// A place in the area, in cells from its least corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) x: f32,
    pub(super) y: f32,
}

/// Returns groups of `width` bits of a word, the lowest first.
fn pieces(word: u64, width: i32) -> impl Iterator<Item = u64> {
    let mask = u64::MAX >> (u64::BITS as i32 - width);
    let mut word = word;
    core::iter::from_fn(move || {
        let piece = word & mask;
        word = word >> (width - 1) >> 1;
        Some(piece)
    })
}

/// Returns a row of a plane; 0 outside.
fn row(plane: &Plane, y: i32) -> u64 {
    if (0..SIDE as i32).contains(&y) {
        *masked(plane, y as usize)
    } else {
        0
    }
}

fn row_mut(plane: &mut Plane, y: i32) -> Option<&mut u64> {
    plane.get_mut(usize::try_from(y).ok()?)
}
