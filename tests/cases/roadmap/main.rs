//! The roadmap: thinning, the wavefront, and doors at every place of the grid.

mod doors;
mod thinning;
mod wavefront;
