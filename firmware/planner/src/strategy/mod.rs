//! The strategies: what is a boundary of the window at what potential, and what counts as finished.

pub mod frontier;
pub mod lookout;
mod nearest;
mod patience;
pub mod road;

pub use frontier::Frontier;
pub use road::Road;
