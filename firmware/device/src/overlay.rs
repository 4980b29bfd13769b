//! What a strategy knows beyond the map, as it goes onto the wire: loops, marks, dates, the road, tractor point and shield.
//!
//! All of it is read from the planner's state when it is asked for; nothing is kept here. A strategy without loops has
//! none of them, one without rails no dates.
//!
//! Units: map cells.

use fieldline_planner::State;
use fieldline_planner::geometry::Cell;
use fieldline_planner::map::tiles::TILE_SIDE;
use fieldline_planner::strategy::Ouroboros;
use fieldline_planner::strategy::tdbvp::rails::PLACE_CELLS;
use fieldline_protocol::message::{Loops, ROAD_PAGE, Road, TILE_DATES};

/// Map cells along a tile, along a mark, and along a place with a date.
const TILE: i32 = TILE_SIDE;
const MARK: i32 = 8;
const PLACE: i32 = PLACE_CELLS;

// A mark is a bit of a `u16`, and a place a byte of the tile's dates.
const _: () = assert!((TILE / MARK) * (TILE / MARK) == 16);
const _: () = assert!(((TILE / PLACE) * (TILE / PLACE)) as usize == TILE_DATES);

/// What became of loops.
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

/// The least cell of the `k`-th square of `side` cells in a tile.
fn part((x, y): (i16, i16), side: i32, k: i32) -> Cell {
    Cell {
        x: i32::from(x) * TILE + k % (TILE / side) * side,
        y: i32::from(y) * TILE + k / (TILE / side) * side,
    }
}

/// Where loops were closed in a tile.
pub(crate) fn marks<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    tile: (i16, i16),
) -> u16 {
    state.ouroboros().map_or(0, |ouroboros| {
        let is_marked = |k: &i32| ouroboros.marks().is_marked(part(tile, MARK, *k));
        (0..16).filter(is_marked).fold(0, |marks, k| marks | 1 << k)
    })
}

/// When places of a tile were visited.
pub(crate) fn dates<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    tile: (i16, i16),
) -> [u8; TILE_DATES] {
    let date = |k: usize| {
        state
            .tdbvp()
            .map_or(0, |tdbvp| tdbvp.rails().rank(part(tile, PLACE, k as i32)))
    };
    core::array::from_fn(date)
}

/// Where the planner is going, without the first `from` cells of the road.
pub(crate) fn road<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    from: u8,
) -> Road {
    let (ouroboros, cells) = (state.ouroboros(), state.path().cells());
    let rest = cells.iter().skip(from.into());
    Road {
        tractor: ouroboros.and_then(Ouroboros::tractor).map(short),
        shield: ouroboros
            .and_then(Ouroboros::shield)
            .map(|shield| shield.ends().map(short)),
        length: u8::try_from(cells.len()).unwrap_or(u8::MAX),
        cells: rest.take(ROAD_PAGE).map(|cell| short(*cell)).collect(),
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
    use fieldline_protocol::message::{Loops, Road};

    use super::{dates, loops, marks, part, road, short};

    #[test]
    fn a_planner_without_a_session_has_nothing_to_show() {
        let state: Box<State<4, 400>> = Box::new(State::new());
        assert_eq!(loops(&state), Loops::default());
        assert_eq!((marks(&state, (0, 0)), dates(&state, (3, -1))), (0, [0; 4]));
        assert_eq!(road(&state, 0), Road::default());
        assert_eq!(road(&state, u8::MAX), Road::default());
    }

    #[test]
    fn parts_of_a_tile_count_by_rows_from_the_least() {
        let cells = [0, 1, 2, 3].map(|k| part((-1, 2), 16, k));
        let expected = [(-32, 64), (-16, 64), (-32, 80), (-16, 80)];
        assert_eq!(cells, expected.map(|(x, y)| Cell { x, y }));
        assert_eq!(part((0, 0), 8, 15), Cell { x: 24, y: 24 });
    }

    #[test]
    fn far_cells_saturate() {
        let far = Cell {
            x: 40_000,
            y: -40_000,
        };
        assert_eq!(short(far), (i16::MAX, i16::MIN));
    }
}
