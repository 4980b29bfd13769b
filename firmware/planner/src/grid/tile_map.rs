//! A value for each of a number of tiles, wherever they lie.
//!
//! The tiles are a sorted list of keys ([`TileKey`]), so memory is needed for the tiles alone,
//! whatever the shape of the area that they cover. The first tile is the origin of the keys.
//!
//! Invariant: the keys are sorted, and value i belongs to key i.
//! Units: tiles.

use heapless::Vec;

use crate::grid::tile_key::{TileKey, find};
use crate::grid::{inside, inside_mut};

/// Values of up to `N` tiles. A value's place in the list moves when a tile is added.
#[derive(Debug)]
pub(crate) struct TileMap<T, const N: usize> {
    keys: Vec<TileKey, N>,
    values: [T; N],
    /// Column and row of the first tile.
    origin: (i32, i32),
}

impl<T: Copy, const N: usize> TileMap<T, N> {
    /// Creates a map without tiles; `empty` fills the memory.
    pub(crate) const fn new(empty: T) -> Self {
        Self {
            keys: Vec::new(),
            values: [empty; N],
            origin: (0, 0),
        }
    }

    /// Removes all tiles.
    pub(crate) fn clear(&mut self) {
        self.keys.clear();
    }

    /// Returns the column and the row of the first tile.
    pub(crate) const fn origin(&self) -> (i32, i32) {
        self.origin
    }

    /// Returns the keys, sorted.
    pub(crate) fn keys(&self) -> &[TileKey] {
        &self.keys
    }

    /// Returns the column and the row of the tile with this key.
    pub(crate) const fn tile(&self, key: TileKey) -> (i32, i32) {
        let (columns, rows) = key.offset();
        (self.origin.0 + columns, self.origin.1 + rows)
    }

    /// Returns a tile's key; `None` if it is too far from the first tile.
    #[inline]
    fn key(&self, (column, row): (i32, i32)) -> Option<TileKey> {
        let (columns, rows) = (
            column.wrapping_sub(self.origin.0),
            row.wrapping_sub(self.origin.1),
        );
        TileKey::of(columns, rows)
    }

    /// Returns true if a tile is within range of the first one, or would be the first.
    pub(crate) fn reaches(&self, tile: (i32, i32)) -> bool {
        self.keys.is_empty() || self.key(tile).is_some()
    }

    /// Returns true if there is no place for another tile.
    pub(crate) fn is_full(&self) -> bool {
        self.keys.is_full()
    }

    /// Returns a tile's place in the list.
    #[inline]
    pub(crate) fn place(&self, tile: (i32, i32)) -> Option<usize> {
        find(&self.keys, self.key(tile)?)
    }

    /// Returns the value at a place in the list.
    #[inline]
    pub(crate) fn value(&self, place: usize) -> Option<&T> {
        inside(&self.values, place)
    }

    /// Returns the value at a place in the list.
    #[inline]
    pub(crate) fn value_mut(&mut self, place: usize) -> Option<&mut T> {
        inside_mut(&mut self.values, place)
    }

    /// Returns a tile's value; `None` if the tile was not added.
    #[inline]
    pub(crate) fn get(&self, tile: (i32, i32)) -> Option<&T> {
        self.value(self.place(tile)?)
    }

    /// Returns the value of a tile, which is added with the value `new` if it is not there; `None`
    /// if it is out of range, or there is no place.
    pub(crate) fn get_or_add(&mut self, tile: (i32, i32), new: T) -> Option<&mut T> {
        if self.keys.is_empty() {
            self.origin = tile;
        }
        let key = self.key(tile)?;
        let place = match self.keys.binary_search(&key) {
            Ok(place) => place,
            Err(place) => {
                let tiles = self.keys.len();
                self.keys.insert(place, key).ok()?;
                self.values.copy_within(place..tiles, place + 1);
                *self.value_mut(place)? = new;
                place
            }
        };
        self.value_mut(place)
    }

    /// Removes a tile. The keys still count from the first one.
    pub(crate) fn remove(&mut self, tile: (i32, i32)) {
        if let Some(place) = self.place(tile) {
            self.keys.remove(place);
            self.values.copy_within(place + 1.., place);
        }
    }

    /// Returns the values of all tiles.
    pub(crate) fn values_mut(&mut self) -> &mut [T] {
        let tiles = self.keys.len();
        self.values.get_mut(..tiles).unwrap_or_default()
    }
}

/// Words that a tile takes in spare memory.
pub(crate) const SPARE_WORDS: usize = 3;

impl<T: bytemuck::Pod, const N: usize> TileMap<T, N> {
    /// Begins anew without tiles, and calls `put` with each tile and value that there was. The
    /// values have 4 bytes; `spare` holds them meanwhile, and what does not fit is lost.
    pub(crate) fn rebuild(
        &mut self,
        spare: &mut [u32],
        mut put: impl FnMut(&mut Self, (i32, i32), T),
    ) {
        const { assert!(size_of::<T>() == size_of::<u32>()) };
        let (spare, _) = spare.as_chunks_mut::<SPARE_WORDS>();
        let old = self.keys.iter().zip(&self.values);
        let mut tiles = 0;
        for (place, (&key, value)) in spare.iter_mut().zip(old) {
            let (x, y) = self.tile(key);
            *place = [x as u32, y as u32, bytemuck::cast(*value)];
            tiles += 1;
        }
        self.clear();
        for &[x, y, value] in spare.iter().take(tiles) {
            put(self, (x as i32, y as i32), bytemuck::cast(value));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::vec::Vec;

    use super::TileMap;

    #[test]
    fn tiles_are_found_wherever_they_lie_and_listed_row_by_row() {
        let mut seed = 1_u32;
        let mut random = |below: i32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as i32 % below
        };
        for round in 0..40 {
            let mut map = TileMap::<i32, 50>::new(0);
            let mut twin = BTreeMap::new();
            let start = (1_000 * round - 20_000, 77 * round);
            for _ in 0..200 {
                let tile = (start.0 + random(14), start.1 - random(9));
                let value = random(1_000);
                let has_room = twin.len() < 50 || twin.contains_key(&(tile.1, tile.0));
                assert_eq!(map.get_or_add(tile, value).is_some(), has_room);
                if has_room {
                    *map.get_or_add(tile, -1).unwrap() = value;
                    twin.insert((tile.1, tile.0), value);
                }
            }
            assert!(map.is_full());
            let tiles: Vec<_> = map.keys().iter().map(|&key| map.tile(key)).collect();
            let rows: Vec<_> = twin.keys().map(|&(row, column)| (column, row)).collect();
            assert_eq!(tiles, rows);
            for (column, row) in (-2..16).flat_map(|x| (-11..3).map(move |y| (x, y))) {
                let tile = (start.0 + column, start.1 + row);
                assert_eq!(map.get(tile), twin.get(&(tile.1, tile.0)));
            }
        }
    }

    #[test]
    fn a_removed_tile_leaves_the_others_in_their_places() {
        let mut map = TileMap::<u32, 4>::new(0);
        for x in 0..4 {
            map.get_or_add((x, -x), x as u32);
        }
        map.remove((0, 0));
        map.remove((2, -2));
        map.remove((7, 7));
        let values = [0, 1, 2, 3].map(|x| map.get((x, -x)).copied());
        assert_eq!(values, [None, Some(1), None, Some(3)]);
        assert!(map.get_or_add((2, -2), 9).is_some_and(|new| *new == 9));
    }

    #[test]
    fn a_map_is_rebuilt_from_what_it_held() {
        let mut map = TileMap::<u32, 4>::new(0);
        for x in 0..4 {
            map.get_or_add((x, -1), x as u32);
        }
        map.rebuild(&mut [0; 10], |map, (x, y), value| {
            map.get_or_add((x - 5, y), 10 + value);
        });
        let values = [-5, -4, -3, -2].map(|x| map.get((x, -1)).copied());
        assert_eq!(values, [Some(10), Some(11), Some(12), None], "three fit");
    }

    #[test]
    fn a_tile_far_from_the_first_one_has_no_place() {
        let mut map = TileMap::<u8, 4>::new(0);
        map.get_or_add((1_000, -5), 1);
        for (column, fits) in [(873, false), (874, true), (1_126, true), (1_127, false)] {
            assert_eq!(map.get_or_add((column, -5), 2).is_some(), fits);
        }
        map.get_or_add((i32::MIN, i32::MAX), 3);
        assert_eq!(map.keys().len(), 3);
        map.clear();
        assert_eq!(map.get((1_000, -5)), None);
        assert!(map.get_or_add((0, 9_000), 1).is_some(), "a new origin");
    }
}
