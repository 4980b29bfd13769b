//! A cell of a plane, its neighbours, and iteration over set cells.
//!
//! Units: columns and rows of the plane.

use crate::grid::Plane;

/// A cell of a bit plane, by column and row. It is not a map cell ([`crate::geometry::Cell`]),
/// because a plane has its own origin and scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Site {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
}

/// Steps to the eight neighbours, sides before diagonals. This order decides ties everywhere.
const STEPS: [(i8, i8); 8] = [
    (1, 0),
    (0, -1),
    (-1, 0),
    (0, 1),
    (1, -1),
    (-1, -1),
    (-1, 1),
    (1, 1),
];

/// Steps to the eight neighbours round a cell, from the north on. Sides have even places.
pub(crate) const RING: [(i8, i8); 8] = [
    (0, -1),
    (1, -1),
    (1, 0),
    (1, 1),
    (0, 1),
    (-1, 1),
    (-1, 0),
    (-1, -1),
];

impl Site {
    /// Returns the site `dx` columns and `dy` rows away; `None` if it leaves the range of the type.
    #[must_use]
    pub fn offset(self, dx: i8, dy: i8) -> Option<Self> {
        Some(Self {
            x: self.x.checked_add_signed(i16::from(dx))?,
            y: self.y.checked_add_signed(i16::from(dy))?,
        })
    }

    /// Returns the sites around, at most eight: first east, north, west and south, with row 0 in
    /// the north, then north-east, north-west, south-west and south-east. They may lie outside a
    /// plane.
    pub fn neighbours(self) -> impl Iterator<Item = Self> {
        STEPS
            .iter()
            .filter_map(move |&(dx, dy)| self.offset(dx, dy))
    }

    /// Returns the site's word in its page; see [`Tiling`](crate::grid::Tiling).
    #[inline]
    pub(crate) const fn word(self) -> usize {
        (self.y >> 1 & 7) as usize
    }

    /// Returns the site's bit in its word.
    #[inline]
    pub(crate) const fn bit(self) -> u32 {
        1 << ((self.y & 1) << 4 | self.x & 15)
    }
}

/// The set cells of a plane, tile after tile and row after row; see [`Plane::sites`].
#[derive(Clone, Debug)]
pub struct Sites<'a> {
    plane: Plane<'a>,
    next_word: usize,
    left: u32,
}

impl<'a> Sites<'a> {
    pub(super) const fn new(plane: Plane<'a>) -> Self {
        Self {
            plane,
            next_word: 0,
            left: 0,
        }
    }
}

impl Iterator for Sites<'_> {
    type Item = Site;

    fn next(&mut self) -> Option<Site> {
        while self.left == 0 {
            self.left = *self.plane.words.get(self.next_word)?;
            self.next_word += 1;
        }
        let bit = self.left.trailing_zeros();
        self.left &= self.left - 1;
        Some(self.plane.tiling.site(self.next_word - 1, bit))
    }
}
