//! Memory for cells: bit planes over tiles, floods, rolling windows, and the accessors that replace
//! indexing.
//!
//! A bit plane has one bit per cell of a number of tiles, in memory that the caller lends
//! ([`Tiling`]). It has memory for these tiles alone, wherever they lie. Cells outside read 0 and
//! cannot be written. Row 0 is in the north, as in a picture.
//!
//! Invariant: a plane's slice holds exactly the words of its tiling. So the index of a site inside
//! is inside the slice.
//!
//! Units: cells. The caller chooses the side of a cell.

pub(crate) mod bits;
mod class;
pub(crate) mod flood;
mod index;
mod rolling;
mod shifts;
mod sites;
mod tile_key;
mod tile_map;
mod tiling;

pub(crate) use index::{at, inside, inside_mut, masked, masked_mut, wrapped, wrapped_mut};
pub(crate) use rolling::Rolling;
pub(crate) use shifts::{Shift, Shifts, shift};
pub(crate) use tile_map::{SPARE_WORDS, TileMap};
pub(crate) use tiling::Block;

pub use class::{Class, Row};
pub(crate) use sites::RING;
pub use sites::{Site, Sites};
pub(crate) use tile_key::SIDES;
pub use tile_key::TileKey;
pub use tiling::{PAGE_SIDE, PAGE_WORDS, Tiling, TooSmall};

/// A bit plane, read only.
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a> {
    tiling: Tiling<'a>,
    words: &'a [u32],
}

/// A bit plane that can be changed.
#[derive(Debug)]
pub struct PlaneMut<'a> {
    tiling: Tiling<'a>,
    words: &'a mut [u32],
}

impl<'a> Plane<'a> {
    /// Creates a plane over the first words of `words`.
    ///
    /// # Errors
    /// If the memory is too small for the tiles.
    pub fn new(tiling: Tiling<'a>, words: &'a [u32]) -> Result<Self, TooSmall> {
        let (needs, has) = (tiling.words(), words.len());
        let words = words.get(..needs).ok_or(TooSmall { needs, has })?;
        Ok(Self { tiling, words })
    }

    /// Returns the tiles.
    #[must_use]
    pub const fn tiling(&self) -> Tiling<'a> {
        self.tiling
    }

    /// Returns all words, tile after tile.
    #[must_use]
    pub const fn words(&self) -> &'a [u32] {
        self.words
    }

    /// Returns true if the cell is set.
    #[must_use]
    #[inline]
    pub fn get(&self, site: Site) -> bool {
        let word = self.tiling.index(site).map_or(0, |i| at(self.words, i));
        word & site.bit() != 0
    }

    /// Returns the words of a tile; 0 outside.
    #[must_use]
    pub fn page(&self, key: TileKey) -> [u32; PAGE_WORDS] {
        let from = self.tiling.place(key).map(|place| place * PAGE_WORDS);
        let words = from.and_then(|from| self.words.get(from..));
        words
            .and_then(|words| words.first_chunk().copied())
            .unwrap_or_default()
    }

    /// Returns the set cells around a site, in the order of [`Site::neighbours`].
    pub fn neighbours(&self, site: Site) -> impl Iterator<Item = Site> + use<'a> {
        let mut is_set = self.query();
        site.neighbours().filter(move |&near| is_set(near))
    }

    /// Returns a query for cells near each other: whether a cell is set.
    pub(crate) fn query(&self) -> impl FnMut(Site) -> bool + use<'a> {
        let (words, mut finder) = (self.words, self.tiling.finder());
        move |site| at(words, finder.index(site)) & site.bit() != 0
    }

    /// Returns the set cells, tile after tile and row after row.
    #[must_use]
    pub fn sites(&self) -> Sites<'a> {
        Sites::new(*self)
    }

    /// Returns the number of set cells.
    #[must_use]
    pub fn count(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }
}

impl<'a> PlaneMut<'a> {
    /// Creates a plane over the first words of `words`, which keep their values.
    ///
    /// # Errors
    /// If the memory is too small for the tiles.
    pub fn new(tiling: Tiling<'a>, words: &'a mut [u32]) -> Result<Self, TooSmall> {
        let (needs, has) = (tiling.words(), words.len());
        let words = words.get_mut(..needs).ok_or(TooSmall { needs, has })?;
        Ok(Self { tiling, words })
    }

    /// Returns the plane, read only.
    #[must_use]
    pub fn view(&self) -> Plane<'_> {
        Plane {
            tiling: self.tiling,
            words: self.words,
        }
    }

    /// Returns the tiles.
    #[must_use]
    pub const fn tiling(&self) -> Tiling<'a> {
        self.tiling
    }

    /// Returns true if the cell is set.
    #[must_use]
    pub fn get(&self, site: Site) -> bool {
        self.view().get(site)
    }

    /// Sets a cell; does nothing outside. Returns true if the cell was clear.
    pub fn set(&mut self, site: Site) -> bool {
        let was = self.word_mut(site).map(|word| {
            let was = *word;
            *word |= site.bit();
            was
        });
        was.is_some_and(|word| word & site.bit() == 0)
    }

    /// Clears a cell; does nothing outside. Returns true if the cell was set.
    pub fn clear(&mut self, site: Site) -> bool {
        let was = self.word_mut(site).map(|word| {
            let was = *word;
            *word &= !site.bit();
            was
        });
        was.is_some_and(|word| word & site.bit() != 0)
    }

    /// Sets every word to `word`.
    pub fn fill(&mut self, word: u32) {
        self.words.fill(word);
    }

    /// Returns all words, tile after tile.
    #[must_use]
    pub fn words_mut(&mut self) -> &mut [u32] {
        self.words
    }

    fn word_mut(&mut self, site: Site) -> Option<&mut u32> {
        let index = self.tiling.index(site)?;
        self.words.get_mut(index)
    }
}

/// Draws a picture into a plane, from the least cell of a tile on: `#` sets, any other character
/// clears.
///
/// A line is a row, the first one in the north; blanks around a line do not count. The function
/// clears cells beyond the picture and ignores characters beyond the plane.
pub fn draw(plane: &mut PlaneMut<'_>, corner: TileKey, picture: &str) {
    plane.fill(0);
    let corner = corner.least();
    let lines = picture.lines().map(str::trim).filter(|l| !l.is_empty());
    for (y, line) in (corner.y..).zip(lines) {
        for (x, character) in (corner.x..).zip(line.chars()) {
            if character == '#' {
                plane.set(Site { x, y });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{Plane, PlaneMut, Site, TileKey, Tiling, TooSmall, draw};

    fn key(column: i32, row: i32) -> TileKey {
        TileKey::of(column, row).unwrap()
    }

    /// The site so many columns and rows from the first tile's least one.
    fn site(x: u16, y: u16) -> Site {
        let least = key(0, 0).least();
        Site {
            x: least.x + x,
            y: least.y + y,
        }
    }

    #[test]
    fn cells_of_the_tiles_are_kept_and_others_are_not() {
        let keys = [key(0, 0), key(1, 0), key(0, 2)];
        let mut words = [0; 25];
        let mut plane = PlaneMut::new(Tiling::new(&keys), &mut words).unwrap();
        assert!(plane.set(site(17, 3)));
        assert!(!plane.set(site(17, 3)));
        assert!(plane.set(site(15, 32)));
        assert!(!plane.set(site(32, 0)), "no such tile");
        assert!(!plane.set(site(0, 16)), "no such tile");
        let sites: Vec<Site> = plane.view().sites().collect();
        assert_eq!(sites, [site(17, 3), site(15, 32)]);
        assert_eq!(plane.view().page(key(1, 0)), [0, 2 << 16, 0, 0, 0, 0, 0, 0]);
        assert!(plane.clear(site(17, 3)));
        assert!(!plane.clear(site(17, 3)));
        assert_eq!(plane.view().count(), 1);
    }

    #[test]
    fn neighbours_come_sides_first_and_from_the_tiles_beside() {
        let keys = [key(0, 0), key(1, 1)];
        let words = [u32::MAX; 16];
        let plane = Plane::new(Tiling::new(&keys), &words).unwrap();
        let around = |x, y| -> Vec<Site> { plane.neighbours(site(x, y)).collect() };
        let corner = [site(15, 14), site(14, 15), site(14, 14), site(16, 16)];
        assert_eq!(around(15, 15), corner);
        assert_eq!(around(16, 15).first(), Some(&site(15, 15)));
        assert_eq!(around(4, 4).len(), 8);
    }

    #[test]
    fn memory_too_small_is_refused() {
        let keys = [key(0, 0)];
        let error = Plane::new(Tiling::new(&keys), &[0; 5]).unwrap_err();
        assert_eq!(error, TooSmall { needs: 8, has: 5 });
        assert!(std::format!("{error}").contains("8 words in memory of 5"));
    }

    #[test]
    fn a_picture_is_read_back_as_drawn() {
        let picture = "
            #..#.
            .##..
        ";
        let keys = [key(0, 0)];
        let mut words = [u32::MAX; 8];
        draw(
            &mut PlaneMut::new(Tiling::new(&keys), &mut words).unwrap(),
            key(0, 0),
            picture,
        );
        assert_eq!(words, [0b0110 << 16 | 0b1001, 0, 0, 0, 0, 0, 0, 0]);
    }
}
