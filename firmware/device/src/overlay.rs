//! Additional knowledge of a strategy, converted for the wire: loops, closed regions, visit stamps,
//! path, tractor point and shield.
//!
//! All of it is read from the planner's state on request; nothing is stored here. It is empty for a
//! strategy without loops or without visit stamps.
//!
//! Units: map cells.

use fieldline_planner::State;
use fieldline_planner::geometry::Cell;
use fieldline_planner::map::tiles::TILE_SIDE;
use fieldline_planner::strategy::Ouroboros;
use fieldline_planner::strategy::ouroboros::REGION_CELLS;
use fieldline_planner::strategy::tdbvp::PLACE_CELLS;
use fieldline_protocol::message::{Loops, PATH_PAGE, Path, TILE_STAMPS};

/// Side of a tile.
const TILE: i32 = TILE_SIDE;
/// Side of a region that the strategy closes.
const REGION: i32 = REGION_CELLS;
/// Side of a place with a visit stamp.
const PLACE: i32 = PLACE_CELLS;

// A tile has one bit of a `u16` per region, and one stamp per place.
const _: () = assert!((TILE / REGION) * (TILE / REGION) == 16);
const _: () = assert!(((TILE / PLACE) * (TILE / PLACE)) as usize == TILE_STAMPS);

/// Returns the counts of loops.
pub(crate) fn loops<const TILES: usize, const SLOTS: usize>(state: &State<TILES, SLOTS>) -> Loops {
    state.ouroboros().map_or_else(Loops::default, |ouroboros| {
        let tally = ouroboros.tally();
        Loops {
            closing: ouroboros.shield().is_some(),
            closed: tally.closed,
            given_up: tally.given_up,
        }
    })
}

/// Returns the cell with the least x and y in the `k`-th square of `side` cells of a tile.
fn square((x, y): (i16, i16), side: i32, k: i32) -> Cell {
    Cell {
        x: i32::from(x) * TILE + k % (TILE / side) * side,
        y: i32::from(y) * TILE + k / (TILE / side) * side,
    }
}

/// Returns one bit per region of a tile: 1 if no new loop starts there.
pub(crate) fn closed_regions<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    tile: (i16, i16),
) -> u16 {
    state.ouroboros().map_or(0, |ouroboros| {
        let is_closed = |k: &i32| {
            ouroboros
                .closed_regions()
                .is_closed(square(tile, REGION, *k))
        };
        (0..16).filter(is_closed).fold(0, |bits, k| bits | 1 << k)
    })
}

/// Returns the stamps of the last visits to the places of a tile; 0 for a place never visited.
pub(crate) fn visit_stamps<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    tile: (i16, i16),
) -> [u8; TILE_STAMPS] {
    let stamp = |k: usize| {
        state.tdbvp().map_or(0, |tdbvp| {
            tdbvp.rails().stamp(square(tile, PLACE, k as i32))
        })
    };
    core::array::from_fn(stamp)
}

/// Returns tractor point, shield and path, without the first `from` cells of the path.
pub(crate) fn path<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    from: u8,
) -> Path {
    let (ouroboros, cells) = (state.ouroboros(), state.path().cells());
    let rest = cells.iter().skip(from.into());
    Path {
        tractor: ouroboros.and_then(Ouroboros::tractor).map(short),
        shield: ouroboros
            .and_then(Ouroboros::shield)
            .map(|shield| shield.ends().map(short)),
        length: u8::try_from(cells.len()).unwrap_or(u8::MAX),
        cells: rest.take(PATH_PAGE).map(|cell| short(*cell)).collect(),
    }
}

fn short(cell: Cell) -> (i16, i16) {
    let short = |at: i32| at.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
    (short(cell.x), short(cell.y))
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use fieldline_planner::State;
    use fieldline_planner::geometry::Cell;
    use fieldline_protocol::message::{Loops, Path};

    use super::{closed_regions, loops, path, short, square, visit_stamps};

    #[test]
    fn a_planner_without_a_session_shows_nothing() {
        let state: Box<State<4, 400>> = Box::new(State::new());
        assert_eq!(loops(&state), Loops::default());
        assert_eq!(closed_regions(&state, (0, 0)), 0);
        assert_eq!(visit_stamps(&state, (3, -1)), [0; 4]);
        assert_eq!(path(&state, 0), Path::default());
        assert_eq!(path(&state, u8::MAX), Path::default());
    }

    #[test]
    fn squares_of_a_tile_are_numbered_row_by_row() {
        let cells = [0, 1, 2, 3].map(|k| square((-1, 2), 16, k));
        let expected = [(-32, 64), (-16, 64), (-32, 80), (-16, 80)];
        assert_eq!(cells, expected.map(|(x, y)| Cell { x, y }));
        assert_eq!(square((0, 0), 8, 15), Cell { x: 24, y: 24 });
    }

    #[test]
    fn distant_cells_saturate() {
        let far = Cell {
            x: 40_000,
            y: -40_000,
        };
        assert_eq!(short(far), (i16::MAX, i16::MIN));
    }
}
