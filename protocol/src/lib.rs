//! What is said between a Fieldline planner and its robot, and nothing else.
//!
//! | room | what |
//! | --- | --- |
//! | [`message`] | the messages, plain data |
//! | [`schema`] | the hash that tells whether two ends mean the same by them |
//! | [`check`] | the frame's checksum, and the keys that make kinds of frames exclude each other |
//! | [`cobs`] | byte stuffing: a frame without zeros between two zeros |
//! | [`frame`] | all of it together: messages to bytes and back |
//!
//! Nothing here can panic on what a peer sends, and no byte sequence can wedge a [`frame::Receiver`]: after any garbage, a
//! delimiter and a good frame are decoded. The prose specification is in `README.md`.
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

pub mod check;
pub mod cobs;
mod explain;
pub mod frame;
pub mod message;
pub mod schema;

pub use schema::{SCHEMA, VERSION};

/// Bits a second on a serial line. A full observation of two scans takes 17 ms; USART1 divides to it within 0.2 % from
/// 84 MHz and within 0.8 % from the 16 MHz fallback, which 921 600 would miss by 2 %.
pub const BAUD: u32 = 460_800;
