//! The local window: 61 × 61 cells of the field q, their boundary and their preferences.
//!
//! Cell (x, y), 0 ≤ x, y < [`SIDE`]: x to the right, y up. A cell that is neither free nor a goal
//! is an obstacle, as is everything outside the window \[Jorge15: 61 × 61 cells\].
//!
//! Invariants: q is [`GOAL`] on goals (or their share of it), 0 on obstacles, outside, and on free
//! cells from which no goal is reachable; elsewhere 0 ≤ q ≤ `GOAL`. A new reachable cell has q = 0
//! until the solver gives it a value.
//!
//! Units: q counts from 0 to [`GOAL`]; preferences are pure numbers.

use fixed::types::I3F13;

use crate::field::multigrid::Origin;
use crate::field::runs::Runs;
use crate::grid::{self, flood};

/// Number of cells along a side of the window \[Jorge15, Table I\].
pub const SIDE: usize = 61;

/// A set of window cells as bit rows: bit x of row y is cell (x, y).
pub type Rows = [u64; SIDE];

/// The value of q on a goal: 2¹⁰⁰.
pub const GOAL: f32 = f32::from_bits((127 + 100) << 23);

/// Floats from a cell to the one above it: a row, a margin cell at each end, and a spare one.
pub(super) const STRIDE: usize = 64;

/// Floats of the field: the rows, a margin row below and above, and a spare one.
pub(super) const FLOATS: usize = STRIDE * STRIDE;

/// The bits of a row that are cells.
pub(super) const ROW: u64 = (1 << SIDE) - 1;

/// Returns the place of cell (x, y) among the floats of the field.
pub(super) const fn index(x: usize, y: usize) -> usize {
    (y + 1) * STRIDE + x + 1
}

/// The preference ε of a cell, within ±2: positive attracts, negative repels.
///
/// Within ±2 every neighbour's weight (1 ± ε/2)/4 is non-negative and the maximum principle holds;
/// beyond, the relaxation diverges \[Maffei20, §III\]. Resolution 2⁻¹³.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Preference(I3F13);

impl Preference {
    /// No preference: the cell is harmonic.
    pub const NONE: Self = Self(I3F13::ZERO);

    /// Returns the preference nearest to `epsilon`, clamped to ±2; none for NaN.
    #[must_use]
    pub fn nearest(epsilon: f32) -> Self {
        // 1.5 · 2²³: the last place of a float this large is one, so adding it rounds to the
        // nearest integer, ties to even.
        const LARGE: f32 = 12_582_912.0;
        const SCALE: f32 = (1 << I3F13::FRAC_NBITS) as f32;
        if epsilon.is_nan() {
            return Self::NONE;
        }
        let rounded = epsilon.clamp(-2.0, 2.0) * SCALE + LARGE;
        let bits = rounded.to_bits().wrapping_sub(LARGE.to_bits());
        Self(I3F13::from_bits(bits as i16))
    }

    /// Returns ε.
    #[must_use]
    pub fn get(self) -> I3F13 {
        self.0
    }

    /// Returns ε/2, the factor of the gradient term in the equation for q.
    #[inline(always)]
    pub(super) fn half(self) -> f32 {
        const SCALE: f32 = 1.0 / (1 << (I3F13::FRAC_NBITS + 1)) as f32;
        f32::from(self.0.to_bits()) * SCALE
    }
}

/// The window: 25 KB.
#[derive(Clone, Debug)]
pub struct Window {
    /// q, row by row with a border of zeros; see [`index`].
    pub(super) q: [f32; FLOATS],
    /// ε, in the same places.
    pub(super) preference: [Preference; FLOATS],
    /// Some preference is not none.
    pub(super) preferred: bool,
    /// Free cells from which a goal is reachable.
    pub(super) reached: Rows,
    /// Goal cells.
    pub(super) goal: Rows,
    /// Some goals have less than a goal's whole charge.
    pub(super) charged: bool,
    /// Some cell has a value to keep.
    pub(super) warm: bool,
    /// Rows that may hold cells far too low for the multigrid (see `seed`).
    pub(super) unraised: u64,
    /// First cell of the multigrid's next blocks.
    pub(super) origin: Origin,
}

impl Window {
    /// Returns a window of obstacles. It is all zeros, so a static one costs no flash.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            q: [0.0; FLOATS],
            preference: [Preference::NONE; FLOATS],
            preferred: false,
            reached: [0; SIDE],
            goal: [0; SIDE],
            charged: false,
            warm: false,
            unraised: 0,
            origin: Origin::Even,
        }
    }

    /// Sets a new boundary. A cell in neither set is an obstacle; a cell in both is a goal. A cell
    /// that stays free or goal keeps its value as a warm start.
    pub fn set_boundary(&mut self, free: &Rows, goal: &Rows) {
        let goal = goal.map(|row| row & ROW);
        let mut free = free.map(|row| row & ROW);
        for (free, goal) in free.iter_mut().zip(&goal) {
            *free &= !goal;
        }
        let mut reached = flood::reach(&free, &goal);
        for (row, goal) in reached.iter_mut().zip(&goal) {
            *row &= !goal;
        }
        let was_reached = core::mem::replace(&mut self.reached, reached);
        let was_goal = core::mem::replace(&mut self.goal, goal);
        let now = reached.iter().zip(&goal);
        let was = was_reached.iter().zip(&was_goal);
        for (y, ((reached, goal), (was_reached, was_goal))) in now.zip(was).enumerate() {
            let before = was_reached | was_goal;
            fill(&mut self.q, y, before & !reached, 0.0);
            if (reached & !before) | (goal & !was_goal) != 0 {
                self.touch_rows(1 << y);
            }
        }
        self.charged = false;
        self.charge_goals();
    }

    /// Gives the goal (x, y) a share of a goal's charge, from 0 to 1, until the next boundary. A
    /// cell that is no goal does not change.
    ///
    /// With shares, p has boundary values between 0 and 1 \[Maffei14, IV\].
    pub fn charge(&mut self, x: usize, y: usize, share: f32) {
        if !self.is_goal(x, y) {
            return;
        }
        if let Some(q) = self.q.get_mut(index(x, y)) {
            *q = GOAL * share.clamp(0.0, 1.0);
            self.charged = true;
        }
    }

    /// Moves the window by (dx, dy) cells over the field: cell (x, y) takes value, boundary and
    /// preference of (x + dx, y + dy). Cells that enter are obstacles until the next
    /// [`Window::set_boundary`]. It is called from two places, so it is not inlined.
    #[inline(never)]
    pub fn shift(&mut self, dx: i32, dy: i32) {
        let across = dx.unsigned_abs() as usize;
        let up = dy.unsigned_abs() as usize;
        if across >= SIDE || up >= SIDE {
            self.empty();
            return;
        }
        if self.unraised != 0 {
            self.unraised = ROW;
        }
        slide(&mut self.q, dx, dy);
        if self.preferred {
            slide(&mut self.preference, dx, dy);
        }
        for mask in [&mut self.reached, &mut self.goal] {
            let bits = |y: usize| grid::at(mask, y.wrapping_add_signed(dy as isize));
            let moved = |bits: u64| {
                if dx >= 0 {
                    bits >> across
                } else {
                    bits << across & ROW
                }
            };
            *mask = core::array::from_fn(|y| moved(bits(y)));
        }
    }

    /// Makes every cell an obstacle.
    fn empty(&mut self) {
        self.q.fill(0.0);
        self.preference.fill(Preference::NONE);
        self.preferred = false;
        for mask in [&mut self.reached, &mut self.goal] {
            mask.fill(0);
        }
        self.warm = false;
        self.unraised = 0;
        self.origin = Origin::Even;
    }

    /// Gives every cell (x, y) the preference `of(x, y)`.
    pub fn set_preferences(&mut self, mut of: impl FnMut(usize, usize) -> Preference) {
        self.change_preferences(|x, y, _| of(x, y));
    }

    /// Gives every cell (x, y) the preference `of(x, y, old)`.
    pub(crate) fn change_preferences(
        &mut self,
        mut of: impl FnMut(usize, usize, Preference) -> Preference,
    ) {
        self.preferred = false;
        let rows = self.preference.chunks_exact_mut(STRIDE).skip(1);
        for (y, row) in rows.take(SIDE).enumerate() {
            for (x, cell) in row.iter_mut().skip(1).take(SIDE).enumerate() {
                *cell = of(x, y, *cell);
                self.preferred |= *cell != Preference::NONE;
            }
        }
    }

    /// Returns the preference of cell (x, y); none outside the window.
    #[must_use]
    pub fn preference(&self, x: usize, y: usize) -> Preference {
        at(&self.preference, x, y).unwrap_or(Preference::NONE)
    }

    /// Returns q of cell (x, y), from 0 to [`GOAL`]; 0 outside the window.
    #[must_use]
    pub fn q(&self, x: usize, y: usize) -> f32 {
        at(&self.q, x, y).unwrap_or(0.0)
    }

    /// Returns true if (x, y) is a free cell from which a goal is reachable.
    #[must_use]
    pub fn is_reached(&self, x: usize, y: usize) -> bool {
        x < SIDE && self.reached.get(y).is_some_and(|row| row >> x & 1 == 1)
    }

    /// Returns true if (x, y) is a goal cell.
    #[must_use]
    pub fn is_goal(&self, x: usize, y: usize) -> bool {
        x < SIDE && self.goal.get(y).is_some_and(|row| row >> x & 1 == 1)
    }

    /// Notes that rows have changed: they and their neighbours may hold cells far too low.
    pub(super) fn touch_rows(&mut self, rows: u64) {
        self.unraised |= (rows | rows << 1 | rows >> 1) & ROW;
    }

    /// Sets q to the whole charge on the goals.
    pub(super) fn charge_goals(&mut self) {
        for (y, &goal) in self.goal.iter().enumerate() {
            fill(&mut self.q, y, goal, GOAL);
        }
    }
}

impl Default for Window {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns the item of cell (x, y); `None` outside the window.
#[inline]
fn at<T: Copy>(cells: &[T; FLOATS], x: usize, y: usize) -> Option<T> {
    if x < SIDE && y < SIDE {
        cells.get(index(x, y)).copied()
    } else {
        None
    }
}

/// Sets q on `cells` of row y.
fn fill(q: &mut [f32; FLOATS], y: usize, cells: u64, value: f32) {
    for run in Runs(cells) {
        let start = index(run.start, y);
        if let Some(run) = q.get_mut(start..start + run.len()) {
            run.fill(value);
        }
    }
}

/// Moves the items of a window so that cell (x, y) gets that of (x + dx, y + dy). Cells that enter
/// get the default.
fn slide<T: Copy + Default>(cells: &mut [T; FLOATS], dx: i32, dy: i32) {
    let (across, up) = (dx.unsigned_abs() as usize, dy.unsigned_abs() as usize);
    let by = dx + dy * STRIDE as i32;
    let distance = by.unsigned_abs() as usize;
    if by >= 0 {
        cells.copy_within(distance.., 0);
    } else {
        cells.copy_within(..FLOATS - distance, distance);
    }
    // Items that crossed an edge wrapped round to the other side, or came from a margin.
    let nothing = T::default();
    let (rows, _) = cells.as_chunks_mut::<STRIDE>();
    let (incoming, outgoing) = if dx >= 0 { (across, 0) } else { (0, across) };
    for row in rows.iter_mut() {
        row.iter_mut()
            .take(outgoing + 1)
            .for_each(|cell| *cell = nothing);
        row.iter_mut()
            .skip(SIDE + 1 - incoming)
            .for_each(|cell| *cell = nothing);
    }
    let (incoming, outgoing) = if dy >= 0 { (up, 0) } else { (0, up) };
    let empty = [nothing; STRIDE];
    rows.iter_mut()
        .take(outgoing + 1)
        .for_each(|row| *row = empty);
    rows.iter_mut()
        .skip(SIDE + 1 - incoming)
        .for_each(|row| *row = empty);
}

#[cfg(test)]
mod tests {
    use super::{GOAL, Preference, SIDE, Window, fill};

    #[test]
    fn a_preference_keeps_within_two() {
        for epsilon in [2.0, 2.001, 1e9] {
            assert_eq!(Preference::nearest(epsilon).get(), 2);
            assert_eq!(Preference::nearest(-epsilon).get(), -2);
        }
        assert_eq!(Preference::nearest(f32::NEG_INFINITY).get(), -2);
        assert_eq!(Preference::nearest(f32::NAN), Preference::NONE);
        assert_eq!(Preference::nearest(0.5).half(), 0.25);
    }

    #[test]
    fn a_new_boundary_keeps_what_stays_and_clears_what_left() {
        let row = |bits: u64| {
            let mut rows = [0; SIDE];
            rows[3] = bits;
            rows
        };
        let mut window = Window::new();
        window.set_boundary(&row(0b001_1110), &row(0b000_0001));
        // As if solved.
        fill(&mut window.q, 3, 0b001_1110, 7.0);

        // Cell 1 stays, 2 becomes the goal, 3 and 4 obstacles, 0 free, 5 new and out of reach.
        window.set_boundary(&row(0b010_0011), &row(0b000_0100));
        let q = core::array::from_fn(|x| window.q(x, 3));
        assert_eq!(q, [GOAL, 7.0, GOAL, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(window.reached[3], 0b000_0011);
    }

    /// A hall between a goal of the whole charge and one of a quarter: both methods find the same
    /// field, between the two.
    #[test]
    fn goals_keep_the_share_that_they_are_charged_with() {
        use crate::field::{Method, SCRATCH_FLOATS, SolverConfig, solve};

        let solved = |method| {
            let (mut free, mut goal) = ([0; SIDE], [0; SIDE]);
            for row in &mut free[2..40] {
                *row = 0x0fff_fffc;
            }
            goal[20] = 1 << 3 | 1 << 24;
            let mut window = Window::new();
            window.set_boundary(&free, &goal);
            window.charge(24, 20, 0.25);
            window.charge(10, 10, 0.5);
            let config = SolverConfig {
                max_cycles: 500,
                tolerance: 1e-4,
                method,
            };
            let scratch = &mut [0.0; SCRATCH_FLOATS];
            solve(&mut window, scratch, &config);
            window
        };
        let [fast, slow] = [Method::Multigrid, Method::GaussSeidel].map(solved);
        for (x, y) in (2..28).flat_map(|x| (2..40).map(move |y| (x, y))) {
            let (a, b) = (fast.q(x, y), slow.q(x, y));
            assert!((a - b).abs() <= 0.01 * b, "({x}, {y}): {a} {b}");
            assert!(a > 0.0 && (a < GOAL || (x, y) == (3, 20)));
        }
        assert_eq!([fast.q(3, 20), fast.q(24, 20)], [GOAL, 0.25 * GOAL]);
        assert!(
            fast.q(23, 20) < 0.25 * GOAL,
            "the walls are nearer than the other goal"
        );
        assert!(!fast.is_goal(10, 10), "what is no goal is not charged");

        // The next boundary has whole goals again.
        let (free, goal) = ([0; SIDE], fast.goal);
        let mut next = fast;
        next.set_boundary(&free, &goal);
        assert_eq!(next.q(24, 20), GOAL);
    }
}
