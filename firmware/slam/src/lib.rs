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
#![allow(
    unreachable_pub,
    rustdoc::private_intra_doc_links,
    reason = "files are private, and their public items are those of the crate"
)]

#[cfg(test)]
extern crate std;

// From low to high.
mod alignment;
mod closing;
mod correlation;
mod graph;
mod grid;
pub mod matrix;
mod motion;
mod pose;
mod scan;
mod slam;
mod solver;
mod workspace;

pub use motion::Motion;
pub use pose::Pose;
pub use scan::{LASERS, Laser};
pub use slam::{Config, Counts, Observed, Rules, Slam};
pub use workspace::Workspace;
