//! Reads map, window, path and residual frontiers over the link, at the end of a run and for
//! pictures during it.
//!
//! The map is searched from the start's tile. Beams leave the robot, so the touched tiles are
//! connected through their eight neighbours. Cost: one request for each touched tile and each tile
//! around them.

use std::collections::{BTreeMap, BTreeSet};

use fieldline_protocol::message::{FIELD_SIDE, FieldRow, Tile};

use super::planned_path::{self, PlannedPath};
use super::relief::Relief;
use super::{Progress, Record};
use crate::link::{Link, LinkError};
use crate::report::GridMap;
use crate::report::grid_map::{CELL_M, TILE_SIDE};

/// Kind of a window's cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WindowCell {
    /// Part of the field.
    #[default]
    Free,
    /// q = 0.
    Obstacle,
    /// q = 1.
    Goal,
}

/// The last window's field, `FIELD_SIDE` cells square, row by row from the least y.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Column of the first cell, in window cells.
    pub origin_x: i32,
    /// Row of the first cell, in window cells.
    pub origin_y: i32,
    /// Side of a window cell, metres.
    pub cell_m: f64,
    /// q, scaled so that a goal is 1.
    pub q: Vec<f32>,
    /// The boundary.
    pub cells: Vec<WindowCell>,
}

/// Map and window at a moment of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Progress at that moment.
    pub progress: Progress,
    /// Number of steps until then.
    pub steps: usize,
    /// The device's map.
    pub map: GridMap,
    /// The last window's field.
    pub window: Option<Window>,
    /// The planner's path.
    pub planned_path: PlannedPath,
    /// Heights and preferences in the window; `None` on flat ground.
    pub relief: Option<Relief>,
}

/// Reads the record's map, window, path and frontiers. A map that consists of parts, because a
/// part of it was heard, is found if each part holds the start or one of `places`, metres.
///
/// # Errors
/// As [`LinkError`]; data read before it stays in the record.
pub fn read(
    link: &mut dyn Link,
    record: &mut Record,
    places: &[[f64; 2]],
) -> Result<(), LinkError> {
    record.frontiers = link.frontiers()?;
    record.window = window(link)?;
    record.planned_path = planned_path::read(link)?;
    let places: Vec<[f64; 2]> = [&[began_m(record)], places].concat();
    record.tiles = tiles(link, &places)?;
    record.map = GridMap::from_tiles(&record.tiles);
    Ok(())
}

/// Reads map, window and path after the record's last step.
///
/// # Errors
/// As [`LinkError`].
pub fn take(link: &mut dyn Link, record: &Record) -> Result<Snapshot, LinkError> {
    let (window, planned_path) = (window(link)?, planned_path::read(link)?);
    let tiles = tiles(link, &[began_m(record)])?;
    Ok(Snapshot {
        progress: record.progress(),
        steps: record.steps.len(),
        map: GridMap::from_tiles(&tiles),
        window,
        planned_path,
        relief: None,
    })
}

/// Returns the first estimated position, metres.
fn began_m(record: &Record) -> [f64; 2] {
    let start = record.steps.first().map(|step| step.estimate);
    let start = start.unwrap_or_default();
    [start.x_m, start.y_m]
}

/// Reads the last window's field; `None` before the first window.
///
/// # Errors
/// As [`LinkError`].
pub fn window(link: &mut dyn Link) -> Result<Option<Window>, LinkError> {
    let mut out: Option<Window> = None;
    for row in 0..FIELD_SIDE as u8 {
        let Some(row) = link.field_row(row)? else {
            return Ok(None);
        };
        let window = out.get_or_insert_with(|| Window {
            origin_x: i32::from(row.origin_x),
            origin_y: i32::from(row.origin_y),
            cell_m: CELL_M * f64::from(row.scale.max(1)),
            q: Vec::with_capacity(FIELD_SIDE * FIELD_SIDE),
            cells: Vec::with_capacity(FIELD_SIDE * FIELD_SIDE),
        });
        for column in 0..FIELD_SIDE {
            window.q.push(row.q.get(column).copied().unwrap_or(0.0));
            window.cells.push(cell_of(&row, column));
        }
    }
    Ok(out)
}

fn cell_of(row: &FieldRow, column: usize) -> WindowCell {
    let byte = row.cells.get(column / 4).copied().unwrap_or(1);
    match (byte >> (2 * (column % 4))) & 3 {
        0 => WindowCell::Free,
        2 => WindowCell::Goal,
        _ => WindowCell::Obstacle,
    }
}

/// Reads every tile of the parts of the map that hold one of `places`, metres.
pub(crate) fn tiles(
    link: &mut dyn Link,
    places: &[[f64; 2]],
) -> Result<BTreeMap<(i16, i16), Tile>, LinkError> {
    let side_m = CELL_M * f64::from(TILE_SIDE);
    let tile_of = |[x_m, y_m]: &[f64; 2]| {
        let number = |m: &f64| (m / side_m).floor() as i16;
        (number(x_m), number(y_m))
    };
    let mut asked: BTreeSet<(i16, i16)> = places.iter().map(tile_of).collect();
    let mut pending: Vec<(i16, i16)> = asked.iter().copied().collect();
    let mut found = BTreeMap::new();
    while let Some((x, y)) = pending.pop() {
        let Some(tile) = link.tile(x, y)? else {
            continue;
        };
        found.insert((x, y), tile);
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        for (dx, dy) in around {
            let next = (x.saturating_add(dx), y.saturating_add(dy));
            if asked.insert(next) {
                pending.push(next);
            }
        }
    }
    Ok(found)
}
