//! The device's side of a Fieldline conversation, without a board: bytes in, bytes out.
//!
//! ```text
//!  serial ──► port ──► session ──► pilot ──► planner::step
//!         ◄──      ◄──         ◄──
//! ```
//!
//! | module | contents |
//! | --- | --- |
//! | [`port`] | serial line, emergency stop and LED through `embedded-io` and `embedded-hal` |
//! | [`session`] | the conversation: hello, duplicates, silence, logs |
//! | [`pilot`] | the state of a session: started, paused, stopped; used directly, it is a link without bytes |
//! | [`limits`] | limits of a session's parameters |
//! | [`convert`] | conversions between the wire's quantities and the planner's |
//! | [`meter`] | the cost of a step |
//! | [`signal`] | patterns of the status LED |
//! | [`ring`] | bytes from an interrupt to the main loop |
//!
//! The caller lends the large memory ([`Memory`]) to every call, so that a board can place it.
//!
//! A session takes bytes from any line and gives bytes back:
//!
//! ```
//! use fieldline_device::meter::NoMeter;
//! use fieldline_device::{Boot, Memory, Session};
//! use fieldline_planner::{State, Workspace};
//! use fieldline_protocol::frame::{
//!     MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, encode_request,
//! };
//! use fieldline_protocol::message::{Reply, Request};
//! use fieldline_protocol::{SCHEMA, VERSION};
//!
//! // A small map: 4 tiles of memory in a box of at most 64 tiles.
//! let mut state = Box::new(State::<4, 64>::new());
//! let mut workspace = Box::new(Workspace::new());
//! let mut memory = Memory { state: &mut state, workspace: &mut workspace };
//! let mut session = Session::new();
//! session.boot(Boot::default(), 4, 64);
//!
//! // The host sends a hello with sequence number 1.
//! let hello = Request::Hello { version: VERSION, schema: SCHEMA, nonce: 42 };
//! let mut bytes = [0; MAX_REQUEST_FRAME];
//! let length = encode_request(1, &hello, &mut bytes)?;
//! for byte in &bytes[..length] {
//!     session.receive(*byte, &mut memory, &mut NoMeter);
//! }
//!
//! // The device sends two hellos: one after its boot, and the answer.
//! let mut host = Receiver::<MAX_REPLY_FRAME>::new(Side::Host);
//! let mut heard = vec![];
//! while let [byte, ..] = *session.pending() {
//!     if let Some(frame) = host.push(byte) {
//!         assert!(matches!(frame.reply()?, Reply::Hello(_)));
//!         heard.push(frame.sequence);
//!     }
//!     session.sent(1);
//! }
//! assert_eq!(heard, [0, 1]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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

/// Silence of the host after which the device's last command is stale, milliseconds.
///
/// At 5 Hz two observations are then missing, and the robot has driven 35 cm at its full 0.7 m/s.
pub const STALE_MS: u16 = 500;
/// Number of tiles in the map's pool of the default image: 1556 m². With more tiles, the stack
/// would not fit into the chip's memory.
pub const TILES: usize = 152;
/// Number of tile slots in the map's box of the default image: 20 × 20 tiles are 64 × 64 m.
pub const SLOTS: usize = 400;
/// The planner's state in the default image.
pub type State = fieldline_planner::State<TILES, SLOTS>;
