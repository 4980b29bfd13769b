//! Bit planes: one bit a cell, 32 cells a word, over memory lent by the caller. The one place that indexes.
//!
//! Bit k of word j of a row is column 32 j + k. Rows are stored one after another, row 0 first; a printed plane shows
//! row 0 on its first line. Whatever lies outside a plane reads 0 and cannot be written. Shapes are chosen at run
//! time, so one piece of memory serves a square box as well as a long one.
//!
//! Invariant: a plane's slice holds exactly `shape.words()` words, so that an index computed from a row and a word
//! inside the shape is inside the slice.
//!
//! Units: cells; the side of a cell is the caller's business.

use core::fmt;

mod sites;
pub use sites::{Site, Sites};

/// Greatest number of words in a row: a row and a word more then have one bit each in a `u32`.
pub const MAX_WORDS_PER_ROW: usize = 31;
/// Greatest number of rows: the index of a word then fits in a `u16`.
pub const MAX_ROWS: usize = 2048;

const _: () = assert!(MAX_WORDS_PER_ROW * MAX_ROWS <= 1 << 16);

/// Rows and words of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    words_per_row: u16,
    rows: u16,
}

/// A rectangle of whole words inside a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First row.
    pub first_row: u16,
    /// Number of rows.
    pub rows: u16,
    /// First word in each row.
    pub first_word: u16,
    /// Number of words in each row.
    pub words: u16,
}

/// Why a plane of this shape cannot be had.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeError {
    /// No rows or no words.
    Empty,
    /// More words in a row than [`MAX_WORDS_PER_ROW`].
    TooWide(usize),
    /// More rows than [`MAX_ROWS`].
    TooTall(usize),
    /// The memory lent is too small.
    TooLarge {
        /// Words that the shape needs.
        needs: usize,
        /// Words that were lent.
        has: usize,
    },
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(
                f,
                "a plane without cells: give at least one word and one row"
            ),
            Self::TooWide(words) => write!(
                f,
                "{words} words in a row: give at most {MAX_WORDS_PER_ROW}, or swap the axes"
            ),
            Self::TooTall(rows) => {
                write!(f, "{rows} rows: give at most {MAX_ROWS}, or swap the axes")
            }
            Self::TooLarge { needs, has } => write!(
                f,
                "a plane of {needs} words in memory of {has}: lend more memory or take a smaller box"
            ),
        }
    }
}

impl core::error::Error for ShapeError {}

impl Shape {
    /// One word.
    pub const UNIT: Self = Self {
        words_per_row: 1,
        rows: 1,
    };

    /// A shape of `rows` rows of `words_per_row` words (32 cells each).
    ///
    /// # Errors
    /// When a side is 0 or beyond its limit.
    pub const fn new(words_per_row: usize, rows: usize) -> Result<Self, ShapeError> {
        if words_per_row == 0 || rows == 0 {
            return Err(ShapeError::Empty);
        }
        if words_per_row > MAX_WORDS_PER_ROW {
            return Err(ShapeError::TooWide(words_per_row));
        }
        if rows > MAX_ROWS {
            return Err(ShapeError::TooTall(rows));
        }
        Ok(Self {
            words_per_row: words_per_row as u16,
            rows: rows as u16,
        })
    }

    /// Words in a row.
    #[must_use]
    pub const fn words_per_row(self) -> usize {
        self.words_per_row as usize
    }

    /// Rows.
    #[must_use]
    pub const fn rows(self) -> usize {
        self.rows as usize
    }

    /// Columns.
    #[must_use]
    pub const fn columns(self) -> usize {
        self.words_per_row() * 32
    }

    /// Words in the plane.
    #[must_use]
    pub const fn words(self) -> usize {
        self.words_per_row() * self.rows()
    }

    /// Whether the site lies in the plane.
    #[must_use]
    pub const fn contains(self, site: Site) -> bool {
        (site.x as usize) < self.columns() && (site.y as usize) < self.rows()
    }

    /// The whole plane.
    #[must_use]
    pub const fn whole(self) -> Region {
        Region {
            first_row: 0,
            rows: self.rows,
            first_word: 0,
            words: self.words_per_row,
        }
    }

    /// The smallest region that holds both corners and all between; corners outside are moved to the border.
    #[must_use]
    pub fn region(self, one: Site, other: Site) -> Region {
        let row = |y: u16| y.min(self.rows - 1);
        let word = |x: u16| (x / 32).min(self.words_per_row - 1);
        let (top, bottom) = (row(one.y.min(other.y)), row(one.y.max(other.y)));
        let (left, right) = (word(one.x.min(other.x)), word(one.x.max(other.x)));
        Region {
            first_row: top,
            rows: bottom - top + 1,
            first_word: left,
            words: right - left + 1,
        }
    }

    /// Index of a word, and `None` outside.
    #[inline]
    pub(crate) fn index(self, row: usize, word: usize) -> Option<usize> {
        (row < self.rows() && word < self.words_per_row())
            .then(|| row * self.words_per_row() + word)
    }

    fn lend(self, has: usize) -> Result<usize, ShapeError> {
        let needs = self.words();
        if has < needs {
            return Err(ShapeError::TooLarge { needs, has });
        }
        Ok(needs)
    }
}

impl Region {
    /// Words in the region.
    #[must_use]
    pub const fn size(self) -> usize {
        self.rows as usize * self.words as usize
    }

    /// The part of the region that lies in a plane of this shape.
    #[must_use]
    pub(crate) fn within(self, shape: Shape) -> Self {
        let first_row = self.first_row.min(shape.rows);
        let first_word = self.first_word.min(shape.words_per_row);
        Self {
            first_row,
            rows: self.rows.min(shape.rows - first_row),
            first_word,
            words: self.words.min(shape.words_per_row - first_word),
        }
    }
}

/// A plane to look at.
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a> {
    shape: Shape,
    words: &'a [u32],
}

/// A plane to change.
#[derive(Debug)]
pub struct PlaneMut<'a> {
    shape: Shape,
    words: &'a mut [u32],
}

impl<'a> Plane<'a> {
    /// A plane over the first words of `words`.
    ///
    /// # Errors
    /// When the memory is too small for the shape.
    pub fn new(shape: Shape, words: &'a [u32]) -> Result<Self, ShapeError> {
        let needs = shape.lend(words.len())?;
        let words = words.get(..needs).unwrap_or(&[]);
        Ok(Self { shape, words })
    }

    /// Rows and words.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// All words, row after row.
    #[must_use]
    pub const fn words(&self) -> &'a [u32] {
        self.words
    }

    /// Whether the cell is set.
    #[must_use]
    #[inline]
    pub fn get(&self, site: Site) -> bool {
        self.word(usize::from(site.y), usize::from(site.x / 32)) & site.bit() != 0
    }

    /// 32 cells of a row.
    #[must_use]
    #[inline]
    pub fn word(&self, row: usize, word: usize) -> u32 {
        self.shape.index(row, word).map_or(0, |i| at(self.words, i))
    }

    /// The words of a row; none outside.
    #[must_use]
    pub fn row(&self, row: usize) -> &'a [u32] {
        row_range(self.shape, row)
            .and_then(|range| self.words.get(range))
            .unwrap_or(&[])
    }

    /// The set cells around a site, in the order of [`Site::neighbours`].
    pub fn neighbours(&self, site: Site) -> impl Iterator<Item = Site> + use<'a> {
        let plane = *self;
        site.neighbours().filter(move |&near| plane.get(near))
    }

    /// The set cells, row after row.
    #[must_use]
    pub fn sites(&self) -> Sites<'a> {
        Sites::new(*self)
    }

    /// Number of set cells.
    #[must_use]
    pub fn count(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }
}

impl<'a> PlaneMut<'a> {
    /// A plane over the first words of `words`, which keep their values.
    ///
    /// # Errors
    /// When the memory is too small for the shape.
    pub fn new(shape: Shape, words: &'a mut [u32]) -> Result<Self, ShapeError> {
        let needs = shape.lend(words.len())?;
        let words = words.get_mut(..needs).unwrap_or(&mut []);
        Ok(Self { shape, words })
    }

    /// Rows and words.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// The same plane, to look at.
    #[must_use]
    pub fn view(&self) -> Plane<'_> {
        Plane {
            shape: self.shape,
            words: self.words,
        }
    }

    /// Whether the cell is set.
    #[must_use]
    pub fn get(&self, site: Site) -> bool {
        self.view().get(site)
    }

    /// Set a cell; whether it was clear before. Outside nothing happens.
    pub fn set(&mut self, site: Site) -> bool {
        let was = self.word_mut(site).map(|word| {
            let was = *word;
            *word |= site.bit();
            was
        });
        was.is_some_and(|word| word & site.bit() == 0)
    }

    /// Clear a cell; whether it was set before. Outside nothing happens.
    pub fn clear(&mut self, site: Site) -> bool {
        let was = self.word_mut(site).map(|word| {
            let was = *word;
            *word &= !site.bit();
            was
        });
        was.is_some_and(|word| word & site.bit() != 0)
    }

    /// Set every word to `word`.
    pub fn fill(&mut self, word: u32) {
        self.words.fill(word);
    }

    /// The words of a row; none outside.
    #[must_use]
    pub fn row_mut(&mut self, row: usize) -> &mut [u32] {
        row_range(self.shape, row)
            .and_then(|range| self.words.get_mut(range))
            .unwrap_or(&mut [])
    }

    /// All words, row after row.
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

/// The word at an index, 0 outside.
#[inline(always)]
pub(crate) fn at(words: &[u32], index: usize) -> u32 {
    words.get(index).copied().unwrap_or(0)
}

/// The words at `index − 1`, `index`, `index + 1`, 0 outside: one check for the three.
#[inline(always)]
pub(crate) fn triple(words: &[u32], index: usize) -> [u32; 3] {
    match words
        .get(index.wrapping_sub(1)..)
        .and_then(|rest| rest.first_chunk::<3>())
    {
        Some(three) => *three,
        None => triple_at_end(words, index),
    }
}

#[cold]
#[inline(never)]
fn triple_at_end(words: &[u32], index: usize) -> [u32; 3] {
    [
        at(words, index.wrapping_sub(1)),
        at(words, index),
        at(words, index.wrapping_add(1)),
    ]
}

/// The picture of a plane: `#` set, `.` clear, one line a row, row 0 first.
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

/// Draw a picture into a plane, from its corner (0, 0): `#` sets, any other character clears; one line a row, row 0
/// first, blanks around a line ignored. Cells beyond the picture are cleared, cells beyond the plane dropped.
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

    use super::{Plane, PlaneMut, Shape, ShapeError, Site, draw, triple};

    #[test]
    fn shapes_that_cannot_be_are_refused() {
        assert_eq!(Shape::new(0, 4), Err(ShapeError::Empty));
        assert_eq!(Shape::new(32, 4), Err(ShapeError::TooWide(32)));
        assert_eq!(Shape::new(1, 5000), Err(ShapeError::TooTall(5000)));
        let shape = Shape::new(2, 3).unwrap();
        let error = Plane::new(shape, &[0; 5]).unwrap_err();
        assert_eq!(error, ShapeError::TooLarge { needs: 6, has: 5 });
        assert!(error.to_string().contains("6 words in memory of 5"));
    }

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

    #[test]
    fn regions_cover_their_corners_in_whole_words() {
        let shape = Shape::new(4, 50).unwrap();
        let region = shape.region(Site { x: 70, y: 900 }, Site { x: 31, y: 7 });
        assert_eq!((region.first_word, region.words), (0, 3));
        assert_eq!((region.first_row, region.rows), (7, 43));
        assert_eq!(shape.whole().size(), 200);
    }

    #[test]
    fn three_words_read_zero_beyond_the_ends() {
        let words = [1, 2, 3];
        assert_eq!(triple(&words, 1), [1, 2, 3]);
        assert_eq!(triple(&words, 0), [0, 1, 2]);
        assert_eq!(triple(&words, 2), [2, 3, 0]);
        assert_eq!(triple(&words, 9), [0, 0, 0]);
    }
}
