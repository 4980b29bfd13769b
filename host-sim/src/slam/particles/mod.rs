//! The instrument of the papers: a particle filter that watches a run and changes nothing.
//!
//! ```text
//! odometry, level scan ─► filter ─► distances of its particles from the true place
//! ```
//!
//! Two of the papers judge a planner by what it does to such a filter: PFErr is the mean over the
//! run of the particles' mean distance to the true place (TDBVP §5). Here the filter stands beside
//! any run, so that every strategy is judged by the same one, whatever corrects its own pose. It
//! takes the run's odometry. If that is the truth, it draws one that drifts.
//!
//! Units: metres, radians.

mod beside;
mod filter;
mod grid;
mod path;
mod proposal;
mod report;
mod scan;
mod spec;

pub use beside::Beside;
pub use path::path;
pub use proposal::Proposal;
pub use report::ParticleReport;
pub use spec::{MOST_PARTICLES, ParticleSpec};
