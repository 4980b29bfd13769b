#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing
    )
)]

#[cfg(test)]
extern crate std;

pub mod convert;
mod log;
pub mod memory;
pub mod meter;
pub mod pilot;
pub mod port;
pub mod ring;
pub mod session;
pub mod signal;

pub use memory::Memory;
pub use meter::{Mark, Meter};
pub use pilot::Pilot;
pub use session::{Boot, Session};

/// Silence of the host after which the device's last command is stale, milliseconds.
///
/// At 5 Hz two observations are then missing, and the robot has driven 35 cm at its full 0.7 m/s.
pub const STALE_MS: u16 = 500;
/// Number of pages in the map's pool of the default image. With fewer pages than tiles, those far
/// from the robot are coded, which loses nothing.
pub const TILES: usize = 172;
/// Number of tiles that the map of the default image may have: 3,768 m² with what nobody sees of
/// them. Pool and tiles together fill the chip's memory.
pub const SLOTS: usize = 368;
/// The planner's state in the default image.
pub type State = fieldline_planner::State<TILES, SLOTS>;
