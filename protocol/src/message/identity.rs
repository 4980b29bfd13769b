//! Who the device is, and what became of it before.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::Counters;

/// Bytes of a build identifier.
pub const BUILD_BYTES: usize = 24;
/// Bytes of a source file's name in a crash report.
pub const CRASH_FILE_BYTES: usize = 32;

/// What ended the program before the last reboot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Cause {
    /// A panic; [`Crash::at`] is the line.
    #[default]
    Panic,
    /// A processor fault; [`Crash::at`] is the program counter.
    Fault,
    /// The stack ran out of its room; [`Crash::at`] is 0.
    StackOverflow,
    /// The main loop did not come round in time; [`Crash::at`] is 0.
    Watchdog,
}

/// A crash: the program stopped, commands zero velocity and reboots.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Crash {
    /// What happened.
    pub cause: Cause,
    /// Source line or program counter.
    pub at: u32,
    /// The last letters of the source file's path; empty for a fault.
    pub file: heapless::String<CRASH_FILE_BYTES>,
}

/// Who the device is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Identity {
    /// Protocol version.
    pub version: u16,
    /// Hash of the message schema.
    pub schema: u32,
    /// Build identifier.
    pub build: heapless::String<BUILD_BYTES>,
    /// Boots since power-on.
    pub boots: u32,
    /// Slots of the map's box, in tiles.
    pub tile_slots: u16,
    /// Tiles in the map's pool.
    pub tile_pool: u16,
    /// Largest frame accepted, bytes.
    pub max_frame: u16,
    /// Silence after which the device considers its command stale, milliseconds.
    pub stale_ms: u16,
    /// The crash that caused the last reboot.
    pub crash: Option<Crash>,
    /// Counters since the boot.
    pub counters: Counters,
}
