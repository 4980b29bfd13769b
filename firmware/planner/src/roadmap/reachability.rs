//! What the robot can get to: the explored passable cells, flooded from where it stands.
//!
//! ```text
//! open    = coarse cells with a passable, free map cell              (at most one word for two tiles and row)
//! reached = the smallest set with: near the robot, or open and beside a reached cell at a side
//! ```
//!
//! In lent memory, and in instalments if the lender keeps it as it is: some ten thousand instructions for the loading of a tile,
//! some hundred thousand for a sweep, of which there is one for each time that the ways change from up to down.
//!
//! Units: coarse cells of 20 cm, 16 × 16 in a tile.

use crate::geometry::Cell;
use crate::grid::bits::halve;
use crate::map::Tiles;
use crate::map::tiles::Extent;
use crate::roadmap::configuration_space::{Footprint, for_each_strip};

/// Coarse cells along a tile's side.
const SIDE: usize = 16;
/// Coarse cells around the robot's own from which the flood starts: it may stand nearer to something than its radius.
const START_REACH: i32 = 2;

/// Words of memory that a `Flood` needs for a box of so many tile places: two planes, and two tiles side by side share a word.
#[must_use]
pub const fn scratch_words(slots: usize) -> usize {
    SIDE * slots
}

/// The tiles of an extent.
pub(crate) fn each(extent: Extent) -> impl Iterator<Item = (i32, i32)> {
    let rows = extent.least.1..=extent.greatest.1;
    rows.flat_map(move |y| (extent.least.0..=extent.greatest.0).map(move |x| (x, y)))
}

/// The flood's planes, row by row, as wide as the extent.
#[derive(Debug)]
pub(crate) struct Flood<'a> {
    extent: Extent,
    per_row: usize,
    open: &'a mut [u32],
    reached: &'a mut [u32],
}

impl<'a> Flood<'a> {
    /// All clear; `None` where the memory is too small, see [`scratch_words`].
    pub(crate) fn new(extent: Extent, scratch: &'a mut [u32]) -> Option<Self> {
        let flood = Self::resume(extent, scratch)?;
        flood.open.fill(0);
        flood.reached.fill(0);
        Some(flood)
    }

    /// The flood of this extent as it was left in its memory.
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

    /// Coarse column and row of a map cell, as far as there are any.
    fn place(&self, cell: Cell) -> Option<(usize, usize)> {
        let x = usize::try_from((cell.x >> 1) - self.extent.least.0 * SIDE as i32).ok()?;
        let y = usize::try_from((cell.y >> 1) - self.extent.least.1 * SIDE as i32).ok()?;
        (x / 32 < self.per_row).then_some((x, y))
    }

    pub(crate) fn is_reached(&self, cell: Cell) -> bool {
        self.place(cell).is_some_and(|(x, y)| {
            let word = self.reached.get(y * self.per_row + x / 32);
            word.is_some_and(|word| word >> (x % 32) & 1 == 1)
        })
    }

    /// Mark what is open in a tile.
    pub(crate) fn load<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        disc: &Footprint,
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
        for_each_strip(tiles, disc, (corner.x, corner.y), 32, |y, strip| {
            let free = strip.passable & !strip.unknown & !strip.obstacle;
            let row = row + ((y - corner.y) / 2) as usize;
            if let Some(word) = self.open.get_mut(row * self.per_row + x / 32) {
                *word |= u32::from(halve(free)) << (x % 32);
            }
        });
    }

    /// Reach what is open around the robot; whether anything is.
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
                let open = self.open.get(index).copied().unwrap_or(0);
                if let Some(word) = self.reached.get_mut(index) {
                    *word |= open & 1 << (x % 32);
                    any |= *word;
                }
            }
        }
        any != 0
    }

    /// Once up and once down the rows; whether that reached something new. The flood is over when it did not.
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

    /// Take over what the row beside has reached, and fill the runs that hold any of it. Answers whether that is new.
    fn spread(&mut self, row: usize, beside: Option<usize>) -> bool {
        let mut changed = false;
        let mut carry = false;
        for word in 0..self.per_row {
            let seeds = beside.and_then(|beside| self.reached.get(beside * self.per_row + word));
            let seeds = seeds.copied().unwrap_or(0);
            changed |= self.fill(row * self.per_row + word, seeds, &mut carry, |bits| bits);
        }
        let mut carry = false;
        for word in (0..self.per_row).rev() {
            changed |= self.fill(row * self.per_row + word, 0, &mut carry, u32::reverse_bits);
        }
        changed
    }

    /// Fill a word's runs from their reached cells and `seeds` on towards the high end, in the order of bits that `turn` gives;
    /// `carry` says whether the run that begins the word was reached in the one before, and then whether the last was.
    fn fill(
        &mut self,
        index: usize,
        seeds: u32,
        carry: &mut bool,
        turn: impl Fn(u32) -> u32,
    ) -> bool {
        let open = turn(self.open.get(index).copied().unwrap_or(0));
        let Some(word) = self.reached.get_mut(index) else {
            return false;
        };
        let before = turn(*word);
        let seeds = open & (before | turn(seeds) | u32::from(*carry));
        // A carry started at a seed clears the run's bits up to its end.
        let (sum, over) = open.overflowing_add(seeds);
        let after = open & !sum | seeds;
        *word = turn(after);
        *carry = over;
        after != before
    }

    /// The reached cells along one side of a tile.
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
