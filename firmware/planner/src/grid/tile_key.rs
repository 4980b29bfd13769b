//! The place of a tile as one number, in the order of rows.
//!
//! ```text
//! key = (row + 128) · 256 + column + 128        of tiles, counted from the first one
//! ```
//!
//! Sorted keys are tiles row by row, as in a plane without gaps.
//!
//! Invariant: no tile lies in the first or the last column or row of the range. So the keys of a
//! tile's neighbours differ from its own by 1, 255, 256 and 257, and none of these is the key of a
//! tile elsewhere.
//!
//! Units: tiles.

use crate::grid::Site;

/// Cells of a plane along a tile's side, as a power of two.
const SHIFT: u16 = 4;
/// Column and row of the first tile.
const MIDDLE: i32 = 128;

/// Steps to the tiles at the four sides: columns and rows.
pub(crate) const SIDES: [(i32, i32); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];

/// The place of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TileKey(u16);

impl TileKey {
    /// Tiles from the first one to the end of the range, in either direction: 403 m.
    pub const REACH: i32 = 126;
    /// The key of no tile.
    pub(crate) const NONE: Self = Self(0);

    /// Returns the key of a tile that lies so many tiles from the first one; `None` beyond the
    /// range of ±126.
    #[must_use]
    #[inline]
    pub const fn of(columns: i32, rows: i32) -> Option<Self> {
        if columns < -Self::REACH
            || columns > Self::REACH
            || rows < -Self::REACH
            || rows > Self::REACH
        {
            return None;
        }
        Some(Self(((rows + MIDDLE) << 8 | (columns + MIDDLE)) as u16))
    }

    /// Returns how many columns and rows the tile lies from the first one.
    #[must_use]
    pub const fn offset(self) -> (i32, i32) {
        (
            (self.0 & 0xff) as i32 - MIDDLE,
            (self.0 >> 8) as i32 - MIDDLE,
        )
    }

    /// Returns the key of the tile that holds a site; [`Self::NONE`] outside.
    #[must_use]
    #[inline]
    pub const fn at(site: Site) -> Self {
        let (column, row) = (site.x >> SHIFT, site.y >> SHIFT);
        if column | row > 0xff {
            return Self::NONE;
        }
        Self(row << 8 | column)
    }

    /// Returns the tile's least site.
    #[must_use]
    pub const fn least(self) -> Site {
        Site {
            x: (self.0 & 0xff) << SHIFT,
            y: self.0 >> 8 << SHIFT,
        }
    }
}

impl TileKey {
    /// Returns the key of a tile so many columns and rows away, at most one each way.
    #[inline]
    pub(crate) const fn beside(self, columns: i32, rows: i32) -> Self {
        Self((self.0 as i32 + (rows << 8) + columns) as u16)
    }

    /// Returns how many columns after another tile of the same row this one lies; `None` if it
    /// lies before.
    #[inline]
    pub(crate) fn columns_after(self, other: Self) -> Option<usize> {
        self.0.checked_sub(other.0).map(usize::from)
    }
}

/// Returns the place of a key in a sorted list.
#[inline]
pub(crate) fn find(keys: &[TileKey], key: TileKey) -> Option<usize> {
    keys.binary_search(&key).ok()
}
