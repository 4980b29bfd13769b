//! Memory of one call: a grid, the planes of a search, and the solver's vectors. Nothing in it
//! outlives the call.

use crate::correlation::Planes;
use crate::grid::Grid;
use crate::solver::Vectors;

/// Memory that a call of [`Slam::observe`](crate::Slam::observe) works in. `SIDE` is a power of
/// two: cells of 10 cm along the side of a grid, which must hold the scans of some keyframes.
#[derive(Clone, Debug, Default)]
pub struct Workspace<const KEYS: usize, const SIDE: usize> {
    pub(crate) grid: Grid<SIDE>,
    pub(crate) planes: Planes<SIDE>,
    pub(crate) vectors: Vectors<KEYS>,
}
