//! Baselines to compare the planner with: [`bvp`], [`bvp_papers`] and [`greedy`]. They run on the
//! host only.
//!
//! A baseline is a [`Session`] over a [`Strategy`]. The session is a [`crate::link::Link`] without
//! bytes.

pub mod bvp;
pub mod bvp_papers;
pub mod chart;
pub mod greedy;
pub mod heights;
pub mod session;
mod slope;
pub mod strategy;

pub use bvp::Bvp;
pub use bvp_papers::BvpPapers;
pub use greedy::GreedyFrontier;
pub use session::Session;
pub use strategy::Strategy;
