//! One multigrid cycle: a correction by factors constant over 2 × 2 cells, then one smoothing
//! sweep.
//!
//! ```text
//! equations ← the cells' equations summed over blocks,
//!             |N − S| and |W − E| with their present signs                         (Picard)
//! x         ← the blocks' factors, by a W cycle over 31-16-8-4-2 blocks a side    (pyramid)
//! q         ← min(q (1 + 1.5 (x − 1)), GOAL)
//! q         ← one Gauss–Seidel sweep
//! ```
//!
//! A cell's equation is multiplied by four: `4 q = Σ w q_k` with w = 1 ± ε/2; the plus holds for
//! the greater of two opposite neighbours. The blocks' origin alternates between cycles, so no wall
//! stays inside the same blocks.
//!
//! Invariant: 0 ≤ q ≤ GOAL. A cycle's cost hardly depends on the field's values.

use crate::field::gauss_seidel;
use crate::field::pyramid::{
    self, EAST, EMPTY, Equation, FINEST, NORTH, OUT, Pyramid, SOURCE, SOUTH, WEST,
};
use crate::field::window::{GOAL, Preference, Rows, STRIDE, Window};
use crate::grid::at;

/// Floats of scratch memory that a cycle needs, 36 KB. Their content has no meaning between cycles.
pub const SCRATCH_FLOATS: usize = pyramid::FLOATS;

/// A row of cells in pairs, one for each block; the last pair is only a neighbour.
type Pairs<T> = [[T; 2]; STRIDE / 2];

/// Origin of the blocks: block (X, Y) covers the two columns from 2X − offset and such rows.
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

    /// Returns the cells from the first block's corner to cell (0, 0), in x and in y.
    fn offset(self) -> usize {
        match self {
            Self::Even => 0,
            Self::Odd => 1,
        }
    }

    /// Returns the start of the lower row of block row `y` in the window's arrays.
    fn start(self, y: usize) -> usize {
        (2 * y + 1 - self.offset()) * STRIDE + 1 - self.offset()
    }
}

/// Runs one cycle and returns max |x − 1| over the blocks: the relative error that the field had.
///
/// The window must be raised first (see `seed`): a product never raises zero.
pub(super) fn cycle(window: &mut Window, scratch: &mut [f32; SCRATCH_FLOATS]) -> f32 {
    let mut pyramid = Pyramid::new(scratch);
    if window.preferred {
        assemble::<true>(window, pyramid.equations());
    } else {
        // All tilts are zero; without them the bits are the same.
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

/// Sums the cells' equations over the finest blocks.
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

/// Two rows of cells, the row below and the row above, aligned so that block X has columns 2X and
/// 2X + 1.
struct BlockRow<'a> {
    /// The row below, the lower one, the upper one, the row above.
    q: [&'a Pairs<f32>; 4],
    /// Goals in those rows, shifted left by one bit.
    goal: [u64; 4],
    /// Preferences of the lower and the upper row.
    preference: [&'a Pairs<Preference>; 2],
    /// Reachable cells of the lower and the upper row.
    reached: [u64; 2],
}

impl<'a> BlockRow<'a> {
    fn new(window: &'a Window, y: usize) -> Self {
        let offset = window.origin.offset();
        let start = window.origin.start(y);
        // Rows outside the window have no cells; rows outside its margins are not read.
        let mask =
            |rows: &Rows, row: usize| at(rows, (2 * y + row).wrapping_sub(1 + offset)) << offset;
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

    /// Returns the columns with a reachable cell beside a goal, in either row.
    fn beside_goal(&self) -> u64 {
        let [below, lower, upper, above] = self.goal;
        let beside_lower = (below | upper) >> 1 | lower | lower >> 2;
        let beside_upper = (lower | above) >> 1 | upper | upper >> 2;
        (self.reached[0] & beside_lower) | (self.reached[1] & beside_upper)
    }

    /// Returns block x, given its western neighbours.
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

/// Returns the row that starts at `start`, or `outside` if there is no such row.
fn pairs<'a, T>(cells: &'a [T], start: Option<usize>, outside: &'a Pairs<T>) -> &'a Pairs<T> {
    let row = start.and_then(|start| cells.get(start..));
    row.and_then(|row| row.as_chunks().0.first_chunk())
        .unwrap_or(outside)
}

/// A block's cells and their eight neighbours.
struct Block {
    /// By rows: below, lower, upper, above.
    q: [[f32; 2]; 4],
    /// West of the lower row and of the upper one.
    west: [f32; 2],
    /// East of them.
    east: [f32; 2],
    /// Preferences of the lower and the upper row.
    preference: [[Preference; 2]; 2],
}

impl Block {
    /// Returns the equation of a block of reachable cells without a goal beside.
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

    /// Returns the equation of any block from the lowest bits of its masks: `reached` of the lower
    /// and the upper row, `goal` of all four rows, shifted left by one bit.
    fn partial<const PREFERRED: bool>(&self, reached: [u64; 2], goal: [u64; 4]) -> Equation {
        let mut sum = EMPTY;
        // Goals below, above, left and right of the cell in column `right` of row `upper`.
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

    /// Adds one cell's equation: 4 q against the inflow from below, above, left and right. `goals`
    /// tells which of these sides is a goal.
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

/// Adds the inflow of a cell from one side: from a goal, from the same block, or from the block on
/// that side.
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

/// Multiplies the field by the over-corrected factors and returns max |x − 1|. If `CHARGED`, goals
/// keep their values.
fn correct<const CHARGED: bool>(window: &mut Window, factors: &[f32]) -> f32 {
    let mut error = 0.0;
    let offset = window.origin.offset();
    for (y, factors) in factors.chunks_exact(FINEST).enumerate() {
        let start = window.origin.start(y);
        let [mut below, mut over] =
            [0, 1].map(|row| at(&window.reached, (2 * y + row).wrapping_sub(offset)) << offset);
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
        // Obstacles stayed zero; the factors may have scaled goals down.
        window.charge_goals();
    }
    error
}
