//! Corrections of the map: a motion of the robot's pose, and tiles that replace the device's.
//!
//! ```text
//! correct { epoch, motion, tiles: n }   opens a correction; the robot stands
//! tiles { epoch, first, last, … }       tiles first, first + 1, … of 0 to n − 1
//! tiles { …, last: true }               closes it, if the device has all n
//! ```
//!
//! A part that comes twice is answered again and changes nothing. Of a part that comes too early
//! nothing is taken: every answer has the number of the first tile that is missing. A `correct`
//! with a greater epoch begins anew. The motion and all shifts act when the correction closes.
//!
//! Units: metres, radians; map cells of 10 cm; tiles of 32 × 32 cells.

use fixed::types::I16F16;
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Maximum number of tiles in a part of a correction.
pub const CORRECTED_TILES: usize = 10;
/// Maximum number of bytes of all cells in a part: an observation is longer.
pub const CORRECTED_BYTES: usize = 640;
/// Maximum number of tiles in a correction: twice those of the default image's map, which are
/// forgotten in one place and known in another.
pub const MOST_CORRECTED: u16 = 512;

/// A rigid motion of the plane: a turn about the map's origin, then a shift.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Motion {
    /// Metres.
    pub x: I16F16,
    /// Metres.
    pub y: I16F16,
    /// Radians.
    pub yaw: I16F16,
}

/// Opens a correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Correct {
    /// Number of the correction, greater than that of the last one; at least 1.
    pub epoch: u16,
    /// From the robot's pose in the map before to its pose after.
    pub motion: Motion,
    /// Number of tiles to come, at most [`MOST_CORRECTED`].
    pub tiles: u16,
}

/// A tile that replaces the device's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct CorrectedTile {
    /// Tile column.
    pub x: i16,
    /// Tile row.
    pub y: i16,
    /// Where to the places go that the planner remembers in the tile, cells along x and y.
    pub shift: (i8, i8),
    /// Number of bytes of its cells in [`CorrectedTiles::cells`]. Without any, nothing in the tile
    /// is known, and it is forgotten.
    pub bytes: u16,
}

/// A part of a correction.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct CorrectedTiles {
    /// The correction.
    pub epoch: u16,
    /// Number of the first of these tiles.
    pub first: u16,
    /// True for the last part: it closes the correction.
    pub last: bool,
    /// The tiles.
    pub tiles: Vec<CorrectedTile, CORRECTED_TILES>,
    /// The cells of all of them, one tile after the other, each as [`super::TeamTile::cells`].
    pub cells: Vec<u8, CORRECTED_BYTES>,
}

/// How far the device is with a correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct CorrectionProgress {
    /// The correction.
    pub epoch: u16,
    /// Number of the first tile that is missing.
    pub next: u16,
    /// True if it is closed: the map and the pose are corrected.
    pub closed: bool,
}
