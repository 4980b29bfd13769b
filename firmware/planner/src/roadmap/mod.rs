//! The skeleton of the traversable space and distances along it.
//!
//! The *centre cells* are the skeleton of the space left by obstacles: of what is known of it, or of the unexplored too,
//! so that paths may run through it [Jorge15, step 1]; see [`crate::roadmap::skeleton::Space`]. They are found by thinning
//! [GuoHall89, two subiterations], which keeps the space's pieces and holes: between two places the skeleton has a
//! way exactly where the space has one. Anchors, cells that are kept whatever the rule says, change neither. A
//! [`Wavefront`] counts the steps from any set of centre cells along the skeleton, and a [`Descent`] walks back
//! down.
//!
//! Departs from [Jorge15, step 1]: the plane that is thinned has cells of 20 cm, one for 2 × 2 cells of the map, and holds
//! the space of the robot's centre (obstacles grown by its radius) in place of the space itself. The skeleton charges
//! the window and does not steer within it, so it need not be finer than the robot; a quarter of the cells and half
//! the passes make it affordable on the microcontroller, and a way in it is a way for this robot's radius. Doors stay
//! open: `tests/golden/doors.txt`.
//!
//! Both the thinning and the wavefront work under a budget: they stop when it is spent and go on later from exactly
//! there, with the same result as without a stop. Neither knows how large a cell is.
//!
//! [GuoHall89]: Z. Guo, R. W. Hall, "Parallel thinning with two-subiteration algorithms", Communications of the
//! ACM 32(3), 1989.

mod barrier;
pub mod branches;
pub(crate) mod coarse;
pub mod configuration_space;
pub mod reachability;
mod residues;
pub mod skeleton;
mod thinning;
mod thinning_rule;
mod wavefront;

pub use barrier::{Barrier, BarrierFull};
pub use residues::{Descent, Residues};
pub use thinning::{Thinning, marks_for};
pub use wavefront::{WaveSpace, Wavefront};

/// How far a budgeted piece of work came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Progress {
    /// Finished; this much of the budget is left.
    Done {
        /// Units of work not used.
        left: u32,
    },
    /// The budget is spent; go on with the next.
    Pending,
}
