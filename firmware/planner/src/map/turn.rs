//! The move of the whole map into the team's coordinates, once a robot knows how its map lies
//! there.
//!
//! A turn is three shears \[Paeth86\], and a shear shifts whole rows or columns by whole cells:
//!
//! ```text
//! x ← x + s (y + ½) + c₁,  y ← y + sin θ (x + ½) + c₂,  x ← x + s (y + ½) + c₃,  s = −tan(θ / 2)
//! ```
//!
//! So every cell goes to one place, and no two go to the same one: no wall becomes thicker, and no
//! free cell is lost. It takes no memory. Each shear rounds to half a cell.
//!
//! Invariant: a row (or column) is moved from its far end on, so that no cell is overwritten before
//! it is read. The robot's trail and the evidence are forgotten.
//! Units: map cells.

use heapless::Vec;

use crate::geometry::{CELL_M, Cell, MapFromOdom};
use crate::grid::{inside_mut, masked_mut};
use crate::map::Map;
use crate::map::compaction::Entry;
use crate::map::tiles::{NO_TRAIL, NoRoom, TILE_SIDE, Tiles};
use crate::math;

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Moves the map; `robot` is the robot's cell afterwards. Without room for a cell the pool
    /// counts as full. For flat ground.
    #[inline(never)]
    pub(crate) fn turn(&mut self, motion: &MapFromOdom, robot: Cell) {
        self.pool_full |= self.tiles.turn(motion).is_err();
        self.evidence.reset(robot);
        self.last_cell = None;
    }
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    fn turn(&mut self, motion: &MapFromOdom) -> Result<(), NoRoom> {
        let (sin, cos) = math::sin_cos(motion.yaw_rad);
        let slant = -sin / (1.0 + cos);
        let (x, y) = (motion.x_m / CELL_M, motion.y_m / CELL_M);
        self.expand_all()?;
        self.trail.fill(NO_TRAIL);
        self.shear_rows(slant, 0.0)?;
        self.shear_columns(sin, y)?;
        // The last shear moves the second one's shift, too.
        self.shear_rows(slant, x - slant * y)?;
        self.versions.begin_moved();
        self.edits = self.edits.wrapping_add(1);
        Ok(())
    }

    /// Returns the least and the greatest column (or row) of the tiles in a row (or column), or of
    /// all tiles; `None` if there are none.
    #[inline(never)]
    fn span(&self, of_columns: bool, at: Option<i32>) -> Option<(i32, i32)> {
        let mut span: Option<(i32, i32)> = None;
        for (column, row) in self.touched() {
            let (along, across) = if of_columns {
                (column, row)
            } else {
                (row, column)
            };
            if at.is_none_or(|at| at == across) {
                let (least, most) = span.unwrap_or((along, along));
                span = Some((least.min(along), most.max(along)));
            }
        }
        span
    }

    /// Shifts each row.
    #[inline(never)]
    fn shear_rows(&mut self, slant: f32, shift: f32) -> Result<(), NoRoom> {
        let Some((least_row, most_row)) = self.span(false, None) else {
            return Ok(());
        };
        for tile_y in least_row..=most_row {
            let columns = self.span(true, Some(tile_y));
            let Some((least, most)) = columns else {
                continue;
            };
            for y in tile_y * TILE_SIDE..(tile_y + 1) * TILE_SIDE {
                let by = shear(slant, y, shift);
                let first = (least * TILE_SIDE + by.min(0)).div_euclid(TILE_SIDE);
                let last = (most * TILE_SIDE + TILE_SIDE - 1 + by.max(0)).div_euclid(TILE_SIDE);
                for n in 0..=last - first {
                    let column = if by > 0 { last - n } else { first + n };
                    let cells = self.cells(column * TILE_SIDE - by, y);
                    self.put(column, y, cells)?;
                }
            }
        }
        Ok(())
    }

    /// Shifts each column.
    #[inline(never)]
    fn shear_columns(&mut self, slant: f32, shift: f32) -> Result<(), NoRoom> {
        let Some((least_column, most_column)) = self.span(true, None) else {
            return Ok(());
        };
        for column in least_column..=most_column {
            let rows = self.span(false, Some(column));
            let Some((least, most)) = rows else { continue };
            // Columns that go up are moved from the top, and then the others from the bottom.
            for goes_up in [true, false] {
                let groups = groups(column, (slant, shift), goes_up);
                let reach = groups.iter().map(|(by, _)| *by);
                let reach = reach.max_by_key(|by| by.abs()).unwrap_or(0);
                let first = least * TILE_SIDE + reach.min(0);
                let last = most * TILE_SIDE + TILE_SIDE - 1 + reach.max(0);
                let count = if groups.is_empty() {
                    0
                } else {
                    last - first + 1
                };
                for n in 0..count {
                    let y = if goes_up { last - n } else { first + n };
                    let mut cells = self.cells(column * TILE_SIDE, y);
                    for (by, mask) in &groups {
                        let from = self.cells(column * TILE_SIDE, y - by);
                        for (cells, from) in cells.iter_mut().zip(from) {
                            *cells = *cells & !mask | from & mask;
                        }
                    }
                    self.put(column, y, cells)?;
                }
            }
        }
        Ok(())
    }

    /// Returns the words of 32 cells of row `y` from column `x` on.
    #[inline(never)]
    fn cells(&self, x: i32, y: i32) -> [u32; 2] {
        let word = |column: i32| {
            let stored = self.stored(self.entry(column, y >> 5));
            stored.map_or([0; 2], |stored| stored.row((y & 31) as usize))
        };
        let (column, shift) = (x >> 5, x & 31);
        let here = word(column);
        if shift == 0 {
            return here;
        }
        let [low, high] = word(column + 1);
        let join = |here: u32, next: u32| here >> shift | next << (TILE_SIDE - shift);
        [join(here[0], low), join(here[1], high)]
    }

    /// Writes the words of row `y` in a column of tiles. Unknown cells take no page.
    #[inline(never)]
    fn put(&mut self, column: i32, y: i32, cells: [u32; 2]) -> Result<(), NoRoom> {
        if cells == [0; 2] && self.entry(column, y >> 5) == Entry::Untouched {
            return Ok(());
        }
        let page = self.touch(column, y >> 5)?;
        for (plane, word) in inside_mut(&mut self.pool, page)
            .into_iter()
            .flatten()
            .zip(cells)
        {
            *masked_mut(plane, (y & 31) as usize) = word;
        }
        Ok(())
    }
}

/// Returns the shift of a row or a column.
#[inline(never)]
fn shear(slant: f32, of: i32, shift: f32) -> i32 {
    math::floor(slant * (of as f32 + 0.5) + shift + 0.5)
}

/// Returns the shifts of a tile's columns that go up, or of those that go down, each with the
/// columns that it is for.
#[inline(never)]
fn groups(tile: i32, (slant, shift): (f32, f32), goes_up: bool) -> Vec<(i32, u32), 32> {
    let mut groups: Vec<(i32, u32), 32> = Vec::new();
    for k in 0..TILE_SIDE {
        let by = shear(slant, tile * TILE_SIDE + k, shift);
        if by == 0 || (by > 0) != goes_up {
            continue;
        }
        match groups.iter_mut().find(|(other, _)| *other == by) {
            Some((_, mask)) => *mask |= 1 << k,
            // There are as many places as columns.
            None => groups.push((by, 1 << k)).unwrap_or_default(),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::*;
    use crate::grid::Class;

    type Plan = Map<64, 128>;

    fn is_room(x: i32, y: i32) -> bool {
        (-40..50).contains(&x) && (-20..60).contains(&y)
    }

    fn is_wall(x: i32, y: i32) -> bool {
        is_room(x, y) && (x == -40 || x == 49 || y == -20 || y == 59 || (x == 7 && y > 3))
    }

    /// A room of 9 × 8 m with a wall in it.
    fn room() -> Box<Plan> {
        let mut map = Box::new(Plan::new());
        map.reset();
        for (x, y) in (-64..64).flat_map(|x| (-64..64).map(move |y| (x, y))) {
            if is_room(x, y) {
                let wall = is_wall(x, y);
                let class = if wall { Class::Obstacle } else { Class::Free };
                map.tiles.set(Cell { x, y }, class).expect("room");
            }
        }
        map
    }

    fn cells(map: &Plan, class: Class) -> Vec<Cell> {
        let all = (-160..160).flat_map(|x| (-160..160).map(move |y| Cell { x, y }));
        all.filter(|cell| map.class(*cell) == class).collect()
    }

    #[test]
    fn every_cell_goes_to_one_place_near_where_the_motion_takes_it() {
        for (x_m, y_m, degrees) in [
            (0.0, 0.0, 0.0_f32),
            (0.43, -0.26, 0.0),
            (-3.31, 5.08, 9.0),
            (0.7, 0.2, -14.0),
            (0.1, 0.1, 40.0),
        ] {
            let motion = MapFromOdom {
                x_m,
                y_m,
                yaw_rad: degrees.to_radians(),
            };
            let mut map = room();
            let before = [Class::Free, Class::Obstacle].map(|class| cells(&map, class));
            map.turn(&motion, Cell::default());
            assert!(!map.pool_full());
            for (class, before) in [Class::Free, Class::Obstacle].into_iter().zip(before) {
                let after = cells(&map, class);
                assert_eq!(after.len(), before.len(), "{motion:?}");
                let back = motion.inverse();
                for cell in after {
                    let from = back.point(cell.centre());
                    let nearest = before.iter().map(|it| it.centre().distance_m(from));
                    let nearest_m = nearest.fold(f32::INFINITY, f32::min);
                    assert!(nearest_m < 1.2 * CELL_M, "{motion:?} {cell:?} {nearest_m}");
                }
            }
        }
    }

    #[test]
    fn a_map_without_room_says_so() {
        let mut map = Box::new(Map::<2, 24>::new());
        map.reset();
        for x in 0..64 {
            map.tiles
                .set(Cell { x, y: 3 }, Class::Obstacle)
                .expect("room");
        }
        let motion = MapFromOdom {
            x_m: 1.0,
            y_m: 0.0,
            yaw_rad: 0.0,
        };
        map.turn(&motion, Cell::default());
        assert!(map.pool_full());
    }
}
