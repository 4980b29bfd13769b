//! Rows of the map, 64 cells at a time. All planning reads the map this way.
//!
//! To planning a cell that the [`Fence`](crate::fence::Fence) forbids is an obstacle, whatever
//! stands there: [`Tiles::reader`]. The map's own rooms read what was measured:
//! [`Tiles::measured`].
//!
//! A reader goes up through the map row by row, so it looks tiles up once in 32 rows. Where one of
//! them is compact, it reads four rows at a time. Bit k of a word is column x + k.
//!
//! Units: map cells.

use crate::grid::Row;
use crate::grid::bits::twice;
use crate::grid::masked;
use crate::map::code::Code;
use crate::map::compaction::{ONES, ZEROS};
use crate::map::tiles::{NO_TRAIL, Plane, Stored, TILE_SIDE, Tiles, Visited};

/// Columns of the halo to the left of a [`Line`].
pub(crate) const HALO: i32 = 16;

/// 32 cells of a row, and the obstacles up to [`HALO`] columns beside them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Line {
    /// Obstacles; bit `HALO` is the line's first cell.
    pub(crate) around: u64,
    /// Cells never measured.
    pub(crate) unknown: u32,
    /// Cells of the robot's trail.
    pub(crate) visited: u32,
}

impl Line {
    /// Returns the obstacles, negative ones included.
    pub(crate) const fn obstacle(self) -> u32 {
        (self.around >> HALO) as u32
    }
}

/// The tile of a reader's present rows.
#[derive(Clone, Copy, Debug)]
struct Column<'a> {
    low: &'a Plane,
    high: &'a Plane,
    visited: &'a Visited,
    /// The tile is compact: this is read, and not what is above.
    code: Option<Code<'a>>,
}

/// Rows that are read at a time where a tile is compact.
const BLOCK: usize = 4;

/// A tile's part of some rows: the low and the high bits of the cells, and the trail's blocks.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    cells: [[u32; BLOCK]; 2],
    visited: [u16; BLOCK / 2],
}

/// A tile's part of a row: the low and the high bits of the cells, and the trail's blocks.
#[derive(Clone, Copy, Debug)]
struct Piece {
    cells: [u32; 2],
    visited: u16,
}

impl<'a> Column<'a> {
    /// An untouched tile.
    const EMPTY: Self = Self {
        low: &ZEROS,
        high: &ZEROS,
        visited: &NO_TRAIL,
        code: None,
    };
    /// A tile that the map has no room for, to a reader of what may be explored.
    const FREE: Self = Self {
        low: &ONES,
        ..Self::EMPTY
    };

    const fn of(stored: Stored<'a>) -> Self {
        match stored {
            Stored::Page { cells, trail } => {
                let [low, high] = cells;
                Self {
                    low,
                    high,
                    visited: trail,
                    code: None,
                }
            }
            Stored::Coded(code) => Self {
                code: Some(code),
                ..Self::EMPTY
            },
        }
    }

    /// Returns the tile's part of a row. It must not be compact.
    #[inline(always)]
    fn piece(&self, row: usize) -> Piece {
        Piece {
            cells: [self.low, self.high].map(|plane| *masked(plane, row)),
            visited: *masked(self.visited, row / 2),
        }
    }

    /// Returns the tile's part of the four rows from a multiple of four on.
    fn part(&self, from: usize) -> Part {
        if let Some(code) = self.code {
            return Part {
                cells: code.block_row(from / BLOCK),
                visited: [0, 1].map(|k| code.trail_row(from / 2 + k)),
            };
        }
        let rows = |plane: &Plane| core::array::from_fn(|k| *masked(plane, from + k));
        Part {
            cells: [rows(self.low), rows(self.high)],
            visited: [0, 1].map(|k| *masked(self.visited, from / 2 + k)),
        }
    }
}

/// A reader of rows, one after another.
#[derive(Debug)]
pub(crate) struct RowReader<'a, const TILES: usize, const SLOTS: usize> {
    tiles: &'a Tiles<TILES, SLOTS>,
    x: i32,
    tile_y: i32,
    columns: [Column<'a>; 3],
    /// One of the tiles is compact.
    has_code: bool,
    /// Where a tile is compact: the four rows from `parts_from` on.
    parts: [Part; 3],
    parts_from: usize,
    /// A tile without room reads as free: nothing of it can be explored.
    only_room: bool,
    /// Forbidden cells read as obstacles.
    is_fenced: bool,
    /// The forbidden cells of each row of the present tiles, if all are alike.
    steady: Option<u64>,
}

impl<'a, const TILES: usize, const SLOTS: usize> RowReader<'a, TILES, SLOTS> {
    /// Creates a reader from column `x` on.
    pub(super) const fn new(tiles: &'a Tiles<TILES, SLOTS>, x: i32) -> Self {
        Self {
            tiles,
            x,
            tile_y: i32::MIN,
            columns: [Column::EMPTY; 3],
            has_code: false,
            parts: [Part {
                cells: [[0; BLOCK]; 2],
                visited: [0; BLOCK / 2],
            }; 3],
            parts_from: usize::MAX,
            only_room: false,
            is_fenced: false,
            steady: None,
        }
    }

    /// Returns the reader of what planning may use: forbidden cells read as obstacles.
    pub(super) fn fenced(self) -> Self {
        let is_fenced = !self.tiles.fence.is_empty();
        Self { is_fenced, ..self }
    }

    /// Returns the reader of what may be explored, if `only_room`: a tile that the map has no room
    /// for reads as free.
    pub(crate) const fn of_room(self, only_room: bool) -> Self {
        Self { only_room, ..self }
    }

    /// Looks up the tiles of a row. Returns its number in them and the shift of their columns.
    #[inline(always)]
    fn tile_row(&mut self, y: i32) -> (usize, u32) {
        if y >> 5 != self.tile_y {
            self.look_up_tiles(y >> 5);
        }
        ((y & 31) as usize, (self.x & 31) as u32)
    }

    #[inline(never)]
    fn look_up_tiles(&mut self, tile_y: i32) {
        self.tile_y = tile_y;
        if self.is_fenced {
            let corner = (self.x, tile_y << 5);
            self.steady = self.tiles.fence.steady_row(corner, TILE_SIDE);
        }
        for (k, column) in (0..).zip(&mut self.columns) {
            let tile_x = (self.x >> 5) + k;
            let found = self.tiles.stored(self.tiles.entry(tile_x, tile_y));
            *column = match found {
                Some(stored) => Column::of(stored),
                None if self.only_room && self.tiles.room(tile_x, tile_y).is_err() => Column::FREE,
                None => Column::EMPTY,
            };
        }
        self.has_code = self.columns.iter().any(|column| column.code.is_some());
        self.parts_from = usize::MAX;
    }

    /// Returns the parts of a row.
    #[inline(always)]
    fn pieces(&mut self, row: usize) -> [Piece; 3] {
        if self.has_code {
            self.decoded(row)
        } else {
            self.columns.each_ref().map(|column| column.piece(row))
        }
    }

    #[inline(never)]
    fn decoded(&mut self, row: usize) -> [Piece; 3] {
        let (from, k) = (row / BLOCK * BLOCK, row % BLOCK);
        if from != self.parts_from {
            self.parts = self.columns.each_ref().map(|column| column.part(from));
            self.parts_from = from;
        }
        self.parts.each_ref().map(|part| Piece {
            cells: part.cells.each_ref().map(|plane| *masked(plane, k)),
            visited: *masked(&part.visited, k / 2),
        })
    }

    /// Returns the forbidden ones of the 64 cells of row `y`.
    #[inline(always)]
    fn forbidden(&self, y: i32) -> u64 {
        if !self.is_fenced {
            return 0;
        }
        match self.steady {
            Some(row) => row,
            None => self.tiles.fence.row(self.x, y),
        }
    }

    /// Returns the 64 cells of row `y`.
    pub(crate) fn row(&mut self, y: i32) -> Row {
        let (row, shift) = self.tile_row(y);
        let pieces = self.pieces(row);
        let [first, second, third] = pieces.map(|piece| piece.cells);
        let visited = pieces.map(|piece| twice(piece.visited));
        let forbidden = self.forbidden(y);
        Row {
            low: join(first[0], second[0], third[0], shift) & !forbidden,
            high: join(first[1], second[1], third[1], shift) | forbidden,
            visited: join(visited[0], visited[1], visited[2], shift),
        }
    }

    /// Returns the 32 cells of row `y` that begin [`HALO`] columns to the right of the reader.
    #[inline(always)]
    pub(crate) fn line(&mut self, y: i32) -> Line {
        let (row, shift) = self.tile_row(y);
        let pieces = self.pieces(row);
        let [first, second, third] = pieces.map(|piece| piece.cells);
        let around = join(first[1], second[1], third[1], shift) | self.forbidden(y);
        // The cells begin in the first tile or in the second, and end in the next.
        let from = shift + HALO as u32;
        let [left, middle, right] = pieces.map(|piece| piece.visited);
        let (low, pair) = if from < 32 {
            (cut(first[0], second[0], from), [left, middle])
        } else {
            (cut(second[0], third[0], from - 32), [middle, right])
        };
        let [one, other] = pair;
        let visited = if one | other == 0 {
            0
        } else {
            cut(twice(one), twice(other), from % 32)
        };
        Line {
            around,
            unknown: !(low | (around >> HALO) as u32),
            visited,
        }
    }
}

/// Returns 64 bits from bit `shift` (below 32) of the first word on.
#[inline(always)]
const fn join(first: u32, second: u32, third: u32, shift: u32) -> u64 {
    (cut(second, third, shift) as u64) << 32 | cut(first, second, shift) as u64
}

/// Returns 32 bits from bit `from` (below 32) of the first word on.
#[inline(always)]
const fn cut(first: u32, second: u32, from: u32) -> u32 {
    first >> from | second << 1 << (31 - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Cell;
    use crate::map::Class;

    #[test]
    fn a_forbidden_cell_is_an_obstacle_to_planning_and_what_it_is_to_the_map() {
        let mut tiles = Tiles::<16, 16>::new();
        tiles.reset();
        for (x, y) in (0..40).flat_map(|x| (0..40).map(move |y| (x, y))) {
            tiles.set(Cell { x, y }, Class::Free).unwrap();
        }
        tiles.mark_visited(Cell { x: 21, y: 21 });
        let corners = [(-0.5, 2.0), (5.0, 2.0), (5.0, 3.0), (-0.5, 3.0)];
        let corners = corners.map(|(x_m, y_m)| crate::geometry::Point { x_m, y_m });
        tiles.set_fence(&crate::fence::Fence::new().no_go(&corners));
        let (mut planned, mut measured) = (tiles.reader(-10), tiles.measured(-10));
        for y in -2..45 {
            let forbidden = if (20..30).contains(&y) {
                u64::MAX >> 4 << 5 & u64::MAX >> 4
            } else {
                0
            };
            let (row, seen) = (planned.row(y), measured.row(y));
            assert_eq!(row.obstacle(), forbidden, "row {y}");
            assert_eq!(row.unknown(), seen.unknown() & !forbidden, "row {y}");
            assert_eq!(row.free(), seen.free() & !forbidden, "row {y}");
            assert_eq!(seen.obstacle(), 0);
            let line = tiles.reader(-10).line(y);
            assert_eq!(line.around, forbidden);
            assert_eq!(line.unknown, (row.unknown() >> HALO) as u32);
        }
        let inside = Cell { x: 3, y: 25 };
        assert_eq!(tiles.class(inside), Class::Free);
        assert_eq!(tiles.planned_class(inside), Class::Obstacle);
        assert_eq!(tiles.planned_class(Cell { x: 3, y: 30 }), Class::Free);
    }

    #[test]
    fn a_line_is_the_middle_of_a_row() {
        let mut tiles = Tiles::<16, 16>::new();
        tiles.reset();
        let mut seed = 3u32;
        for _ in 0..4000 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let cell = Cell {
                x: (seed >> 8) as i32 % 96,
                y: (seed >> 16) as i32 % 70,
            };
            let class = [Class::Free, Class::Obstacle][(seed >> 5 & 1) as usize];
            tiles.set(cell, class).unwrap();
            if seed >> 27 == 0 {
                tiles.mark_visited(cell);
            }
        }
        for x in -20..90 {
            let mut reader = tiles.reader(x);
            for y in -3..75 {
                let (row, line) = (tiles.row(x, y), reader.line(y));
                let middle = |bits: u64| (bits >> HALO) as u32;
                assert_eq!(line.around, row.obstacle());
                assert_eq!(line.obstacle(), middle(row.obstacle()));
                assert_eq!(line.unknown, middle(row.unknown()));
                assert_eq!(line.visited, middle(row.visited()));
            }
        }
    }
}
