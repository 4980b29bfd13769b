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
//! A device that was reset is told by a *recall* what the map does not have: the obstacle points
//! near the robot, and the track along which it came.
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
/// Number of bytes of the trail in a tile.
pub const TRAIL_BYTES: usize = 32;
/// Maximum number of points in a recall.
pub const RECALLED_POINTS: usize = 128;
/// Maximum number of differences in a recalled track.
pub const RECALLED_TRACK: usize = 56;
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
    /// True if [`TRAIL_BYTES`] bytes follow its cells: where the robot's centre was. A device that
    /// was reset has lost it.
    #[serde(default)]
    pub trail: bool,
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
    /// The cells of all of them, one tile after the other, each as [`super::TeamTile::cells`], and
    /// each with its trail behind it: 16 rows of 16 blocks of 2 × 2 cells, the least y first, the
    /// least x in the lowest bit; each row a little-endian word of two bytes.
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

/// An obstacle point near the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct RecalledPoint {
    /// Millimetres east of the origin of the [`Recall`].
    pub x_mm: i16,
    /// Millimetres north of it.
    pub y_mm: i16,
    /// Number of returns of the point, 1 to 8; 255 for a point beside the hull of a robot that
    /// starts, which nothing has seen.
    pub returns: u8,
}

/// Tells a device that was reset what it knew of the space around its robot. It comes after the
/// correction that gave the device its map back, and before the first observation.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Recall {
    /// The correction that gave the map back: the last one that was closed.
    pub epoch: u16,
    /// From where the points are told, by odometry: metres east and north.
    pub origin: (I16F16, I16F16),
    /// The nearest obstacle points.
    pub points: Vec<RecalledPoint, RECALLED_POINTS>,
    /// Where the track ends, in the map: metres, metres, radians.
    pub track_end: Option<Motion>,
    /// The differences of the track's poses, the oldest first, each in the frame of the older pose:
    /// ahead in 4 mm, to the left in 1 mm, turned in 0.01 rad.
    pub track: Vec<[i8; 3], RECALLED_TRACK>,
}
