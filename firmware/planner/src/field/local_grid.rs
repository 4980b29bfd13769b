//! The local grid: passable cells and obstacles of the window, 61 × 61 cells around the robot.
//!
//! A window cell is `scale` × `scale` map cells (1, 2 or 4). If no centre cell is near, the window
//! grows \[Jorge15, III-B\] by a larger scale, at the same memory and time. At scales 1 and 2 a
//! window cell is passable if any of its map cells is: passable cells on the two sides of a wall
//! are five cells apart, so no wall is lost at 20 cm. At 40 cm a wall could be lost, so at scale 4
//! all map cells must be passable. That closes doors; a window of this scale is only used in open
//! space.
//!
//! Invariant: `origin` is a multiple of `scale`; bit x of row y is the window cell whose least map
//! cell is origin + scale·(x, y).
//!
//! Units: cells; metres where a name says so.

use core::ops::Range;

use crate::field::window::{ROW, SIDE};
use crate::geometry::{CELL_M, Cell, Point};
use crate::grid::bits::halve;
use crate::grid::{at, flood};
use crate::map::Tiles;
use crate::math;
use crate::roadmap::configuration_space::{Footprint, Strip, for_each_strip};

pub(crate) use crate::field::window::Rows;

/// Scales of the window, map cells along a window cell.
pub(crate) const SCALES: [i32; 3] = [1, 2, 4];

/// Cells around a robot in a blocked cell within which [`LocalGrid::free_robot`] opens a way out.
const ESCAPE_CELLS: usize = 4;

/// The window's cells.
#[derive(Clone, Debug)]
pub(crate) struct LocalGrid {
    /// Least map cell.
    pub origin: Cell,
    /// Map cells along a window cell; 0 before the first update.
    pub scale: i32,
    /// Cells where the robot's centre may be.
    pub passable: Rows,
    /// Cells that hold an obstacle.
    pub obstacle: Rows,
}

/// Returns the OR of each group of `scale` adjacent bits; 32 / scale bits remain.
fn squeeze(word: u32, scale: i32) -> u64 {
    let halve = |word| u32::from(halve(word));
    u64::from(match scale {
        1 => word,
        2 => halve(word),
        _ => halve(halve(word)),
    })
}

/// Returns the window's columns from `first` to `last`.
fn columns(first: i32, last: i32) -> u64 {
    let (first, last) = (first.max(0), last.min(SIDE as i32 - 1));
    if first > last {
        return 0;
    }
    u64::MAX << first & u64::MAX >> (63 - last)
}

impl LocalGrid {
    /// Returns an empty grid. It is all zeros, so a static one costs no flash.
    #[must_use]
    pub(crate) const fn new() -> Self {
        let origin = Cell { x: 0, y: 0 };
        Self {
            origin,
            scale: 0,
            passable: [0; SIDE],
            obstacle: [0; SIDE],
        }
    }

    /// Reads the window around the map cell `centre` from the map.
    pub(crate) fn update<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        footprint: &Footprint,
        centre: Cell,
        scale: i32,
    ) {
        let half = SIDE as i32 / 2;
        let least = |at: i32| (at.div_euclid(scale) - half) * scale;
        let origin = Cell {
            x: least(centre.x),
            y: least(centre.y),
        };
        (self.origin, self.scale) = (origin, scale);
        self.passable.fill(0);
        self.obstacle.fill(0);
        let mut blocked: Rows = [0; SIDE];
        let across = SIDE as i32 * scale;
        for block in 0..(across + 31) / 32 {
            let shift = (block * 32 / scale) as u32;
            let corner = (origin.x + block * 32, origin.y);
            for_each_strip(tiles, footprint, corner, across, |y, strip: Strip| {
                let row = ((y - origin.y) / scale) as usize;
                let put = |rows: &mut Rows, word: u32| {
                    if let Some(out) = rows.get_mut(row) {
                        *out |= squeeze(word, scale) << shift;
                    }
                };
                put(&mut self.passable, strip.passable);
                put(&mut self.obstacle, strip.obstacle);
                put(&mut blocked, !strip.passable);
            });
        }
        for (passable, blocked) in self.passable.iter_mut().zip(blocked) {
            *passable &= if scale == 4 { ROW & !blocked } else { ROW };
        }
        for row in &mut self.obstacle {
            *row &= ROW;
        }
    }

    /// Returns the window cell of a map cell; `None` outside the window.
    #[must_use]
    pub(crate) fn place(&self, cell: Cell) -> Option<(usize, usize)> {
        let bits = self.scale.checked_ilog2()?;
        let x = (cell.x - self.origin.x) >> bits;
        let y = (cell.y - self.origin.y) >> bits;
        let inside = |at: i32| (0..SIDE as i32).contains(&at);
        (inside(x) && inside(y)).then_some((x as usize, y as usize))
    }

    /// Returns the rows of a coarse cell whose least map cell is `least`, and its columns, as far
    /// as they lie in the window.
    fn span(&self, least: Cell) -> Option<(Range<usize>, u64)> {
        let bits = self.scale.checked_ilog2()?;
        let along = |at: i32, origin: i32| ((at - origin) >> bits, (at + 1 - origin) >> bits);
        let (left, right) = along(least.x, self.origin.x);
        let (low, high) = along(least.y, self.origin.y);
        let inside = |at: i32| at.clamp(0, SIDE as i32) as usize;
        Some((inside(low)..inside(high + 1), columns(left, right)))
    }

    /// Returns the map cell in the middle of a window cell.
    #[must_use]
    pub(crate) const fn cell(&self, x: usize, y: usize) -> Cell {
        let middle = self.scale / 2;
        Cell {
            x: self.origin.x + x as i32 * self.scale + middle,
            y: self.origin.y + y as i32 * self.scale + middle,
        }
    }

    /// Returns true if a window cell is set in `rows`.
    #[must_use]
    pub(crate) fn has(rows: &Rows, (x, y): (usize, usize)) -> bool {
        rows.get(y).is_some_and(|row| row >> x & 1 == 1)
    }

    /// Sets a window cell in `rows`.
    pub(crate) fn put(rows: &mut Rows, (x, y): (usize, usize)) {
        if let Some(row) = rows.get_mut(y) {
            *row |= 1 << x;
        }
    }

    /// Returns the passable cells that a path of passable cells joins to `from`, and its own;
    /// `None` if `from` lies outside the window.
    pub(crate) fn reachable(&self, from: Cell) -> Option<Rows> {
        let mut seeds: Rows = [0; SIDE];
        Self::put(&mut seeds, self.place(from)?);
        Some(flood::reach(&self.passable, &seeds))
    }

    /// Sets in `rows` the passable window cells of a coarse cell whose least map cell is `least`.
    /// Returns true if there are any.
    pub(crate) fn mark(&self, rows: &mut Rows, least: Cell) -> bool {
        let Some((span, columns)) = self.span(least) else {
            return false;
        };
        let rows = rows.iter_mut().zip(&self.passable);
        let mut any = 0;
        for (row, passable) in rows.skip(span.start).take(span.len()) {
            *row |= passable & columns;
            any |= passable & columns;
        }
        any != 0
    }

    /// Returns true if a square of the map overlaps the grid.
    pub(crate) const fn overlaps(&self, least: Cell, side: i32) -> bool {
        let reach = SIDE as i32 * self.scale;
        least.x < self.origin.x + reach
            && least.y < self.origin.y + reach
            && self.origin.x < least.x + side
            && self.origin.y < least.y + side
    }

    /// Makes the coarse cell whose least map cell is `least` impassable.
    pub(crate) fn block(&mut self, least: Cell) {
        if let Some((span, columns)) = self.span(least)
            && let Some(rows) = self.passable.get_mut(span)
        {
            rows.iter_mut().for_each(|row| *row &= !columns);
        }
    }

    /// Makes the cells nearer to `middle` than `radius_m` impassable, except those at least as far
    /// from it as the robot is.
    pub(crate) fn close_disc(&mut self, middle: Cell, radius_m: f32, robot: Cell) {
        let most2 = (radius_m * radius_m).min(middle.distance2(robot));
        let reach = math::floor(radius_m / CELL_M) + 1;
        let places = |at: i32, origin: i32| {
            let place = |at: i32| (at - origin).div_euclid(self.scale.max(1));
            place(at - reach).max(0)..=place(at + reach).min(SIDE as i32 - 1)
        };
        let (xs, ys) = (
            places(middle.x, self.origin.x),
            places(middle.y, self.origin.y),
        );
        for (x, y) in ys.flat_map(|y| xs.clone().map(move |x| (x as usize, y as usize))) {
            if self.cell(x, y).distance2(middle) < most2
                && let Some(row) = self.passable.get_mut(y)
            {
                *row &= !(1 << x);
            }
        }
    }

    /// Makes the footprint around each of `cells` (their centres) impassable, except cells at least
    /// as far from it as the robot is now: so the robot is never enclosed. Does nothing unless the
    /// scale is 1; a larger window cell does not resolve the distance.
    pub(crate) fn keep_off(
        &mut self,
        robot: Cell,
        cells: impl Iterator<Item = Point>,
        footprint: &Footprint,
    ) {
        if self.scale != 1 {
            return;
        }
        for cell in cells.map(Point::cell) {
            let (dx, dy) = (robot.x - cell.x, robot.y - cell.y);
            self.block_footprint(cell, footprint, dx * dx + dy * dy);
        }
    }

    /// Makes the footprint around a cell impassable, where it is nearer than the root of `limit2`,
    /// in cells.
    fn block_footprint(&mut self, cell: Cell, footprint: &Footprint, limit2: i32) {
        let (x, y) = (cell.x - self.origin.x, cell.y - self.origin.y);
        for dy in -footprint.reach()..=footprint.reach() {
            let row = usize::try_from(y + dy).unwrap_or(SIDE);
            let row = self.passable.get_mut(row);
            let Some((row, half)) = row.zip(footprint.half_width(dy)) else {
                continue;
            };
            // The row's cells that are nearer than the limit lie side by side.
            let nearer = |half: &i32| half * half + dy * dy < limit2;
            if let Some(half) = (0..=half).rev().find(nearer) {
                *row &= !columns(x - half, x + half);
            }
        }
    }

    /// Opens a way out if the robot's own cell is not passable: it stands nearer to an obstacle
    /// than its radius, or the map is wrong by a cell. Within [`ESCAPE_CELLS`] every cell that
    /// touches no obstacle becomes passable; if the robot's own cell touches one, every cell that
    /// is none.
    pub(crate) fn free_robot(&mut self, robot: Cell) {
        let Some(place) = self.place(robot) else {
            return;
        };
        if Self::has(&self.passable, place) {
            return;
        }
        let (x, y) = place;
        let columns = ((1_u64 << (2 * ESCAPE_CELLS + 1)) - 1) << x >> ESCAPE_CELLS;
        let obstacle = |row: usize| at(&self.obstacle, row);
        let touched = |row: usize| {
            let here = obstacle(row);
            here | here << 1 | here >> 1 | obstacle(row + 1) | obstacle(row.wrapping_sub(1))
        };
        let has_room = touched(y) >> x & 1 == 0;
        for (row, passable) in self.passable.iter_mut().enumerate() {
            if row.abs_diff(y) <= ESCAPE_CELLS {
                let taken = if has_room {
                    touched(row)
                } else {
                    obstacle(row)
                };
                *passable |= columns & !taken;
            }
        }
        Self::put(&mut self.passable, place);
        for row in &mut self.passable {
            *row &= ROW;
        }
    }
}

impl Default for LocalGrid {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns a point of the map in cells of the window with this least map cell and scale.
#[must_use]
pub(crate) fn position((origin, scale): (Cell, i32), point: Point) -> (f32, f32) {
    let side = CELL_M * scale as f32;
    let along = |at: f32, origin: i32| (at - origin as f32 * CELL_M) / side;
    (along(point.x_m, origin.x), along(point.y_m, origin.y))
}

#[cfg(test)]
mod tests;
