//! What the robots of a team say to each other.
//!
//! A packet is for all who hear it. It may be lost, doubled, late, or out of order.
//!
//! Units: centimetres in names with `_cm`; map cells; tiles of 32 × 32 cells. All coordinates are
//! the team's.

use heapless::Vec;

use crate::config::Member;
use crate::geometry::{Cell, MapFromOdom, MapPose, OdomPose, Point, Pose, Twist};
use crate::math;

/// Greatest number of places on the road ahead that a beacon tells.
pub const ROAD_POINTS: usize = 4;
/// Unit of their offsets, metres.
const ROAD_UNIT_M: f32 = 0.4;
/// Greatest number of tiles in a digest.
pub const DIGEST_TILES: usize = 24;
/// Greatest number of tiles in a request.
pub const WANTED_TILES: usize = 16;

/// What a robot of a team does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Activity {
    /// It drives.
    #[default]
    Exploring,
    /// It makes way for another robot, or has made way and waits.
    Yielding,
    /// It should make way and cannot.
    Cornered,
    /// It stands by order.
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

impl Activity {
    /// Returns true if the robot moves, or will move by itself.
    pub(crate) const fn moves(self) -> bool {
        matches!(
            self,
            Self::Exploring | Self::Holding | Self::Yielding | Self::Cornered
        )
    }
}

/// Where a robot is and what it is about to do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beacon {
    /// A number that is equal for equal maps: their hash.
    pub map: u32,
    /// Position, centimetres.
    pub position_cm: (i16, i16),
    /// Radians.
    pub yaw_rad: f32,
    /// Standard deviation of the position, centimetres.
    pub sd_cm: u8,
    /// Velocity.
    pub velocity: Twist,
    /// Half of the hull's length and width, centimetres, rounded up.
    pub half_cm: (u8, u8),
    /// What the robot does.
    pub activity: Activity,
    /// The map cell that the robot drives to.
    pub goal: Option<(i16, i16)>,
    /// Places on the road ahead: offsets from the position in units of 0.4 m.
    pub road: Vec<(i8, i8), ROAD_POINTS>,
}

/// Rounds to the nearest integer.
fn rounded(value: f32) -> i32 {
    math::floor(value + 0.5)
}

/// Clamps to the range of a wire's coordinate.
fn short(value: i32) -> i16 {
    value.clamp(i16::MIN.into(), i16::MAX.into()) as i16
}

/// Rounds a half side up to whole centimetres.
pub(crate) fn half_cm(half_m: f32) -> u8 {
    (-math::floor(-half_m * 100.0)).clamp(0, u8::MAX.into()) as u8
}

impl Beacon {
    /// Sets the pose.
    #[must_use]
    pub(crate) fn at(self, pose: &Pose) -> Self {
        let cm = |metres: f32| short(rounded(metres * 100.0));
        Self {
            position_cm: (cm(pose.x_m), cm(pose.y_m)),
            yaw_rad: math::wrap(pose.yaw_rad),
            ..self
        }
    }

    /// Sets the goal.
    #[must_use]
    pub(crate) fn bound_for(self, goal: Option<Cell>) -> Self {
        Self {
            goal: goal.map(|cell| (short(cell.x), short(cell.y))),
            ..self
        }
    }

    /// Returns the beacon in other coordinates. `sd_m` is what the motion adds to the standard
    /// deviation of the place.
    #[must_use]
    pub(crate) fn moved(&self, by: &MapFromOdom, sd_m: f32) -> Self {
        let road: Vec<Point, ROAD_POINTS> = self.road().map(|place| by.point(place)).collect();
        let goal = self.goal_cell().map(|cell| by.point(cell.centre()).cell());
        let MapPose(pose) = by.apply(&OdomPose(self.pose()));
        self.clone()
            .at(&pose)
            .within(sd_m)
            .bound_for(goal)
            .along(road.into_iter())
    }

    /// Adds to the standard deviation of the place, metres.
    #[must_use]
    pub(crate) fn within(self, sd_m: f32) -> Self {
        let (said, more) = (f32::from(self.sd_cm), 100.0 * sd_m);
        let sd_cm = rounded(math::sqrt(said * said + more * more));
        Self {
            sd_cm: sd_cm.clamp(0, u8::MAX.into()) as u8,
            ..self
        }
    }

    /// Sets the road ahead: as many of these places as there is room for. Call [`Self::at`] before.
    #[must_use]
    pub(crate) fn along(mut self, places: impl Iterator<Item = Point>) -> Self {
        let from = self.point();
        let offset = |to: f32, from: f32| {
            let units = rounded((to - from) / ROAD_UNIT_M);
            units.clamp(i8::MIN.into(), i8::MAX.into()) as i8
        };
        self.road = places
            .take(ROAD_POINTS)
            .map(|place| (offset(place.x_m, from.x_m), offset(place.y_m, from.y_m)))
            .collect();
        self
    }

    /// Returns the position.
    #[must_use]
    pub fn point(&self) -> Point {
        let (x, y) = self.position_cm;
        Point {
            x_m: f32::from(x) * 0.01,
            y_m: f32::from(y) * 0.01,
        }
    }

    /// Returns the pose in the plane.
    #[must_use]
    pub fn pose(&self) -> Pose {
        let Point { x_m, y_m } = self.point();
        Pose {
            x_m,
            y_m,
            yaw_rad: self.yaw_rad,
            ..Pose::default()
        }
    }

    /// Returns the places on the road ahead.
    pub fn road(&self) -> impl Iterator<Item = Point> + '_ {
        let from = self.point();
        self.road.iter().map(move |&(dx, dy)| Point {
            x_m: from.x_m + f32::from(dx) * ROAD_UNIT_M,
            y_m: from.y_m + f32::from(dy) * ROAD_UNIT_M,
        })
    }

    /// Returns the cell that the robot drives to.
    #[must_use]
    pub fn goal_cell(&self) -> Option<Cell> {
        self.goal.map(|(x, y)| Cell {
            x: x.into(),
            y: y.into(),
        })
    }
}

/// A tile's column and row, and its version.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileVersion {
    /// Column and row of the tile.
    pub tile: (i8, i8),
    /// The tile's epoch.
    pub epoch: u16,
    /// Hash of the digest's salt and the cells.
    pub hash: u16,
}

/// The versions of some tiles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Digest {
    /// The hashes begin with this number.
    pub salt: u8,
    /// The tiles.
    pub tiles: Vec<TileVersion, DIGEST_TILES>,
}

/// A request for tiles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The number of the robot that is asked.
    pub of: u8,
    /// Column and row of each tile.
    pub tiles: Vec<(i8, i8), WANTED_TILES>,
}

/// The cells of a tile.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TeamTile {
    /// Column and row of the tile.
    pub tile: (i8, i8),
    /// The tile's epoch.
    pub epoch: u16,
    /// The low and the high plane of the classes: a word per row, bit k is column k.
    pub planes: [[u32; 32]; 2],
}

/// The body of a packet.
#[derive(Clone, Debug, PartialEq)]
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
///
/// ```
/// use fieldline_planner::{
///     Activity, Beacon, Body, DIGEST_TILES, Digest, Packet, ROAD_POINTS, TeamTile, TileVersion,
///     WANTED_TILES, Wanted,
/// };
///
/// /// Returns a line for a log.
/// fn line(packet: &Packet) -> String {
///     let what = match &packet.body {
///         Body::Beacon(Beacon { activity: Activity::Finished, .. }) => "is ready".into(),
///         Body::Beacon(beacon) => format!("is at {:?}", beacon.point()),
///         Body::Digest(Digest { tiles, .. }) => {
///             let newest = tiles.iter().max_by_key(|version: &&TileVersion| version.epoch);
///             format!("has {} tiles, newest {newest:?}", tiles.len())
///         }
///         Body::Wanted(Wanted { of, tiles }) => format!("asks {of} for {tiles:?}"),
///         Body::Tile(TeamTile { tile, .. }) => format!("says tile {tile:?}"),
///     };
///     format!("robot {} {what}", packet.from.id)
/// }
/// assert_eq!((ROAD_POINTS, DIGEST_TILES, WANTED_TILES), (4, 24, 16));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Packet {
    /// The robot that says it.
    pub from: Member,
    /// Number of the packet since the robot's boot; wraps.
    pub sequence: u16,
    /// What it says.
    pub body: Body,
}

impl Packet {
    /// Returns true if all its numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let Body::Beacon(Beacon {
            yaw_rad, velocity, ..
        }) = &self.body
        else {
            return true;
        };
        let numbers = [*yaw_rad, velocity.linear_mps, velocity.angular_radps];
        numbers.iter().all(|number| number.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{Beacon, half_cm};
    use crate::geometry::{Point, Pose};

    #[test]
    fn a_beacon_tells_the_place_within_half_a_centimetre() {
        let pose = Pose {
            x_m: -12.344,
            y_m: 3.006,
            yaw_rad: 4.0,
            ..Pose::default()
        };
        let beacon = Beacon::default().at(&pose);
        assert_eq!(beacon.position_cm, (-1234, 301));
        assert!((beacon.pose().yaw_rad - (4.0 - core::f32::consts::TAU)).abs() < 1e-5);
        let road = [(0.4, 0.1), (0.9, -0.3)].map(|(x_m, y_m)| Point {
            x_m: pose.x_m + x_m,
            y_m: pose.y_m + y_m,
        });
        let beacon = beacon.along(road.into_iter());
        let told: Vec<(i8, i8)> = beacon.road.iter().copied().collect();
        assert_eq!(told, [(1, 0), (2, -1)]);
        assert!(
            beacon
                .road()
                .all(|place| place.distance_m(pose.point()) < 1.0)
        );
    }

    #[test]
    fn half_sides_are_rounded_up() {
        assert_eq!([0.254, 0.25, 0.2485, 9.0].map(half_cm), [26, 25, 25, 255]);
    }
}
