//! The potential in the local window, and the way down it.
//!
//! Obstacles hold p = 1, goals p = 0, and every free cell between them satisfies [Prestes02; Maffei20, eq. 1]
//!
//! ```text
//! ∇²p − ε (|∂p/∂x| + |∂p/∂y|) = 0          ε: the cell's preference, |ε| ≤ 2
//! ```
//!
//! The robot follows −∇p. Everything here works with **q = 1 − p** instead (obstacle 0, goal [`GOAL`]), in which the
//! same equation reads
//!
//! ```text
//! q = ((N + S) + (W + E) + (ε/2) (|N − S| + |W − E|)) / 4
//! ```
//!
//! because far from every goal p is 1 less something like 1e-20, which no float near 1 can hold, while q keeps its
//! full relative precision. The equation is homogeneous of degree one, so the goal's value is free: 2¹⁰⁰ doubles the
//! range that an f32 reaches before it underflows.
//!
//! | room | what it holds |
//! | --- | --- |
//! | [`window`] | the cells: field, boundary, preferences; warm values across a move |
//! | `seed` | a start for cells that have no value, or one far too low |
//! | `gauss_seidel` | one relaxation sweep, the papers' method |
//! | `multigrid`, `pyramid` | one cycle of the fast method, and its coarse levels |
//! | [`solver`] | which method, how long, and when to stop |
//! | [`descent`] | the heading of −∇p, the way of steepest ascent of q |
//! | [`preference`] | `p_diff`, the flatness measure that preferences answer to |
//!
//! Directions: x right (east), y up (north), row 0 is the least y. Everything is f32 without fused operations, so that
//! host and target compute the same bits.

// The solver's inner loops index by shape alone: no number that comes from outside is an index here. `Window` guards its own.
#[allow(
    clippy::indexing_slicing,
    reason = "runs lie within the masks, whose bits are below SIDE in each of SIDE rows; a margin of a row and a cell lies around them"
)]
mod gauss_seidel;
#[allow(
    clippy::indexing_slicing,
    reason = "block columns are below FINEST, one less than the pairs of a row; block rows start within the field"
)]
mod multigrid;
#[allow(
    clippy::indexing_slicing,
    reason = "levels are cut from a fixed scratch, sized by the same constants at compile time"
)]
mod pyramid;
mod runs;
#[allow(
    clippy::indexing_slicing,
    reason = "as for the sweep: runs within the masks, a margin around them"
)]
mod seed;

pub mod descent;
pub mod height_preference;
pub mod local_grid;
pub mod preference;
pub mod solver;
pub mod window;

pub use crate::config::{Method, SolverConfig};
pub use multigrid::SCRATCH_FLOATS;
pub use solver::{Solution, Stop, solve};
pub use window::{GOAL, Preference, PreferenceError, SIDE, Window};

/// The window and the multigrid's scratch memory go into the chip's 64 KB of core-coupled memory.
const _: () = assert!(size_of::<Window>() + SCRATCH_FLOATS * size_of::<f32>() <= 64 * 1024);
