//! Whole sessions with a device: generated, judged, shrunken, and replayed from files.
//!
//! | module | content |
//! | --- | --- |
//! | [`ask`] | a request of a session, and its answer |
//! | [`script`] | the file of a session: JSON lines |
//! | [`choices`] | where generators take their numbers from: a seed, or a fuzzer's bytes |
//! | [`generate`] | generators, from absurd to plausible |
//! | [`judge`] | what no session may cause |
//! | [`target`] | the devices under test |
//! | [`play`] | a conversation of a host and a device, judged |
//! | [`shrink`] | the fewest and simplest requests that cause a finding |
//! | [`campaign`] | many sessions, and their totals |
//!
//! Invariant: a session is its requests. A generator may look at answers, as a simulated robot
//! does, but the recorded requests replay without it.

pub mod ask;
pub mod campaign;
pub mod choices;
mod compact;
pub mod generate;
pub mod judge;
pub mod play;
pub mod script;
pub mod shrink;
pub mod target;
pub mod totals;
