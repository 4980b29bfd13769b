//! Memory for cells: bit planes, floods, rolling windows, toroidal tile addresses, and the
//! accessors that replace indexing.
//!
//! A bit plane has one bit per cell and 32 cells per word, in memory that the caller lends:
//!
//! ```text
//! bit k of word j of a row = column 32 j + k
//! ```
//!
//! Rows follow one another, row 0 first. A printed plane shows row 0 on its first line. Cells
//! outside a plane read 0 and cannot be written. A plane takes its shape at run time, so the same
//! memory serves a square box and a long one.
//!
//! Invariant: a plane's slice holds exactly `shape.words()` words. So the index of a row and a word
//! inside the shape is inside the slice.
//!
//! Units: cells. The caller chooses the side of a cell.

use core::fmt;

pub(crate) mod bits;
mod class;
pub(crate) mod flood;
mod index;
mod rolling;
mod shape;
mod sites;
mod tile_key;
mod tile_map;

pub(crate) use index::{at, inside, inside_mut, masked, masked_mut, triple, wrapped, wrapped_mut};
pub(crate) use rolling::Rolling;
pub(crate) use tile_map::TileMap;

pub use class::{Class, Row};
pub use shape::{MAX_ROWS, MAX_WORDS_PER_ROW, Shape, ShapeError};
pub use sites::{Site, Sites};
pub use tile_key::TileKey;

/// A bit plane, read only.
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a> {
    shape: Shape,
    words: &'a [u32],
}

/// A bit plane that can be changed.
#[derive(Debug)]
pub struct PlaneMut<'a> {
    shape: Shape,
    words: &'a mut [u32],
}

impl<'a> Plane<'a> {
    /// Creates a plane over the first words of `words`.
    ///
    /// # Errors
    /// [`ShapeError::TooLarge`] if the memory is too small for the shape.
    pub fn new(shape: Shape, words: &'a [u32]) -> Result<Self, ShapeError> {
        let needs = shape.lend(words.len())?;
        let words = words.get(..needs).unwrap_or(&[]);
        Ok(Self { shape, words })
    }

    /// Returns the numbers of rows and words.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// Returns all words, row after row.
    #[must_use]
    pub const fn words(&self) -> &'a [u32] {
        self.words
    }

    /// Returns true if the cell is set.
    #[must_use]
    #[inline]
    pub fn get(&self, site: Site) -> bool {
        self.word(usize::from(site.y), usize::from(site.x / 32)) & site.bit() != 0
    }

    /// Returns 32 cells of a row; 0 outside.
    #[must_use]
    #[inline]
    pub fn word(&self, row: usize, word: usize) -> u32 {
        self.shape.index(row, word).map_or(0, |i| at(self.words, i))
    }

    /// Returns the words of a row; none outside.
    #[must_use]
    pub fn row(&self, row: usize) -> &'a [u32] {
        row_range(self.shape, row)
            .and_then(|range| self.words.get(range))
            .unwrap_or(&[])
    }

    /// Returns the set cells around a site, in the order of [`Site::neighbours`].
    pub fn neighbours(&self, site: Site) -> impl Iterator<Item = Site> + use<'a> {
        let plane = *self;
        site.neighbours().filter(move |&near| plane.get(near))
    }

    /// Returns the set cells, row after row.
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
    /// [`ShapeError::TooLarge`] if the memory is too small for the shape.
    pub fn new(shape: Shape, words: &'a mut [u32]) -> Result<Self, ShapeError> {
        let needs = shape.lend(words.len())?;
        let words = words.get_mut(..needs).unwrap_or(&mut []);
        Ok(Self { shape, words })
    }

    /// Returns the numbers of rows and words.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// Returns the plane, read only.
    #[must_use]
    pub fn view(&self) -> Plane<'_> {
        Plane {
            shape: self.shape,
            words: self.words,
        }
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

    /// Returns all words, row after row.
    #[must_use]
    pub fn words_mut(&mut self) -> &mut [u32] {
        self.words
    }

    fn word_mut(&mut self, site: Site) -> Option<&mut u32> {
        let index = self
            .shape
            .index(usize::from(site.y), usize::from(site.x / 32))?;
        self.words.get_mut(index)
    }
}

fn row_range(shape: Shape, row: usize) -> Option<core::ops::Range<usize>> {
    let start = shape.index(row, 0)?;
    Some(start..start + shape.words_per_row())
}

/// Prints a plane: `#` is set, `.` is clear; one line per row, row 0 first.
impl fmt::Display for Plane<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in 0..self.shape.rows() {
            for word in self.row(row) {
                for k in 0..32 {
                    f.write_str(if word >> k & 1 == 1 { "#" } else { "." })?;
                }
            }
            f.write_str("\n")?;
        }
        Ok(())
    }
}

/// Draws a picture into a plane, from its corner (0, 0): `#` sets, any other character clears.
///
/// A line is a row, row 0 first; blanks around a line do not count. The function clears cells
/// beyond the picture and ignores characters beyond the plane.
pub fn draw(plane: &mut PlaneMut<'_>, picture: &str) {
    plane.fill(0);
    let lines = picture.lines().map(str::trim).filter(|l| !l.is_empty());
    for (y, line) in (0_u16..).zip(lines) {
        for (x, character) in (0_u16..).zip(line.chars()) {
            if character == '#' {
                plane.set(Site { x, y });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;
    use std::vec::Vec;

    use super::{Plane, PlaneMut, Shape, Site, draw};

    #[test]
    fn bit_k_of_word_j_is_column_32_j_plus_k() {
        let shape = Shape::new(2, 3).unwrap();
        let mut words = [0; 7];
        let mut plane = PlaneMut::new(shape, &mut words).unwrap();
        assert!(plane.set(Site { x: 33, y: 1 }));
        assert!(!plane.set(Site { x: 33, y: 1 }));
        assert!(plane.set(Site { x: 0, y: 2 }));
        assert!(!plane.set(Site { x: 64, y: 0 }), "beyond the last column");
        assert!(!plane.set(Site { x: 0, y: 3 }), "beyond the last row");
        assert_eq!(plane.view().row(1), [0, 2]);
        assert_eq!(plane.view().count(), 2);
        assert!(plane.clear(Site { x: 33, y: 1 }));
        assert!(!plane.clear(Site { x: 33, y: 1 }));
        assert_eq!(words, [0, 0, 0, 0, 1, 0, 0]);
    }

    #[test]
    fn neighbours_come_sides_first_and_never_from_the_next_row() {
        let shape = Shape::new(1, 3).unwrap();
        let mut words = [u32::MAX; 3];
        words[1] = !(1 << 30);
        let plane = Plane::new(shape, &words).unwrap();
        let around: Vec<(u16, u16)> = plane
            .neighbours(Site { x: 31, y: 1 })
            .map(|s| (s.x, s.y))
            .collect();
        assert_eq!(around, [(31, 0), (31, 2), (30, 0), (30, 2)]);
        let corner: Vec<(u16, u16)> = plane
            .neighbours(Site { x: 0, y: 0 })
            .map(|s| (s.x, s.y))
            .collect();
        assert_eq!(corner, [(1, 0), (0, 1), (1, 1)]);
    }

    #[test]
    fn a_picture_is_read_back_as_drawn() {
        let picture = "
            #..#.
            .##..
        ";
        let shape = Shape::new(1, 3).unwrap();
        let mut words = [u32::MAX; 3];
        draw(&mut PlaneMut::new(shape, &mut words).unwrap(), picture);
        assert_eq!(words, [0b01001, 0b00110, 0]);
        let plane = Plane::new(shape, &words).unwrap();
        let text = plane.to_string();
        assert!(text.starts_with("#..#...") && text.lines().count() == 3);
        let sites: Vec<(u16, u16)> = plane.sites().map(|s| (s.x, s.y)).collect();
        assert_eq!(sites, [(0, 0), (3, 0), (1, 1), (2, 1)]);
    }
}
