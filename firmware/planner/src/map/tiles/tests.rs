//! Cells, ranges and pools of small maps.

use crate::geometry::Cell;
use crate::map::tiles::{Class, NoRoom, Tiles};

fn small() -> Tiles<4, 24> {
    let mut tiles = Tiles::new();
    tiles.reset();
    tiles
}

#[test]
fn a_cell_reads_back_and_its_neighbours_stay_unknown() {
    let mut tiles = small();
    for (x, class) in [
        (-33, Class::Free),
        (-32, Class::Obstacle),
        (31, Class::Negative),
    ] {
        let cell = Cell { x, y: -5 };
        tiles.set(cell, class).unwrap();
        assert_eq!(tiles.class(cell), class);
        assert_eq!(tiles.class(Cell { x: x + 2, y: -5 }), Class::Unknown);
    }
    tiles.set(Cell { x: 31, y: -5 }, Class::Unknown).unwrap();
    assert_eq!(tiles.class(Cell { x: 31, y: -5 }), Class::Unknown);
}

#[test]
fn a_row_spans_three_tiles() {
    let mut tiles = small();
    for x in -40..40 {
        let class = if x % 3 == 0 {
            Class::Obstacle
        } else {
            Class::Free
        };
        tiles.set(Cell { x, y: 7 }, class).unwrap();
    }
    for start in [-40, -33, -32, -31, -24] {
        let row = tiles.row(start, 7);
        for k in 0..64 {
            let cell = Cell { x: start + k, y: 7 };
            assert_eq!(
                row.obstacle() >> k & 1 == 1,
                tiles.class(cell) == Class::Obstacle
            );
            assert_eq!(row.free() >> k & 1 == 1, tiles.class(cell) == Class::Free);
        }
    }
    assert_eq!(tiles.row(0, 8).unknown(), u64::MAX);
}

#[test]
fn a_tile_must_be_within_range_of_the_first_one() {
    let mut tiles = small();
    let origin = Cell { x: 1000, y: -1000 };
    tiles.set(origin, Class::Free).unwrap();
    assert_eq!(
        tiles.set(
            Cell {
                x: 1000,
                y: -1000 + 127 * 32
            },
            Class::Free
        ),
        Err(NoRoom::Box)
    );
    tiles
        .set(
            Cell {
                x: 1000,
                y: -1000 + 126 * 32,
            },
            Class::Free,
        )
        .unwrap();
    assert_eq!(
        tiles.class(Cell {
            x: 1000,
            y: -1000 + 127 * 32
        }),
        Class::Unknown,
        "it was refused"
    );
}

#[test]
fn a_full_pool_refuses_and_keeps_what_it_has() {
    let mut tiles = small();
    for k in 0..4 {
        tiles.set(Cell { x: 32 * k, y: 0 }, Class::Free).unwrap();
    }
    assert_eq!(
        tiles.set(Cell { x: 0, y: 32 }, Class::Free),
        Err(NoRoom::Pool)
    );
    assert_eq!(
        (tiles.used(), tiles.class(Cell { x: 96, y: 0 })),
        (4, Class::Free)
    );
}

#[test]
fn the_visited_layer_covers_blocks_of_two_by_two() {
    let mut tiles = small();
    for (x, y) in [(-3, 9), (31, 9), (32, 40)] {
        tiles.set(Cell { x, y }, Class::Free).unwrap();
        tiles.mark_visited(Cell { x, y });
    }
    assert_eq!(tiles.row(-10, 8).visited(), 0b11 << 6 | 0b11 << 40);
    assert_eq!(tiles.row(-10, 9).visited(), tiles.row(-10, 8).visited());
    assert_eq!(tiles.row(30, 41).visited(), 0b11 << 2);
    assert_eq!(tiles.row(-10, 10).visited(), 0);
}

#[test]
fn the_packed_tile_agrees_with_the_cells() {
    let mut tiles = small();
    for i in 0..300 {
        let cell = Cell {
            x: i * 7 % 32,
            y: i * 11 % 32,
        };
        let class = [Class::Free, Class::Obstacle, Class::Negative][i as usize % 3];
        tiles.set(cell, class).unwrap();
    }
    let bytes = tiles.packed(0, 0).unwrap();
    for i in 0..1024usize {
        let code = bytes[i / 4] >> (i % 4 * 2) & 3;
        assert_eq!(
            code,
            tiles.class(Cell {
                x: i as i32 % 32,
                y: i as i32 / 32
            }) as u8
        );
    }
    assert!(tiles.packed(1, 0).is_none());
}
