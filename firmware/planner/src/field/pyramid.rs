//! The coarse levels of the multigrid: blocks of 2 × 2 blocks, and one correction factor for each.
//!
//! Multiply all values of block J by a factor x_J and ask that the sum of the block's equations holds:
//!
//! ```text
//! D_J x_J = Σ_K A_JK x_K + b_J        K: the four blocks beside J
//! A_JK = Σ w_ik q_k over cells i of J beside cells k of K      what flows in from K
//! b_J  = Σ w_ik GOAL over cells i of J beside goals            what flows in from goals
//! D_J  = Σ 4 q_i − Σ w_ik q_k over cells i, k of J             what flows out
//! ```
//!
//! At the solution every x is 1, so max |x − 1| measures the error that is left. The system has the shape of the
//! fine one, so a block of blocks is again a block: A, b and D add up, with each x absorbed into the q beside it.
//! A factor keeps small values small: far from the goals, where q falls by e every few cells, an additive correction
//! would bury the field under the near side's rounding.
//!
//! A level lies row by row between margins as long as a row, so that the neighbours of block i are i ± 1 and i ± side
//! without a test; whatever is read across a border meets a coupling of zero. Levels overlap in their margins.
//!
//! Invariant: factors are finite and non-negative; D ≥ [`LEAST_OUTFLOW`] (ΣA + b), so that one relaxation changes a
//! factor at most 1/0.7 times its neighbours' greatest.

use core::cell::Cell;

/// One block's equation and factor, by the constants below.
pub(super) type Block = [f32; BLOCK_FLOATS];

/// Floats of a block.
pub(super) const BLOCK_FLOATS: usize = 7;

/// D: what flows out, for a factor of one.
pub(super) const OUT: usize = 0;
/// b: what flows in from goals.
pub(super) const SOURCE: usize = 1;
/// A: what flows in from the block below.
pub(super) const SOUTH: usize = 2;
/// A: what flows in from the block above.
pub(super) const NORTH: usize = 3;
/// A: what flows in from the block to the left.
pub(super) const WEST: usize = 4;
/// A: what flows in from the block to the right.
pub(super) const EAST: usize = 5;
/// x: the block's factor.
pub(super) const FACTOR: usize = 6;

/// A block without a free cell.
pub(super) const EMPTY: Block = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Blocks along a side of the finest level.
pub(super) const FINEST: usize = 31;

/// Blocks along a side of the coarsest level.
const COARSEST: usize = 2;

/// Sweeps that solve the coarsest level.
const COARSEST_SWEEPS: usize = 4;

/// Least outflow in parts of the inflow. A field far from its solution can have blocks that keep all that flows in.
const LEAST_OUTFLOW: f32 = 0.7;

/// Over-correction: 2 × 2 blocks of constants underestimate a smooth correction.
const OVERCORRECTION: f32 = 1.3;

/// Blocks of all levels with their margins.
pub(super) const BLOCKS: usize = {
    let mut side = FINEST;
    let mut blocks = side;
    loop {
        blocks += side * side + side;
        if side == COARSEST {
            break blocks;
        }
        side = side.div_ceil(2);
    }
};

/// The finest level's blocks, row by row.
pub(super) fn finest(levels: &mut [Block]) -> &mut [Block] {
    &mut levels[FINEST..][..FINEST * FINEST]
}

/// Find the finest level's factors: a W cycle over the levels below it. Its equations must be set, its factors one.
pub(super) fn solve(levels: &mut [Block]) {
    descend(levels, FINEST);
}

/// Improve the factors of the first level in `levels`, of `side` blocks, by those of the coarser ones behind it.
fn descend(levels: &mut [Block], side: usize) {
    if side == COARSEST {
        for sweep in 0..COARSEST_SWEEPS {
            relax(levels, side, sweep % 2 == 1);
        }
        return;
    }
    let coarse_side = side.div_ceil(2);
    let coarse_start = side + side * side + side;
    let turns = if side == FINEST { 1 } else { 2 };
    for _ in 0..turns {
        let (level, coarse) = levels.split_at_mut(coarse_start);
        aggregate(level, side, &mut coarse[..coarse_side * coarse_side]);
        descend(&mut levels[coarse_start - coarse_side..], coarse_side);
        let (level, coarse) = levels.split_at_mut(coarse_start);
        spread(
            &mut level[side..][..side * side],
            side,
            &coarse[..coarse_side * coarse_side],
        );
        relax(levels, side, true);
    }
}

/// One Gauss–Seidel sweep over a level's factors.
fn relax(levels: &mut [Block], side: usize, backward: bool) {
    let count = side * side;
    let blocks = Cell::from_mut(levels).as_slice_of_cells();
    let rows = blocks[..count].iter().zip(&blocks[2 * side..][..count]);
    let columns = blocks[side - 1..][..count]
        .iter()
        .zip(&blocks[side + 1..][..count]);
    let all = blocks[side..][..count].iter().zip(rows.zip(columns));
    let relax =
        |(block, ((south, north), (west, east)))| relax_block(block, [south, north, west, east]);
    if backward {
        all.rev().for_each(relax);
    } else {
        all.for_each(relax);
    }
}

/// x = (b + Σ A x) / D.
#[inline(always)]
fn relax_block(block: &Cell<Block>, neighbours: [&Cell<Block>; 4]) {
    let equation = block.as_array_of_cells();
    let out = equation[OUT].get();
    if out > 0.0 {
        let [south, north, west, east] = neighbours.map(|n| n.as_array_of_cells()[FACTOR].get());
        let up_and_down = equation[SOUTH].get() * south + equation[NORTH].get() * north;
        let sideways = equation[WEST].get() * west + equation[EAST].get() * east;
        equation[FACTOR].set((equation[SOURCE].get() + up_and_down + sideways) / out);
    }
}

/// Add up a level's equations, with their factors absorbed, into blocks of 2 × 2, with factors of one.
fn aggregate(level: &[Block], side: usize, coarse: &mut [Block]) {
    let coarse_side = side.div_ceil(2);
    for y in 0..side {
        let row = &level[(y + 1) * side..];
        let below = &level[y * side..];
        let above = &level[(y + 2) * side..];
        let coarse = &mut coarse[y / 2 * coarse_side..][..coarse_side];
        for (x, coarse) in coarse.iter_mut().enumerate() {
            let west = 2 * x;
            let mut sum = EMPTY;
            add_child(
                &mut sum,
                &row[west],
                [
                    below[west][FACTOR],
                    above[west][FACTOR],
                    level[(y + 1) * side + west - 1][FACTOR],
                    row[west + 1][FACTOR],
                ],
                y % 2,
                0,
            );
            if west + 1 < side {
                let east = west + 1;
                add_child(
                    &mut sum,
                    &row[east],
                    [
                        below[east][FACTOR],
                        above[east][FACTOR],
                        row[west][FACTOR],
                        row[east + 1][FACTOR],
                    ],
                    y % 2,
                    1,
                );
            }
            if y % 2 == 0 {
                *coarse = sum;
            } else {
                for i in 0..FACTOR {
                    coarse[i] += sum[i];
                }
            }
            if y % 2 == 1 || y + 1 == side {
                bound_outflow(coarse);
            }
        }
    }
}

/// D ≥ 0.7 (ΣA + b).
#[inline(always)]
pub(super) fn bound_outflow(block: &mut Block) {
    let inflow = (block[SOUTH] + block[NORTH]) + (block[WEST] + block[EAST]) + block[SOURCE];
    block[OUT] = block[OUT].max(LEAST_OUTFLOW * inflow);
}

#[inline(always)]
fn add_child(sum: &mut Block, child: &Block, factors: [f32; 4], odd_row: usize, odd_column: usize) {
    let flow = [
        child[SOUTH] * factors[0],
        child[NORTH] * factors[1],
        child[WEST] * factors[2],
        child[EAST] * factors[3],
    ];
    let mut out = child[OUT] * child[FACTOR];
    sum[SOUTH + odd_row] += flow[odd_row];
    out -= flow[1 - odd_row];
    sum[WEST + odd_column] += flow[2 + odd_column];
    out -= flow[3 - odd_column];
    sum[OUT] += out;
    sum[SOURCE] += child[SOURCE];
}

/// Multiply a level's factors by their coarse block's.
fn spread(level: &mut [Block], side: usize, coarse: &[Block]) {
    let coarse_side = side.div_ceil(2);
    for (y, row) in level.chunks_exact_mut(side).enumerate() {
        let coarse = &coarse[y / 2 * coarse_side..][..coarse_side];
        for (pair, coarse) in row.chunks_mut(2).zip(coarse) {
            let factor = overcorrect(coarse[FACTOR]);
            for block in pair {
                block[FACTOR] *= factor;
            }
        }
    }
}

/// 1 + 1.3 (x − 1), but within half and twice x.
#[inline(always)]
pub(super) fn overcorrect(x: f32) -> f32 {
    let y = 1.0 + OVERCORRECTION * (x - 1.0);
    y.clamp(0.5 * x, x + x)
}
