//! Gain: the unexplored area that the robot may see from a place, within some metres.
//!
//! Rays lead from the place through free and unexplored cells up to the first closed one. A cell k
//! along a ray stands for k · w cells of the square around the place, where w is the spacing of the
//! slopes:
//!
//! ```text
//! x = k, y = k · s   ⇒   dx dy = k dk ds        gain = Σ rays Σ k [unexplored] · k · w
//! ```
//!
//! So no cell counts twice, and no cell needs a mark. What lies behind unexplored cells is taken
//! for visible. Most gaps that a robot does not fit through are pieces of a wall that were not seen
//! yet. So unexplored cells behind such a gap whose far side was not seen count only as deep as the
//! robot is wide. Counted in full, they promise several square metres outside of a building, and
//! the robot drives there for nothing (measured: docs/MEASURED.md, "Unexplored cells behind narrow
//! gaps").
//!
//! What the map has no room for counts nothing: a frontier from which only that would be seen is no
//! goal. So a robot whose map is full explores what its tiles still take, and then ends.
//!
//! A round reads the squares of up to 25 places, so their cells lie in words of 32: a core of 32
//! bits takes several instructions to shift a longer word. A square and its gain take 53,000
//! instructions on the chip (measured: "Words of a square of cells").
//!
//! Units: map cells, square metres.

mod opening;

use crate::geometry::{CELL_M, Cell};
use crate::grid::masked;
use crate::map::Tiles;
use crate::path::rays::{RAYS, RAYS_A_SIDE, along, ray};

/// Greatest length of a ray, cells: half a row of the map's reader.
const MOST_REACH: i32 = 31;
/// Side of the square of cells around the place.
const SIDE: usize = 2 * MOST_REACH as usize + 1;
/// Rows in memory: one more than the square has, so that a mask keeps an index inside.
const ROWS: usize = SIDE + 1;
/// The place in its square.
const MIDDLE: Cell = Cell {
    x: MOST_REACH,
    y: MOST_REACH,
};

/// Words along a row of the square.
const WORDS: usize = 2;

/// The unexplored and the closed ones of 32 cells in a row.
type Pair = [u32; 2];

/// What is around a place.
pub(crate) struct View {
    /// The square's rows, from the least x on.
    rows: [[Pair; WORDS]; ROWS],
    /// Distance that the robot's centre keeps from obstacles, cells.
    clearance: i32,
    /// Length of the rays, cells.
    reach: i32,
}

impl View {
    /// Reads the map around a cell, up to `reach_m` metres, for a robot that keeps its centre
    /// `clearance` cells from every obstacle.
    pub(crate) fn of<const TILES: usize, const SLOTS: usize>(
        tiles: &Tiles<TILES, SLOTS>,
        from: Cell,
        reach_m: f32,
        clearance: i32,
    ) -> Self {
        let mut reader = tiles.reader(from.x - MOST_REACH).of_room(true);
        let mut rows = [[[0; 2]; WORDS]; ROWS];
        for (y, pairs) in rows.iter_mut().enumerate().take(SIDE) {
            let row = reader.row(from.y - MOST_REACH + y as i32);
            let (unknown, closed) = (row.unknown(), row.obstacle());
            *pairs = [0, 32].map(|x| [(unknown >> x) as u32, (closed >> x) as u32]);
        }
        Self {
            rows,
            clearance,
            reach: ((reach_m / CELL_M) as i32).min(MOST_REACH),
        }
    }

    /// Returns the unexplored area that may be seen, square metres.
    pub(crate) fn gain_m2(&self) -> f32 {
        self.along_m2((0..RAYS).map(ray))
    }

    /// Returns the unexplored area that may be seen in the quarter of all directions around this
    /// one, square metres.
    pub(crate) fn gain_towards_m2(&self, (dx, dy): (i32, i32)) -> f32 {
        let is_ahead = move |ray: &(i32, i32)| {
            let along = ray.0 * dx + ray.1 * dy;
            let across = ray.0 * dy - ray.1 * dx;
            along > across.abs()
        };
        self.along_m2((0..RAYS).map(ray).filter(is_ahead))
    }

    /// Returns the unexplored area along these rays, square metres.
    fn along_m2(&self, rays: impl Iterator<Item = (i32, i32)>) -> f32 {
        let cells: i32 = rays.map(|ray| self.along(ray)).sum();
        cells as f32 * (2.0 * CELL_M * CELL_M / RAYS_A_SIDE as f32)
    }

    /// Returns the unexplored cells that a ray stands for: Σ k over its runs of unexplored cells.
    fn along(&self, ray: (i32, i32)) -> i32 {
        let Some(rows) = self.rows.as_flattened().first_chunk::<{ ROWS * WORDS }>() else {
            return 0;
        };
        // Where the run of unexplored cells begins; 0 outside of a run.
        let (mut before, mut first) = (0, 0);
        let (mut x, mut y) = (16 * MIDDLE.x + 8, 16 * MIDDLE.y + 8);
        let beyond = self.reach + 1;
        // A range with `..=` would cost ten instructions more a cell.
        for k in 1..beyond {
            (x, y) = (x + ray.0, y + ray.1);
            let [unknown, closed] = *masked(rows, place(x >> 4, y >> 4));
            let bit = 1 << (x >> 4 & 31);
            // Most cells are explored and free.
            if unknown & bit == 0 {
                if first > 0 {
                    before += sum(first, k);
                    first = 0;
                }
            } else if first == 0 {
                first = k;
            }
            if closed & bit != 0 {
                return before;
            }
        }
        if first == 0 {
            return before;
        }
        let nearest = first + 2 * self.clearance + 1;
        let is_cut = nearest < beyond && self.is_near(along(MIDDLE, ray, first));
        before + sum(first, if is_cut { nearest } else { beyond })
    }

    /// Returns true if the robot's centre is too near to an obstacle in a cell: one is within the
    /// clearance along both axes.
    fn is_near(&self, cell: Cell) -> bool {
        let around = |at: i32, most: i32| {
            let (least, last) = (at - self.clearance, at + self.clearance);
            (least.max(0), last.min(most))
        };
        let ((left, right), (top, bottom)) = (around(cell.x, 63), around(cell.y, SIDE as i32 - 1));
        let rows = self.rows.iter().take(bottom as usize + 1);
        let [low, high] = rows.skip(top as usize).fold([0; 2], |all, row| {
            let [[_, low], [_, high]] = *row;
            [all[0] | low, all[1] | high]
        });
        let closed = u64::from(high) << 32 | u64::from(low);
        closed & u64::MAX << left & u64::MAX >> (63 - right) != 0
    }
}

/// Returns the place of a cell's pair in the square.
#[inline(always)]
const fn place(x: i32, y: i32) -> usize {
    (y * WORDS as i32 + (x >> 5)) as usize
}

/// Returns the sum of the numbers from `first` to the one before `beyond`.
const fn sum(first: i32, beyond: i32) -> i32 {
    (beyond - first) * (first + beyond - 1) / 2
}

#[cfg(test)]
mod tests;
