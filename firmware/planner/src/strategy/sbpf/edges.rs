//! The cells that attract: edges of what is covered, and gates \[Kenealy15, eqs. 7–10\].
//!
//! ```text
//! r(x, y) = (1/9) Σ s(x + i, y + j)   over the 3 × 3 block; s = 1: covered, no obstacle   (eq. 7)
//! R = 1 if r ∈ [0.3, 0.7]: 3 to 6 of 9 cells                                             (eq. 8)
//! γ(x, y) = Σ gap(x, y, i, j); gap = 1 if (x + i, y + j) and (x − i, y − j) are obstacles (eq. 9)
//! G = 1 if γ > 1: at least one pair, which counts twice                                 (eq. 10)
//! ```
//!
//! A cell attracts if nothing has sensed it and R = 1. ESBPF: or G = 1.
//!
//! Obstacle cells have s = 0: the paper sets their potential to zero \[Kenealy15, 3.3\]. So what is
//! behind a wall does not attract. A cell in a door or a corridor of one cell has one free
//! neighbour: R = 0 there, and G = 1.
//!
//! Departs from \[Kenealy15, eq. 10\]: a gate attracts only if one of its neighbours is covered and
//! no obstacle. The inside of a thick wall has obstacles on both sides, and no robot will sense it.
//!
//! Units: cells of the area.

use crate::grid::bits::ones64;
use crate::strategy::sbpf::levels::Levels;

/// Covered cells of a 3 × 3 block at an edge: `[0.3, 0.7]` of nine.
const EDGE: core::ops::RangeInclusive<u32> = 3..=6;

/// Returns the cells of a row that attract. `has_gates` is true for ESBPF.
pub(super) fn attractive(levels: &Levels, y: i32, has_gates: bool) -> u64 {
    let open = [y - 1, y, y + 1].map(|y| levels.covered(y) & !levels.obstacle(y));
    let stones = [y - 1, y, y + 1].map(|y| levels.obstacle(y));
    // Cells with an open neighbour in their block.
    let any = open.iter().fold(0, |all, row| all | row);
    let candidates = levels.never_sensed(y) & (any | any << 1 | any >> 1);
    let gates = if has_gates { gates(stones) } else { 0 };
    let is_edge = |&x: &u32| EDGE.contains(&open.iter().map(|row| block(*row, x)).sum::<u32>());
    let edges = ones64(candidates).filter(is_edge);
    edges.fold(candidates & gates, |cells, x| cells | 1 << x)
}

/// Returns the number of set cells of a row in columns x − 1 to x + 1.
const fn block(row: u64, x: u32) -> u32 {
    // One column to the left of column 0 there is nothing.
    let three = if x == 0 { row << 1 } else { row >> (x - 1) };
    (three & 0b111).count_ones()
}

/// Returns the cells of the middle row with two obstacles straight across.
const fn gates([below, here, above]: [u64; 3]) -> u64 {
    let (left, right) = (1, 1);
    let across = here << left & here >> right;
    let rising = below << left & above >> right;
    let falling = above << left & below >> right;
    across | rising | falling | (below & above)
}
