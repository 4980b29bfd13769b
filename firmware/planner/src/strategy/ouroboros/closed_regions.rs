//! Marks: the surroundings of loops that were closed, where no tractor point is made again [Jorge15, III-A].
//!
//! Two bits for 0.8 × 0.8 m of the map: *marked*, and *pending*, near the path of the loop that is being closed. The path is pending
//! until the loop is closed, and forgotten when it is not. Tiles are addressed as the map's are, so the marks lie
//! wherever the map does and need no skeleton.
//!
//! Invariant: as the map's: what is known fits the box, so no two of its tiles share a place. A mark that reaches a tile
//! beyond may fall on the box's other side; it then keeps a tractor point from where one might have been.
//!
//! Units: map cells.

use crate::geometry::Cell;
use crate::grid::TileBox;

/// Cells around the path that are marked with it: 1 m, half a corridor.
pub const NEAR_CELLS: i32 = 10;
/// Map cells along a mark, as a power of two.
const SHIFT: i32 = 3;
/// Marks along a tile, as a power of two.
const TILE_SHIFT: i32 = 2;

/// Marks in a box of tiles; 4 bytes for each of its `SLOTS` places.
#[derive(Debug)]
pub struct Marks<const SLOTS: usize> {
    marked: [u16; SLOTS],
    pending: [u16; SLOTS],
    slots: TileBox,
}

impl<const SLOTS: usize> Marks<SLOTS> {
    /// Nothing is marked; without a box.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            marked: [0; SLOTS],
            pending: [0; SLOTS],
            slots: TileBox::EMPTY,
        }
    }

    /// Forget everything; the box is `width` × `height` tiles.
    pub fn reset(&mut self, (width, height): (i32, i32)) {
        self.marked.fill(0);
        self.pending.fill(0);
        self.slots = TileBox { width, height };
    }

    /// Whether a loop was closed near here.
    #[must_use]
    pub fn is_marked(&self, cell: Cell) -> bool {
        let (slot, bit) = self.place(cell.x >> SHIFT, cell.y >> SHIFT);
        self.marked.get(slot).is_some_and(|marks| marks & bit != 0)
    }

    /// The path of the loop that is being closed comes by here.
    pub fn note(&mut self, cell: Cell) {
        let span = |at: i32| (at - NEAR_CELLS) >> SHIFT..=(at + NEAR_CELLS) >> SHIFT;
        for y in span(cell.y) {
            for x in span(cell.x) {
                let (slot, bit) = self.place(x, y);
                if let Some(marks) = self.pending.get_mut(slot) {
                    *marks |= bit;
                }
            }
        }
    }

    /// The loop is closed: what is pending is marked.
    pub fn keep(&mut self) {
        for (marked, pending) in self.marked.iter_mut().zip(&mut self.pending) {
            *marked |= core::mem::take(pending);
        }
    }

    /// The loop is not closed after all.
    pub fn forget(&mut self) {
        self.pending.fill(0);
    }

    /// The tile's place and the bit in it of a mark, by column and row of marks. Beyond every place without a box.
    fn place(&self, x: i32, y: i32) -> (usize, u16) {
        let slot = self.slots.slot(x >> TILE_SHIFT, y >> TILE_SHIFT);
        (slot, 1 << ((y & 3) << TILE_SHIFT | (x & 3)))
    }
}

impl<const SLOTS: usize> Default for Marks<SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::Marks;
    use crate::geometry::Cell;

    #[test]
    fn a_path_is_marked_when_its_loop_is_closed_and_not_before() {
        let mut marks: Marks<12> = Marks::new();
        marks.note(Cell { x: 0, y: 0 });
        assert!(!marks.is_marked(Cell { x: 0, y: 0 }), "there is no box");
        marks.reset((4, 3));
        for x in -40..20 {
            marks.note(Cell { x, y: -3 });
        }
        assert!(!marks.is_marked(Cell { x: -20, y: -3 }));
        marks.forget();
        marks.keep();
        assert!(!marks.is_marked(Cell { x: -20, y: -3 }), "it was forgotten");
        marks.note(Cell { x: -20, y: -3 });
        marks.keep();
        for (dx, dy) in [(0, 0), (10, 0), (-10, 0), (0, 10), (10, -10)] {
            let near = Cell {
                x: -20 + dx,
                y: -3 + dy,
            };
            assert!(marks.is_marked(near), "{near:?}");
        }
        for (dx, dy) in [(18, 0), (-18, 0), (0, 18), (0, -18)] {
            let far = Cell {
                x: -20 + dx,
                y: -3 + dy,
            };
            assert!(!marks.is_marked(far), "{far:?}");
        }
    }

    #[test]
    fn every_mark_of_the_box_has_a_place_of_its_own() {
        let mut marks: Marks<12> = Marks::new();
        marks.reset((4, 3));
        let cell = |k: i32| Cell {
            x: k % 16 * 8 - 64,
            y: k / 16 * 8 + 800,
        };
        let places = (0..192).map(|k| marks.place(cell(k).x >> 3, cell(k).y >> 3));
        let mut places: std::vec::Vec<_> = places.collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 192);
        assert!(places.iter().all(|(slot, _)| *slot < 12));
    }
}
