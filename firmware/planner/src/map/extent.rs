//! The bounds of the tiles in use, and the reasons why a map refuses a cell.
//!
//! Units: tiles.

/// The reason why the map has no room for a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRoom {
    /// The extent would outgrow the box.
    Box,
    /// Every page of the pool is in use.
    Pool,
}

/// Inclusive bounds of the tiles in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Least tile column and row.
    pub least: (i32, i32),
    /// Greatest tile column and row.
    pub greatest: (i32, i32),
}

impl Extent {
    /// Returns the extent with this tile inside.
    pub(super) const fn with(self, x: i32, y: i32) -> Self {
        Self {
            least: (min(self.least.0, x), min(self.least.1, y)),
            greatest: (max(self.greatest.0, x), max(self.greatest.1, y)),
        }
    }

    /// Returns the number of tiles across.
    #[must_use]
    pub const fn width(self) -> i32 {
        self.greatest.0 - self.least.0 + 1
    }

    /// Returns the number of tiles up.
    #[must_use]
    pub const fn height(self) -> i32 {
        self.greatest.1 - self.least.1 + 1
    }
}

const fn min(a: i32, b: i32) -> i32 {
    if a < b { a } else { b }
}

const fn max(a: i32, b: i32) -> i32 {
    if a > b { a } else { b }
}
