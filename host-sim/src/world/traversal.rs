//! Grid traversal: a straight line through square cells, one cell at a time [Amanatides87].
//!
//! `start` is in cells and `speed` in cells per metre of ray. Every crossing is computed as
//! `(edge − start) / speed` from the line itself, never as a sum. So after a jump over cells, the
//! traversal crosses the rest at the same bits.
//!
//! [Amanatides87]: J. Amanatides, A. Woo, "A fast voxel traversal algorithm for ray tracing",
//! Eurographics 1987.

/// Cells per metre; a slower ray along an axis counts as parallel to the other axis.
const PARALLEL: f64 = 1e-12;

/// A traversal at one of its cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridTraversal {
    start: [f64; 2],
    speed: [f64; 2],
    inverse: [f64; 2],
    /// The current cell.
    pub(crate) cell: [i64; 2],
    /// Metres along the ray at which the ray entered the cell.
    pub(crate) entered_m: f64,
    /// Metres along the ray at the next crossing of each axis.
    next_m: [f64; 2],
}

impl GridTraversal {
    /// Begins at `start`, in cells, with `speed` in cells per metre.
    pub(crate) fn new(start: [f64; 2], speed: [f64; 2]) -> Self {
        let mut traversal = Self {
            start,
            speed,
            inverse: speed.map(|s| 1.0 / s),
            cell: start.map(|s| s.floor() as i64),
            entered_m: 0.0,
            next_m: [0.0; 2],
        };
        traversal.next_m = [traversal.crossing(0), traversal.crossing(1)];
        traversal
    }

    #[inline(always)]
    fn crossing(&self, axis: usize) -> f64 {
        if self.speed[axis].abs() < PARALLEL {
            return f64::INFINITY;
        }
        let edge = self.cell[axis] + i64::from(self.speed[axis] > 0.0);
        (edge as f64 - self.start[axis]) * self.inverse[axis]
    }

    /// Metres along the ray at which the ray leaves the current cell.
    #[inline(always)]
    pub(crate) fn left_m(&self) -> f64 {
        self.next_m[0].min(self.next_m[1])
    }

    /// Moves to the next cell; through a corner it crosses x first.
    #[inline(always)]
    pub(crate) fn advance(&mut self) {
        let axis = usize::from(self.next_m[1] < self.next_m[0]);
        self.entered_m = self.next_m[axis];
        self.cell[axis] += if self.speed[axis] > 0.0 { 1 } else { -1 };
        self.next_m[axis] = self.crossing(axis);
    }

    /// Moves to the cell at `at_m` metres along the ray.
    #[inline(always)]
    pub(crate) fn jump(&mut self, at_m: f64) {
        self.entered_m = at_m;
        self.cell = [0, 1].map(|axis| (self.start[axis] + self.speed[axis] * at_m).floor() as i64);
        self.next_m = [self.crossing(0), self.crossing(1)];
    }
}
