//! Tests: compact tiles in a small pool. Nothing is lost, and nothing is in two places.
//!
//! Places are cells; the pool holds 60 tiles.

use std::boxed::Box;
use std::collections::{BTreeMap, BTreeSet};
use std::vec::Vec;

use super::{Entry, LOW_PAGES, NoRoom, RESERVED_PAGES, SideTable, Tiles};
use crate::geometry::Cell;
use crate::grid::Row;
use crate::map::Class;
use crate::map::neighbourhood::Neighbourhood;
use crate::map::pool::{UNIT_WORDS, UNITS, run};

const TILES: usize = 60;
const FAR: Cell = Cell { x: 0, y: 3_000 };
type Small = Tiles<TILES, 400>;
type Large = Tiles<400, 400>;

/// Keeps the number of the tile by its page, and checks that no tile is in two places.
#[derive(Default)]
struct Guest {
    pages: BTreeMap<usize, i8>,
}

impl SideTable for Guest {
    fn release_page(&mut self, page: usize) -> i8 {
        self.pages.remove(&page).unwrap()
    }

    fn restore_page(&mut self, page: usize, kept: i8) {
        assert_eq!(self.pages.insert(page, kept), None);
    }
}

fn small() -> Box<Small> {
    let mut tiles = Box::<Small>::default();
    tiles.reset();
    tiles
}

/// A pool on uneven ground.
fn uneven() -> Box<Small> {
    let mut tiles = small();
    tiles.lend(16);
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

fn random(seed: &mut u32, below: i32) -> i32 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*seed >> 8) as i32 % below
}

/// Asserts that every page and every unit has one owner.
fn assert_whole<const N: usize>(tiles: &Tiles<N, 400>) {
    let mut owners = BTreeSet::new();
    let mut used: BTreeMap<usize, u16> = BTreeMap::new();
    for place in 0..tiles.keys().len() {
        match tiles.entry_at(place) {
            Entry::Untouched => unreachable!("the directory has touched tiles"),
            Entry::Page(page) => assert!(owners.insert(page), "page {page} twice"),
            Entry::Coded(unit) => {
                let units = tiles.code(unit).length().div_ceil(UNIT_WORDS);
                let bits = used.entry(unit / UNITS).or_default();
                let more = run(unit % UNITS, units);
                assert_eq!(*bits & more, 0, "unit {unit} twice");
                *bits |= more;
            }
        }
    }
    let mut at = tiles.free.shared;
    while let Some(page) = at.checked_sub(1).map(usize::from) {
        assert!(owners.insert(page), "shared page {page} twice");
        let [bits, next] = tiles.share(page);
        assert_eq!(used.remove(&page), Some(bits));
        at = next;
    }
    assert!(used.is_empty(), "codes in pages that are not shared");
    let mut at = tiles.free.page;
    let mut spare = 0;
    while let Some(page) = at.checked_sub(1).map(usize::from) {
        assert!(owners.insert(page), "spare page {page} twice");
        spare += 1;
        at = tiles.words(page)[0] as u16;
    }
    assert_eq!(spare, tiles.free.pages);
    assert_eq!(owners, (0..usize::from(tiles.free.given)).collect());
}

/// The robot drives over free ground.
#[test]
fn free_ground_takes_two_units_a_tile() {
    let mut tiles = small();
    for tile in 0..300 {
        tiles.compacting.follow(corner(tile));
        free(&mut tiles, tile).unwrap();
    }
    assert_whole(&tiles);
    for tile in 0..300 {
        assert!(cells(tile).all(|cell| tiles.class(cell) == Class::Free));
        let Cell { x, y } = corner(tile);
        assert_eq!(tiles.row(x, y + 5).free() as u32, u32::MAX);
        assert_eq!(tiles.packed(x / 32, y / 32), Some([0x55; 256]));
        assert!(tiles.is_touched(x / 32, y / 32) && tiles.room(x / 32, y / 32).is_ok());
    }
}

/// Rooms with noise on their walls, of which a page holds two or three.
#[test]
fn rooms_take_less_than_half_a_page() {
    let mut tiles = small();
    let mut seed = 9;
    let mut fits = 0_i32;
    for tile in 0..400 {
        tiles.compacting.follow(corner(tile));
        let all = cells(tile).try_for_each(|cell| {
            let (x, y) = (cell.x % 96, cell.y % 64);
            let noise = random(&mut seed, 2);
            let class = match () {
                () if x < 2 || y < 1 + noise => Class::Obstacle,
                () if x > 70 + 3 * noise => Class::Unknown,
                () => Class::Free,
            };
            tiles.set(cell, class)
        });
        match all {
            Ok(()) => fits += 1,
            Err(why) => {
                assert_eq!(why, NoRoom::Pool);
                break;
            }
        }
    }
    assert!(fits > 2 * TILES as i32, "{fits}");
    assert_whole(&tiles);
    assert_eq!(tiles.room(19, 19), Err(NoRoom::Pool));
    // What is there can still be written.
    for tile in [0, 1, fits / 2] {
        tiles.compacting.follow(corner(tile));
        assert_eq!(tiles.set(corner(tile), Class::Negative), Ok(()), "{tile}");
    }
    assert_whole(&tiles);
}

/// Tiles of noise cannot be compacted: the pool is full when its pages are.
#[test]
fn noise_fills_the_pool() {
    let mut tiles = small();
    let mut seed = 4;
    let mut written = 0;
    'tiles: for tile in 0..100 {
        tiles.compacting.follow(corner(tile));
        for cell in cells(tile) {
            let class = Class::from_bits(random(&mut seed, 2) as u32, random(&mut seed, 2) as u32);
            match tiles.set(cell, class) {
                Ok(()) => {}
                Err(NoRoom::Later) => tiles.compacting.follow(corner(tile)),
                Err(why) => {
                    assert_eq!(why, NoRoom::Pool);
                    break 'tiles;
                }
            }
        }
        written = tile + 1;
    }
    assert!(
        (TILES as i32 - 2..=TILES as i32).contains(&written),
        "{written}"
    );
    assert_eq!(tiles.room(19, 19), Err(NoRoom::Pool));
    assert_whole(&tiles);
}

/// Writes and reads random tiles while the robot jumps about, beside a pool with a page for each:
/// both hold the same, the trail too.
#[test]
fn a_small_pool_holds_what_a_large_one_holds() {
    let (mut tiles, mut large) = (small(), Box::<Large>::default());
    large.reset();
    let mut seed = 3_u32;
    let mut compact = 0;
    for round in 0..6_000 {
        let tile = random(&mut seed, 110);
        tiles.compacting.follow(corner(tile));
        for _ in 0..30 {
            let cell = cells(tile).nth(random(&mut seed, 1024) as usize).unwrap();
            let class = match random(&mut seed, 60) {
                0 => Class::Obstacle,
                1 => Class::Negative,
                _ if (cell.x / 8 + cell.y / 8) % 3 == 0 => Class::Unknown,
                _ => Class::Free,
            };
            // Whole blocks, so that a tile is not all noise.
            for part in (0..16).map(|k| {
                Cell {
                    x: cell.x & !3,
                    y: cell.y & !3,
                }
                .offset(k % 4, k / 4)
            }) {
                let stored = tiles.set(part, class);
                assert_eq!(stored, Ok(()), "round {round}");
                large.set(part, class).unwrap();
            }
            let class = tiles.class(cell);
            tiles.mark_visited(cell);
            large.mark_visited(cell);
            assert_eq!(tiles.class(cell), class);
        }
        compact = compact.max(tiles.compacting.compact);
        if round % 500 == 0 {
            assert_whole(&tiles);
        }
    }
    assert!(compact > 60, "{compact}");
    assert_eq!(tiles.edits(), large.edits());
    let mut near = [Neighbourhood::of(&tiles).has_lone_arrival(FAR); 2];
    assert_eq!(near, [false; 2]);
    let (mut small_reader, mut large_reader) =
        (Neighbourhood::of(&tiles), Neighbourhood::of(&large));
    for x in (-40..660).step_by(17) {
        let rows = |row: Row| (row.low, row.high, row.visited);
        let (mut one, mut other) = (tiles.measured(x), large.measured(x));
        let (mut line, mut other_line) = (tiles.measured(x), large.measured(x));
        for y in -3..200 {
            assert_eq!(rows(one.row(y)), rows(other.row(y)), "{x} {y}");
            assert_eq!(line.line(y), other_line.line(y), "{x} {y}");
        }
        for corner in (0..200).map(|y| Cell { x, y }) {
            let square = small_reader.obstacles_from::<5>(corner);
            assert_eq!(square, large_reader.obstacles_from::<5>(corner));
            near = [
                small_reader.has_lone_arrival(corner),
                large_reader.has_lone_arrival(corner),
            ];
            assert_eq!(near[0], near[1]);
        }
    }
    for (x, y) in (0..20).flat_map(|x| (0..6).map(move |y| (x, y))) {
        assert_eq!(tiles.packed(x, y), large.packed(x, y));
        let version = |entry| tiles.version(entry);
        let other = |entry| large.version(entry);
        assert_eq!(version(tiles.entry(x, y)), other(large.entry(x, y)));
    }
}

#[test]
fn on_uneven_ground_a_compact_tile_is_written_once_the_window_is_there() {
    let mut tiles = uneven();
    (0..30).for_each(|tile| free(&mut tiles, tile).unwrap());
    tiles.mark_visited(corner(19));
    let trail = |tiles: &Small| tiles.row(corner(19).x, corner(19).y).visited() & 0xffff_ffff;
    let beside = trail(&tiles);
    tiles.compacting.follow(FAR);
    tiles.compact(FAR, 64, &mut ());
    assert!(tiles.free_pages() >= LOW_PAGES);
    let (wall, edits) = (corner(19), tiles.edits());
    assert!(matches!(tiles.entry(19, 0), Entry::Coded(_)));
    assert_eq!(tiles.set(wall, Class::Free), Ok(()));
    assert_eq!(tiles.set(wall, Class::Obstacle), Err(NoRoom::Later));
    assert_eq!((tiles.class(wall), tiles.edits()), (Class::Free, edits));
    tiles.compact(wall, 8, &mut ());
    assert_eq!(tiles.set(wall, Class::Obstacle), Ok(()));
    assert_eq!((beside, trail(&tiles)), (0b11, 0b11));
    let standing = cells(19).filter(|&cell| tiles.class(cell) != Class::Free);
    assert_eq!(standing.collect::<Vec<_>>(), [wall]);
}

#[test]
fn pages_are_kept_back_for_compact_tiles() {
    let mut tiles = uneven();
    (0..30).for_each(|tile| free(&mut tiles, tile).unwrap());
    tiles.compacting.follow(FAR);
    tiles.compact(FAR, 64, &mut ());
    let spare = tiles.free_pages();
    let news = (100..160).filter(|&tile| tiles.set(corner(tile), Class::Obstacle).is_ok());
    assert_eq!(news.count(), spare - RESERVED_PAGES);
    assert_eq!(tiles.room(19, 19), Err(NoRoom::Pool));
    tiles.compact(corner(24), 32, &mut ());
    let around = [4, 24, 25, 23].map(|tile| tiles.set(corner(tile), Class::Negative));
    assert_eq!(around, [Ok(()); 4]);
}

/// The window jumps about on uneven ground: every page is in one place, and the side table keeps
/// every byte.
#[test]
fn a_side_table_keeps_its_bytes() {
    let (mut tiles, mut guest) = (uneven(), Guest::default());
    let mut twin = BTreeMap::new();
    let mut seed = 3_u32;
    let (mut compact, mut written) = (0, 0);
    for _ in 0..4_000 {
        let tile = random(&mut seed, 60);
        tiles.compacting.follow(corner(tile));
        tiles.compact(corner(tile), 1, &mut guest);
        for _ in 0..40 {
            let cell = cells(tile).nth(random(&mut seed, 1024) as usize).unwrap();
            let class = match random(&mut seed, 800) {
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
        compact = compact.max(tiles.compacting.compact);
    }
    assert_whole(&tiles);
    assert!(compact > 20 && written > 60_000, "{compact} {written}");
    for cell in (0..60).flat_map(cells) {
        let expected = twin.get(&(cell.x, cell.y)).copied().unwrap_or_default();
        assert_eq!(tiles.class(cell), expected, "{cell:?}");
    }
    for tile in 0..60 {
        let kept = match tiles.entry(corner(tile).x / 32, corner(tile).y / 32) {
            Entry::Untouched => continue,
            Entry::Page(page) => guest.pages[&page],
            Entry::Coded(unit) => tiles.kept(unit),
        };
        assert_eq!(i32::from(kept), tile);
    }
}
