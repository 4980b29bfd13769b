//! What a display can read from the state: map tiles, skeleton, path, residual frontiers, and the
//! memory of the strategies.
//!
//! Everything is computed on request. It is empty before a session, and for a strategy that does
//! not have it.
//!
//! Units: map cells; tiles of 32 × 32 cells.

#[cfg(feature = "internals")]
use crate::field::preference::Preferences;
use crate::geometry::Cell;
use crate::grid::TileKey;
use crate::map::tiles::TILE_SIDE;
use crate::planner::state::State;
use crate::status::ResidualFrontier;
use crate::strategy::ouroboros::{Closed, Ouroboros, REGION_CELLS};
use crate::strategy::tdbvp::PLACE_CELLS;

/// Places of a tile.
const PLACES: usize = ((TILE_SIDE / PLACE_CELLS) * (TILE_SIDE / PLACE_CELLS)) as usize;
/// Regions of a tile: one bit of a `u16` each.
const REGIONS: i32 = (TILE_SIDE / REGION_CELLS) * (TILE_SIDE / REGION_CELLS);
const _: () = assert!(REGIONS == 16 && PLACES == 4);

/// The numbers of loops of a session with [`Strategy::Ouroboros`](crate::Strategy::Ouroboros).
///
/// ```
/// use fieldline_planner::{LoopCounts, State};
///
/// let state = Box::new(State::<4, 64>::new());
/// assert_eq!(state.loops(), LoopCounts::default());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoopCounts {
    /// True while the robot closes a loop.
    pub closing: bool,
    /// Number of loops closed.
    pub closed: u16,
    /// Number of loops given up.
    pub given_up: u16,
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Returns the cells of a tile, two bits each, least x and y first: 0 unknown, 1 free, 2
    /// obstacle, 3 negative obstacle. What came and may be gone is unknown. `None` if nothing in it
    /// was ever measured.
    #[must_use]
    pub fn tile(&self, column: i16, row: i16) -> Option<[u8; 256]> {
        self.map.shown(i32::from(column), i32::from(row))
    }

    /// Returns the skeleton of a tile: 16 rows of 16 coarse cells, least y first, least x in the
    /// lowest bit.
    #[must_use]
    pub fn tile_skeleton(&self, column: i16, row: i16) -> [u16; 16] {
        let frame = self.skeleton.frame();
        let mut rows = [0; 16];
        let Some(plane) = self.skeleton.skeleton() else {
            return rows;
        };
        let corner = Cell {
            x: i32::from(column) * TILE_SIDE,
            y: i32::from(row) * TILE_SIDE,
        };
        let Some(site) = frame.site(corner) else {
            return rows;
        };
        let page = plane.page(TileKey::at(site));
        for (pair, word) in rows.chunks_exact_mut(2).zip(page) {
            pair.copy_from_slice(&[word as u16, (word >> 16) as u16]);
        }
        rows
    }

    /// Returns the path to the current goal: coarse cells of 20 cm, each named by the least of its
    /// four map cells, the robot's end first.
    #[must_use]
    pub fn path(&self) -> &[Cell] {
        self.strategy.frontier.path().cells()
    }

    /// Returns the residual frontiers, each with its reason.
    #[must_use]
    pub fn frontiers(&self) -> &[ResidualFrontier] {
        self.strategy.frontier.residual_frontiers()
    }

    /// Returns the preferences after the last step.
    #[cfg(feature = "internals")]
    #[must_use]
    pub const fn preferences(&self) -> &Preferences {
        &self.preferences
    }

    /// Returns the numbers of loops.
    #[must_use]
    pub fn loops(&self) -> LoopCounts {
        let Some(ouroboros) = self.strategy.ouroboros() else {
            return LoopCounts::default();
        };
        let tally = ouroboros.tally();
        LoopCounts {
            closing: ouroboros.shield().is_some(),
            closed: tally.closed,
            given_up: tally.given_up,
        }
    }

    /// Returns the tractor point of the loop that is being closed, a coarse cell \[Jorge15\].
    #[must_use]
    pub fn tractor(&self) -> Option<Cell> {
        self.strategy.ouroboros().and_then(Ouroboros::tractor)
    }

    /// Returns the two end cells of the shield behind the robot \[Jorge15\].
    #[must_use]
    pub fn shield(&self) -> Option<[Cell; 2]> {
        let shield = self.strategy.ouroboros().and_then(Ouroboros::shield)?;
        Some(shield.ends())
    }

    /// Returns one bit for each region of 8 × 8 cells of a tile, row by row: 1 if no new loop
    /// starts there because a loop was closed near it.
    #[must_use]
    pub fn closed_regions(&self, column: i16, row: i16) -> u16 {
        self.regions((column, row), Closed::Loop)
    }

    /// Returns one bit for each region of 8 × 8 cells of a tile, row by row: 1 if no new loop
    /// starts there because a loop was given up near it, or a revisit ended there.
    #[must_use]
    pub fn given_up_regions(&self, column: i16, row: i16) -> u16 {
        self.regions((column, row), Closed::GivenUp)
    }

    /// Returns one bit for each region of a tile: 1 if it is closed for that reason.
    fn regions(&self, tile: (i16, i16), why: Closed) -> u16 {
        let Some(ouroboros) = self.strategy.ouroboros() else {
            return 0;
        };
        let regions = ouroboros.closed_regions();
        (0..REGIONS)
            .filter(|&k| regions.closed(square(tile, REGION_CELLS, k)) == Some(why))
            .fold(0, |bits, k| bits | 1 << k)
    }

    /// Returns the stamps of the last visits to the four places of a tile, row by row: 0 for a
    /// place that was never visited \[Maffei14\].
    #[must_use]
    pub fn visit_stamps(&self, column: i16, row: i16) -> [u8; PLACES] {
        let Some(tdbvp) = self.strategy.tdbvp() else {
            return [0; PLACES];
        };
        let rails = tdbvp.rails();
        core::array::from_fn(|k| rails.stamp(square((column, row), PLACE_CELLS, k as i32)))
    }
}

/// Returns the cell with the least x and y in the `k`-th square of `side` cells of a tile.
fn square((column, row): (i16, i16), side: i32, k: i32) -> Cell {
    let across = TILE_SIDE / side;
    Cell {
        x: i32::from(column) * TILE_SIDE + k % across * side,
        y: i32::from(row) * TILE_SIDE + k / across * side,
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::{Cell, LoopCounts, State, square};

    #[test]
    fn a_planner_without_a_session_shows_nothing() {
        let state = Box::<State<4, 400>>::default();
        assert_eq!(state.loops(), LoopCounts::default());
        assert_eq!(state.closed_regions(0, 0), 0);
        assert_eq!(state.given_up_regions(0, 0), 0);
        assert_eq!(state.visit_stamps(3, -1), [0; 4]);
        assert_eq!((state.tractor(), state.shield()), (None, None));
        assert!(state.path().is_empty() && state.frontiers().is_empty());
    }

    #[test]
    fn squares_of_a_tile_are_numbered_row_by_row() {
        let cells = [0, 1, 2, 3].map(|k| square((-1, 2), 16, k));
        let expected = [(-32, 64), (-16, 64), (-32, 80), (-16, 80)];
        assert_eq!(cells, expected.map(|(x, y)| Cell { x, y }));
        assert_eq!(square((0, 0), 8, 15), Cell { x: 24, y: 24 });
    }
}
