//! Baselines that run on the host only, for comparison with the planner: [`bvp`] and [`greedy`].
//!
//! A baseline is a [`crate::link::Link`] without bytes ([`Session`]) over a strategy ([`Plan`]).

pub mod bvp;
pub mod chart;
pub mod greedy;
pub mod heights;
pub mod session;

pub use bvp::Bvp;
pub use greedy::GreedyFrontier;
pub use session::{Plan, Session};
