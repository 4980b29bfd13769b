//! Metrics of a run, computed on the true world.

mod cell_area;
mod coverage;
mod crossings;
mod footing;
mod gentle;
mod ground_truth;
mod loops;
mod map_error;
mod map_score;
mod overlap;
pub mod patrol;
mod reach;
mod ride;
mod safety;
mod team_overlap;

pub use cell_area::CellArea;
pub use coverage::{Coverage, DIRECTIONS, MAP_CELL_M, Truth, map_cells, truth};
pub use crossings::crossings;
pub use footing::{Footing, HEADINGS};
pub use ground_truth::{GroundTruth, TrueClass};
pub use loops::{LEAST_M, Loops};
pub use map_error::{GHOST_M, MapError, map_error, walls_share};
pub use map_score::{MapScore, Score};
pub use overlap::{EARLIER_M, NEAR_M, Overlap};
pub use patrol::Patrol;
pub use reach::{CellSet, START_SLACK_M};
pub use ride::Ride;
pub use safety::Safety;
pub use team_overlap::TeamOverlap;
