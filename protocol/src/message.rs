//! The messages: plain data, postcard-encoded, physical quantities in `fixed` types.
//!
//! Units: metres, radians, seconds, milliseconds where the name says `_ms`, millimetres where it says `_mm`.
//! Frames: x forward (or east), y left (or north), z up, angles counter-clockwise.
//!
//! | message | from | answered by |
//! | --- | --- | --- |
//! | [`Request::Hello`] | host | [`Reply::Hello`] or [`Reply::Incompatible`] |
//! | [`Request::Control`] | host | [`Reply::Control`] or [`Reply::Refused`] |
//! | [`Request::Observation`] | host | [`Reply::Command`] or [`Reply::Refused`] |
//! | [`Request::Tile`] | host | [`Reply::Tile`] or [`Reply::Refused`] |
//! | [`Request::FieldRow`] | host | [`Reply::FieldRow`] or [`Reply::Refused`] |
//! | [`Request::Frontiers`] | host | [`Reply::Frontiers`] or [`Reply::Refused`] |
//! | [`Request::Road`] | host | [`Reply::Road`] or [`Reply::Refused`] |
//!
//! The device says two things unasked: [`Reply::Hello`] after it booted, and [`Reply::Crash`] before it reboots.
//!
//! Every quantity of 32 bits is an `I16F16` and every one of 16 bits an `I4F12`; the exact-byte tests hold that.

mod command;
mod frontier;
mod identity;
mod observation;
mod page;
mod refusal;
mod session;

pub use command::{Command, Cost, Counters, Fault, Finish, Loops, Stages, Status};
pub use frontier::{Frontier, MAX_FRONTIERS, Residue};
pub use identity::{BUILD_BYTES, CRASH_FILE_BYTES, Cause, Crash, Identity};
pub use observation::{
    INVALID_MM, MAX_BEAMS, MAX_SCANS, NO_RETURN_MM, Observation, Pose, Scan, Twist,
};
pub use page::{
    FIELD_CELL_BYTES, FIELD_SIDE, FieldRow, ROAD_PAGE, Road, TILE_BYTES, TILE_DATES,
    TILE_SKELETON_BYTES, Tile,
};
pub use refusal::{Parameter, Refusal};
pub use session::{Control, Laser, Preference, Start, Strategy, Terrain};

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// From the host.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Request {
    /// Who are you? Its number and first two fields never change, so that any two versions can refuse each other.
    Hello {
        /// Protocol version.
        version: u16,
        /// Hash of the message schema.
        schema: u32,
        /// The host's own choice: a new one makes the device forget the sequence numbers that it answered.
        nonce: u32,
    },
    /// Change the session's state.
    Control(Control),
    /// What was sensed; asks for a command.
    Observation(Observation),
    /// Read one map tile, by tile coordinates (cell / 32, rounded down).
    Tile {
        /// Tile column.
        x: i16,
        /// Tile row.
        y: i16,
    },
    /// Read one row of the last window's field.
    FieldRow {
        /// Row, 0 is the least y.
        row: u8,
    },
    /// Read the residual frontiers.
    Frontiers,
    /// Read where the planner is going: the road from one of its cells on.
    Road {
        /// Cells of the road to leave out.
        from: u8,
    },
}

/// From the device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Reply {
    /// Who it is. Its number and first two fields (version, schema) never change.
    Hello(Identity),
    /// It speaks another protocol and will not talk. Its number and first two fields never change.
    Incompatible {
        /// The device's protocol version.
        version: u16,
        /// Hash of the device's message schema.
        schema: u32,
    },
    /// The session changed state.
    Control(Status),
    /// What to drive.
    Command(Command),
    /// A map tile; `None` where nothing was ever seen.
    Tile(Option<Tile>),
    /// A row of the field; `None` before the first window.
    FieldRow(Option<FieldRow>),
    /// Residual frontiers.
    Frontiers(Vec<Frontier, MAX_FRONTIERS>),
    /// The request was refused.
    Refused(Refusal),
    /// The program crashed; it stands still and reboots.
    Crash(Crash),
    /// Where the planner is going.
    Road(Road),
}
