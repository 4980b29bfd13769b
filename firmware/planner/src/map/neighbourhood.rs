//! The obstacles in a square of up to 5 × 5 cells, and the class of a cell near the last one.
//!
//! ```text
//! bit side · dy + dx = 1 if the cell (dx, dy) from the corner is an obstacle, 0 ≤ dx, dy < side
//! ```
//!
//! What came ([`Class::Negative`](crate::grid::Class) on flat ground) stands too. On uneven ground
//! that class is a hole, or ground that stayed unmeasured: no level beam ends there, so it does not
//! count.
//!
//! Units: map cells.

use crate::geometry::Cell;
use crate::grid::{Class, masked_mut};
use crate::map::tile::Stored;
use crate::map::tiles::{TILE_SIDE, Tiles};

/// The inner 3 × 3 cells of a square of 5 × 5.
pub(crate) const INNER: u32 = 0b01110 << 5 | 0b01110 << 10 | 0b01110 << 15;
/// The plane of the low bits of the classes.
const LOW: usize = 0;
/// The plane of the high bits.
const HIGH: usize = 1;
/// The last column or row of a tile.
const LAST: i32 = TILE_SIDE - 1;

/// A tile; none if it is untouched.
type Tile<'a> = Option<Stored<'a>>;

/// Reads squares of a map. It remembers the tiles of the last ones: the beams of a scan end in few
/// tiles, and finding a tile costs more than reading it.
#[derive(Clone, Debug)]
pub(crate) struct Neighbourhood<'a, const TILES: usize, const SLOTS: usize> {
    tiles: &'a Tiles<TILES, SLOTS>,
    /// The last tile of each parity of column and row. The four tiles around a corner have
    /// different ones.
    last: [((i32, i32), Tile<'a>); 4],
    has_landmarks: bool,
}

impl<'a, const TILES: usize, const SLOTS: usize> Neighbourhood<'a, TILES, SLOTS> {
    pub(crate) fn of(tiles: &'a Tiles<TILES, SLOTS>) -> Self {
        Self {
            tiles,
            // No cell lies in this tile.
            last: [((i32::MAX, i32::MAX), None); 4],
            has_landmarks: tiles.has_landmarks(),
        }
    }

    /// Returns the class of a cell, as [`Tiles::class`].
    pub(crate) fn class(&mut self, cell: Cell) -> Class {
        let tile = self.tile((cell.x >> 5, cell.y >> 5));
        let (row, column) = ((cell.y & LAST) as usize, (cell.x & LAST) as u32);
        tile.map_or(Class::Unknown, |stored| stored.class(row, column))
    }

    /// Returns true if at most one of a coarse cell's four map cells was never measured and is not
    /// forbidden.
    pub(crate) fn is_explored(&mut self, least: Cell) -> bool {
        let fence = self.tiles.fence();
        let unknown = |part: &Cell| self.class(*part) == Class::Unknown && fence.allows(*part);
        least.quarters().filter(unknown).count() < 2
    }

    /// Returns the obstacles that stand in the square of `SIDE` cells, at most 5, from `corner` on.
    #[inline]
    pub(crate) fn obstacles_from<const SIDE: i32>(&mut self, corner: Cell) -> u32 {
        let obstacles = self.square::<SIDE, HIGH>(corner);
        if obstacles != 0 && self.tiles.is_lent() {
            obstacles & !self.square::<SIDE, LOW>(corner)
        } else {
            obstacles
        }
    }

    /// Returns the obstacles that stand and the landmarks in the square of 2 × 2 cells from
    /// `corner` on.
    #[inline]
    pub(crate) fn obstacles_and_landmarks_from(&mut self, corner: Cell) -> u32 {
        let obstacles = self.obstacles_from::<2>(corner);
        if self.has_landmarks {
            obstacles | self.tiles.landmarks_from(corner)
        } else {
            obstacles
        }
    }

    /// Returns true if what stands within two cells of a cell came, and has neither a wall nor
    /// unknown cells beside it there: a person, not a wall whose cells noise had freed. For flat
    /// ground.
    pub(crate) fn has_lone_arrival(&mut self, cell: Cell) -> bool {
        const WHOLE: u32 = (1 << 25) - 1;
        let corner = cell.offset(-2, -2);
        // The low bit of free cells and of what came is set, that of walls and unknown cells not.
        self.square::<5, LOW>(corner) == WHOLE && self.square::<5, HIGH>(corner) != 0
    }

    /// Returns a bit of each cell in the square of `SIDE` cells, at most 5, from `corner` on.
    #[inline]
    fn square<const SIDE: i32, const PLANE: usize>(&mut self, corner: Cell) -> u32 {
        const { assert!(0 < SIDE && SIDE <= 5, "the square fits a word") };
        let (x, y) = (corner.x & LAST, corner.y & LAST);
        if x > TILE_SIDE - SIDE || y > TILE_SIDE - SIDE {
            return self.square_across(corner, SIDE, PLANE);
        }
        let tile = self.tile((corner.x >> 5, corner.y >> 5));
        (0..SIDE).fold(0, |square, row| {
            let bits = line(tile, PLANE, y + row) >> x;
            square | (bits & ((1 << SIDE) - 1)) << (SIDE * row)
        })
    }

    /// [`Self::square`] across the border of tiles.
    #[inline(never)]
    fn square_across(&mut self, corner: Cell, side: i32, plane: usize) -> u32 {
        let (left, right) = (corner.x >> 5, (corner.x + side - 1) >> 5);
        (0..side).fold(0, |square, row| {
            let y = corner.y + row;
            // If both are the same tile, the square ends before the second one begins.
            let low = line(self.tile((left, y >> 5)), plane, y & LAST);
            let high = line(self.tile((right, y >> 5)), plane, y & LAST);
            let bits = (u64::from(high) << TILE_SIDE | u64::from(low)) >> (corner.x & LAST);
            square | (bits as u32 & ((1 << side) - 1)) << (side * row)
        })
    }

    /// Returns a tile.
    #[inline]
    fn tile(&mut self, tile: (i32, i32)) -> Tile<'a> {
        let parity = (tile.0 & 1 | (tile.1 & 1) << 1) as usize;
        let last = masked_mut(&mut self.last, parity);
        if last.0 != tile {
            *last = (tile, self.tiles.stored(self.tiles.entry(tile.0, tile.1)));
        }
        last.1
    }
}

/// Returns a row of a plane.
#[inline(always)]
fn line(tile: Tile<'_>, plane: usize, row: i32) -> u32 {
    tile.map_or(0, |stored| {
        let [low, high] = stored.row(row as usize);
        if plane == LOW { low } else { high }
    })
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Calls `each` with the rows of the 32 × 32 cells from this corner on, least y first: 1 for an
    /// obstacle that stands.
    pub(crate) fn standing_block(&self, corner: Cell, mut each: impl FnMut(u32)) {
        let (x, shift) = (corner.x >> 5, corner.x & 31);
        for tile_y in [corner.y >> 5, (corner.y >> 5) + 1] {
            let [left, right] = [x, x + 1].map(|x| self.stored(self.entry(x, tile_y)));
            let least = (tile_y << 5).max(corner.y);
            let end = ((tile_y + 1) << 5).min(corner.y + TILE_SIDE);
            for y in least..end {
                let [low, high] = [left, right].map(|it| u64::from(line(it, HIGH, y & LAST)));
                let both = low | high << TILE_SIDE;
                each((both >> shift) as u32);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::Neighbourhood;
    use crate::geometry::Cell;
    use crate::grid::Class;
    use crate::map::Tiles;

    #[test]
    fn a_lone_arrival_has_neither_walls_nor_unknown_cells_beside_it() {
        let mut tiles = Box::new(Tiles::<16, 64>::new());
        tiles.reset();
        for (x, y) in (20..44).flat_map(|x| (20..44).map(move |y| (x, y))) {
            tiles.set(Cell { x, y }, Class::Free).expect("room");
        }
        let here = Cell { x: 31, y: 33 };
        let is_lone = |tiles: &Tiles<16, 64>, at| Neighbourhood::of(tiles).has_lone_arrival(at);
        assert!(!is_lone(&tiles, here), "nothing stands there");
        tiles
            .set(here.offset(1, -2), Class::Negative)
            .expect("room");
        assert!(is_lone(&tiles, here));
        assert!(!is_lone(&tiles, here.offset(-2, 0)), "too far off");
        for beside in [Class::Obstacle, Class::Unknown] {
            tiles.set(here.offset(-2, 2), beside).expect("room");
            assert!(!is_lone(&tiles, here), "{beside:?}");
        }
    }

    #[test]
    fn a_hole_on_uneven_ground_is_no_obstacle_that_stands() {
        let here = Cell { x: 31, y: 33 };
        let square = |lent: usize| {
            let mut tiles = Box::new(Tiles::<16, 64>::new());
            tiles.reset();
            tiles.lend(lent);
            tiles.set(here, Class::Obstacle).expect("room");
            tiles.set(here.offset(1, 0), Class::Negative).expect("room");
            Neighbourhood::of(&tiles).obstacles_from::<2>(here)
        };
        assert_eq!(square(0), 0b11, "what came stands");
        assert_eq!(square(1), 0b01);
    }

    #[test]
    fn the_square_and_the_block_are_those_of_single_cells() {
        let mut tiles = Box::new(Tiles::<16, 64>::new());
        tiles.reset();
        let mut seed = 1_u32;
        for (x, y) in (-40..40).flat_map(|x| (-40..40).map(move |y| (x, y))) {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let class = Class::from_bits(seed >> 30 & 1, seed >> 31 & 1);
            tiles.set(Cell { x, y }, class).expect("room");
        }
        let stands = |cell| u32::from(!tiles.class(cell).is_open());
        let single = |corner: Cell, side: i32| -> u32 {
            let bit = |k| stands(corner.offset(k % side, k / side)) << k;
            (0..side * side).map(bit).sum()
        };
        let mut near = Neighbourhood::of(&tiles);
        for corner in (-45..45).flat_map(|x| (-45..45).map(move |y| Cell { x, y })) {
            assert_eq!(
                near.obstacles_from::<5>(corner),
                single(corner, 5),
                "{corner:?}"
            );
            assert_eq!(
                near.obstacles_from::<2>(corner),
                single(corner, 2),
                "{corner:?}"
            );
            assert_eq!(near.class(corner), tiles.class(corner), "{corner:?}");
        }
        for corner in [(-41, -3), (-32, 0), (7, 31), (40, 2)].map(|(x, y)| Cell { x, y }) {
            let mut rows = Vec::new();
            tiles.standing_block(corner, |row| rows.push(row));
            let row = |y| (0..32).map(|k| stands(corner.offset(k, y)) << k).sum();
            let direct: Vec<u32> = (0..32).map(row).collect();
            assert_eq!(rows, direct, "{corner:?}");
        }
    }
}
