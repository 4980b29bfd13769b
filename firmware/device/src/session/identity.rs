//! Identity of the device, for its hello.

use fieldline_protocol::frame::MAX_REQUEST_FRAME;
use fieldline_protocol::message::{BUILD_BYTES, Counters, Crash, Identity};
use fieldline_protocol::{SCHEMA, VERSION};

use crate::STALE_MS;

/// A board's knowledge of its last boot.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Boot {
    /// Number of boots since power-on.
    pub boots: u32,
    /// The crash that caused this boot.
    pub crash: Option<Crash>,
}

/// Counters that are all zero.
pub(super) const ZERO_COUNTERS: Counters = Counters {
    received: 0,
    crc_errors: 0,
    dropped: 0,
    duplicates: 0,
    stale_stops: 0,
};

/// Identity of a device that has not booted.
pub(super) const NOT_BOOTED: Identity = Identity {
    version: VERSION,
    schema: SCHEMA,
    build: heapless::String::new(),
    boots: 0,
    tile_slots: 0,
    tile_pool: 0,
    max_frame: 0,
    stale_ms: STALE_MS,
    crash: None,
    counters: ZERO_COUNTERS,
};

/// Returns the identity of a device after `boot`, with `tile_pool` tiles and `tile_slots` tile
/// slots.
#[must_use]
pub fn identity(boot: Boot, tile_pool: usize, tile_slots: usize) -> Identity {
    let short = |count: usize| u16::try_from(count).unwrap_or(u16::MAX);
    Identity {
        build: build(),
        boots: boot.boots,
        tile_slots: short(tile_slots),
        tile_pool: short(tile_pool),
        max_frame: short(MAX_REQUEST_FRAME),
        crash: boot.crash,
        ..NOT_BOOTED
    }
}

/// Returns the name of the build: `FIELDLINE_BUILD` at compile time, or else the version.
fn build() -> heapless::String<BUILD_BYTES> {
    let name = option_env!("FIELDLINE_BUILD").unwrap_or(env!("CARGO_PKG_VERSION"));
    let mut build = heapless::String::new();
    for letter in name.chars() {
        if build.push(letter).is_err() {
            break;
        }
    }
    build
}
