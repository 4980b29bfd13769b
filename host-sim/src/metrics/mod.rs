//! What a run is judged by, on the true world.

mod localization;
mod safety;

pub use localization::Localization;
pub use safety::Safety;
