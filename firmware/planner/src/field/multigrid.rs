//! One multigrid cycle: correct the field by factors constant over 2 × 2 cells, then smooth it by one sweep.
//!
//! ```text
//! equations ← the cells' equations summed over blocks, |N − S| and |W − E| with their present signs     (Picard)
//! x         ← the blocks' factors, by a W cycle over 31-16-8-4-2 blocks a side                        (pyramid)
//! q         ← min(q (1 + 1.5 (x − 1)), GOAL)
//! q         ← one Gauss–Seidel sweep
//! ```
//!
//! A cell's equation is taken four times over, `4 q = Σ w q_k` with w = 1 ± ε/2, plus for the greater of two opposite
//! neighbours. The blocks' origin alternates between cycles, so that no wall stays inside the same blocks.
//!
//! Invariant: 0 ≤ q ≤ GOAL. A cycle's cost hardly depends on the field's values.

use crate::field::gauss_seidel;
use crate::field::pyramid::{
    self, EAST, EMPTY, Equation, FINEST, NORTH, OUT, Pyramid, SOURCE, SOUTH, WEST,
};
use crate::field::window::{GOAL, Preference, SIDE, STRIDE, Window};

/// Floats of scratch memory that a cycle needs, 36 KB. Their content before and after means nothing.
pub const SCRATCH_FLOATS: usize = pyramid::FLOATS;

/// A row of cells two by two, as the blocks see it; the last pair is only the neighbour of the one before.
type Pairs<T> = [[T; 2]; STRIDE / 2];

/// Where the blocks begin: block (X, Y) covers columns 2X − origin and the next, and such rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// At cell (0, 0).
    Even,
    /// One cell before it.
    Odd,
}

impl Origin {
    fn other(self) -> Self {
        match self {
            Self::Even => Self::Odd,
            Self::Odd => Self::Even,
        }
    }

    /// Cells from the first block's corner to cell (0, 0), in x and in y.
    fn offset(self) -> usize {
        match self {
            Self::Even => 0,
            Self::Odd => 1,
        }
    }

    /// Where the lower row of block row `y` starts in the window's arrays.
    fn start(self, y: usize) -> usize {
        (2 * y + 1 - self.offset()) * STRIDE + 1 - self.offset()
    }
}

/// One cycle. Answers max |x − 1| over the blocks: the relative error that the field had.
///
/// The window must be raised (see `seed`): zero stays zero, however it is multiplied.
pub(super) fn cycle(window: &mut Window, scratch: &mut [f32; SCRATCH_FLOATS]) -> f32 {
    let mut pyramid = Pyramid::new(scratch);
    if window.preferred {
        assemble::<true>(window, pyramid.equations());
    } else {
        // Tilts of zero: leaving them out gives the same bits.
        assemble::<false>(window, pyramid.equations());
    }
    pyramid.solve();
    let error = if window.charged {
        correct::<true>(window, pyramid.factors())
    } else {
        correct::<false>(window, pyramid.factors())
    };
    gauss_seidel::sweep(window);
    window.origin = window.origin.other();
    error
}

/// Sum the cells' equations over the finest blocks.
fn assemble<const PREFERRED: bool>(window: &Window, equations: &mut [Equation]) {
    for (y, equations) in equations.chunks_exact_mut(FINEST).enumerate() {
        let row = BlockRow::new(window, y);
        let (mut reached, mut beside_goal) = (row.reached, row.beside_goal());
        let mut west = [0.0; 2];
        for (x, equation) in equations.iter_mut().enumerate() {
            let block = row.block(x, west);
            *equation = if reached[0] & reached[1] & !beside_goal & 0b11 == 0b11 {
                block.full::<PREFERRED>()
            } else if (reached[0] | reached[1]) & 0b11 != 0 {
                let goals = if beside_goal & 0b11 != 0 {
                    row.goal
                } else {
                    [0; 4]
                };
                block.partial::<PREFERRED>(reached, goals.map(|row| row >> (2 * x)))
            } else {
                EMPTY
            };
            west = [block.q[1][1], block.q[2][1]];
            reached = reached.map(|row| row >> 2);
            beside_goal >>= 2;
        }
    }
}

/// Two rows of cells with those below and above them, aligned so that block X has columns 2X and 2X + 1.
struct BlockRow<'a> {
    /// The row below, the lower one, the upper one, the row above.
    q: [&'a Pairs<f32>; 4],
    /// Goals in those rows, one column further to the left.
    goal: [u64; 4],
    /// The lower row's preferences, the upper one's.
    preference: [&'a Pairs<Preference>; 2],
    /// Reached cells of those two.
    reached: [u64; 2],
}

impl<'a> BlockRow<'a> {
    fn new(window: &'a Window, y: usize) -> Self {
        let offset = window.origin.offset();
        let start = window.origin.start(y);
        // Rows outside the window have no cells; rows outside its margins are never looked at.
        let mask = |rows: &[u64; SIDE], row: usize| {
            let row = (2 * y + row).checked_sub(1 + offset);
            row.and_then(|row| rows.get(row))
                .map_or(0, |bits| bits << offset)
        };
        let q = |row: usize| {
            let start = (start + row * STRIDE).checked_sub(STRIDE);
            pairs(&window.q, start, &[[0.0; 2]; STRIDE / 2])
        };
        let preference = |row: usize| {
            let start = Some(start + row * STRIDE);
            pairs(
                &window.preference,
                start,
                &[[Preference::NONE; 2]; STRIDE / 2],
            )
        };
        Self {
            q: [q(0), q(1), q(2), q(3)],
            goal: [0, 1, 2, 3].map(|row| mask(&window.goal, row) << 1),
            preference: [preference(0), preference(1)],
            reached: [1, 2].map(|row| mask(&window.reached, row)),
        }
    }

    /// Columns with a reached cell beside a goal in either row.
    fn beside_goal(&self) -> u64 {
        let [below, lower, upper, above] = self.goal;
        let beside_lower = (below | upper) >> 1 | lower | lower >> 2;
        let beside_upper = (lower | above) >> 1 | upper | upper >> 2;
        (self.reached[0] & beside_lower) | (self.reached[1] & beside_upper)
    }

    /// Block x, given its western neighbours.
    #[inline(always)]
    fn block(&self, x: usize, west: [f32; 2]) -> Block {
        Block {
            q: self.q.map(|row| row[x]),
            west,
            east: [self.q[1][x + 1][0], self.q[2][x + 1][0]],
            preference: self.preference.map(|row| row[x]),
        }
    }
}

/// The row that starts at `start`, or `outside` if there is no such row.
fn pairs<'a, T>(cells: &'a [T], start: Option<usize>, outside: &'a Pairs<T>) -> &'a Pairs<T> {
    let row = start.and_then(|start| cells.get(start..));
    row.and_then(|row| row.as_chunks().0.first_chunk())
        .unwrap_or(outside)
}

/// A block's cells and the eight around them.
struct Block {
    /// By rows: below, lower, upper, above.
    q: [[f32; 2]; 4],
    /// To the left of the lower cells and of the upper ones.
    west: [f32; 2],
    /// To their right.
    east: [f32; 2],
    /// Lower and upper.
    preference: [[Preference; 2]; 2],
}

impl Block {
    /// The equation of a block of free cells without a goal beside.
    #[inline(always)]
    fn full<const PREFERRED: bool>(&self) -> Equation {
        let mut sum = EMPTY;
        self.add_cell::<PREFERRED, 0, 0>(&mut sum, [false; 4]);
        self.add_cell::<PREFERRED, 0, 1>(&mut sum, [false; 4]);
        self.add_cell::<PREFERRED, 1, 0>(&mut sum, [false; 4]);
        self.add_cell::<PREFERRED, 1, 1>(&mut sum, [false; 4]);
        pyramid::bound_outflow(&mut sum);
        sum
    }

    /// The equation of any block, from the lowest bits of the rows' masks: `reached` the lower and the upper,
    /// `goal` all four, one column further to the left.
    fn partial<const PREFERRED: bool>(&self, reached: [u64; 2], goal: [u64; 4]) -> Equation {
        let mut sum = EMPTY;
        // A goal below, above, left, right of the cell in column `right` of row `upper`?
        let goals = |upper: usize, right: usize| {
            [
                goal[upper] >> 1,
                goal[upper + 2] >> 1,
                goal[upper + 1],
                goal[upper + 1] >> 2,
            ]
            .map(|row| row >> right & 1 == 1)
        };
        if reached[0] & 0b01 != 0 {
            self.add_cell::<PREFERRED, 0, 0>(&mut sum, goals(0, 0));
        }
        if reached[0] & 0b10 != 0 {
            self.add_cell::<PREFERRED, 0, 1>(&mut sum, goals(0, 1));
        }
        if reached[1] & 0b01 != 0 {
            self.add_cell::<PREFERRED, 1, 0>(&mut sum, goals(1, 0));
        }
        if reached[1] & 0b10 != 0 {
            self.add_cell::<PREFERRED, 1, 1>(&mut sum, goals(1, 1));
        }
        pyramid::bound_outflow(&mut sum);
        sum
    }

    /// Add one cell's equation: 4 q against what flows in from below, above, left and right, where `goals` may be.
    #[inline(always)]
    fn add_cell<const PREFERRED: bool, const UPPER: usize, const RIGHT: usize>(
        &self,
        sum: &mut Equation,
        goals: [bool; 4],
    ) {
        let row = self.q[UPPER + 1];
        let [mut south, mut north] = [self.q[UPPER][RIGHT], self.q[UPPER + 2][RIGHT]];
        let mut west = if RIGHT == 0 { self.west[UPPER] } else { row[0] };
        let mut east = if RIGHT == 0 { row[1] } else { self.east[UPPER] };
        if PREFERRED {
            let half = self.preference[UPPER][RIGHT].half();
            let tilt = if north >= south { half } else { -half };
            (south, north) = (south - tilt * south, north + tilt * north);
            let tilt = if west >= east { half } else { -half };
            (west, east) = (west + tilt * west, east - tilt * east);
        }
        sum[OUT] += 4.0 * row[RIGHT];
        add_inflow(sum, SOUTH, south, UPPER == 1, goals[0]);
        add_inflow(sum, NORTH, north, UPPER == 0, goals[1]);
        add_inflow(sum, WEST, west, RIGHT == 1, goals[2]);
        add_inflow(sum, EAST, east, RIGHT == 0, goals[3]);
    }
}

/// Add what flows into a cell from one side: from a goal, from the same block, or from the block on that side.
#[inline(always)]
fn add_inflow(sum: &mut Equation, side: usize, inflow: f32, inside: bool, goal: bool) {
    if goal {
        sum[SOURCE] += inflow;
    } else if inside {
        sum[OUT] -= inflow;
    } else {
        sum[side] += inflow;
    }
}

/// Multiply the field by the over-corrected factors. Answers max |x − 1|. If `CHARGED`, goals are left alone.
fn correct<const CHARGED: bool>(window: &mut Window, factors: &[f32]) -> f32 {
    let mut error = 0.0;
    let offset = window.origin.offset();
    for (y, factors) in factors.chunks_exact(FINEST).enumerate() {
        let start = window.origin.start(y);
        let [mut below, mut over] = [0, 1].map(|row| {
            let row = (2 * y + row).checked_sub(offset);
            let reached = row.and_then(|row| window.reached.get(row));
            reached.map_or(0, |bits| bits << offset)
        });
        let (lower, upper) = window.q[start..][..2 * STRIDE].split_at_mut(STRIDE);
        let columns = lower
            .as_chunks_mut()
            .0
            .iter_mut()
            .zip(upper.as_chunks_mut().0);
        for (&x, ([a, b], [c, d])) in factors.iter().zip(columns) {
            let change = (x - 1.0).abs();
            if change > error {
                error = change;
            }
            let factor = pyramid::overcorrect(x);
            let parts = [below & 1, below >> 1 & 1, over & 1, over >> 1 & 1];
            (below, over) = (below >> 2, over >> 2);
            for (q, reached) in [a, b, c, d].into_iter().zip(parts) {
                if CHARGED && reached == 0 {
                    continue;
                }
                *q *= factor;
                if factor > 1.0 && *q > GOAL {
                    *q = GOAL;
                }
            }
        }
    }
    if !CHARGED {
        // Obstacles stayed zero; goals may have been scaled down.
        window.charge_goals();
    }
    error
}
