//! Recorded logs through the device's localisation and mapping, without driving.
//!
//! ```text
//! carmen ─► wire (start, observations) ─► link ─► run (poses, tiles) ─► report, files
//!              ▲                                       │
//!           drift (--degrade)          relations ──────┘
//! ```
//!
//! | file | holds |
//! | --- | --- |
//! | [`carmen`] | the log: scans, odometry |
//! | [`sweep`] | the sweep of a laser whose lines do not tell it |
//! | [`drift`] | drifting odometry from corrected poses |
//! | [`wire`] | the log as a session's start and its observations |
//! | [`run`] | the session over a link |
//! | [`relations`] | errors against known relations between poses |
//! | [`clock`] | the offset between the clocks of relations and log |
//! | [`report`] | the figures of a replay, and its files |
//!
//! The map's frame is the first pose of the log. Units: metres, radians, seconds.

pub mod carmen;
pub mod clock;
pub mod drift;
pub mod relations;
pub mod report;
pub mod run;
pub mod sweep;
pub mod wire;
