//! What can be read of the planner beside its commands: tiles of the map, rows of the field, the road.
//!
//! Units: map cells; dates in seconds.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Bytes of a map tile: 32 × 32 cells of two bits, row by row from the least y, least x in the low bits.
pub const TILE_BYTES: usize = 256;
/// Bytes of a tile's skeleton: 16 × 16 coarse cells of one bit, row by row from the least y.
pub const TILE_SKELETON_BYTES: usize = 32;
/// Places of a tile that have a date of their own: 2 × 2 of 1.6 m, row by row from the least y.
pub const TILE_DATES: usize = 4;
/// Cells in a row of the field's window.
pub const FIELD_SIDE: usize = 61;
/// Bytes of a row's cell kinds: 61 cells of two bits.
pub const FIELD_CELL_BYTES: usize = 16;
/// Cells of the road that a reply lists at the most.
pub const ROAD_PAGE: usize = 32;

/// One map tile.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Tile {
    /// Tile column.
    pub x: i16,
    /// Tile row.
    pub y: i16,
    /// Two bits a cell: 0 unknown, 1 free, 2 obstacle, 3 negative obstacle.
    pub cells: Vec<u8, TILE_BYTES>,
    /// One bit a coarse cell: on the skeleton.
    pub skeleton: Vec<u8, TILE_SKELETON_BYTES>,
    /// One bit for 8 × 8 cells, row by row from the least y, least x in the lowest bit: a loop was closed near here.
    pub marks: u16,
    /// When a place of 16 × 16 cells was last visited, where the strategy keeps account: the later the greater, 0 never.
    pub dates: [u8; TILE_DATES],
}

/// One row of the last window's field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FieldRow {
    /// Row, 0 is the least y.
    pub row: u8,
    /// Cell column of the window's first cell, in units of the window's cell.
    pub origin_x: i16,
    /// Cell row of the window's first cell.
    pub origin_y: i16,
    /// Side of a window cell in map cells of 10 cm.
    pub scale: u8,
    /// q = 1 − p, scaled so that a goal is 1; 0 on obstacles.
    pub q: Vec<f32, FIELD_SIDE>,
    /// Two bits a cell, least x in the low bits: 0 free, 1 obstacle, 2 goal.
    pub cells: Vec<u8, FIELD_CELL_BYTES>,
}

/// Where the planner is going. Cells are map cells, the least ones of the planner's own of 20 cm.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Road {
    /// The tractor point: behind the robot, to be reached by the way ahead.
    pub tractor: Option<(i16, i16)>,
    /// The two ends of the shield, a wall across the way back while a loop is being closed.
    pub shield: Option<[(i16, i16); 2]>,
    /// Cells that the planner keeps of the road, the robot's end first.
    pub length: u8,
    /// Of them, those asked for.
    pub cells: Vec<(i16, i16), ROAD_PAGE>,
}
