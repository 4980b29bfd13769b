//! The tiles that a plane covers, in pages: memory for these tiles alone, wherever they lie.
//!
//! ```text
//! page          16 × 16 cells, 8 words
//! word k        rows 2 k and 2 k + 1 of a page
//! bit           16 · (row & 1) + column
//! index         8 · place + k, with the tile's place in the sorted list of keys
//! ```
//!
//! A tile that is not in the list has no memory: its cells read 0 and cannot be written.
//!
//! Invariant: the keys are sorted, and none is there twice.
//! Units: cells of the plane.

use core::fmt;

use crate::grid::tile_key::find;
use crate::grid::{Site, TileKey, at, masked};

/// Words of a page.
pub const PAGE_WORDS: usize = 8;
/// Cells along a page's side.
pub const PAGE_SIDE: usize = 16;
/// The place of a tile that is not in the list. The index of its words is beyond any plane.
const ABSENT: usize = 1 << 16;

/// The tiles of a plane.
#[derive(Clone, Copy, Debug)]
pub struct Tiling<'a> {
    keys: &'a [TileKey],
}

/// The error of memory too small for a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooSmall {
    /// Words that the plane needs.
    pub needs: usize,
    /// Words that were lent.
    pub has: usize,
}

impl fmt::Display for TooSmall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { needs, has } = self;
        write!(
            f,
            "a plane of {needs} words in memory of {has}: lend more memory or take fewer tiles"
        )
    }
}

impl core::error::Error for TooSmall {}

impl<'a> Tiling<'a> {
    /// Makes the tiling of these tiles, which must be sorted.
    #[must_use]
    pub const fn new(keys: &'a [TileKey]) -> Self {
        Self { keys }
    }

    /// Returns the tiles' keys, sorted.
    #[must_use]
    pub const fn keys(self) -> &'a [TileKey] {
        self.keys
    }

    /// Returns the number of words of a plane.
    #[must_use]
    pub const fn words(self) -> usize {
        self.keys.len() * PAGE_WORDS
    }

    /// Returns a tile's place in the list.
    #[must_use]
    pub fn place(self, key: TileKey) -> Option<usize> {
        find(self.keys, key)
    }

    /// Returns the index of a site's word; `None` outside the tiles.
    #[must_use]
    pub fn index(self, site: Site) -> Option<usize> {
        Some(self.place(TileKey::at(site))? * PAGE_WORDS + site.word())
    }

    /// Returns the site of a bit of a word.
    pub(crate) fn site(self, index: usize, bit: u32) -> Site {
        let key = self.keys.get(index / PAGE_WORDS).copied();
        let Site { x, y } = key.unwrap_or_default().least();
        Site {
            x: x + (bit & 15) as u16,
            y: y + 2 * (index % PAGE_WORDS) as u16 + (bit >> 4) as u16,
        }
    }

    /// Returns the place of a tile at most one column and one row from that at `place`. The words
    /// of a tile that is not in the list lie beyond any plane.
    pub(crate) fn beside(self, place: usize, columns: i32, rows: i32) -> usize {
        let Some(&key) = self.keys.get(place) else {
            return ABSENT;
        };
        let key = key.beside(columns, rows);
        if rows == 0 {
            let place = place.wrapping_add_signed(columns as isize);
            return if self.keys.get(place) == Some(&key) {
                place
            } else {
                ABSENT
            };
        }
        self.place(key).unwrap_or(ABSENT)
    }

    /// Returns the places of the tiles around one, row by row, with its own in the middle.
    pub(crate) fn around(self, place: usize) -> [usize; 9] {
        let mut places = [ABSENT; 9];
        let Some(&key) = self.keys.get(place) else {
            return places;
        };
        for (rows, three) in (-1..=1).zip(places.chunks_exact_mut(3)) {
            // Tiles of a row that are side by side have places one after another.
            let west = key.beside(-1, rows);
            let first = match rows {
                0 => place.saturating_sub(1),
                _ => self.keys.partition_point(|&other| other < west),
            };
            for (&key, place) in self.keys.iter().skip(first).zip(first..).take(3) {
                if let Some(entry) = key.columns_after(west).and_then(|k| three.get_mut(k)) {
                    *entry = place;
                }
            }
        }
        places
    }

    /// Returns a finder of words near each other.
    pub(crate) const fn finder(self) -> Finder<'a> {
        Finder {
            tiling: self,
            key: TileKey::NONE,
            place: ABSENT,
        }
    }
}

/// Finds the words of sites near each other: it looks a tile up only when the tile changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Finder<'a> {
    tiling: Tiling<'a>,
    key: TileKey,
    place: usize,
}

impl Finder<'_> {
    /// Returns the index of a site's word, beyond any plane outside the tiles.
    #[inline]
    pub(crate) fn index(&mut self, site: Site) -> usize {
        let key = TileKey::at(site);
        if key != self.key {
            self.key = key;
            self.place = self.tiling.place(key).unwrap_or(ABSENT);
        }
        self.place * PAGE_WORDS + site.word()
    }
}

/// The words of a page, and those above and below it.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// The last word of the tile in the north: row −1 is its upper half.
    above: u32,
    page: [u32; PAGE_WORDS],
    /// The first word of the tile in the south.
    below: u32,
}

impl Column {
    /// Reads the column of the tiles at three places, from north to south.
    fn read(words: &[u32], [above, here, below]: [usize; 3]) -> Self {
        let page = words.get(here * PAGE_WORDS..);
        Self {
            above: at(words, above * PAGE_WORDS + PAGE_WORDS - 1),
            page: page
                .and_then(|words| words.first_chunk().copied())
                .unwrap_or_default(),
            below: at(words, below * PAGE_WORDS),
        }
    }

    /// Returns the cells in the north of word k, in it, and in its south.
    fn three(&self, k: usize) -> [u32; 3] {
        let here = *masked(&self.page, k);
        let above = match k {
            0 => self.above,
            _ => *masked(&self.page, k - 1),
        };
        let below = if k + 1 == PAGE_WORDS {
            self.below
        } else {
            *masked(&self.page, k + 1)
        };
        [above >> 16 | here << 16, here, here >> 16 | below << 16]
    }
}

/// A page, and the words of the tiles around it that touch it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    west: Column,
    here: Column,
    east: Column,
}

impl Block {
    /// Reads the block around the tile at `place`, with 0 for tiles that are not in the list.
    pub(crate) fn read(tiling: Tiling<'_>, words: &[u32], place: usize) -> Self {
        let [nw, n, ne, w, here, e, sw, s, se] = tiling.around(place);
        Self {
            west: Column::read(words, [nw, w, sw]),
            here: Column::read(words, [n, here, s]),
            east: Column::read(words, [ne, e, se]),
        }
    }

    /// Sets the cells beyond a side of the page: in the west, in the east, in the north, or in the
    /// south.
    pub(crate) fn fill_beyond(&mut self, side: (i32, i32)) {
        match side {
            (-1, _) => self.west.page = [u32::MAX; PAGE_WORDS],
            (1, _) => self.east.page = [u32::MAX; PAGE_WORDS],
            (_, -1) => self.here.above = u32::MAX,
            _ => self.here.below = u32::MAX,
        }
    }

    /// Returns word k of the page.
    pub(crate) const fn word(&self, k: usize) -> u32 {
        *masked(&self.here.page, k)
    }

    /// Returns the neighbours of the cells of word k: north, north-east, and so on round.
    pub(crate) fn neighbours(&self, k: usize) -> [u32; 8] {
        let [before_north, before, before_south] = self.west.three(k);
        let [north, here, south] = self.here.three(k);
        let [after_north, after, after_south] = self.east.three(k);
        [
            north,
            eastern(north, after_north),
            eastern(here, after),
            eastern(south, after_south),
            south,
            western(south, before_south),
            western(here, before),
            western(north, before_north),
        ]
    }
}

/// Returns each cell's eastern neighbour; `east` is the word in the east.
const fn eastern(here: u32, east: u32) -> u32 {
    here >> 1 & 0x7fff_7fff | east << 15 & 0x8000_8000
}

/// Returns each cell's western neighbour; `west` is the word in the west.
const fn western(here: u32, west: u32) -> u32 {
    here << 1 & 0xfffe_fffe | west >> 15 & 0x0001_0001
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{Block, PAGE_WORDS, Tiling};
    use crate::grid::{RING, Site, TileKey};

    /// Keys of tiles that touch each other in many ways.
    fn keys() -> Vec<TileKey> {
        let at = [
            (0, 0),
            (1, 0),
            (3, 0),
            (0, 1),
            (2, 1),
            (3, 1),
            (1, 3),
            (2, 3),
            (1, 4),
        ];
        at.map(|(x, y)| TileKey::of(x, y).unwrap()).to_vec()
    }

    #[test]
    fn a_word_and_a_bit_are_one_site_and_back() {
        let keys = keys();
        let tiling = Tiling::new(&keys);
        for (index, bit) in (0..tiling.words()).flat_map(|index| (0..32).map(move |b| (index, b))) {
            let site = tiling.site(index, bit);
            assert_eq!(tiling.index(site), Some(index));
            assert_eq!(site.bit(), 1 << bit);
        }
        let beyond = TileKey::of(2, 0).unwrap().least();
        assert_eq!(tiling.index(beyond), None);
        assert_eq!(tiling.index(Site { x: u16::MAX, y: 0 }), None);
    }

    #[test]
    fn the_tiles_around_one_are_found() {
        let keys = keys();
        let tiling = Tiling::new(&keys);
        for (place, key) in keys.iter().enumerate() {
            let steps = (-1..=1).flat_map(|rows| (-1..=1).map(move |columns| (columns, rows)));
            for ((columns, rows), found) in steps.zip(tiling.around(place)) {
                let expected = tiling.place(key.beside(columns, rows));
                let found = (found < keys.len()).then_some(found);
                assert_eq!(found, expected, "{columns} {rows} from {place}");
                let beside = tiling.beside(place, columns, rows);
                assert_eq!((beside < keys.len()).then_some(beside), expected);
            }
        }
    }

    #[test]
    fn a_block_has_the_neighbours_of_every_cell() {
        let keys = keys();
        let tiling = Tiling::new(&keys);
        let mut seed = 1_u32;
        let words: Vec<u32> = (0..tiling.words())
            .map(|_| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                seed ^ seed >> 15
            })
            .collect();
        let get = |site: Site| {
            tiling
                .index(site)
                .is_some_and(|i| words[i] & site.bit() != 0)
        };
        for index in 0..tiling.words() {
            let block = Block::read(tiling, &words, index / PAGE_WORDS);
            let k = index % PAGE_WORDS;
            assert_eq!(block.word(k), words[index]);
            for (word, (dx, dy)) in block.neighbours(k).into_iter().zip(RING) {
                for bit in 0..32 {
                    let near = tiling.site(index, bit).offset(dx, dy).unwrap();
                    assert_eq!(word >> bit & 1 == 1, get(near), "{index} {bit} {dx} {dy}");
                }
            }
        }
    }
}
