//! What a run is judged by, on the true world.

mod coverage;
mod localization;
mod loops;
mod overlap;
mod reach;
mod safety;

pub use coverage::{Coverage, DIRECTIONS, MAP_CELL_M, Truth, map_cells, truth};
pub use localization::Localization;
pub use loops::{LEAST_M, Loops};
pub use overlap::{EARLIER_M, NEAR_M, Overlap};
pub use reach::{CellSet, START_SLACK_M};
pub use safety::Safety;
