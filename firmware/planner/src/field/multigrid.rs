//! One multigrid cycle: correct the field by factors constant over 2 × 2 cells, then smooth it by one sweep.
//!
//! ```text
//! equations ← the cells' equations summed over blocks, |N − S| and |W − E| with their present signs     (Picard)
//! x         ← the blocks' factors, by a W cycle over 31-16-8-4-2 blocks a side                        (pyramid)
//! q         ← min(q (1 + 1.5 (x − 1)), GOAL)
//! q         ← one Gauss–Seidel sweep
//! ```
//!
//! A cell's equation is taken four times over: 4 q = Σ w q_k with w = 1 ± ε/2, plus for the greater of two opposite
//! neighbours. The blocks' origin alternates between cycles, so that no wall stays inside the same blocks.
//!
//! Invariant: 0 ≤ q ≤ GOAL. A cycle's cost hardly depends on the field's values.

use super::gauss_seidel;
use super::pyramid::{
    self, EAST, EMPTY, Equation, FINEST, NORTH, OUT, Pyramid, SOURCE, SOUTH, WEST,
};
use super::window::{GOAL, Preference, SIDE, STRIDE, Window};

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
/// No reached cell may be blank.
pub(super) fn cycle(window: &mut Window, scratch: &mut [f32; SCRATCH_FLOATS]) -> f32 {
    let mut pyramid = Pyramid::new(scratch);
    if window.preferred {
        assemble::<true>(window, pyramid.equations());
    } else {
        // Tilts of zero: leaving them out gives the same bits.
        assemble::<false>(window, pyramid.equations());
    }
    pyramid.solve();
    let error = correct(window, pyramid.factors());
    gauss_seidel::sweep(window);
    window.origin = window.origin.other();
    error
}

/// Sum the cells' equations over the finest blocks.
fn assemble<const PREFERRED: bool>(window: &Window, equations: &mut [Equation]) {
    for (y, equations) in equations.chunks_exact_mut(FINEST).enumerate() {
        let row = BlockRow::new(window, y);
        let mut reached = row.reached;
        let mut beside_goal = row.beside_goal();
        for (x, equation) in equations.iter_mut().enumerate() {
            *equation = EMPTY;
            if (reached[0] | reached[1]) & 0b11 != 0 {
                let goals = if beside_goal & 0b11 == 0 {
                    None
                } else {
                    Some(&row.goal)
                };
                for (upper, right) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    if reached[upper] >> right & 1 == 1 {
                        row.add_cell::<PREFERRED>(equation, goals, x, upper, right);
                    }
                }
                pyramid::bound_outflow(equation);
            }
            reached = reached.map(|bits| bits >> 2);
            beside_goal >>= 2;
        }
    }
}

/// Two rows of cells and those below and above them, aligned so that block X has columns 2X and 2X + 1.
struct BlockRow<'a> {
    /// The row below, the lower one, the upper one, the row above.
    q: [&'a Pairs<f32>; 4],
    /// Goals in those rows.
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
        // Rows in units from the window's lowest margin; rows beyond the margins are nobody's neighbours.
        let mask = |rows: &[u64; SIDE], row: usize| {
            let inside = (2 * y + row).checked_sub(1 + offset);
            inside
                .and_then(|row| rows.get(row))
                .map_or(0, |bits| bits << offset)
        };
        let q = |row: usize| {
            pairs(
                &window.q,
                (start + row * STRIDE).checked_sub(STRIDE),
                &[[0.0; 2]; 32],
            )
        };
        let preference = |row: usize| {
            pairs(
                &window.preference,
                Some(start + row * STRIDE),
                &[[Preference::NONE; 2]; 32],
            )
        };
        Self {
            q: [q(0), q(1), q(2), q(3)],
            goal: [0, 1, 2, 3].map(|row| mask(&window.goal, row)),
            preference: [preference(0), preference(1)],
            reached: [1, 2].map(|row| mask(&window.reached, row)),
        }
    }

    /// Columns with a cell beside a goal in either row.
    fn beside_goal(&self) -> u64 {
        let [south, lower, upper, north] = self.goal;
        let beside_lower = south | upper | lower << 1 | lower >> 1;
        let beside_upper = lower | north | upper << 1 | upper >> 1;
        (self.reached[0] & beside_lower) | (self.reached[1] & beside_upper)
    }

    /// Add the equation of block x's cell in the (`upper`, `right`) corner. `goals` may be left out where none is near.
    #[inline(always)]
    fn add_cell<const PREFERRED: bool>(
        &self,
        equation: &mut Equation,
        goals: Option<&[u64; 4]>,
        x: usize,
        upper: usize,
        right: usize,
    ) {
        let [below, row, above] = [self.q[upper], self.q[upper + 1], self.q[upper + 2]];
        let (south, north) = (below[x][right], above[x][right]);
        let west = if right == 1 {
            row[x][0]
        } else if x > 0 {
            row[x - 1][1]
        } else {
            0.0
        };
        let east = if right == 0 { row[x][1] } else { row[x + 1][0] };
        let mut inflow = [south, north, west, east];
        if PREFERRED {
            let half = self.preference[upper][x][right].half();
            let upright = if north >= south { half } else { -half };
            let level = if west >= east { half } else { -half };
            inflow[0] -= upright * south;
            inflow[1] += upright * north;
            inflow[2] += level * west;
            inflow[3] -= level * east;
        }
        // Out of the block on this corner's two sides, and across the block on the two others.
        let outer = [upper == 0, upper == 1, right == 0, right == 1];
        equation[OUT] += 4.0 * row[x][right];
        for (side, towards) in [SOUTH, NORTH, WEST, EAST].into_iter().enumerate() {
            let is_goal = goals.is_some_and(|goals| {
                let bit = 2 * x + right;
                let bits = [
                    goals[upper],
                    goals[upper + 2],
                    goals[upper + 1] << 1,
                    goals[upper + 1] >> 1,
                ];
                bits[side] >> bit & 1 == 1
            });
            if is_goal {
                equation[SOURCE] += inflow[side];
            } else if outer[side] {
                equation[towards] += inflow[side];
            } else {
                equation[OUT] -= inflow[side];
            }
        }
    }
}

/// The row that starts at `start`, or `outside` if there is no such row.
fn pairs<'a, T>(cells: &'a [T], start: Option<usize>, outside: &'a Pairs<T>) -> &'a Pairs<T> {
    let row = start.and_then(|start| cells.get(start..));
    row.and_then(|row| row.as_chunks().0.first_chunk())
        .unwrap_or(outside)
}

/// Multiply the field by the over-corrected factors. Answers max |x − 1|.
fn correct(window: &mut Window, factors: &[f32]) -> f32 {
    let mut error = 0.0;
    for (y, factors) in factors.chunks_exact(FINEST).enumerate() {
        let start = window.origin.start(y);
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
            for q in [a, b, c, d] {
                *q *= factor;
                if factor > 1.0 && *q > GOAL {
                    *q = GOAL;
                }
            }
        }
    }
    // Obstacles stayed zero; goals may have been scaled down.
    window.charge_goals();
    error
}
