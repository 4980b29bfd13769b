//! The potential in the local window, and its descent.
//!
//! Obstacles hold p = 1 and goals p = 0. Every free cell that a goal reaches satisfies \[Prestes02;
//! Maffei20, eq. 1\]
//!
//! ```text
//! ∇²p − ε (|∂p/∂x| + |∂p/∂y|) = 0          ε: the cell's preference, |ε| ≤ 2
//! ```
//!
//! The robot follows −∇p. The code stores **q = 1 − p** instead (obstacle 0, goal [`GOAL`]), for
//! which the same equation reads
//!
//! ```text
//! q = ((N + S) + (W + E) + (ε/2) (|N − S| + |W − E|)) / 4
//! ```
//!
//! Far from every goal, p differs from 1 by as little as 1e-20. An f32 near 1 cannot hold that; q
//! keeps its full relative precision. The equation is homogeneous of degree one, so the goal's
//! value is free: 2¹⁰⁰ doubles the range of exponents before an f32 underflows.
//!
//! | module | content |
//! | --- | --- |
//! | [`window`] | the cells: field, boundary, preferences; values kept across a move |
//! | `local_grid` | passable cells and obstacles around the robot, from the map |
//! | `seed` | a first value for cells that have none, or one far too low |
//! | `gauss_seidel` | one relaxation sweep, the papers' method |
//! | `multigrid`, `pyramid` | one cycle of the fast method, and its coarse levels |
//! | [`solver`] | choice of the method, budget, stop rule |
//! | [`descent`] | the heading of −∇p |
//! | [`preference`] | ε of a cell from its height and from the field's flatness `p_diff` |
//!
//! Directions: x right (east), y up (north); row 0 is the least y. All arithmetic is f32 without
//! fused operations, so host and target compute the same bits.

// The solver's inner loops index by constant shape: no index depends on outside data. `Window`
// checks its own indices.
#[allow(
    clippy::indexing_slicing,
    reason = "runs lie within the masks, whose bits are below SIDE in SIDE rows, inside the margins"
)]
mod gauss_seidel;
#[allow(
    clippy::indexing_slicing,
    reason = "block columns are below FINEST, one less than a row's pairs; rows start in the field"
)]
mod multigrid;
#[allow(
    clippy::indexing_slicing,
    reason = "levels are cut from scratch memory that the same constants size at compile time"
)]
mod pyramid;
mod runs;
#[allow(
    clippy::indexing_slicing,
    reason = "as in the sweep: runs lie within the masks, inside the margins"
)]
mod seed;

pub mod descent;
pub(crate) mod local_grid;
pub mod preference;
pub mod solver;
pub mod window;

pub use crate::config::{Method, SolverConfig};
pub use multigrid::SCRATCH_FLOATS;
pub use solver::{SWEEPS_PER_CYCLE, Solution, Stop, solve};
pub use window::{GOAL, Preference, Rows, SIDE, Window};

/// The window and the multigrid's scratch memory fit into the chip's 64 KB core-coupled memory.
const _: () = assert!(size_of::<Window>() + SCRATCH_FLOATS * size_of::<f32>() <= 64 * 1024);
