//! What others measured in a tile that a robot's graph corrects.
//!
//! The canvas of a host knows one robot's scans; its device also knows what peers said. A tile that
//! the robot measured first lies where its own pose was, and its peers found their poses in it. So
//! what they added goes where the tile goes:
//!
//! ```text
//! corrected = own scans at the corrected poses
//!           ∪ (device − own scans at the poses where the device entered them), by the tile's shift
//! ```
//!
//! The second line fills cells that the first one leaves unknown. An obstacle beside one that the
//! own scans drew is one of their own: a map that turned into the team's coordinates is rounded.
//!
//! Units: map cells; classes 0 unknown, 1 free, 2 obstacle, 3 what came.

use std::collections::BTreeMap;

use fieldline_planner::map::tiles::TILE_SIDE;

use crate::link::correction::Classes;
use crate::trial::map_copy::Key;

/// Cells that others measured, each where its tile's shift brings it.
#[derive(Debug, Default)]
pub(super) struct Others(BTreeMap<(i32, i32), u32>);

impl Others {
    /// Takes the cells of a device's tile that the own scans do not explain. `own` has the class
    /// that they gave to a cell.
    pub(super) fn take(
        &mut self,
        (key, tile): (Key, &Classes),
        shift: (i8, i8),
        own: impl Fn((i32, i32)) -> u32,
    ) {
        for (cell, class) in cells(key, tile) {
            let (x, y) = cell;
            let mut beside = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
            let is_own = own(cell) != 0 || (class >= 2 && beside.any(|cell| own(cell) >= 2));
            if !is_own {
                let to = (x + i32::from(shift.0), y + i32::from(shift.1));
                let place = self.0.entry(to).or_default();
                *place = class.max(*place);
            }
        }
    }

    /// Fills the unknown cells of a corrected tile.
    pub(super) fn fill(&self, key: Key, tile: &mut Classes) {
        let [x0, y0] = [key.0, key.1].map(|at| i32::from(at) * TILE_SIDE);
        for row in 0..TILE_SIDE {
            for column in 0..TILE_SIDE {
                let Some(class) = self.0.get(&(x0 + column, y0 + row)) else {
                    continue;
                };
                let [low, high] = tile.each_mut().map(|plane| &mut plane[row as usize]);
                if (*low | *high) >> column & 1 == 0 {
                    *low |= (class & 1) << column;
                    *high |= (class >> 1) << column;
                }
            }
        }
    }
}

/// Returns the class of a cell of a map in tiles.
pub(super) fn class_at((x, y): (i32, i32), tile: impl Fn(Key) -> Option<Classes>) -> u32 {
    let key = [x, y].map(|at| at.div_euclid(TILE_SIDE) as i16);
    let (column, row) = (x.rem_euclid(TILE_SIDE), y.rem_euclid(TILE_SIDE) as usize);
    tile(key.into()).map_or(0, |[low, high]| {
        low[row] >> column & 1 | (high[row] >> column & 1) << 1
    })
}

/// Returns the known cells of a tile, each with its class.
fn cells(key: Key, [low, high]: &Classes) -> impl Iterator<Item = ((i32, i32), u32)> {
    let [x0, y0] = [key.0, key.1].map(|at| i32::from(at) * TILE_SIDE);
    let rows = (0..).zip(low.iter().zip(high));
    let cells = rows.flat_map(move |(row, (low, high))| {
        (0..TILE_SIDE).map(move |k| {
            let class = low >> k & 1 | (high >> k & 1) << 1;
            ((x0 + k, y0 + row), class)
        })
    });
    cells.filter(|(_, class)| *class != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tile with these cells.
    fn tile(cells: &[((usize, usize), u32)]) -> Classes {
        let mut tile = Classes::default();
        for &((x, y), class) in cells {
            tile[0][y] |= (class & 1) << x;
            tile[1][y] |= (class >> 1) << x;
        }
        tile
    }

    #[test]
    fn what_others_measured_moves_with_the_tile_and_hides_nothing() {
        let own = tile(&[((5, 5), 2), ((6, 5), 1)]);
        // Beside the own wall and cell: an obstacle that is the same wall, and two cells of others.
        let device = tile(&[
            ((5, 5), 2),
            ((6, 5), 1),
            ((5, 6), 2),
            ((8, 5), 2),
            ((9, 5), 1),
        ]);
        let mut others = Others::default();
        let own_at = |cell| class_at(cell, |key| (key == (0, 0)).then_some(own));
        others.take(((0, 0), &device), (2, 1), own_at);
        let mut corrected = tile(&[((7, 6), 2), ((10, 6), 1)]);
        others.fill((0, 0), &mut corrected);
        let expected = tile(&[((7, 6), 2), ((10, 6), 1), ((11, 6), 1)]);
        assert_eq!(corrected, expected);
    }

    #[test]
    fn a_cell_that_leaves_its_tile_fills_the_next_one() {
        let mut others = Others::default();
        others.take(((-1, 0), &tile(&[((31, 3), 2)])), (2, 0), |_| 0);
        let mut next = Classes::default();
        others.fill((0, 0), &mut next);
        assert_eq!(next, tile(&[((1, 3), 2)]));
        assert_eq!(class_at((1, 3), |_| Some(next)), 2);
        assert_eq!(
            class_at((-31, 3), |key| (key == (-1, 0)).then_some(next)),
            2
        );
    }
}
