//! A tile's cells: two planes of a word a row, `low` and `high` bits of the class code, bit k = column k.

use crate::grid::{Class, masked, masked_mut};
use crate::map::tiles::TILE_ROWS;

/// A bit of every cell of a tile, row by row.
pub(super) type Plane = [u32; TILE_ROWS];
/// Low plane, high plane.
pub(super) type Cells = [Plane; 2];

/// A tile that a beam goes through. Rows count from 0 to 31, columns are bits.
#[derive(Debug)]
pub(super) struct TileMut<'a> {
    pub(super) cells: &'a mut Cells,
    /// Changes of any cell of the map so far; wraps.
    pub(super) edits: &'a mut u32,
}

impl TileMut<'_> {
    /// Whether a cell is known to be traversable.
    #[inline(always)]
    pub(super) fn is_free(&self, row: usize, bit: u32) -> bool {
        let [low, high] = self.words(row);
        low & !high & bit != 0
    }

    /// What is known of a cell.
    pub(super) fn class(&self, row: usize, bit: u32) -> Class {
        let [low, high] = self.words(row);
        Class::from_bits(low & bit, high & bit)
    }

    /// Low and high bits of a row.
    #[inline(always)]
    fn words(&self, row: usize) -> [u32; 2] {
        let [low, high] = &*self.cells;
        [low, high].map(|plane| *masked(plane, row))
    }

    /// Store what is known of a cell.
    #[inline(always)]
    pub(super) fn set(&mut self, row: usize, bit: u32, class: Class) {
        let [low, high] = &mut *self.cells;
        let words = [low, high].map(|plane| masked_mut(plane, row));
        *self.edits = self.edits.wrapping_add(u32::from(write(words, bit, class)));
    }
}

/// Write a cell's class into the words of its row; whether it changed.
#[inline(always)]
const fn write([low, high]: [&mut u32; 2], bit: u32, class: Class) -> bool {
    let code = class as u32;
    let old = (*low, *high);
    *low = *low & !bit | bit & (code & 1).wrapping_neg();
    *high = *high & !bit | bit & (code >> 1 & 1).wrapping_neg();
    old.0 != *low || old.1 != *high
}
