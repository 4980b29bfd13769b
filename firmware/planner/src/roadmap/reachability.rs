//! Reachability: the explored passable cells, flooded from where the robot stands.
//!
//! ```text
//! open    = coarse cells with a passable, free map cell
//! reached = the smallest set of open cells near the robot, or beside a reached cell at a side
//! ```
//!
//! A tile is flooded whole from its reached cells and those at its sides. It is *awake* while
//! something new may come in from a tile beside it. The flood runs in lent memory, and in
//! instalments if that keeps its values. Loading a tile takes some 10,000 instructions, flooding it
//! some 3,000.
//!
//! Units: coarse cells of 20 cm, 16 × 16 in a tile.

use crate::geometry::{CELL_M, Cell};
use crate::grid::bits::halve;
use crate::grid::{
    Block, PAGE_SIDE, PAGE_WORDS, SIDES, TileKey, Tiling, at, inside, inside_mut, masked,
};
use crate::map::Tiles;
use crate::map::tiles::TILE_SIDE;
use crate::math;
use crate::roadmap::configuration_space::{Footprint, for_each_strip};
use crate::roadmap::skeleton::Frame;

/// Distance from the robot's cell at which the flood starts, coarse cells: the robot may stand
/// nearer to an obstacle than its radius.
const START_REACH: i32 = 2;
/// Tiles with a bit in a word.
const PER_WORD: usize = u32::BITS as usize;

/// Rows of a tile, the least x in the lowest bit.
type Rows = [u16; PAGE_SIDE];

/// Returns the words of memory that a flood of so many tiles needs: two planes, and a bit for each
/// tile.
pub(crate) const fn scratch_words(tiles: usize) -> usize {
    2 * PAGE_WORDS * tiles + tiles.div_ceil(PER_WORD)
}

/// The flood's planes. Invariant: a reached cell is open.
#[derive(Debug)]
pub(crate) struct Reachability<'a> {
    frame: Frame,
    tiling: Tiling<'a>,
    open: &'a mut [u32],
    reached: &'a mut [u32],
    /// The tiles that are awake, by their places.
    awake: &'a mut [u32],
}

impl<'a> Reachability<'a> {
    /// Empties the planes.
    pub(crate) fn clear(&mut self) {
        self.open.fill(0);
        self.reached.fill(0);
        self.awake.fill(0);
    }

    /// Takes up the flood of these tiles that the memory holds; `None` if the memory is too small,
    /// see [`scratch_words`].
    pub(crate) fn resume(frame: Frame, tiling: Tiling<'a>, scratch: &'a mut [u32]) -> Option<Self> {
        let words = tiling.words();
        let (open, rest) = scratch.split_at_mut_checked(words)?;
        let (reached, rest) = rest.split_at_mut_checked(words)?;
        Some(Self {
            frame,
            tiling,
            open,
            reached,
            awake: rest.get_mut(..tiling.keys().len().div_ceil(PER_WORD))?,
        })
    }

    /// Returns a query for cells near each other: whether the robot can reach a cell.
    pub(crate) fn is_reached(&self) -> impl FnMut(Cell) -> bool {
        let mut finder = self.tiling.finder();
        move |cell| {
            let site = self.frame.site(cell);
            site.is_some_and(|site| at(self.reached, finder.index(site)) & site.bit() != 0)
        }
    }

    /// Returns the number of tiles.
    pub(crate) fn tiles(&self) -> usize {
        self.tiling.keys().len()
    }

    /// Marks the open cells of the tile at a place, if there is one.
    pub(crate) fn load<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        footprint: &Footprint,
        place: usize,
    ) {
        let Some(&key) = self.tiling.keys().get(place) else {
            return;
        };
        let (tile_x, tile_y) = self.frame.tile(key);
        if !tiles.is_touched(tile_x, tile_y) {
            return;
        }
        let corner = (tile_x * TILE_SIDE, tile_y * TILE_SIDE);
        let mut rows: Rows = [0; PAGE_SIDE];
        for_each_strip(tiles, footprint, corner, TILE_SIDE, |y, strip| {
            let free = strip.passable & !strip.unknown & !strip.obstacle;
            if let Some(row) = rows.get_mut(((y - corner.1) / 2) as usize) {
                *row |= halve(free);
            }
        });
        write(self.open, place, &rows);
    }

    /// Closes the loaded cells nearer to a cell than `radius_m`, except those at least as far from
    /// it as the robot is.
    pub(crate) fn close(&mut self, cell: Cell, radius_m: f32, robot: Cell) {
        let most2 = (radius_m * radius_m).min(cell.distance2(robot));
        let reach = math::floor(radius_m / (2.0 * CELL_M)) + 1;
        for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
            let near = cell.offset(2 * dx, 2 * dy);
            let site = self
                .frame
                .site(near)
                .filter(|_| near.distance2(cell) < most2);
            let index = site.and_then(|site| Some((self.tiling.index(site)?, site.bit())));
            if let Some((index, bit)) = index
                && let Some(word) = self.open.get_mut(index)
            {
                *word &= !bit;
            }
        }
    }

    /// Reaches the open cells around the robot. Returns true if there are any.
    pub(crate) fn start(&mut self, robot: Cell) -> bool {
        let mut any = false;
        for dy in -START_REACH..=START_REACH {
            for dx in -START_REACH..=START_REACH {
                let site = self.frame.site(robot.offset(2 * dx, 2 * dy));
                let index = site.and_then(|site| Some((self.tiling.index(site)?, site.bit())));
                let Some((index, bit)) = index else {
                    continue;
                };
                let reached = at(self.open, index) & bit;
                if let Some(word) = self.reached.get_mut(index).filter(|_| reached != 0) {
                    *word |= reached;
                    any = true;
                    self.wake_around(index / PAGE_WORDS);
                }
            }
        }
        any
    }

    /// Lets a tile and those beside it be flooded.
    fn wake_around(&mut self, place: usize) {
        self.wake(place);
        for (columns, rows) in SIDES {
            self.wake(self.tiling.beside(place, columns, rows));
        }
    }

    /// Lets a tile be flooded, if there is one at this place.
    fn wake(&mut self, place: usize) {
        let is_there = place < self.tiling.keys().len();
        if let Some(word) = self.awake.get_mut(place / PER_WORD).filter(|_| is_there) {
            *word |= 1 << (place % PER_WORD);
        }
    }

    /// Returns the first tile that is awake, and lets it sleep.
    fn take_awake(&mut self) -> Option<usize> {
        let (number, word) = self
            .awake
            .iter_mut()
            .enumerate()
            .find(|(_, it)| **it != 0)?;
        let bit = word.trailing_zeros() as usize;
        *word &= *word - 1;
        Some(number * PER_WORD + bit)
    }

    /// Floods up to so many tiles. Returns true if the flood is over.
    pub(crate) fn spread(&mut self, most: u32) -> bool {
        for _ in 0..most {
            let Some(place) = self.take_awake() else {
                return true;
            };
            self.flood(place);
        }
        false
    }

    /// Floods a tile from its reached cells and those at its sides, and wakes the tiles beside it
    /// that this may change.
    fn flood(&mut self, place: usize) {
        let block = Block::read(self.tiling, self.reached, place);
        let open = read(self.open, place);
        let before = read(self.reached, place);
        let mut reached = before;
        for (k, pair) in reached.chunks_exact_mut(2).enumerate() {
            let [north, _, east, _, south, _, west, _] = block.neighbours(k);
            let beside = north | east | south | west;
            for (row, beside) in pair.iter_mut().zip([beside as u16, (beside >> 16) as u16]) {
                *row |= beside;
            }
        }
        for (row, open) in reached.iter_mut().zip(&open) {
            *row = fill(*open, *row & open);
        }
        while spread_down(&open, &mut reached) | spread_up(&open, &mut reached) {}
        write(self.reached, place, &reached);
        let mut new: Rows = [0; PAGE_SIDE];
        for ((new, before), after) in new.iter_mut().zip(before).zip(reached) {
            *new = after & !before;
        }
        let columns = new.iter().fold(0, |columns, row| columns | row);
        let sides = [
            ((0, -1), *masked(&new, 0) != 0),
            ((0, 1), *masked(&new, PAGE_SIDE - 1) != 0),
            ((-1, 0), columns & 1 != 0),
            ((1, 0), columns >> (PAGE_SIDE - 1) != 0),
        ];
        for ((columns, rows), _) in sides.into_iter().filter(|(_, is_new)| *is_new) {
            self.wake(self.tiling.beside(place, columns, rows));
        }
    }

    /// Calls `found` with the reached cells along one side of a tile.
    pub(crate) fn along(&self, key: TileKey, side: (i32, i32), mut found: impl FnMut(Cell)) {
        let corner = self.frame.cell(key.least());
        let last = 2 * (PAGE_SIDE as i32 - 1);
        let mut is_reached = self.is_reached();
        for k in 0..PAGE_SIDE as i32 {
            let at = |side: i32| match side {
                0 => 2 * k,
                1 => last,
                _ => 0,
            };
            let cell = corner.offset(at(side.0), at(side.1));
            if is_reached(cell) {
                found(cell);
            }
        }
    }
}

/// Returns the rows of the tile at a place.
fn read(words: &[u32], place: usize) -> Rows {
    let mut rows = [0; PAGE_SIDE];
    for (k, pair) in rows.chunks_exact_mut(2).enumerate() {
        let word = inside(words, place * PAGE_WORDS + k).copied().unwrap_or(0);
        pair.copy_from_slice(&[word as u16, (word >> 16) as u16]);
    }
    rows
}

/// Stores the rows of the tile at a place.
fn write(words: &mut [u32], place: usize, rows: &Rows) {
    for (k, pair) in rows.chunks_exact(2).enumerate() {
        if let ([low, high], Some(word)) = (pair, inside_mut(words, place * PAGE_WORDS + k)) {
            *word = u32::from(*low) | u32::from(*high) << 16;
        }
    }
}

/// Spreads from each row to the one after it. Returns true if a cell was new.
fn spread_down(open: &Rows, reached: &mut Rows) -> bool {
    let mut changed = false;
    let mut before = 0;
    for (row, open) in reached.iter_mut().zip(open) {
        changed |= spread_row(row, *open, before);
        before = *row;
    }
    changed
}

/// Spreads from each row to the one before it. Returns true if a cell was new.
fn spread_up(open: &Rows, reached: &mut Rows) -> bool {
    let mut changed = false;
    let mut after = 0;
    for (row, open) in reached.iter_mut().zip(open).rev() {
        changed |= spread_row(row, *open, after);
        after = *row;
    }
    changed
}

/// Reaches the open cells of a row beside reached ones of another row, and the runs that they are
/// in. Returns true if any were new.
fn spread_row(row: &mut u16, open: u16, beside: u16) -> bool {
    let seeds = beside & open & !*row;
    if seeds == 0 {
        return false;
    }
    *row |= fill(open, seeds);
    true
}

/// Returns every run of `open` that holds one of `seeds`, whole.
fn fill(open: u16, seeds: u16) -> u16 {
    // A carry that starts at a seed clears the run's bits up to its end.
    let up = |open: u16, seeds: u16| open & !open.wrapping_add(seeds) | seeds;
    let down = up(open.reverse_bits(), seeds.reverse_bits());
    up(open, seeds) | down.reverse_bits()
}

#[cfg(test)]
mod tests;
