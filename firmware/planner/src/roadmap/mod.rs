//! The roadmap: the skeleton of the traversable space, and distances along it.
//!
//! | file | what it holds |
//! | --- | --- |
//! | [`configuration_space`] | the cells where the robot's centre fits |
//! | [`skeleton`], `coarse` | the skeleton at 20 cm, and the round that computes the next |
//! | `thinning`, `thinning_rule` | Guo–Hall thinning in instalments |
//! | [`branches`] | ends, passages, junctions; the way along a branch |
//! | `wavefront`, `residues` | distances from any set of centre cells, and the way back down |
//! | `barrier` | cells taken out of the skeleton for a while |
//! | [`reachability`] | the explored cells that the robot can reach |
//! | [`flooding`] | their flood in instalments |
//!
//! The *centre cells* are the skeleton of the space left by obstacles: of the known part of it, or
//! of the unexplored as well, so that paths may run through it \[Jorge15, step 1\]; see
//! [`skeleton::Space`]. Thinning (\[GuoHall89\], two subiterations) keeps the space's pieces and
//! holes: between two places the skeleton has a way exactly where the space has one. Anchors, cells
//! that are kept whatever the rule says, change neither.
//!
//! Departs from \[Jorge15, step 1\]: the plane that is thinned has cells of 20 cm, one for 2 × 2
//! cells of the map, and holds the configuration space instead of the space itself. The skeleton
//! charges the window and does not steer within it, so it need not be finer than the robot. A
//! quarter of the cells and half the passes make it affordable on the microcontroller, and a way in
//! it is a way for this robot's radius. Doors stay open: `tests/golden/doors.txt`.
//!
//! The thinning works under a budget: it stops when that is spent and continues later from exactly
//! there, with the same result as without a stop. Neither it nor the wave knows how large a cell
//! is.

mod barrier;
pub(crate) mod branches;
pub(crate) mod coarse;
pub mod configuration_space;
pub(crate) mod flooding;
pub(crate) mod reachability;
mod residues;
pub mod skeleton;
mod thinning;
mod thinning_rule;
mod wavefront;

pub use barrier::{Barrier, BarrierFull};
pub use residues::{Descent, Residues};
pub use thinning::Thinning;
pub use wavefront::{WaveSpace, Wavefront};

/// The state of a thinning after an instalment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Progress {
    /// It is finished.
    Done {
        /// Units of the budget that are left.
        left: u32,
    },
    /// The budget is spent; it needs another instalment.
    Pending,
}
