//! The size of a plane, and rectangles of whole words in it.
//!
//! Units: rows, and words of 32 cells.

use core::fmt;

use crate::grid::Site;

/// Greatest number of words in a row: a `u32` then has a bit for each word and one more.
pub const MAX_WORDS_PER_ROW: usize = 31;
/// Greatest number of rows: the index of a word then fits in a `u16`.
pub const MAX_ROWS: usize = 2048;

const _: () = assert!(MAX_WORDS_PER_ROW * MAX_ROWS <= 1 << 16);

/// The numbers of rows and words of a plane; neither is 0.
///
/// The fields store each number less one. So the smallest shape is all zeros, and a static planner
/// costs no flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    more_words: u16,
    more_rows: u16,
}

/// The reason why a plane of this shape is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeError {
    /// No rows or no words.
    Empty,
    /// More words in a row than [`MAX_WORDS_PER_ROW`].
    TooWide(usize),
    /// More rows than [`MAX_ROWS`].
    TooTall(usize),
    /// The lent memory is too small.
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
                "a plane of {needs} words in memory of {has}: lend more memory or take a \
                 smaller box"
            ),
        }
    }
}

impl core::error::Error for ShapeError {}

impl Shape {
    /// One row of one word.
    pub const UNIT: Self = Self {
        more_words: 0,
        more_rows: 0,
    };

    /// Creates a shape of `rows` rows of `words_per_row` words (32 cells each).
    ///
    /// # Errors
    /// [`ShapeError`] if a side is 0 or beyond its limit.
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
            more_words: words_per_row as u16 - 1,
            more_rows: rows as u16 - 1,
        })
    }

    /// Returns the number of words in a row.
    #[must_use]
    pub const fn words_per_row(self) -> usize {
        self.more_words as usize + 1
    }

    /// Returns the number of rows.
    #[must_use]
    pub const fn rows(self) -> usize {
        self.more_rows as usize + 1
    }

    /// Returns the number of columns.
    #[must_use]
    pub const fn columns(self) -> usize {
        self.words_per_row() * 32
    }

    /// Returns the number of words in the plane.
    #[must_use]
    pub const fn words(self) -> usize {
        self.words_per_row() * self.rows()
    }

    /// Returns true if the site lies in the plane.
    #[must_use]
    pub const fn contains(self, site: Site) -> bool {
        (site.x as usize) < self.columns() && (site.y as usize) < self.rows()
    }

    /// Returns the index of a word; `None` outside.
    #[inline]
    pub(crate) fn index(self, row: usize, word: usize) -> Option<usize> {
        (row < self.rows() && word < self.words_per_row())
            .then(|| row * self.words_per_row() + word)
    }

    /// Returns the number of words that the plane needs if `has` words are enough.
    pub(super) fn lend(self, has: usize) -> Result<usize, ShapeError> {
        let needs = self.words();
        if has < needs {
            return Err(ShapeError::TooLarge { needs, has });
        }
        Ok(needs)
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::{Shape, ShapeError};
    use crate::grid::Plane;

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
}
