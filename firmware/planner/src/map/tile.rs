//! The cells of a tile: a low and a high plane of 32 words, one word per row.
//!
//! Bit k of a word is column k. The two bits of a cell are its [`Class`].
//!
//! Units: map cells.

use crate::grid::bits::count;
use crate::grid::{Class, masked, masked_mut};
use crate::map::code::Code;
use crate::map::tiles::TILE_ROWS;
use crate::map::versions::News;

/// One bit of every cell of a tile, row by row.
pub(super) type Plane = [u32; TILE_ROWS];
/// The low plane and the high plane.
pub(super) type Cells = [Plane; 2];

/// The trail: 16 rows of 16 blocks of 2 × 2 cells.
pub(super) type Visited = [u16; TILE_ROWS / 2];

/// A tile as it is stored.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stored<'a> {
    /// In a page.
    Page {
        cells: &'a Cells,
        trail: &'a Visited,
    },
    /// As a code.
    Coded(Code<'a>),
}

impl Stored<'_> {
    /// Returns the low and the high bits of a row.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> [u32; 2] {
        match self {
            Self::Page { cells, .. } => cells.each_ref().map(|plane| *masked(plane, row)),
            Self::Coded(code) => code.row(row),
        }
    }

    /// Returns the class of a cell.
    pub(super) fn class(&self, row: usize, column: u32) -> Class {
        let [low, high] = match self {
            Self::Page { cells, .. } => {
                let row = |plane| masked::<u32, TILE_ROWS>(plane, row) >> column & 1;
                cells.each_ref().map(row)
            }
            Self::Coded(code) => code.class_bits(row, column),
        };
        Class::from_bits(low, high)
    }

    /// Returns true if a cell is a negative obstacle.
    #[inline(never)]
    pub(super) fn has_negative(&self) -> bool {
        self.with_planes(|[low, high]| low.iter().zip(high).any(|(low, high)| low & high != 0))
    }

    /// Returns the number of cells that were measured.
    #[inline(never)]
    pub(super) fn known(&self) -> u32 {
        match self {
            Self::Page { cells, .. } => {
                let [low, high] = cells;
                let rows = low.iter().zip(high);
                rows.map(|(low, high)| count(low | high)).sum()
            }
            Self::Coded(code) => code.known(),
        }
    }

    /// Returns the cells.
    #[inline(never)]
    pub(super) fn cells(&self) -> Cells {
        match self {
            Self::Page { cells, .. } => **cells,
            Self::Coded(code) => code.cells(),
        }
    }

    /// Returns the trail.
    #[inline(never)]
    pub(super) fn trail(&self) -> Visited {
        match self {
            Self::Page { trail, .. } => **trail,
            Self::Coded(code) => code.trail(),
        }
    }

    /// Calls a function with the low and the high plane.
    pub(super) fn with_planes<T>(&self, read: impl FnOnce([&Plane; 2]) -> T) -> T {
        match self {
            Self::Page { cells, .. } => read(cells.each_ref()),
            Self::Coded(code) => read(code.cells().each_ref()),
        }
    }
}

/// A tile that can be read and written. A row is 0 to 31; a column is a bit.
#[derive(Debug)]
pub(super) struct TileMut<'a> {
    pub(super) cells: &'a mut Cells,
    /// Number of changes of any cell of the map; wraps.
    pub(super) edits: &'a mut u32,
    pub(super) news: &'a mut News,
}

impl TileMut<'_> {
    /// Returns true if a cell is free.
    #[inline(always)]
    pub(super) fn is_free(&self, row: usize, bit: u32) -> bool {
        let [low, high] = self.words(row);
        low & !high & bit != 0
    }

    /// Returns the class of a cell.
    pub(super) fn class(&self, row: usize, bit: u32) -> Class {
        let [low, high] = self.words(row);
        Class::from_bits(low & bit, high & bit)
    }

    /// Returns the low and the high bits of a row.
    #[inline(always)]
    fn words(&self, row: usize) -> [u32; 2] {
        let [low, high] = &*self.cells;
        [low, high].map(|plane| *masked(plane, row))
    }

    /// Stores the class of a cell.
    #[inline(always)]
    pub(super) fn set(&mut self, row: usize, bit: u32, class: Class) {
        let [low, high] = &mut *self.cells;
        let words = [low, high].map(|plane| masked_mut(plane, row));
        let (before, after) = (write(words, bit, class), class as u32);
        *self.edits = self.edits.wrapping_add(u32::from(before != after));
        self.news.note(before, after);
    }
}

/// Writes a cell's class into the words of its row. Returns the number of the class before.
#[inline(always)]
const fn write([low, high]: [&mut u32; 2], bit: u32, class: Class) -> u32 {
    let code = class as u32;
    let before = (*low & bit != 0) as u32 | ((*high & bit != 0) as u32) << 1;
    *low = *low & !bit | bit & (code & 1).wrapping_neg();
    *high = *high & !bit | bit & (code >> 1 & 1).wrapping_neg();
    before
}
