//! The shifts of a correction: where the places go that lay in tiles of the map.
//!
//! ```text
//! place ← place + shift of its tile, or + 0 if the tile has none
//! ```
//!
//! The list lies in scratch memory: two words for each tile that is shifted.
//!
//! Units: map cells; tiles of 32 × 32 cells.

use crate::geometry::Cell;

/// Cells along a tile's side, as a power of two.
const TILE_SHIFT: i32 = 5;

/// A tile and its shift: column and row, then cells along x and y.
pub(crate) type Shift = [u32; 2];

/// Returns the entry of a tile.
pub(crate) fn shift((column, row): (i16, i16), (x, y): (i8, i8)) -> Shift {
    let pair = |low: i16, high: i16| u32::from(low as u16) | u32::from(high as u16) << 16;
    [pair(column, row), pair(x.into(), y.into())]
}

/// Returns the two numbers of a word.
fn unpair(word: u32) -> (i32, i32) {
    (i32::from(word as i16), i32::from((word >> 16) as i16))
}

/// The shifts of some tiles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shifts<'a>(pub(crate) &'a [Shift]);

impl Shifts<'_> {
    /// Returns true if no tile is shifted.
    pub(crate) const fn is_empty(self) -> bool {
        self.0.is_empty()
    }

    /// Returns the shift of a tile; of two, the first one.
    fn of(self, tile: (i32, i32)) -> (i32, i32) {
        let found = self.0.iter().find(|[at, _]| unpair(*at) == tile);
        found.map_or((0, 0), |&[_, by]| unpair(by))
    }

    /// Returns where a place goes.
    #[inline(never)]
    pub(crate) fn moved(self, cell: Cell) -> Cell {
        let (x, y) = self.of((cell.x >> TILE_SHIFT, cell.y >> TILE_SHIFT));
        cell.offset(x, y)
    }

    /// Returns where a coarse cell goes, which is named by its least map cell.
    pub(crate) fn moved_coarse(self, cell: Cell) -> Cell {
        let Cell { x, y } = self.moved(cell);
        Cell {
            x: x & !1,
            y: y & !1,
        }
    }

    /// Moves a place that is kept in 16 bits.
    pub(crate) fn move_short(self, place: &mut [i16; 2]) {
        let [x, y] = place.map(i32::from);
        let Cell { x, y } = self.moved(Cell { x, y });
        *place = [x, y].map(|at| at as i16);
    }
}

#[cfg(test)]
mod tests {
    use super::{Shifts, shift};
    use crate::geometry::Cell;

    #[test]
    fn a_place_goes_with_its_tile_and_others_stay() {
        let list = [shift((-1, 2), (-128, 127)), shift((0, 0), (3, 0))];
        let shifts = Shifts(&list);
        let moved = |x, y| {
            let Cell { x, y } = shifts.moved(Cell { x, y });
            (x, y)
        };
        assert_eq!(moved(-1, 64), (-129, 191));
        assert_eq!(moved(-32, 95), (-160, 222));
        assert_eq!([moved(-33, 64), moved(-1, 63)], [(-33, 64), (-1, 63)]);
        assert_eq!([moved(0, 0), moved(31, 31)], [(3, 0), (34, 31)]);
        // A tile's number has 16 bits, a cell's more.
        assert_eq!(moved(1 << 21, 0), (1 << 21, 0));
        let mut short = [31, -1];
        shifts.move_short(&mut short);
        assert_eq!(short, [31, -1]);
    }
}
