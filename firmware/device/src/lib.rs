//! The device's side of the conversation: bytes in, bytes out.
#![no_std]
#![forbid(unsafe_code)]
