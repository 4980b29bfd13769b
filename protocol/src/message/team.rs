//! Packets between the robots of a team: what a robot says is for all who hear it.
//!
//! A packet may be lost, doubled, late, or out of order. The radio is not part of this crate;
//! [`crate::packet`] has the bytes of a packet in the air.
//!
//! | body | says | when |
//! | --- | --- | --- |
//! | [`Beacon`] | pose, hull, goal, the road ahead, a mark of the map | in every step |
//! | [`Digest`] | the versions of some tiles | once a second |
//! | [`Wanted`] | which tiles to say again | after a digest that differs |
//! | [`TeamTile`] | the cells of a tile | when they changed, or were wanted |
//!
//! Units: centimetres in names with `_cm`; map cells of 10 cm; tiles of 32 × 32 cells, all in the
//! team's coordinates.

use fixed::types::{I4F12, I16F16};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::{TILE_BYTES, Twist};

/// Maximum number of points of the road ahead in a beacon.
pub const ROAD_POINTS: usize = 4;
/// Unit of the road's offsets, centimetres.
pub const ROAD_UNIT_CM: i16 = 40;
/// Maximum number of tiles in a digest.
pub const DIGEST_TILES: usize = 24;
/// Maximum number of tiles in a request for tiles.
pub const WANTED_TILES: usize = 16;
/// Number of cells of a tile.
const TILE_CELLS: usize = 4 * TILE_BYTES;
/// Greatest length of a run of cells.
const LONGEST_RUN: u8 = 64;

/// A robot of a team.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, Schema,
)]
pub struct Member {
    /// The robot's number, unique in the team.
    pub id: u8,
    /// A number that changes each time the robot begins a session: its map is then empty again.
    pub boot: u16,
}

/// The team of a session, and the robot's place in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Team {
    /// This robot.
    pub member: Member,
    /// The pose of the odometry's origin in the team's coordinates: x, y in metres.
    pub origin: (I16F16, I16F16),
    /// Its yaw, radians.
    pub yaw: I16F16,
    /// Standard deviation of the robot's start along each axis, millimetres; 0 if it is known.
    pub sd_mm: u16,
    /// Standard deviation of its yaw at the start, milliradians; 0 if it is known.
    pub sd_mrad: u16,
}

/// What a robot of a team does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Activity {
    /// It drives.
    #[default]
    Exploring,
    /// It makes way for another robot, or has made way and waits.
    Yielding,
    /// It should make way and cannot.
    Cornered,
    /// It stands by order: paused, or the emergency stop is pressed.
    Standing,
    /// Its exploration is finished.
    Finished,
    /// Its planner cannot continue.
    Faulted,
    /// It leaves the team.
    Gone,
    /// It stands until another robot is out of its way.
    Holding,
}

/// Where a robot is and what it is about to do: at most [`crate::packet::MAX_BEACON`] bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Beacon {
    /// A hash of the whole map: equal for equal maps.
    pub map: u32,
    /// Position, centimetres.
    pub x_cm: i16,
    /// Position, centimetres.
    pub y_cm: i16,
    /// Radians, in [−π, π].
    pub yaw: I4F12,
    /// Standard deviation of the position, centimetres.
    pub sd_cm: u8,
    /// Velocity.
    pub velocity: Twist,
    /// Half of the hull's length, centimetres, rounded up.
    pub half_length_cm: u8,
    /// Half of the hull's width, centimetres, rounded up.
    pub half_width_cm: u8,
    /// What the robot does.
    pub activity: Activity,
    /// The map cell that the robot drives to.
    pub goal: Option<(i16, i16)>,
    /// Places on the road ahead, as offsets from the position in units of [`ROAD_UNIT_CM`].
    pub road: Vec<(i8, i8), ROAD_POINTS>,
}

/// The version of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct TileVersion {
    /// Tile column: cell / 32, rounded down.
    pub x: i8,
    /// Tile row.
    pub y: i8,
    /// The tile's epoch.
    pub epoch: u16,
    /// Hash of the salt and the cells.
    pub hash: u16,
}

/// The versions of some tiles.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Digest {
    /// The hashes begin with this number. It changes from round to round, so that two tiles with
    /// the same hash by chance differ the next time.
    pub salt: u8,
    /// The tiles.
    pub tiles: Vec<TileVersion, DIGEST_TILES>,
}

/// A request for tiles.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Wanted {
    /// The robot that is asked.
    pub of: u8,
    /// Column and row of each tile.
    pub tiles: Vec<(i8, i8), WANTED_TILES>,
}

/// The cells of a tile.
///
/// [`TeamTile::cells`] is a list of runs in rows from the least y: the class in the two low bits,
/// the number of cells less one in the six high bits. A list of [`TILE_BYTES`] bytes is no list of
/// runs: it has two bits per cell, as [`super::Tile::cells`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct TeamTile {
    /// Tile column.
    pub x: i8,
    /// Tile row.
    pub y: i8,
    /// The tile's epoch.
    pub epoch: u16,
    /// The classes of the cells.
    pub cells: Vec<u8, TILE_BYTES>,
}

impl TeamTile {
    /// Encodes the classes of a tile's cells (0 to 3), row by row from the least y.
    #[must_use]
    pub fn pack(cells: impl Iterator<Item = u8> + Clone) -> Vec<u8, TILE_BYTES> {
        runs(cells.clone()).unwrap_or_else(|| plain(cells))
    }

    /// Returns the classes of the cells as runs: class and number of cells. `None` if the list does
    /// not have exactly the cells of a tile.
    #[must_use]
    pub fn unpack(&self) -> Option<impl Iterator<Item = (u8, usize)> + '_> {
        Self::unpack_cells(&self.cells)
    }

    /// As [`TeamTile::unpack`], for the bytes of [`TeamTile::cells`].
    #[must_use]
    pub fn unpack_cells(bytes: &[u8]) -> Option<impl Iterator<Item = (u8, usize)> + '_> {
        let is_plain = bytes.len() == TILE_BYTES;
        let cells = if is_plain {
            4 * bytes.len()
        } else {
            bytes.iter().map(|run| run_length(*run)).sum()
        };
        let run = move |&byte: &u8| {
            let in_plain = (0..4).map(move |k| (byte >> (2 * k) & 3, 1));
            let as_run = core::iter::once((byte & 3, run_length(byte)));
            let (in_plain, as_run) = (is_plain.then_some(in_plain), (!is_plain).then_some(as_run));
            in_plain
                .into_iter()
                .flatten()
                .chain(as_run.into_iter().flatten())
        };
        (cells == TILE_CELLS).then(|| bytes.iter().flat_map(run))
    }
}

const fn run_length(run: u8) -> usize {
    (run >> 2) as usize + 1
}

/// Encodes cells as runs; `None` if they take as many bytes as without.
fn runs(cells: impl Iterator<Item = u8>) -> Option<Vec<u8, TILE_BYTES>> {
    let mut bytes = Vec::<u8, TILE_BYTES>::new();
    let (mut class, mut length) = (0, 0);
    for cell in cells {
        if length > 0 && (cell != class || length == LONGEST_RUN) {
            bytes.push((length - 1) << 2 | class).ok()?;
            length = 0;
        }
        (class, length) = (cell & 3, length + 1);
    }
    if length > 0 {
        bytes.push((length - 1) << 2 | class).ok()?;
    }
    (!bytes.is_full()).then_some(bytes)
}

/// Encodes cells in two bits each.
fn plain(cells: impl Iterator<Item = u8>) -> Vec<u8, TILE_BYTES> {
    let mut bytes = Vec::new();
    // A tile fills the list exactly.
    let _ = bytes.resize_default(TILE_BYTES);
    for (number, cell) in cells.enumerate() {
        if let Some(byte) = bytes.get_mut(number / 4) {
            *byte |= (cell & 3) << (2 * (number % 4));
        }
    }
    bytes
}

/// The body of a packet.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Body {
    /// Where the robot is and what it is about to do.
    Beacon(Beacon),
    /// The versions of some tiles.
    Digest(Digest),
    /// A request for tiles.
    Wanted(Wanted),
    /// The cells of a tile.
    Tile(TeamTile),
}

/// A packet: what a robot says to all who hear it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Packet {
    /// The robot that says it.
    pub from: Member,
    /// Number of the packet since the robot's boot; wraps.
    pub sequence: u16,
    /// What it says.
    pub body: Body,
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::TeamTile;

    fn tile(cells: &[u8]) -> TeamTile {
        TeamTile {
            cells: TeamTile::pack(cells.iter().copied()),
            ..TeamTile::default()
        }
    }

    fn unpacked(tile: &TeamTile) -> Option<Vec<u8>> {
        let runs = tile.unpack()?;
        Some(
            runs.flat_map(|(class, cells)| [class].repeat(cells))
                .collect(),
        )
    }

    #[test]
    fn an_empty_tile_is_sixteen_runs() {
        let tile = tile(&[0; 1024]);
        assert_eq!(tile.cells, [0xfc; 16]);
        assert_eq!(unpacked(&tile).unwrap(), [0; 1024]);
    }

    #[test]
    fn any_tile_is_unpacked_as_it_was_packed() {
        let mut seed = 5_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 8
        };
        for change in [1, 2, 3, 4, 5, 40, 400] {
            let mut class = 0;
            let cells: Vec<u8> = (0..1024)
                .map(|_| {
                    if random() % change == 0 {
                        class = (random() & 3) as u8;
                    }
                    class
                })
                .collect();
            let tile = tile(&cells);
            assert_eq!(unpacked(&tile).unwrap(), cells, "{change}");
            assert_eq!(tile.cells.len() == 256, change <= 3, "{change}");
        }
    }

    #[test]
    fn runs_that_do_not_make_a_tile_are_refused() {
        let mut tile = tile(&[1; 1024]);
        tile.cells.pop();
        assert_eq!(unpacked(&tile), None);
        tile.cells.clear();
        assert_eq!(unpacked(&tile), None);
        for _ in 0..17 {
            tile.cells.push(0xfd).unwrap();
        }
        assert_eq!(unpacked(&tile), None);
    }
}
