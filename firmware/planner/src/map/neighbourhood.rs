//! The obstacles in a square of up to 5 × 5 cells.
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
use crate::grid::masked;
use crate::map::tiles::{TILE_SIDE, Tiles};

/// The plane of the low bits of the classes.
const LOW: usize = 0;
/// The plane of the high bits.
const HIGH: usize = 1;

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Returns the obstacles that stand in the square of `SIDE` cells, at most 5, from `corner` on.
    #[inline]
    pub(crate) fn obstacles_from<const SIDE: i32>(&self, corner: Cell) -> u32 {
        let obstacles = self.square::<SIDE, HIGH>(corner);
        if obstacles != 0 && self.is_lent() {
            obstacles & !self.square::<SIDE, LOW>(corner)
        } else {
            obstacles
        }
    }

    /// Returns true if what stands within two cells of a cell came, and has neither a wall nor
    /// unknown cells beside it there: a person, not a wall whose cells noise had freed. For flat
    /// ground.
    pub(crate) fn has_lone_arrival(&self, cell: Cell) -> bool {
        const WHOLE: u32 = (1 << 25) - 1;
        let corner = cell.offset(-2, -2);
        // The low bit of free cells and of what came is set, that of walls and unknown cells not.
        self.square::<5, LOW>(corner) == WHOLE && self.square::<5, HIGH>(corner) != 0
    }

    /// Returns a bit of each cell in the square of `SIDE` cells, at most 5, from `corner` on.
    #[inline]
    fn square<const SIDE: i32, const PLANE: usize>(&self, corner: Cell) -> u32 {
        const { assert!(0 < SIDE && SIDE <= 5, "the square fits a word") };
        let Cell { x, y } = corner;
        let shift = x & (TILE_SIDE - 1);
        let mut square = 0;
        let mut row = 0;
        while row < SIDE {
            let tile_y = (y + row) >> 5;
            // Rows of the square in this row of tiles.
            let last = SIDE.min(((tile_y + 1) << 5) - y);
            let left = self.plane::<PLANE>(x >> 5, tile_y);
            let spills = shift > TILE_SIDE - SIDE;
            let right = spills.then(|| self.plane::<PLANE>((x >> 5) + 1, tile_y));
            while row < last {
                let line = ((y + row) & 31) as usize;
                let mut bits = left(line) >> shift;
                if let Some(right) = &right {
                    bits |= right(line) << (TILE_SIDE - shift);
                }
                square |= (bits & ((1 << SIDE) - 1)) << (SIDE * row);
                row += 1;
            }
        }
        square
    }

    /// Calls `each` with the rows of the 32 × 32 cells from this corner on, least y first: 1 for an
    /// obstacle that stands.
    pub(crate) fn standing_block(&self, corner: Cell, mut each: impl FnMut(u32)) {
        let (x, shift) = (corner.x >> 5, corner.x & 31);
        for tile_y in [corner.y >> 5, (corner.y >> 5) + 1] {
            let (left, right) = (
                self.plane::<HIGH>(x, tile_y),
                self.plane::<HIGH>(x + 1, tile_y),
            );
            let least = (tile_y << 5).max(corner.y);
            let end = ((tile_y + 1) << 5).min(corner.y + TILE_SIDE);
            for y in least..end {
                let line = (y & 31) as usize;
                let both = u64::from(left(line)) | u64::from(right(line)) << TILE_SIDE;
                each((both >> shift) as u32);
            }
        }
    }

    /// Returns the rows of a plane of a tile. In the high one an obstacle that stands is 1.
    #[inline(always)]
    fn plane<const PLANE: usize>(&self, tile_x: i32, tile_y: i32) -> impl Fn(usize) -> u32 {
        let planes = self.planes(self.entry(tile_x, tile_y));
        move |line| match planes {
            Some([low, high]) => *masked(if PLANE == LOW { low } else { high }, line),
            None => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

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
        assert!(!tiles.has_lone_arrival(here), "nothing stands there");
        tiles
            .set(here.offset(1, -2), Class::Negative)
            .expect("room");
        assert!(tiles.has_lone_arrival(here));
        assert!(!tiles.has_lone_arrival(here.offset(-2, 0)), "too far off");
        for beside in [Class::Obstacle, Class::Unknown] {
            tiles.set(here.offset(-2, 2), beside).expect("room");
            assert!(!tiles.has_lone_arrival(here), "{beside:?}");
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
            tiles.obstacles_from::<2>(here)
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
        for corner in (-45..45).flat_map(|x| (-45..45).map(move |y| Cell { x, y })) {
            assert_eq!(
                tiles.obstacles_from::<5>(corner),
                single(corner, 5),
                "{corner:?}"
            );
            assert_eq!(
                tiles.obstacles_from::<2>(corner),
                single(corner, 2),
                "{corner:?}"
            );
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
