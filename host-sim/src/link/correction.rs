//! A correction of the map, as a host has it, and its parts on the wire.
//!
//! A correction goes to any link by [`Link::correct`](super::Link::correct): one message opens it,
//! and parts with the tiles follow, each from the tile on that the device said is missing. So a
//! part that was lost is sent again, whatever lost it.
//!
//! Tiles that are forgotten go first: their pages are spare for the others.
//!
//! Units: metres, radians; map cells; tiles of 32 × 32 cells.

use fieldline_device::convert::quantity;
use fieldline_planner::geometry::{MapFromOdom, MapPose, OdomPose, Pose};
use fieldline_protocol::message::{self as wire, CORRECTED_BYTES, CORRECTED_TILES, TeamTile};

/// The cells of a tile: a low and a high plane. A word is a row, bit k of it column k; the classes
/// are 0 unknown, 1 free, 2 obstacle, 3 what came.
pub type Classes = [[u32; 32]; 2];

/// A rigid motion of the plane: a turn about the map's origin, then a shift.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Metres.
    pub x_m: f64,
    /// Metres.
    pub y_m: f64,
    /// Radians.
    pub yaw_rad: f64,
}

impl Motion {
    /// Returns the motion as the wire has it.
    #[must_use]
    pub fn message(&self) -> wire::Motion {
        let long = |value: f64| quantity(value as f32);
        wire::Motion {
            x: long(self.x_m),
            y: long(self.y_m),
            yaw: long(self.yaw_rad),
        }
    }

    /// Returns the way by which a pose moves, metres.
    #[must_use]
    pub fn length_at_m(&self, pose: &Pose) -> f64 {
        let (sin, cos) = self.yaw_rad.sin_cos();
        let (x, y) = (f64::from(pose.x_m), f64::from(pose.y_m));
        let to = (self.x_m + cos * x - sin * y, self.y_m + sin * x + cos * y);
        (to.0 - x).hypot(to.1 - y)
    }

    /// Returns the motion from the pose `before` to the pose `after`.
    #[must_use]
    pub fn between(before: &Pose, after: &Pose) -> Self {
        Self::of(&MapFromOdom::between(&OdomPose(*before), &MapPose(*after)))
    }

    /// Returns this motion.
    #[must_use]
    pub fn of(motion: &MapFromOdom) -> Self {
        Self {
            x_m: motion.x_m.into(),
            y_m: motion.y_m.into(),
            yaw_rad: motion.yaw_rad.into(),
        }
    }
}

/// A tile that replaces the device's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CorrectedTile {
    /// Tile column and row.
    pub key: (i16, i16),
    /// Where to the places go that the planner remembers in the tile, cells along x and y.
    pub shift: (i8, i8),
    /// The cells; without a known one the tile is forgotten.
    pub classes: Classes,
    /// Where the robot's centre was, for a device that was reset: rows of blocks of 2 × 2 cells.
    pub trail: [u16; 16],
}

impl CorrectedTile {
    /// Returns true if nothing in the tile is known.
    fn is_forgotten(&self) -> bool {
        self.classes == Classes::default()
    }

    /// Returns the trail as the wire has it; empty without one.
    fn trail_bytes(&self) -> Vec<u8> {
        if self.trail == [0; 16] || self.is_forgotten() {
            return Vec::new();
        }
        self.trail.into_iter().flat_map(u16::to_le_bytes).collect()
    }

    /// Returns the cells as the wire has them.
    fn bytes(&self) -> Vec<u8> {
        if self.is_forgotten() {
            return Vec::new();
        }
        let [low, high] = &self.classes;
        let class = |k: usize| low[k / 32] >> (k % 32) & 1 | (high[k / 32] >> (k % 32) & 1) << 1;
        TeamTile::pack((0..1024).map(|k| class(k) as u8)).to_vec()
    }
}

/// A correction of the map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapCorrection {
    /// Its number, greater than that of the last one, which every command tells; at least 1.
    pub epoch: u16,
    /// The motion of the robot's pose in the map: after = motion ∘ before.
    pub motion: Motion,
    /// The tiles that change, at most [`wire::MOST_CORRECTED`]. Others stay.
    pub tiles: Vec<CorrectedTile>,
}

impl MapCorrection {
    /// Returns the message that opens the correction.
    #[must_use]
    pub fn opening(&self) -> wire::Correct {
        wire::Correct {
            epoch: self.epoch,
            motion: self.motion.message(),
            tiles: u16::try_from(self.tiles.len()).unwrap_or(u16::MAX),
        }
    }

    /// Returns the tiles in the order in which they are sent.
    pub fn in_order(&self) -> impl Iterator<Item = &CorrectedTile> {
        let of = |forgotten: bool| {
            let tiles = self.tiles.iter();
            tiles.filter(move |tile| tile.is_forgotten() == forgotten)
        };
        of(true).chain(of(false))
    }

    /// Returns the part from a tile on: as many tiles as fit.
    #[must_use]
    pub fn part(&self, first: u16) -> wire::CorrectedTiles {
        let mut part = wire::CorrectedTiles {
            epoch: self.epoch,
            first,
            last: true,
            ..wire::CorrectedTiles::default()
        };
        for tile in self.in_order().skip(first.into()) {
            let (bytes, trail) = (tile.bytes(), tile.trail_bytes());
            let has_room = part.tiles.len() < CORRECTED_TILES
                && part.cells.len() + bytes.len() + trail.len() <= CORRECTED_BYTES;
            if !has_room {
                part.last = false;
                break;
            }
            let head = wire::CorrectedTile {
                x: tile.key.0,
                y: tile.key.1,
                shift: tile.shift,
                bytes: bytes.len() as u16,
                trail: !trail.is_empty(),
            };
            // There is room for all of it.
            let _ = part.tiles.push(head);
            let _ = part.cells.extend_from_slice(&bytes);
            let _ = part.cells.extend_from_slice(&trail);
        }
        part
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(x: i16, change: usize) -> CorrectedTile {
        let mut classes = Classes::default();
        for k in (0..1024).filter(|k| change > 0 && (k / change).is_multiple_of(2)) {
            classes[k / 97 % 2][k / 32] |= 1 << (k % 32);
        }
        CorrectedTile {
            key: (x, -x),
            shift: (1, -1),
            classes,
            trail: [0; 16],
        }
    }

    #[test]
    fn parts_hold_all_tiles_once_those_that_are_forgotten_first() {
        let changes = [700, 0, 1, 2, 0, 3, 40, 100, 5, 900, 1, 600, 600, 600, 600];
        let tiles: Vec<_> = (0..)
            .zip(changes)
            .map(|(x, change)| tile(x, change))
            .collect();
        let count = tiles.len() as u16;
        let correction = MapCorrection {
            epoch: 3,
            tiles,
            ..MapCorrection::default()
        };
        let (mut next, mut sent) = (0, Vec::new());
        loop {
            let part = correction.part(next);
            let bytes: usize = part.tiles.iter().map(|tile| usize::from(tile.bytes)).sum();
            assert_eq!(bytes, part.cells.len());
            assert_eq!((part.epoch, part.first), (3, next));
            assert!(!part.tiles.is_empty());
            sent.extend(part.tiles.iter().map(|tile| tile.x));
            next += part.tiles.len() as u16;
            assert_eq!(part.last, next == count);
            if part.last {
                break;
            }
        }
        assert_eq!(sent[..3], [1, 4, 0]);
        sent.sort_unstable();
        assert!(sent.into_iter().eq(0..count as i16));
    }

    #[test]
    fn a_correction_of_the_pose_alone_has_one_part() {
        let part = MapCorrection::default().part(0);
        assert!(part.last && part.tiles.is_empty());
    }
}
