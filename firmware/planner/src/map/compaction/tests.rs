//! Tests: compact tiles in a small pool. No tile is lost or in two places.
//!
//! Places are cells; the pool holds 40 tiles.

use std::boxed::Box;
use std::collections::BTreeMap;
use std::vec::Vec;

use super::{Entry, LOW_PAGES, NoRoom, RESERVED_PAGES, SideTable, Tiles};
use crate::geometry::Cell;
use crate::map::Class;

const TILES: usize = 40;
const FAR: Cell = Cell { x: 0, y: 9_000 };
type Small = Tiles<TILES, 400>;

/// Keeps the number of the tile by its page, and checks that no tile is in two places.
#[derive(Default)]
struct Guest {
    pages: BTreeMap<usize, i8>,
    halves: BTreeMap<usize, i8>,
}

impl SideTable for Guest {
    fn release_page(&mut self, page: usize) -> i8 {
        self.pages.remove(&page).unwrap()
    }

    fn restore_page(&mut self, page: usize, kept: i8) {
        assert_eq!(self.pages.insert(page, kept), None);
        assert!(!self.halves.contains_key(&(2 * page)));
        assert!(!self.halves.contains_key(&(2 * page + 1)));
    }

    fn store_half(&mut self, half: usize, kept: i8) {
        assert_eq!(self.halves.insert(half, kept), None);
        assert!(!self.pages.contains_key(&(half / 2)));
    }

    fn release_half(&mut self, half: usize) -> i8 {
        self.halves.remove(&half).unwrap()
    }
}

fn small() -> Box<Small> {
    let mut tiles = Box::<Small>::default();
    tiles.reset();
    tiles
}

fn corner(tile: i32) -> Cell {
    Cell {
        x: 32 * (tile % 20),
        y: 32 * (tile / 20),
    }
}

fn cells(tile: i32) -> impl Iterator<Item = Cell> {
    (0..1024).map(move |k| Cell {
        x: corner(tile).x + k % 32,
        y: corner(tile).y + k / 32,
    })
}

fn free(tiles: &mut Small, tile: i32) -> Result<(), NoRoom> {
    cells(tile).try_for_each(|cell| tiles.set(cell, Class::Free))
}

/// The robot drives over free ground; the window is the last tile.
#[test]
fn free_ground_is_not_bounded_by_the_pool() {
    let mut tiles = small();
    for tile in 0..200 {
        free(&mut tiles, tile).unwrap();
        tiles.compact(corner(tile), 32, &mut ());
        assert!(tiles.used() <= TILES - LOW_PAGES + 9, "{}", tiles.used());
    }
    for tile in 0..200 {
        assert!(cells(tile).all(|cell| tiles.class(cell) == Class::Free));
        let Cell { x, y } = corner(tile);
        assert_eq!(tiles.row(x, y + 5).free() as u32, u32::MAX);
        assert_eq!(tiles.packed(x / 32, y / 32), Some([0x55; 256]));
        assert!(tiles.is_touched(x / 32, y / 32) && tiles.room(x / 32, y / 32).is_ok());
    }
}

#[test]
fn a_compact_tile_is_written_once_the_window_is_there() {
    let mut tiles = small();
    (0..30).for_each(|tile| free(&mut tiles, tile).unwrap());
    tiles.compact(FAR, 64, &mut ());
    assert_eq!(tiles.used(), 0);
    let (wall, edits) = (corner(3), tiles.edits());
    assert_eq!(tiles.set(wall, Class::Free), Ok(()));
    assert_eq!(tiles.set(wall, Class::Obstacle), Err(NoRoom::Pool));
    assert_eq!((tiles.class(wall), tiles.edits()), (Class::Free, edits));
    tiles.compact(wall, 8, &mut ());
    assert_eq!(tiles.set(wall, Class::Obstacle), Ok(()));
    tiles.compact(FAR, 64, &mut ());
    let standing = cells(3).filter(|&cell| tiles.class(cell) != Class::Free);
    assert_eq!(standing.collect::<Vec<_>>(), [wall]);
}

#[test]
fn a_tile_that_was_compact_has_no_trail() {
    let mut tiles = small();
    free(&mut tiles, 3).unwrap();
    tiles.mark_visited(corner(3));
    let trail = |tiles: &Small| tiles.row(corner(3).x, corner(3).y).visited();
    assert_eq!(trail(&tiles), 0b11);
    (4..30).for_each(|tile| free(&mut tiles, tile).unwrap());
    tiles.compact(FAR, 64, &mut ());
    assert_eq!((tiles.used(), trail(&tiles)), (0, 0));
    tiles.compact(corner(3), 8, &mut ());
    assert_eq!((tiles.used() > 0, trail(&tiles)), (true, 0));
}

#[test]
fn pages_are_kept_back_for_compact_tiles() {
    let mut tiles = small();
    (0..30).for_each(|tile| free(&mut tiles, tile).unwrap());
    tiles.compact(FAR, 64, &mut ());
    let news = (100..160).filter(|&tile| tiles.set(corner(tile), Class::Obstacle).is_ok());
    assert_eq!(news.count(), TILES - RESERVED_PAGES);
    assert_eq!(tiles.room(19, 19), Err(NoRoom::Pool));
    tiles.compact(corner(24), 32, &mut ());
    let around = [4, 24, 25, 23].map(|tile| tiles.set(corner(tile), Class::Negative));
    assert_eq!(around, [Ok(()); 4]);
}

/// Writes, compacts and expands random tiles while the window jumps about: the map is as
/// written, every page and half is in one place, and the side table keeps every byte.
#[test]
fn nothing_is_lost_or_in_two_places() {
    let (mut tiles, mut guest) = (small(), Guest::default());
    let mut twin = BTreeMap::new();
    let mut seed = 3_u32;
    let mut random = |below: i32| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as i32 % below
    };
    let (mut halves, mut written) = (0, 0);
    for _ in 0..4_000 {
        let tile = random(60);
        tiles.compact(corner(tile), 1, &mut guest);
        for _ in 0..40 {
            let cell = cells(tile).nth(random(1024) as usize).unwrap();
            let class = match random(800) {
                0 => Class::Obstacle,
                _ => Class::Free,
            };
            let was = tiles.entry(cell.x / 32, cell.y / 32);
            if tiles.set(cell, class).is_ok() {
                twin.insert((cell.x, cell.y), class);
                written += 1;
                if was == Entry::Untouched
                    && let Entry::Page(page) = tiles.entry(cell.x / 32, cell.y / 32)
                {
                    guest.restore_page(page, tile as i8);
                }
            }
        }
        halves = halves.max(guest.halves.len());
    }
    assert!(halves > 20 && written > 60_000, "{halves} {written}");
    for cell in (0..60).flat_map(cells) {
        let expected = twin.get(&(cell.x, cell.y)).copied().unwrap_or_default();
        assert_eq!(tiles.class(cell), expected, "{cell:?}");
    }
    for tile in 0..60 {
        let kept = match tiles.entry(corner(tile).x / 32, corner(tile).y / 32) {
            Entry::Untouched => continue,
            Entry::Page(page) => guest.pages[&page],
            Entry::Half(half) => guest.halves[&half],
            Entry::AllFree(kept) => kept,
        };
        assert_eq!(i32::from(kept), tile);
    }
}
