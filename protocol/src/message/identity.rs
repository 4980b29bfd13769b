//! Who the device is, and what its last crash was.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::Counters;

/// Maximum length of a build identifier, bytes.
pub const BUILD_BYTES: usize = 24;
/// Maximum length of a source file's name in a crash report, bytes.
pub const CRASH_FILE_BYTES: usize = 32;

/// Cause of a crash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Cause {
    /// A panic; [`Crash::at`] is the source line.
    #[default]
    Panic,
    /// A processor fault; [`Crash::at`] is the program counter.
    Fault,
    /// The stack overflowed; [`Crash::at`] is 0.
    StackOverflow,
    /// The main loop took too long; [`Crash::at`] is 0.
    Watchdog,
}

/// A crash: the program stopped, sends no further command, and reboots.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Crash {
    /// Cause of the crash.
    pub cause: Cause,
    /// Source line or program counter.
    pub at: u32,
    /// End of the source file's path; empty for all causes other than a panic.
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
    /// Number of boots since power-on.
    pub boots: u32,
    /// Maximum number of tiles that the map can have.
    pub tile_slots: u16,
    /// Number of tiles in the map's pool. A tile that is all free or has no obstacle needs little
    /// or no place in it.
    pub tile_pool: u16,
    /// Length of the longest frame that the device accepts, bytes.
    pub max_frame: u16,
    /// Silence of the host after which the device's command is stale, milliseconds.
    pub stale_ms: u16,
    /// The crash that caused the last reboot.
    pub crash: Option<Crash>,
    /// Counters since the boot.
    pub counters: Counters,
}
