//! The messages: plain data, encoded by postcard, with physical quantities in `fixed` types.
//!
//! Units: metres, radians, seconds; milliseconds in names with `_ms`, millimetres in names with
//! `_mm`. Axes: x points forward (or east), y left (or north), z up. Angles grow counter-clockwise.
//!
//! | message | from | answered by |
//! | --- | --- | --- |
//! | [`Request::Hello`] | host | [`Reply::Hello`] or [`Reply::Incompatible`] |
//! | [`Request::Control`] | host | [`Reply::Control`] or [`Reply::Refused`] |
//! | [`Request::Observation`] | host | [`Reply::Command`] or [`Reply::Refused`] |
//! | [`Request::Tile`] | host | [`Reply::Tile`] or [`Reply::Refused`] |
//! | [`Request::FieldRow`] | host | [`Reply::FieldRow`] or [`Reply::Refused`] |
//! | [`Request::Frontiers`] | host | [`Reply::Frontiers`] or [`Reply::Refused`] |
//! | [`Request::Path`] | host | [`Reply::Path`] or [`Reply::Refused`] |
//! | [`Request::Hear`] | host | [`Reply::Heard`] or [`Reply::Refused`] |
//! | [`Request::Say`] | host | [`Reply::Say`] or [`Reply::Refused`] |
//! | [`Request::Correct`] | host | [`Reply::Corrected`] or [`Reply::Refused`] |
//! | [`Request::Tiles`] | host | [`Reply::Corrected`] or [`Reply::Refused`] |
//! | [`Request::Recall`] | host | [`Reply::Corrected`] or [`Reply::Refused`] |
//!
//! The device sends two messages without a request: [`Reply::Hello`] after it booted, and
//! [`Reply::Crash`] before it reboots.
//!
//! Every quantity of 32 bits is an `I16F16` and every quantity of 16 bits an `I4F12`. The
//! exact-byte tests check this.

mod command;
mod correction;
mod doing;
mod identity;
mod location;
mod observation;
mod readout;
mod refusal;
mod residual;
mod session;
mod team;

pub use command::{
    Command, Cost, Counters, Errand, Fault, Finish, InputFaults, Loops, Mistake, Stages, Status,
};
pub use correction::{
    CORRECTED_BYTES, CORRECTED_TILES, Correct, CorrectedTile, CorrectedTiles, CorrectionProgress,
    MOST_CORRECTED, Motion, RECALLED_POINTS, RECALLED_TRACK, Recall, RecalledPoint, TRAIL_BYTES,
};
pub use doing::{Doing, Event, Events};
pub use identity::{BUILD_BYTES, CRASH_FILE_BYTES, Cause, Crash, Identity};
pub use location::{Location, Quality};
pub use observation::{
    INVALID_MM, MAX_BEAMS, MAX_SCANS, NO_RETURN_MM, Observation, Pose, Scan, Twist,
};
pub use readout::{
    FIELD_CELL_BYTES, FIELD_SIDE, FieldRow, PATH_PAGE, Path, TILE_BYTES, TILE_SKELETON_BYTES,
    TILE_STAMPS, Tile,
};
pub use refusal::{Parameter, Refusal};
pub use residual::{MAX_FRONTIERS, ResidualFrontier, ResidualReason};
pub use session::{
    Budget, Control, FENCE_CORNERS, FENCE_POLYGONS, Fence, FencePolygon, Hull, Laser, LoopLimits,
    Order, Preference, SpaceField, Start, Strategy, UnevenGround,
};
pub use team::{
    Activity, Beacon, Body, DIGEST_TILES, Digest, Member, Packet, ROAD_POINTS, ROAD_UNIT_CM, Team,
    TeamTile, TileVersion, WANTED_TILES, Wanted,
};

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A message from the host.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Request {
    /// Asks the device who it is.
    ///
    /// The number of this message and its first two fields never change, so that any two versions
    /// can refuse each other.
    Hello {
        /// Protocol version.
        version: u16,
        /// Hash of the message schema.
        schema: u32,
        /// A number that the host chooses. A new one makes the device forget which sequence numbers
        /// it answered.
        nonce: u32,
    },
    /// Changes the state of the session.
    Control(Control),
    /// Reports what the robot sensed, and asks for a command.
    Observation(Observation),
    /// Reads one map tile by its tile coordinates (cell / 32, rounded down).
    Tile {
        /// Tile column.
        x: i16,
        /// Tile row.
        y: i16,
    },
    /// Reads one row of the field in the last window.
    FieldRow {
        /// Row; 0 has the least y.
        row: u8,
    },
    /// Reads the residual frontiers.
    Frontiers,
    /// Reads the planner's path, tractor point and shield.
    Path {
        /// Number of path cells to leave out, from the robot's end.
        from: u8,
    },
    /// Passes on a packet that another robot of the team said.
    Hear(Packet),
    /// Asks for the next packet to pass on to the team. The host asks after each observation until
    /// there is none.
    Say,
    /// Opens a correction of the map.
    Correct(Correct),
    /// Brings tiles of the open correction.
    Tiles(CorrectedTiles),
    /// Tells a device that was reset what lies around its robot.
    Recall(Recall),
}

/// A message from the device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Reply {
    /// Who the device is. The number of this message and its first two fields (version and schema)
    /// never change.
    Hello(Identity),
    /// The host has another version or schema, so the device refuses all its requests. The number
    /// of this message and its first two fields never change.
    Incompatible {
        /// The device's protocol version.
        version: u16,
        /// Hash of the device's message schema.
        schema: u32,
    },
    /// The session has a new state.
    Control(Status),
    /// The command for the robot: its velocity, with status and cost.
    Command(Command),
    /// A map tile; `None` if nothing in it was ever seen.
    Tile(Option<Tile>),
    /// A row of the field; `None` before the first window.
    FieldRow(Option<FieldRow>),
    /// The residual frontiers.
    Frontiers(Vec<ResidualFrontier, MAX_FRONTIERS>),
    /// The device refused the request.
    Refused(Refusal),
    /// The program crashed. The device stands still and reboots.
    Crash(Crash),
    /// The planner's path, tractor point and shield.
    Path(Path),
    /// The device heard the packet.
    Heard,
    /// The next packet for the team; `None` until the next step.
    Say(Option<Packet>),
    /// How far the device is with a correction of the map.
    Corrected(CorrectionProgress),
}
