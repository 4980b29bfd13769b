//! What a host can read from the planner beside its commands: map tiles, field rows, the path.
//!
//! Units: map cells of 10 cm.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Length of a map tile, bytes: 32 × 32 cells of two bits, row by row from the least y, with the
/// least x in the low bits.
pub const TILE_BYTES: usize = 256;
/// Length of a tile's skeleton, bytes: 16 × 16 coarse cells of one bit, row by row from the least
/// y.
pub const TILE_SKELETON_BYTES: usize = 32;
/// Number of visit stamps in a tile: 2 × 2 places of 1.6 m, row by row from the least y.
pub const TILE_STAMPS: usize = 4;
/// Number of cells in a row of the field's window.
pub const FIELD_SIDE: usize = 61;
/// Length of the cell kinds of a field row, bytes: 61 cells of two bits.
pub const FIELD_CELL_BYTES: usize = 16;
/// Maximum number of path cells in one reply.
pub const PATH_PAGE: usize = 32;

/// One map tile.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Tile {
    /// Tile column.
    pub x: i16,
    /// Tile row.
    pub y: i16,
    /// Class of each cell, two bits: 0 unknown, 1 free, 2 obstacle, 3 negative obstacle.
    pub cells: Vec<u8, TILE_BYTES>,
    /// One bit per coarse cell: 1 if the cell is on the skeleton.
    pub skeleton: Vec<u8, TILE_SKELETON_BYTES>,
    /// Regions in which no new loop starts because a loop was closed near them. One bit per 8 × 8
    /// cells, row by row from the least y, with the least x in the lowest bit.
    pub closed_regions: u16,
    /// Regions in which no new loop starts because a loop was given up near them, or a revisit
    /// ended there. Bits as in `closed_regions`. No region is in both.
    pub given_up_regions: u16,
    /// Stamp of the last visit to each place of 16 × 16 cells; 0 if the place was never visited or
    /// if the strategy keeps no account of visits.
    ///
    /// A stamp numbers an interval of steps; the greater stamp is the later visit. An interval is 4
    /// steps long at first. When the 255 numbers are used up, the planner lowers all stamps, or
    /// halves them and doubles the interval. So a stamp is no time: compare only stamps that were
    /// read together.
    pub visit_stamps: [u8; TILE_STAMPS],
}

/// One row of the field in the last window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FieldRow {
    /// Row; 0 has the least y.
    pub row: u8,
    /// Column of the window's first cell, in window cells.
    pub origin_x: i16,
    /// Row of the window's first cell, in window cells.
    pub origin_y: i16,
    /// Side of a window cell, map cells.
    pub scale: u8,
    /// q = 1 − p, scaled such that a goal has 1; 0 on obstacles.
    pub q: Vec<f32, FIELD_SIDE>,
    /// Kind of each cell, two bits, with the least x in the low bits: 0 free, 1 obstacle, 2 goal.
    pub cells: Vec<u8, FIELD_CELL_BYTES>,
}

/// Where the planner sends the robot.
///
/// The planner's path cells have a side of 20 cm. Each is given by its map cell with the least x
/// and y.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Path {
    /// The tractor point: a point behind the robot that the robot must reach by a way ahead.
    pub tractor: Option<(i16, i16)>,
    /// The two ends of the shield: a wall across the way back, as long as a loop is being closed.
    pub shield: Option<[(i16, i16); 2]>,
    /// Number of cells in the whole path.
    pub length: u8,
    /// The requested part of the path, from the robot's end.
    pub cells: Vec<(i16, i16), PATH_PAGE>,
}
