//! Whole sessions of hostile hosts: no panic, no fast or unasked motion, no number that is not
//! finite, and the device still answers.
//!
//! `protocol/tests/hostile.rs` attacks the bytes. Here every frame is well-formed and its content
//! is absurd or spoilt. Without `--release`, overflow checks and debug assertions are on. `chip`
//! bounds instructions and stack of such sessions.

mod clock;
mod corpus;
mod fast;
mod full;
mod history;
mod short;
