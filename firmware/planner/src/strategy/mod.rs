//! The strategies: what is a boundary of the window at what potential, and what counts as finished.

pub mod frontier;
mod nearest;
pub mod ouroboros;
mod patience;
pub mod road;

pub use frontier::Frontier;
pub use ouroboros::Ouroboros;
pub use road::Road;
