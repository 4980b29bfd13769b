//! The code of a tile: its cells, its trail and its version, without loss, in less than a page.
//!
//! A tile is 8 × 8 *blocks* of 4 × 4 cells. Where all cells of a block have one class, two bits say
//! it. Floors and what nobody has seen are mostly such blocks. The others are *mixed*:
//!
//! | words | hold |
//! | --- | --- |
//! | 1 | the epoch; a bit for each row of the trail that is not empty |
//! | 1 | what the team was not told; the byte of the side table |
//! | 2 | a bit for each block: it is mixed |
//! | 2, 2 | the low and the high bit of the class of the others |
//! | 1 for each mixed block | the low bits of its 16 cells, then the high bits, row by row |
//! | 1 for each two rows of the trail | the rows that are not empty |
//!
//! Reading a row takes the same time wherever it lies: the number of mixed blocks before it is a
//! count of bits.
//!
//! Invariant: a block that is mixed has no class.
//! Units: map cells.

#[cfg(test)]
mod tests;

use crate::grid::bits::{count, ones};
use crate::grid::{at, masked, masked_mut};
use crate::map::tile::{Cells, Visited};
use crate::map::versions::{News, Version};

/// Words before the mixed blocks.
const HEAD: usize = 8;
/// The word where the bits of the mixed blocks begin.
const MIXED: usize = 2;
/// The words where the low and the high bits of the classes begin.
const CLASSES: [usize; 2] = [4, 6];
/// Side of a block, cells.
const BLOCK: usize = 4;
/// Side of a tile, blocks.
const ACROSS: usize = 8;
/// Most words of a code, three quarters of a page: what a longer one leaves holds few others.
pub(super) const MOST_WORDS: usize = 48;

/// Four rows of cells: the low and the high bits.
pub(super) type BlockRow = [[u32; BLOCK]; 2];

/// A tile's code.
#[derive(Clone, Copy, Debug)]
pub(super) struct Code<'a>(&'a [u32]);

/// A code that is written.
#[derive(Debug)]
pub(super) struct Writer {
    words: [u32; MOST_WORDS],
    length: usize,
}

/// Returns a word with four bits for each of the lowest eight bits.
#[inline(always)]
const fn fourfold(byte: u32) -> u32 {
    let wide = (byte | byte << 12) & 0x000f_000f;
    let wide = (wide | wide << 6) & 0x0303_0303;
    let wide = (wide | wide << 3) & 0x1111_1111;
    wide * 15
}

/// Returns a bit for each four bits of a word in which all are set.
const fn whole(word: u32) -> u32 {
    let pairs = word & word >> 1;
    let wide = pairs & pairs >> 2 & 0x1111_1111;
    let wide = (wide | wide >> 3) & 0x0303_0303;
    let wide = (wide | wide >> 6) & 0x000f_000f;
    (wide | wide >> 12) & 0xff
}

/// Returns the four rows of one plane from a block row on.
fn rows_of(plane: &[u32; 32], block_row: usize) -> [u32; BLOCK] {
    core::array::from_fn(|k| *masked(plane, BLOCK * block_row + k))
}

impl Writer {
    /// Writes the code of a tile; `None` if it is too long.
    #[inline(never)]
    pub(super) fn of(cells: &Cells, trail: &Visited, version: Version) -> Option<Self> {
        let mut code = Self {
            words: [0; MOST_WORDS],
            length: HEAD,
        };
        for block_row in 0..ACROSS {
            code.put_blocks(
                cells.each_ref().map(|plane| rows_of(plane, block_row)),
                block_row,
            )?;
        }
        let mut rows = 0;
        let mut before = None;
        for (k, &row) in trail.iter().enumerate().filter(|(_, row)| **row != 0) {
            rows |= 1 << k;
            before = match before {
                None => Some(row),
                Some(first) => {
                    code.push(u32::from(first) | u32::from(row) << 16)?;
                    None
                }
            };
        }
        if let Some(last) = before {
            code.push(last.into())?;
        }
        let [first, ..] = &mut code.words;
        *first = rows << 16;
        set_version(&mut code.words, version);
        Some(code)
    }

    /// Writes the byte of the side table.
    pub(super) fn keep(&mut self, kept: i8) {
        let [_, second, ..] = &mut self.words;
        *second = *second & !0xff00 | u32::from(kept as u8) << 8;
    }

    /// Writes the blocks of four rows.
    fn put_blocks(&mut self, planes: BlockRow, block_row: usize) -> Option<()> {
        let all = planes.map(|rows| whole(rows.into_iter().fold(u32::MAX, |all, row| all & row)));
        let none = planes.map(|rows| whole(!rows.into_iter().fold(0, |any, row| any | row)));
        let uniform = all.into_iter().zip(none).map(|(all, none)| all | none);
        let mixed = !uniform.fold(0xff, |both, plane| both & plane) & 0xff;
        let shift = block_row % 4 * ACROSS;
        let word = block_row / 4;
        let mut put = |first: usize, bits: u32| {
            if let Some(place) = self.words.get_mut(first + word) {
                *place |= bits << shift;
            }
        };
        put(MIXED, mixed);
        for (first, all) in CLASSES.into_iter().zip(all) {
            put(first, all & !mixed);
        }
        ones(mixed).try_for_each(|block| {
            let bits = |rows: [u32; BLOCK]| {
                let nibbles = (0..).zip(rows);
                let nibble = |row: u32| row >> (BLOCK as u32 * block) & 15;
                nibbles.fold(0, |bits, (k, row): (u32, u32)| {
                    bits | nibble(row) << (4 * k)
                })
            };
            let [low, high] = planes.map(bits);
            self.push(low | high << 16)
        })
    }

    fn push(&mut self, word: u32) -> Option<()> {
        *self.words.get_mut(self.length)? = word;
        self.length += 1;
        Some(())
    }

    /// Returns the code.
    pub(super) fn words(&self) -> &[u32] {
        self.words.get(..self.length).unwrap_or_default()
    }
}

impl<'a> Code<'a> {
    /// Reads the code at the beginning of some words.
    pub(super) const fn new(words: &'a [u32]) -> Self {
        Self(words)
    }

    fn word(self, place: usize) -> u32 {
        at(self.0, place)
    }

    /// Returns the tile's version.
    pub(super) fn version(self) -> Version {
        Version {
            epoch: self.word(0) as u16,
            news: News::of_bits(self.word(1) as u8),
        }
    }

    /// Returns the byte of the side table.
    pub(super) fn kept(self) -> i8 {
        (self.word(1) >> 8) as i8
    }

    /// Returns the eight bits of a block row.
    fn bits(self, first: usize, block_row: usize) -> u32 {
        self.word(first + block_row / 4) >> (block_row % 4 * ACROSS) & 0xff
    }

    /// Returns the number of mixed blocks before a block, 0 to 63.
    #[inline(never)]
    fn mixed_before(self, block: usize) -> usize {
        let [first, second] = [self.word(MIXED), self.word(MIXED + 1)];
        let below = |bits: usize| (1_u32 << (bits % 32)) - 1;
        let count = if block < 32 {
            count(first & below(block))
        } else {
            count(first) + count(second & below(block))
        };
        count as usize
    }

    /// Returns where the trail begins.
    fn trail_at(self) -> usize {
        let mixed = [MIXED, MIXED + 1].map(|place| count(self.word(place)));
        HEAD + mixed.into_iter().sum::<u32>() as usize
    }

    /// Returns the number of words.
    #[inline(never)]
    pub(super) fn length(self) -> usize {
        let rows = count(self.word(0) >> 16);
        self.trail_at() + rows.div_ceil(2) as usize
    }

    /// Returns four rows of cells.
    #[inline(never)]
    pub(super) fn block_row(self, block_row: usize) -> BlockRow {
        let [low, high] = CLASSES.map(|first| fourfold(self.bits(first, block_row)));
        let mut rows = [[low; BLOCK], [high; BLOCK]];
        let mixed = self.bits(MIXED, block_row);
        if mixed == 0 {
            return rows;
        }
        let from = HEAD + self.mixed_before(block_row * ACROSS);
        for (place, block) in (from..).zip(ones(mixed)) {
            let word = self.word(place);
            let shift = BLOCK as u32 * block;
            let [low, high] = &mut rows;
            for (k, (low, high)) in (0..).zip(low.iter_mut().zip(high)) {
                *low |= (word >> (4 * k) & 15) << shift;
                *high |= (word >> (16 + 4 * k) & 15) << shift;
            }
        }
        rows
    }

    /// Returns the low and the high bits of a row.
    #[inline(never)]
    pub(super) fn row(self, row: usize) -> [u32; 2] {
        let rows = self.block_row(row / BLOCK);
        rows.map(|plane| *masked(&plane, row % BLOCK))
    }

    /// Returns the low and the high bit of a cell's class.
    #[inline(never)]
    pub(super) fn class_bits(self, row: usize, column: u32) -> [u32; 2] {
        let (block_row, across) = (row / BLOCK, column / BLOCK as u32);
        if self.bits(MIXED, block_row) >> across & 1 == 0 {
            return CLASSES.map(|first| self.bits(first, block_row) >> across & 1);
        }
        let block = block_row * ACROSS + across as usize;
        let word = self.word(HEAD + self.mixed_before(block));
        let bit = 4 * (row % BLOCK) as u32 + column % BLOCK as u32;
        [word >> bit & 1, word >> (16 + bit) & 1]
    }

    /// Returns the number of cells that were measured.
    #[inline(never)]
    pub(super) fn known(self) -> u32 {
        let [low, high] = CLASSES;
        let whole = [0, 1].map(|k| count(self.word(low + k) | self.word(high + k)));
        let mixed = (HEAD..self.trail_at()).map(|place| {
            let word = self.word(place);
            count((word | word >> 16) & 0xffff)
        });
        whole.into_iter().sum::<u32>() * (BLOCK * BLOCK) as u32 + mixed.sum::<u32>()
    }

    /// Returns a row of the trail.
    #[inline(never)]
    pub(super) fn trail_row(self, row: usize) -> u16 {
        let rows = self.word(0) >> 16;
        if rows >> row & 1 == 0 {
            return 0;
        }
        let before = count(rows & ((1 << row) - 1)) as usize;
        (self.word(self.trail_at() + before / 2) >> (before % 2 * 16)) as u16
    }

    /// Returns the cells.
    #[inline(never)]
    pub(super) fn cells(self) -> Cells {
        let mut cells = [[0; 32]; 2];
        for block_row in 0..ACROSS {
            let rows = self.block_row(block_row);
            for (plane, rows) in cells.iter_mut().zip(rows) {
                for (k, row) in rows.into_iter().enumerate() {
                    *masked_mut(plane, BLOCK * block_row + k) = row;
                }
            }
        }
        cells
    }

    /// Returns the trail.
    #[inline(never)]
    pub(super) fn trail(self) -> Visited {
        core::array::from_fn(|row| self.trail_row(row))
    }
}

/// Writes the version of a tile into its code.
pub(super) fn set_version(words: &mut [u32], Version { epoch, news }: Version) {
    if let [first, second, ..] = words {
        *first = *first & !0xffff | u32::from(epoch);
        *second = *second & !0xff | u32::from(news.bits());
    }
}
