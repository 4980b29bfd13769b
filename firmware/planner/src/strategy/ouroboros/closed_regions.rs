//! Closed regions: the surroundings of loops, in which no new tractor point is made \[Jorge15,
//! III-A: "the next tractor point must be placed in an unmarked area"\].
//!
//! A region is 0.8 × 0.8 m of the map and has two bits:
//!
//! | `over` | `other` | state of the region |
//! | --- | --- | --- |
//! | 0 | 0 | open |
//! | 0 | 1 | *pending*: the path of the current loop comes near |
//! | 1 | 0 | closed: a loop was closed near it |
//! | 1 | 1 | closed: no loop was closed near it; one was given up, or a revisit ended |
//!
//! Pending regions become closed at the end of the loop, or are dropped when the loop turns out to
//! be none. A closed region keeps its state. The strategy treats both kinds of closed regions
//! alike. The regions need no skeleton and outlast a map that is replaced under them.
//!
//! Departs from \[Jorge15, III-A\], which marks only loops that were closed: loops that were given
//! up and places of a finished revisit become closed regions too, or the robot would begin the same
//! loop again.
//!
//! A loop road through the unexplored has pending regions in tiles that the map does not hold. If
//! there is no place for the tile of a region, the region stays open.
//!
//! Units: map cells.

use crate::geometry::Cell;
use crate::grid::{Shifts, TileMap};

/// Side of a region as a power of two, cells.
const REGION_SHIFT: i32 = 3;
/// Side of a region, cells.
pub(crate) const REGION_CELLS: i32 = 1 << REGION_SHIFT;
/// Regions along a tile as a power of two: a tile's 4 × 4 regions fill a `u16`.
const TILE_SHIFT: i32 = 2;
/// Regions of a tile.
const REGIONS: i32 = 1 << (2 * TILE_SHIFT);

/// Why a region is closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Closed {
    /// A loop was closed near it.
    Loop,
    /// A loop was given up near it, or a revisit ended there.
    GivenUp,
}

/// Closed and pending regions of up to `SLOTS` tiles: the words `over` and `other` of each.
#[derive(Debug)]
pub(crate) struct ClosedRegions<const SLOTS: usize> {
    tiles: TileMap<[u16; 2], SLOTS>,
}

impl<const SLOTS: usize> ClosedRegions<SLOTS> {
    /// No region is closed.
    pub(crate) const fn new() -> Self {
        Self {
            tiles: TileMap::new([0; 2]),
        }
    }

    /// Returns true if no new loop starts in the region of a map cell.
    #[must_use]
    pub(crate) fn is_closed(&self, cell: Cell) -> bool {
        self.closed(cell).is_some()
    }

    /// Returns why the region of a map cell is closed; `None` if it is open or pending.
    #[must_use]
    pub(crate) fn closed(&self, cell: Cell) -> Option<Closed> {
        let (tile, bit) = place(cell.x >> REGION_SHIFT, cell.y >> REGION_SHIFT);
        match self.tiles.get(tile)?.map(|word| word & bit != 0) {
            [false, _] => None,
            [true, false] => Some(Closed::Loop),
            [true, true] => Some(Closed::GivenUp),
        }
    }

    /// Makes the open regions within `near_cells` of a cell of the loop's path pending, along
    /// either axis.
    pub(crate) fn add_pending(&mut self, cell: Cell, near_cells: i32) {
        let span = |at: i32| (at - near_cells) >> REGION_SHIFT..=(at + near_cells) >> REGION_SHIFT;
        for y in span(cell.y) {
            for x in span(cell.x) {
                let (tile, bit) = place(x, y);
                if let Some([over, other]) = self.tiles.get_or_add(tile, [0; 2]) {
                    *other |= bit & !*over;
                }
            }
        }
    }

    /// Closes the pending regions.
    pub(crate) fn close_pending(&mut self, why: Closed) {
        for [over, other] in self.tiles.values_mut() {
            let pending = *other & !*over;
            *over |= pending;
            if why == Closed::Loop {
                *other &= !pending;
            }
        }
    }

    /// Moves each region to the one that holds its middle then. Of several, a closed one keeps its
    /// state. `spare` is memory.
    pub(super) fn shift(&mut self, shifts: Shifts<'_>, spare: &mut [u32]) {
        if shifts.is_empty() {
            return;
        }
        self.tiles
            .rebuild(spare, |tiles, (x, y), [over, other]: [u16; 2]| {
                for k in 0..REGIONS {
                    let middle = Cell {
                        x: (x << TILE_SHIFT | k & 3) * REGION_CELLS + REGION_CELLS / 2,
                        y: (y << TILE_SHIFT | k >> TILE_SHIFT) * REGION_CELLS + REGION_CELLS / 2,
                    };
                    if (over | other) >> k & 1 == 0 {
                        continue;
                    }
                    let to = shifts.moved(middle);
                    let (tile, bit) = place(to.x >> REGION_SHIFT, to.y >> REGION_SHIFT);
                    let [into_over, into_other] = match tiles.get_or_add(tile, [0; 2]) {
                        Some([into, _]) if *into & bit != 0 => continue,
                        Some(into) => into,
                        None => continue,
                    };
                    if over >> k & 1 != 0 {
                        (*into_over, *into_other) = (*into_over | bit, *into_other & !bit);
                    }
                    *into_other |= (other >> k & 1) * bit;
                }
            });
    }

    /// Drops the pending regions.
    pub(crate) fn drop_pending(&mut self) {
        for [over, other] in self.tiles.values_mut() {
            *other &= *over;
        }
    }
}

/// Returns the tile of a region, by column and row of regions, and its bit there.
const fn place(x: i32, y: i32) -> ((i32, i32), u16) {
    let bit = (y & 3) << TILE_SHIFT | (x & 3);
    ((x >> TILE_SHIFT, y >> TILE_SHIFT), 1 << bit)
}

#[cfg(test)]
mod tests {
    use super::{Closed, ClosedRegions, place};
    use crate::config::OuroborosTuning;
    use crate::geometry::Cell;
    use crate::grid::{Shifts, shift};

    const NEAR_CELLS: i32 = OuroborosTuning::DEFAULT.near_cells;

    #[test]
    fn regions_along_a_path_are_closed_with_its_loop_and_not_before() {
        let mut regions: ClosedRegions<12> = ClosedRegions::new();
        for x in -40..20 {
            regions.add_pending(Cell { x, y: -3 }, NEAR_CELLS);
        }
        assert!(!regions.is_closed(Cell { x: -20, y: -3 }));
        regions.drop_pending();
        regions.close_pending(Closed::Loop);
        let is_closed = regions.is_closed(Cell { x: -20, y: -3 });
        assert!(!is_closed, "it was dropped");
        regions.add_pending(Cell { x: -20, y: -3 }, NEAR_CELLS);
        regions.close_pending(Closed::Loop);
        let shifted = |(dx, dy)| Cell {
            x: -20 + dx,
            y: -3 + dy,
        };
        for near in [(0, 0), (10, 0), (-10, 0), (0, 10), (10, -10)].map(shifted) {
            assert!(regions.is_closed(near), "{near:?}");
        }
        for far in [(18, 0), (-18, 0), (0, 18), (0, -18)].map(shifted) {
            assert!(!regions.is_closed(far), "{far:?}");
        }
    }

    #[test]
    fn a_closed_region_tells_why_and_keeps_its_state() {
        let at = |x| Cell { x, y: 0 };
        let mut regions: ClosedRegions<12> = ClosedRegions::new();
        regions.add_pending(at(-40), NEAR_CELLS);
        assert_eq!(regions.closed(at(-40)), None, "pending");
        regions.close_pending(Closed::Loop);
        regions.add_pending(at(40), NEAR_CELLS);
        regions.close_pending(Closed::GivenUp);
        let both = |regions: &ClosedRegions<12>| [-40, 0, 40].map(|x| regions.closed(at(x)));
        let expected = [Some(Closed::Loop), None, Some(Closed::GivenUp)];
        assert_eq!(both(&regions), expected);
        for why in [Closed::Loop, Closed::GivenUp] {
            for x in [-40, 40] {
                regions.add_pending(at(x), NEAR_CELLS);
            }
            assert_eq!(both(&regions), expected, "while a loop is being closed");
            regions.close_pending(why);
            assert_eq!(both(&regions), expected, "{why:?}");
        }
        regions.add_pending(at(0), NEAR_CELLS);
        regions.drop_pending();
        assert_eq!(both(&regions), expected);
    }

    #[test]
    fn regions_go_with_their_tiles() {
        let mut regions: ClosedRegions<12> = ClosedRegions::new();
        for (x, why) in [(4, Closed::Loop), (36, Closed::GivenUp)] {
            regions.add_pending(Cell { x, y: -20 }, 0);
            regions.close_pending(why);
        }
        regions.add_pending(Cell { x: 12, y: -20 }, 0);
        // Both land on the same region: one is closed, and the other pending.
        let list = [shift((0, -1), (16, 4)), shift((1, -1), (-8, 4))];
        regions.shift(Shifts(&list), &mut [0; 36]);
        let closed = |regions: &ClosedRegions<12>| {
            let places = (0..80).step_by(8).filter(|x| {
                let cell = Cell { x: *x, y: -16 };
                regions.is_closed(cell)
            });
            places.collect::<std::vec::Vec<i32>>()
        };
        assert_eq!(closed(&regions), [16, 24]);
        regions.close_pending(Closed::Loop);
        assert_eq!(closed(&regions), [16, 24]);
        let why = [16, 24].map(|x| regions.closed(Cell { x, y: -16 }));
        assert_eq!(why, [Some(Closed::Loop), Some(Closed::GivenUp)]);
    }

    #[test]
    fn every_region_has_a_bit_of_its_own() {
        let places = (0..192).map(|k| place(k % 16 - 8, k / 16 + 100));
        let mut places: std::vec::Vec<_> = places.collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 192);
        places.dedup_by_key(|(tile, _)| *tile);
        assert_eq!(places.len(), 12);
    }

    #[test]
    fn without_a_place_for_its_tile_a_region_stays_open() {
        let mut regions: ClosedRegions<2> = ClosedRegions::new();
        let cells = [16, 48, 80].map(|x| Cell { x, y: 16 });
        for cell in cells {
            regions.add_pending(cell, 0);
        }
        regions.close_pending(Closed::Loop);
        assert_eq!(
            cells.map(|cell| regions.is_closed(cell)),
            [true, true, false]
        );
    }
}
