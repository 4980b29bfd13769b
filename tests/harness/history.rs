//! History of the device's map: every change of every cell, with its time.
//!
//! The tiles around the robot are read after every step ([`crate::watched`]). Classes change in the
//! elevation window, at most 3.2 m from the robot, and in rooms that level beams look into, at most
//! 12 m away: four tiles on every side of the robot's own tile. Reading changes no command.
//! Units: milliseconds; map cells of 10 cm.

use std::collections::BTreeMap;

use fieldline_protocol::message::{Observation, Tile};
use host_sim::link::{Link, LinkError};
use host_sim::report::MapCell;
use host_sim::report::grid_map::{CELL_M, TILE_SIDE};

/// Tiles on every side of the robot's own tile that a step may change: 12.8 m.
const REACH_TILES: i16 = 4;

/// Time of a change, milliseconds, and the cell's new class.
pub type Change = (u32, MapCell);

/// All changes of all cells.
#[derive(Clone, Debug, Default)]
pub struct History {
    changes: BTreeMap<[i32; 2], Vec<Change>>,
}

/// Writes a history, step by step.
#[derive(Debug, Default)]
pub struct Watcher {
    tiles: BTreeMap<(i16, i16), Vec<u8>>,
    /// The history so far.
    pub history: History,
}

impl History {
    /// Returns a cell's class at a time.
    #[must_use]
    pub fn at(&self, cell: [i32; 2], time_ms: u32) -> MapCell {
        let changes = self.of(cell).iter();
        let last = changes.rev().find(|(when_ms, _)| *when_ms <= time_ms);
        last.map_or(MapCell::Unknown, |(_, class)| *class)
    }

    /// Returns all changes of a cell, in order.
    #[must_use]
    pub fn of(&self, cell: [i32; 2]) -> &[Change] {
        self.changes.get(&cell).map_or(&[], Vec::as_slice)
    }

    /// Returns the cells that ever had one of these classes.
    pub fn ever<'a>(&'a self, classes: &'a [MapCell]) -> impl Iterator<Item = [i32; 2]> + 'a {
        let had = |changes: &Vec<Change>| changes.iter().any(|(_, class)| classes.contains(class));
        let cells = self.changes.iter().filter(move |(_, changes)| had(changes));
        cells.map(|(cell, _)| *cell)
    }

    /// Notes the changes from one packed tile to the next. Both hold two bits a cell, row by row.
    fn note(&mut self, time_ms: u32, tile: &Tile, before: &[u8]) {
        let side = TILE_SIDE as usize;
        for (k, now) in tile.cells.iter().enumerate() {
            let changed = now ^ before.get(k).copied().unwrap_or(0);
            for lane in (0..4).filter(|lane| changed >> (2 * lane) & 3 != 0) {
                let (column, row) = ((4 * k + lane) % side, (4 * k + lane) / side);
                let x = i32::from(tile.x) * TILE_SIDE + column as i32;
                let y = i32::from(tile.y) * TILE_SIDE + row as i32;
                let change = (time_ms, class(now >> (2 * lane)));
                self.changes.entry([x, y]).or_default().push(change);
            }
        }
    }
}

fn class(code: u8) -> MapCell {
    match code & 3 {
        0 => MapCell::Unknown,
        1 => MapCell::Free,
        2 => MapCell::Obstacle,
        _ => MapCell::NegativeObstacle,
    }
}

impl Watcher {
    /// Makes a watcher for a run.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Reads the tiles around the robot after a step.
    ///
    /// # Errors
    /// As [`LinkError`].
    pub fn look(
        &mut self,
        link: &mut dyn Link,
        observation: &Observation,
    ) -> Result<(), LinkError> {
        let side_m = CELL_M * f64::from(TILE_SIDE);
        let tile = |m: f64| (m / side_m).floor() as i16;
        let (x, y) = (
            tile(observation.pose.x.to_num()),
            tile(observation.pose.y.to_num()),
        );
        let around = -REACH_TILES..=REACH_TILES;
        for (dx, dy) in around
            .clone()
            .flat_map(|dy| around.clone().map(move |dx| (dx, dy)))
        {
            let place = (x + dx, y + dy);
            if let Some(tile) = link.tile(place.0, place.1)? {
                let before = self.tiles.entry(place).or_default();
                self.history.note(observation.time_ms, &tile, before);
                *before = tile.cells.to_vec();
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{History, MapCell, Tile};

    fn tile(x: i16, first: u8) -> Tile {
        let mut cells = [0; 256];
        cells[9] = first;
        Tile {
            x,
            y: 0,
            cells: cells.into_iter().collect(),
            skeleton: [0; 32].into_iter().collect(),
            closed_regions: 0,
            given_up_regions: 0,
            visit_stamps: [0; 4],
        }
    }

    #[test]
    fn a_cell_has_the_class_of_its_last_change() {
        let mut history = History::default();
        // Byte 9 holds columns 4 to 7 of row 1.
        history.note(100, &tile(-1, 0b01_00_10_11), &[]);
        history.note(
            300,
            &tile(-1, 0b01_00_10_01),
            &tile(-1, 0b01_00_10_11).cells,
        );
        let cell = [4 - 32, 1];
        let changes = [(100, MapCell::NegativeObstacle), (300, MapCell::Free)];
        assert_eq!(history.of(cell), changes);
        let at = |time_ms| history.at(cell, time_ms);
        assert_eq!(
            [at(99), at(100), at(299), at(300)],
            [
                MapCell::Unknown,
                MapCell::NegativeObstacle,
                MapCell::NegativeObstacle,
                MapCell::Free
            ]
        );
        assert_eq!(history.of([5 - 32, 1]), [(100, MapCell::Obstacle)]);
        assert_eq!(history.of([6 - 32, 1]), []);
        let ever = |classes: &[MapCell]| history.ever(classes).collect::<Vec<_>>();
        assert_eq!(ever(&[MapCell::NegativeObstacle]), [cell]);
        assert_eq!(ever(&[MapCell::Free, MapCell::Obstacle]).len(), 3);
    }
}
