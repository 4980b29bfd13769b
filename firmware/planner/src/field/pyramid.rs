//! The coarse levels of the multigrid: blocks of 2 × 2 blocks, and one correction factor for each.
//!
//! Multiply all values of block J by a factor `x_J` and require the sum of the block's equations:
//!
//! ```text
//! D_J x_J = Σ_K A_JK x_K + b_J        K: the four blocks beside J
//!
//! A_JK = Σ w_ik q_k,  i ∈ J, k ∈ K              what flows in from block K
//! b_J  = Σ w_ik GOAL, i ∈ J, k a goal           what flows in from goals
//! D_J  = Σ 4 q_i − Σ w_ik q_k,  i, k ∈ J        what flows out
//! ```
//!
//! At the solution every x is 1, so max |x − 1| is the remaining error. The system has the form of
//! the fine one, so a block of blocks is again a block: A, b and D add up, with each x absorbed
//! into its q. A *factor* preserves small values. Far from the goals q falls by a fixed part every
//! few cells; the rounding of an added correction from the near side would be larger than the
//! field.
//!
//! The factors of a level lie row by row between two margins, each as long as a row. So the
//! neighbours of factor i are i ± 1 and i ± side without a test: a factor read across a border has
//! a coupling of zero.
//!
//! The constants below belong to the method and are not tuned for a world: bounds keep the
//! arithmetic finite, and the cycles converge only near these values.
//!
//! Invariants: 0 ≤ x ≤ [`MOST`]; D ≥ 0.7 (ΣA + b) ≥ 0.7 [`FAINT`]. So nothing divides by zero.
//! Nothing overflows: from one level to the next A grows at most 8-fold and D 16-fold, from 2¹⁰²
//! and 2¹⁰⁴ to 2¹¹⁴ and 2¹²⁰.

use core::cell::Cell;

/// One block's equation: D, b, and A from the four sides, indexed by the constants below.
pub(super) type Equation = [f32; EQUATION_FLOATS];

const EQUATION_FLOATS: usize = 6;

/// D: outflow for a factor of one.
pub(super) const OUT: usize = 0;
/// b: inflow from goals.
pub(super) const SOURCE: usize = 1;
/// A: inflow from the block below.
pub(super) const SOUTH: usize = 2;
/// A: inflow from the block above.
pub(super) const NORTH: usize = 3;
/// A: inflow from the block to the left.
pub(super) const WEST: usize = 4;
/// A: inflow from the block to the right.
pub(super) const EAST: usize = 5;

/// 2⁻¹²⁰, far below the flow of any value that the field distinguishes from zero. Every block gets
/// this outflow and the same inflow from goals, so x = 1 where there is no other flow.
const FAINT: f32 = f32::from_bits((127 - 120) << 23);

/// The absent block beyond an odd row's end.
const NOTHING: Equation = [0.0; EQUATION_FLOATS];

/// A block without a free cell.
pub(super) const EMPTY: Equation = [FAINT, FAINT, 0.0, 0.0, 0.0, 0.0];

/// Blocks along a side of the finest level.
pub(super) const FINEST: usize = 31;

/// Blocks along a side of the coarsest level.
const COARSEST: usize = 2;

/// Double sweeps that solve the coarsest level.
const COARSEST_SWEEPS: usize = 2;

/// Least outflow as a part of the inflow: in a field far from its solution some blocks keep all
/// their inflow.
const LEAST_OUTFLOW: f32 = 0.7;

/// Over-correction: factors that are constant over a block correct a smooth error too little,
/// because the steps at the blocks' borders cost as much as its slope. From 1.6 on the last cycles
/// no longer settle; 1.3 takes a quarter more cycles.
const OVERCORRECTION: f32 = 1.5;

/// Greatest factor of one relaxation. A field with a larger error takes another cycle.
const MOST: f32 = 4.0;

/// Floats of all levels: equations, and factors with their margins.
pub(super) const FLOATS: usize = EQUATIONS * EQUATION_FLOATS + FACTORS;

const EQUATIONS: usize = {
    let (mut side, mut sum) = (FINEST, COARSEST * COARSEST);
    while side > COARSEST {
        sum += side * side;
        side = side.div_ceil(2);
    }
    sum
};

const FACTORS: usize = {
    let (mut side, mut sum) = (FINEST, COARSEST * (COARSEST + 2) + 1);
    while side > COARSEST {
        sum += side * (side + 2) + 1;
        side = side.div_ceil(2);
    }
    sum
};

/// A level and all coarser ones.
#[derive(Debug)]
pub(super) struct Pyramid<'a> {
    side: usize,
    equations: &'a mut [Equation],
    factors: &'a mut [f32],
}

impl<'a> Pyramid<'a> {
    /// Returns all levels, in scratch memory of any content.
    pub(super) fn new(scratch: &'a mut [f32; FLOATS]) -> Self {
        let (equations, factors) = scratch.split_at_mut(EQUATIONS * EQUATION_FLOATS);
        factors.fill(1.0);
        let (equations, _) = equations.as_chunks_mut();
        Self {
            side: FINEST,
            equations,
            factors,
        }
    }

    /// Returns the finest level's equations, row by row; the caller sets them before
    /// [`Pyramid::solve`].
    pub(super) fn equations(&mut self) -> &mut [Equation] {
        &mut self.equations[..self.side * self.side]
    }

    /// Returns the finest level's factors, row by row.
    pub(super) fn factors(&self) -> &[f32] {
        &self.factors[self.side..][..self.side * self.side]
    }

    /// Finds this level's factors by a W cycle: one turn on the finest level, two on the others.
    pub(super) fn solve(&mut self) {
        let (mut level, mut coarser) = self.split();
        level.factors.fill(1.0);
        if level.side == COARSEST {
            for _ in 0..COARSEST_SWEEPS {
                level.relax();
            }
            return;
        }
        for _ in 0..if level.side == FINEST { 1 } else { 2 } {
            level.aggregate(coarser.equations());
            coarser.solve();
            level.spread(coarser.factors());
            level.relax();
        }
    }

    /// Splits into this level and the coarser ones.
    fn split(&mut self) -> (Level<'_>, Pyramid<'_>) {
        let side = self.side;
        let (equations, coarser_equations) = self.equations.split_at_mut(side * side);
        let (factors, coarser_factors) = self.factors.split_at_mut(side * (side + 2) + 1);
        let level = Level {
            side,
            equations,
            factors,
        };
        let side = side.div_ceil(2);
        (
            level,
            Pyramid {
                side,
                equations: coarser_equations,
                factors: coarser_factors,
            },
        )
    }
}

/// One level.
#[derive(Debug)]
struct Level<'a> {
    side: usize,
    /// Row by row.
    equations: &'a mut [Equation],
    /// Row by row, between two margins as long as a row, and a spare one.
    factors: &'a mut [f32],
}

impl Level<'_> {
    /// Runs two Gauss–Seidel sweeps, backwards and forwards: x ← (b + Σ A x) / D.
    fn relax(&mut self) {
        let (side, count) = (self.side, self.side * self.side);
        let factors = Cell::from_mut(&mut *self.factors).as_slice_of_cells();
        let south = &factors[..count];
        let west = &factors[side - 1..][..count];
        let here = &factors[side..][..count];
        let east = &factors[side + 1..][..count];
        let north = &factors[2 * side..][..count];
        let around = south.iter().zip(north).zip(west.iter().zip(east));
        let cells = self.equations.iter().zip(here).zip(around);
        cells.clone().rev().for_each(relax);
        cells.for_each(relax);
    }

    /// Sums the equations, with their factors absorbed, over blocks of 2 × 2.
    fn aggregate(&self, coarse: &mut [Equation]) {
        let side = self.side;
        let coarse_side = side.div_ceil(2);
        for (y, row) in self.equations.chunks_exact(side).enumerate() {
            let coarse_row = &mut coarse[y / 2 * coarse_side..][..coarse_side];
            let [below, above] = [y * side, (y + 2) * side].map(|start| self.factor_pairs(start));
            let [left, right] =
                [(y + 1) * side - 1, (y + 1) * side + 1].map(|start| self.factor_pairs(start));
            let factors = below.iter().zip(above).zip(left.iter().zip(right));
            let blocks = coarse_row.iter_mut().zip(row.chunks(2)).zip(factors);
            let (lower, last) = (y % 2 == 0, y % 2 == 1 || y + 1 == side);
            for ((block, children), ((below, above), (left, right))) in blocks {
                let [child, more @ ..] = children else {
                    continue;
                };
                let west = absorb(child, [left[1], below[0], above[0], left[0], right[0]]);
                let east = more.first().unwrap_or(&NOTHING);
                let east = absorb(east, [right[0], below[1], above[1], left[1], right[1]]);
                add_pair(block, &west, &east, lower);
                if last {
                    bound_outflow(block);
                }
            }
        }
    }

    /// Returns the factors from `start` on, in pairs.
    fn factor_pairs(&self, start: usize) -> &[[f32; 2]] {
        self.factors[start..].as_chunks().0
    }

    /// Multiplies the factors by the over-corrected ones of their coarse blocks.
    fn spread(&mut self, coarse: &[f32]) {
        let (side, coarse_side) = (self.side, self.side.div_ceil(2));
        let rows = self.factors[side..][..side * side].chunks_exact_mut(side);
        for (y, row) in rows.enumerate() {
            let coarse_row = &coarse[y / 2 * coarse_side..][..coarse_side];
            let (pairs, last) = row.as_chunks_mut::<2>();
            for ([west, east], &x) in pairs.iter_mut().zip(coarse_row) {
                let factor = overcorrect(x);
                *west *= factor;
                *east *= factor;
            }
            if let ([last], Some(&x)) = (last, coarse_row.last()) {
                *last *= overcorrect(x);
            }
        }
    }
}

/// The four neighbours of a factor: south and north, west and east.
type Neighbours<'a> = (
    (&'a Cell<f32>, &'a Cell<f32>),
    (&'a Cell<f32>, &'a Cell<f32>),
);

/// Relaxes one factor: x ← (b + Σ A x) / D.
#[inline(always)]
fn relax(
    ((equation, here), ((south, north), (west, east))): ((&Equation, &Cell<f32>), Neighbours<'_>),
) {
    let upright = equation[SOUTH] * south.get() + equation[NORTH] * north.get();
    let level = equation[WEST] * west.get() + equation[EAST] * east.get();
    let factor = (equation[SOURCE] + (upright + level)) / equation[OUT];
    here.set(if factor > MOST { MOST } else { factor });
}

/// Returns an equation with its factors multiplied in: the block's own, and those below, above,
/// left and right of it.
#[inline(always)]
fn absorb(equation: &Equation, [here, south, north, west, east]: [f32; 5]) -> Equation {
    [
        equation[OUT] * here,
        equation[SOURCE],
        equation[SOUTH] * south,
        equation[NORTH] * north,
        equation[WEST] * west,
        equation[EAST] * east,
    ]
}

/// Adds two equations side by side to a block's, as its lower row or its upper one; the lower row
/// comes first.
#[inline(always)]
fn add_pair(block: &mut Equation, west: &Equation, east: &Equation, lower: bool) {
    // Flows between the two, and between the rows, stay inside the block.
    let out = (west[OUT] + east[OUT]) - (west[EAST] + east[WEST]);
    let source = west[SOURCE] + east[SOURCE];
    let (south, north) = (west[SOUTH] + east[SOUTH], west[NORTH] + east[NORTH]);
    if lower {
        *block = [out - north, source, south, 0.0, west[WEST], east[EAST]];
    } else {
        block[OUT] += out - south;
        block[SOURCE] += source;
        block[NORTH] = north;
        block[WEST] += west[WEST];
        block[EAST] += east[EAST];
    }
}

/// Raises D to at least 0.7 (ΣA + b).
#[inline(always)]
pub(super) fn bound_outflow(equation: &mut Equation) {
    let [out, source, south, north, west, east] = equation;
    let least = LEAST_OUTFLOW * ((*south + *north) + (*west + *east) + *source);
    if *out < least {
        *out = least;
    }
}

/// Returns 1 + 1.5 (x − 1), clamped between x/2 and 2x.
#[inline(always)]
pub(super) fn overcorrect(x: f32) -> f32 {
    let y = 1.0 + OVERCORRECTION * (x - 1.0);
    if y < 0.5 * x {
        0.5 * x
    } else if y > 2.0 * x {
        2.0 * x
    } else {
        y
    }
}
