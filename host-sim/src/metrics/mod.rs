//! What a run is judged by, on the true world.

mod coverage;
mod crossings;
mod footing;
mod frame;
mod gentle;
mod ground_truth;
mod localization;
mod loops;
mod overlap;
pub mod patrol;
mod reach;
mod ride;
mod safety;

pub use coverage::{Coverage, DIRECTIONS, MAP_CELL_M, Truth, map_cells, truth};
pub use crossings::crossings;
pub use footing::{Footing, HEADINGS};
pub use frame::Frame;
pub use gentle::is_gentle;
pub use ground_truth::{GroundTruth, Score, Table, Truly};
pub use localization::Localization;
pub use loops::{LEAST_M, Loops};
pub use overlap::{EARLIER_M, NEAR_M, Overlap};
pub use patrol::Patrol;
pub use reach::{CellSet, START_SLACK_M};
pub use ride::Ride;
pub use safety::Safety;
