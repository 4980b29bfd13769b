//! One multigrid cycle: correct the field by factors constant over 2 × 2 cells, then smooth it by one sweep.
//!
//! ```text
//! blocks ← the cells' equations added up, with the signs of |N − S| and |W − E| as they are now    (Picard)
//! x      ← their factors, by a W cycle over 31-16-8-4-2 blocks a side                              (pyramid)
//! q      ← min(q (1 + 1.3 (x − 1)), GOAL)
//! q      ← one Gauss–Seidel sweep
//! ```
//!
//! The blocks' origin alternates between cycles, so that no wall lies inside the same block twice. Coefficients are
//! four times the equation's: w = 1 ± ε/2 and 4 q.
//!
//! Invariant: 0 ≤ q ≤ GOAL. A cycle's cost hardly depends on the field.

use super::gauss_seidel;
use super::pyramid::{
    self, BLOCK_FLOATS, BLOCKS, Block, EAST, EMPTY, FACTOR, FINEST, NORTH, OUT, SOURCE, SOUTH, WEST,
};
use super::runs::Runs;
use super::window::{GOAL, SIDE, STRIDE, Window, index};

/// Floats of scratch memory that a cycle needs, 38 KB.
pub const SCRATCH_FLOATS: usize = BLOCKS * BLOCK_FLOATS;

/// Where the blocks begin: block (X, Y) covers columns and rows 2X − origin and the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Origin {
    /// At cell (0, 0).
    #[default]
    Even,
    /// One cell before it.
    Odd,
}

impl Origin {
    /// The other one.
    pub(super) fn other(self) -> Self {
        match self {
            Self::Even => Self::Odd,
            Self::Odd => Self::Even,
        }
    }

    fn offset(self) -> usize {
        self as usize
    }
}

/// One cycle. Answers max |x − 1| over the finest blocks: the relative error that the field had.
///
/// No reached cell may be blank.
pub(super) fn cycle(window: &mut Window, scratch: &mut [f32; SCRATCH_FLOATS]) -> f32 {
    let origin = window.origin;
    window.origin = origin.other();
    let (levels, _) = scratch.as_chunks_mut::<BLOCK_FLOATS>();
    levels.fill(EMPTY);
    assemble(window, pyramid::finest(levels), origin);
    pyramid::solve(levels);
    let error = correct(window, pyramid::finest(levels), origin);
    gauss_seidel::sweep(window);
    error
}

/// Add the cells' equations up over the finest blocks.
fn assemble(window: &Window, blocks: &mut [Block], origin: Origin) {
    let offset = origin.offset();
    for (y_block, row) in blocks.chunks_exact_mut(FINEST).enumerate() {
        for (x_block, block) in row.iter_mut().enumerate() {
            *block = EMPTY;
            for odd_row in 0..2 {
                for odd_column in 0..2 {
                    let (x, y) = (
                        (2 * x_block + odd_column).wrapping_sub(offset),
                        (2 * y_block + odd_row).wrapping_sub(offset),
                    );
                    if window.is_reached(x, y) {
                        add_cell(block, window, x, y, odd_row, odd_column);
                    }
                }
            }
            pyramid::bound_outflow(block);
        }
    }
}

fn add_cell(
    block: &mut Block,
    window: &Window,
    x: usize,
    y: usize,
    odd_row: usize,
    odd_column: usize,
) {
    let at = index(x, y);
    let q = &window.q;
    let (south, north, west, east) = (q[at - STRIDE], q[at + STRIDE], q[at - 1], q[at + 1]);
    let half = window.preference[y][x].half();
    let tilt = if north >= south { half } else { -half };
    let (south_flow, north_flow) = (south - tilt * south, north + tilt * north);
    let tilt = if west >= east { half } else { -half };
    let (west_flow, east_flow) = (west + tilt * west, east - tilt * east);
    block[OUT] += 4.0 * q[at];
    let mut add = |goal: bool, inside: bool, side: usize, flow: f32| {
        if goal {
            block[SOURCE] += flow;
        } else if inside {
            block[OUT] -= flow;
        } else {
            block[side] += flow;
        }
    };
    add(
        y > 0 && window.is_goal(x, y - 1),
        odd_row == 1,
        SOUTH,
        south_flow,
    );
    add(window.is_goal(x, y + 1), odd_row == 0, NORTH, north_flow);
    add(
        x > 0 && window.is_goal(x - 1, y),
        odd_column == 1,
        WEST,
        west_flow,
    );
    add(window.is_goal(x + 1, y), odd_column == 0, EAST, east_flow);
}

/// Multiply the field by the over-corrected factors. Answers max |x − 1|.
fn correct(window: &mut Window, blocks: &[Block], origin: Origin) -> f32 {
    let offset = origin.offset();
    let mut error = 0.0_f32;
    for block in blocks {
        if block[OUT] > 0.0 {
            error = error.max((block[FACTOR] - 1.0).abs());
        }
    }
    for y in 0..SIDE {
        let row = &blocks[(y + offset) / 2 * FINEST..][..FINEST];
        for x in Runs(window.reached[y]).flatten() {
            let q = &mut window.q[index(x, y)];
            *q = (*q * pyramid::overcorrect(row[(x + offset) / 2][FACTOR])).min(GOAL);
        }
    }
    error
}
