//! Reachability: the explored passable cells, flooded from where the robot stands.
//!
//! ```text
//! open    = coarse cells with a passable, free map cell
//! reached = the smallest set of open cells near the robot, or beside a reached cell at a side
//! ```
//!
//! The flood runs in lent memory, and in instalments if that keeps its values. Loading a tile takes
//! some 10,000 instructions, a sweep some 100,000. The flood needs a sweep for each time that its
//! way turns from up to down.
//!
//! Units: coarse cells of 20 cm, 16 × 16 in a tile.

use crate::geometry::Cell;
use crate::grid::bits::halve;
use crate::grid::{at, inside, inside_mut};
use crate::map::Tiles;
use crate::map::tiles::Extent;
use crate::roadmap::configuration_space::{Footprint, for_each_strip};

/// Side of a tile, coarse cells.
const SIDE: usize = 16;
/// Distance from the robot's cell at which the flood starts, coarse cells: the robot may stand
/// nearer to an obstacle than its radius.
const START_REACH: i32 = 2;

/// Returns the words of memory that a flood needs in a box of `slots` tiles: two planes, with a
/// word for two tiles side by side.
pub(crate) const fn scratch_words(slots: usize) -> usize {
    SIDE * slots
}

/// Returns the tiles of an extent, row by row.
pub(crate) fn tiles_of(extent: Extent) -> impl Iterator<Item = (i32, i32)> {
    let rows = extent.least.1..=extent.greatest.1;
    rows.flat_map(move |y| (extent.least.0..=extent.greatest.0).map(move |x| (x, y)))
}

/// The flood's planes, row by row, as wide as the extent. Invariant: a reached cell is open.
#[derive(Debug)]
pub(crate) struct Reachability<'a> {
    extent: Extent,
    per_row: usize,
    open: &'a mut [u32],
    reached: &'a mut [u32],
}

impl<'a> Reachability<'a> {
    /// Makes empty planes; `None` if the memory is too small, see [`scratch_words`].
    pub(crate) fn new(extent: Extent, scratch: &'a mut [u32]) -> Option<Self> {
        let reachability = Self::resume(extent, scratch)?;
        reachability.open.fill(0);
        reachability.reached.fill(0);
        Some(reachability)
    }

    /// Takes up the flood of this extent that the memory holds.
    pub(crate) fn resume(extent: Extent, scratch: &'a mut [u32]) -> Option<Self> {
        let per_row = usize::try_from(extent.width()).ok()?.div_ceil(2);
        let words = per_row * SIDE * usize::try_from(extent.height()).ok()?;
        let (open, reached) = scratch.get_mut(..2 * words)?.split_at_mut(words);
        Some(Self {
            extent,
            per_row,
            open,
            reached,
        })
    }

    /// Returns the coarse column and row of a map cell; `None` west or south of the extent, or east
    /// of the planes.
    fn place(&self, cell: Cell) -> Option<(usize, usize)> {
        let x = usize::try_from((cell.x >> 1) - self.extent.least.0 * SIDE as i32).ok()?;
        let y = usize::try_from((cell.y >> 1) - self.extent.least.1 * SIDE as i32).ok()?;
        (x / 32 < self.per_row).then_some((x, y))
    }

    /// Returns true if the robot can reach a cell.
    pub(crate) fn is_reached(&self, cell: Cell) -> bool {
        self.place(cell)
            .is_some_and(|(x, y)| at(self.reached, y * self.per_row + x / 32) >> (x % 32) & 1 == 1)
    }

    /// Marks the open cells of a tile.
    pub(crate) fn load<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        footprint: &Footprint,
        (tile_x, tile_y): (i32, i32),
    ) {
        let corner = Cell {
            x: tile_x * 32,
            y: tile_y * 32,
        };
        let place = self.place(corner);
        let Some((x, row)) = place.filter(|_| tiles.is_touched(tile_x, tile_y)) else {
            return;
        };
        for_each_strip(tiles, footprint, (corner.x, corner.y), 32, |y, strip| {
            let free = strip.passable & !strip.unknown & !strip.obstacle;
            let row = row + ((y - corner.y) / 2) as usize;
            if let Some(word) = self.open.get_mut(row * self.per_row + x / 32) {
                *word |= u32::from(halve(free)) << (x % 32);
            }
        });
    }

    /// Reaches the open cells around the robot. Returns true if there are any.
    pub(crate) fn start(&mut self, robot: Cell) -> bool {
        let mut any = 0;
        for dy in -START_REACH..=START_REACH {
            for dx in -START_REACH..=START_REACH {
                let near = Cell {
                    x: robot.x + 2 * dx,
                    y: robot.y + 2 * dy,
                };
                let Some((x, y)) = self.place(near) else {
                    continue;
                };
                let index = y * self.per_row + x / 32;
                let open = at(self.open, index);
                if let Some(word) = self.reached.get_mut(index) {
                    *word |= open & 1 << (x % 32);
                    any |= *word;
                }
            }
        }
        any != 0
    }

    /// Spreads once up and once down the rows. Returns true if that reached something new; if not,
    /// the flood is over.
    pub(crate) fn sweep(&mut self) -> bool {
        let rows = self.open.len() / self.per_row.max(1);
        let mut changed = false;
        for row in 0..rows {
            changed |= self.spread(row, row.checked_sub(1));
        }
        for row in (0..rows).rev() {
            changed |= self.spread(row, Some(row + 1));
        }
        changed
    }

    /// Reaches the open cells of a row beside reached ones of the row `beside`, and the runs that
    /// they are in. Returns true if any were new.
    fn spread(&mut self, row: usize, beside: Option<usize>) -> bool {
        let mut changed = false;
        let mut carry = false;
        for word in 0..self.per_row {
            let seeds = beside.map_or(0, |beside| at(self.reached, beside * self.per_row + word));
            changed |= self.fill(row * self.per_row + word, seeds, &mut carry, |bits| bits);
        }
        let mut carry = false;
        for word in (0..self.per_row).rev() {
            changed |= self.fill(row * self.per_row + word, 0, &mut carry, u32::reverse_bits);
        }
        changed
    }

    /// Fills a word's runs from their reached cells and `seeds` towards the high end, in the order
    /// of bits that `turn` gives. `carry` is true before if the run goes on from a reached cell of
    /// the word before, and after if it goes on into the next word. Returns true if a cell was new.
    fn fill(
        &mut self,
        index: usize,
        seeds: u32,
        carry: &mut bool,
        turn: impl Fn(u32) -> u32,
    ) -> bool {
        let open = inside(self.open, index);
        let Some((&open, word)) = open.zip(inside_mut(self.reached, index)) else {
            return false;
        };
        let open = turn(open);
        let before = turn(*word);
        let seeds = open & (before | turn(seeds) | u32::from(*carry));
        // A carry that starts at a seed clears the run's bits up to its end.
        let (sum, over) = open.overflowing_add(seeds);
        let after = open & !sum | seeds;
        *word = turn(after);
        *carry = over;
        after != before
    }

    /// Calls `found` with the reached cells along one side of a tile.
    pub(crate) fn along(&self, tile: (i32, i32), side: (i32, i32), mut found: impl FnMut(Cell)) {
        let last = 2 * (SIDE as i32 - 1);
        for k in 0..SIDE as i32 {
            let at = |side: i32| match side {
                0 => 2 * k,
                1 => last,
                _ => 0,
            };
            let cell = Cell {
                x: tile.0 * 32 + at(side.0),
                y: tile.1 * 32 + at(side.1),
            };
            if self.is_reached(cell) {
                found(cell);
            }
        }
    }
}
