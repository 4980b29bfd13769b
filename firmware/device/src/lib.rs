//! The device's side of the conversation, without a board: bytes in, bytes out.
//!
//! ```text
//!  serial ──► port ──► session ──► pilot ──► planner::step
//!         ◄──      ◄──         ◄──
//! ```
//!
//! | room | what it knows |
//! | --- | --- |
//! | [`convert`] | wire quantities and the planner's, both ways |
//! | [`limits`] | which parameters a session may have |
//! | [`pilot`] | the session's state: started, paused, stopped; used directly it is a link without bytes |
//! | [`session`] | the conversation: hello, duplicates, silence, logs |
//! | [`signal`] | what the status LED shows |
//! | [`ring`] | bytes from an interrupt to the main loop |
//! | [`port`] | serial line, e-stop and LED through `embedded-io` and `embedded-hal` |
//!
//! The big memories ([`Memory`]) are lent to every call, so that a board can put them where it has room.
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
pub mod limits;
mod log;
pub mod meter;
mod overlay;
pub mod pilot;
pub mod port;
pub mod ring;
pub mod session;
pub mod signal;

pub use meter::Meter;
pub use pilot::{Memory, Pilot};
pub use session::{Boot, Session};

/// Silence of the host after which the device's last command is stale, milliseconds: three observations at 5 Hz missed, and the
/// robot has gone 35 cm at full speed.
pub const STALE_MS: u16 = 500;
/// Tiles in the map's pool of the default image: 1556 m² of touched tiles. With more, the stack would not fit the chip beside it.
pub const TILES: usize = 152;
/// Places for tiles in the map's box of the default image: 20 × 20 tiles are 64 × 64 m.
pub const SLOTS: usize = 400;
/// The planner's memory of the default image.
pub type State = fieldline_planner::State<TILES, SLOTS>;
