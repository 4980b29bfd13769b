//! The elevation window: 64 × 64 cells around the robot, each with the running mean of the heights measured in it.
//!
//! ```text
//! h ← h + (z − h) / n,    n = min(measurements so far, MOST_COUNT)          [Maffei-Terrain, III-B]
//! ```
//!
//! A height is an [`I7F9`]: ±64 m around the start in steps of 2 mm. Beside it lies a byte of marks: how often the cell was
//! measured, how sure it is that something stands in it, and whether the ground seems to be gone. Of a cell never measured the height says
//! whether that is suspected. Ground met from too far off to be measured is glimpsed: it has a height of its own kind, counted and marked at
//! once, which denies that the ground is gone and gives way to the first that is measured.
//!
//! The window owns no memory. A session on flat ground has no use for it, and one on uneven ground none for the counts of
//! [`crate::map::Evidence`], so the heights lie in the latter's 8 KB and the marks in the last tiles of the map's pool.
//!
//! Invariant: a slot belongs to exactly one cell of the window (cell mod 64), and strips that enter are cleared.
//! Units: map cells, metres above the start.

use fixed::types::I7F9;

use crate::geometry::Cell;

/// Cells along the window's side.
pub const WINDOW_SIDE: i32 = 64;
/// Cells of the window.
pub const WINDOW_CELLS: usize = (WINDOW_SIDE * WINDOW_SIDE) as usize;
/// Measurements that a mean remembers.
const MOST_COUNT: u8 = 15;
/// What is farther off a mean, in steps of a height, may be false: 0.15 m.
const OUTLIER: i32 = I7F9::lit("0.15").to_bits() as i32;
/// Bits of the count.
const COUNT: u8 = 0x0f;
/// Bits of what stands.
const STANDING: u8 = 0x70;
/// One hit of something that stands.
const ONE_STANDING: u8 = 0x10;
/// The ground seems to be gone; with a count, the height is but glimpsed.
const SUNKEN: u8 = 0x80;
/// Hits from which on something stands there: fewer are false returns.
const SURE: u8 = 3;

/// What is known of the ground of a cell, if anything is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// Measured, metres.
    At(f32),
    /// Never measured, and held to be gone.
    Doubtful,
    /// Seen to be gone, or something stands on it.
    Blocked,
}

/// The window, for reading.
#[derive(Clone, Copy, Debug)]
pub struct Heights<'a> {
    heights: &'a [[u8; 2]],
    marks: &'a [u8],
    /// Its least cell.
    origin: Cell,
}

/// The window.
#[derive(Debug)]
pub struct Elevation<'a> {
    heights: &'a mut [[u8; 2]],
    marks: &'a mut [u8],
    origin: &'a mut Cell,
}

/// Whether a mark is of a height that is but glimpsed.
#[inline(always)]
const fn is_glimpse(mark: u8) -> bool {
    mark & SUNKEN != 0 && mark & COUNT != 0
}

/// How often a cell of this mark was measured.
#[inline(always)]
const fn measured(mark: u8) -> u8 {
    if is_glimpse(mark) { 0 } else { mark & COUNT }
}

/// Where a cell of the window at `origin` is stored; `None` outside of it.
#[inline(always)]
const fn slot(origin: Cell, cell: Cell) -> Option<usize> {
    let (x, y) = (cell.x - origin.x, cell.y - origin.y);
    // One comparison for both ends of each.
    if (x as u32) < WINDOW_SIDE as u32 && (y as u32) < WINDOW_SIDE as u32 {
        Some(((cell.y & (WINDOW_SIDE - 1)) * WINDOW_SIDE + (cell.x & (WINDOW_SIDE - 1))) as usize)
    } else {
        None
    }
}

impl<'a> Heights<'a> {
    /// A window whose least cell is `origin`, over memory for [`WINDOW_CELLS`] cells; what is missing was never measured.
    #[must_use]
    pub fn new(heights: &'a [u8], marks: &'a [u8], origin: Cell) -> Self {
        let (heights, _) = heights.as_chunks();
        Self {
            heights,
            marks,
            origin,
        }
    }

    /// Its least cell.
    #[must_use]
    pub const fn origin(&self) -> Cell {
        self.origin
    }

    #[inline(always)]
    fn mark(&self, slot: usize) -> u8 {
        self.marks.get(slot).copied().unwrap_or(0)
    }

    /// The stored height of a cell; `None` where none was measured.
    #[inline(always)]
    #[must_use]
    pub fn fixed(&self, cell: Cell) -> Option<I7F9> {
        let slot = slot(self.origin, cell)?;
        if measured(self.mark(slot)) == 0 {
            return None;
        }
        Some(I7F9::from_le_bytes(*self.heights.get(slot)?))
    }

    /// The mean height of a cell, metres; `None` where none was measured.
    #[inline(always)]
    #[must_use]
    pub fn height_m(&self, cell: Cell) -> Option<f32> {
        self.fixed(cell).map(metres)
    }

    /// The mean height of a cell that was glimpsed and never measured, metres.
    #[must_use]
    pub fn glimpse_m(&self, cell: Cell) -> Option<f32> {
        let slot = slot(self.origin, cell).filter(|&slot| is_glimpse(self.mark(slot)))?;
        Some(metres(I7F9::from_le_bytes(*self.heights.get(slot)?)))
    }

    /// What is known of a cell's ground: `None` where it was never measured.
    #[inline(always)]
    #[must_use]
    pub fn ground(&self, cell: Cell) -> Option<Ground> {
        let slot = slot(self.origin, cell)?;
        let mark = self.mark(slot);
        if mark == 0 {
            return None;
        }
        let stored = *self.heights.get(slot)?;
        if mark & STANDING >= SURE * ONE_STANDING {
            Some(Ground::Blocked)
        } else if mark & (COUNT | SUNKEN) == SUNKEN {
            Some(if stored == SUSPECT {
                Ground::Doubtful
            } else {
                Ground::Blocked
            })
        } else {
            (measured(mark) > 0).then(|| Ground::At(metres(I7F9::from_le_bytes(stored))))
        }
    }

    /// How often a cell was measured, up to 15.
    #[must_use]
    pub fn count(&self, cell: Cell) -> u8 {
        slot(self.origin, cell).map_or(0, |slot| measured(self.mark(slot)))
    }

    /// Whether something stands in a cell.
    #[must_use]
    pub fn is_standing(&self, cell: Cell) -> bool {
        slot(self.origin, cell)
            .is_some_and(|slot| self.mark(slot) & STANDING >= SURE * ONE_STANDING)
    }

    /// Whether the ground of a cell seems to be gone.
    #[must_use]
    pub fn is_sunken(&self, cell: Cell) -> bool {
        slot(self.origin, cell).is_some_and(|slot| self.mark(slot) & (COUNT | SUNKEN) == SUNKEN)
    }

    /// Whether nothing was ever met in a cell, and of the eight around one seems to be gone and one is measured.
    #[must_use]
    pub fn is_on_a_rim(&self, cell: Cell) -> bool {
        let around = || {
            (-1..=1)
                .flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)))
                .map(|(dx, dy)| Cell {
                    x: cell.x + dx,
                    y: cell.y + dy,
                })
        };
        slot(self.origin, cell).is_some_and(|slot| self.mark(slot) == 0)
            && around().any(|near| self.is_sunken(near))
            && around().any(|near| self.count(near) > 0)
    }

    /// Whether the ground of a cell never measured is suspected to be gone, and not yet believed to be.
    #[must_use]
    pub fn is_suspect(&self, cell: Cell) -> bool {
        slot(self.origin, cell).is_some_and(|slot| {
            self.mark(slot) & (COUNT | SUNKEN) == 0 && self.heights.get(slot) == Some(&SUSPECT)
        })
    }
}

/// What the height of a cell never measured says if its ground is suspected to be gone; nothing else is ever stored there.
const SUSPECT: [u8; 2] = [1, 0];

/// A stored height in metres.
#[inline(always)]
#[must_use]
pub fn metres(height: I7F9) -> f32 {
    const STEP_M: f32 = 1.0 / (1 << I7F9::FRAC_NBITS) as f32;
    f32::from(height.to_bits()) * STEP_M
}

impl<'a> Elevation<'a> {
    /// The window over memory for [`WINDOW_CELLS`] cells, all zeros at first.
    #[must_use]
    pub fn new(heights: &'a mut [u8], marks: &'a mut [u8], origin: &'a mut Cell) -> Self {
        let (heights, _) = heights.as_chunks_mut();
        Self {
            heights,
            marks,
            origin,
        }
    }

    /// The window, for reading.
    #[inline(always)]
    #[must_use]
    pub fn read(&self) -> Heights<'_> {
        Heights {
            heights: self.heights,
            marks: self.marks,
            origin: *self.origin,
        }
    }

    /// Keep the window around `centre`; nothing is known of cells that enter.
    pub fn follow(&mut self, centre: Cell) {
        let half = WINDOW_SIDE / 2;
        let next = Cell {
            x: centre.x - half,
            y: centre.y - half,
        };
        let old = core::mem::replace(self.origin, next);
        let (dx, dy) = (next.x - old.x, next.y - old.y);
        if dx.abs() >= WINDOW_SIDE || dy.abs() >= WINDOW_SIDE {
            self.marks.fill(0);
            self.heights.fill([0; 2]);
            return;
        }
        let entering = |from: i32, to: i32| {
            if to > from {
                from + WINDOW_SIDE..to + WINDOW_SIDE
            } else {
                to..from
            }
        };
        for y in entering(old.y, next.y) {
            for x in next.x..next.x + WINDOW_SIDE {
                self.clear(Cell { x, y });
            }
        }
        for x in entering(old.x, next.x) {
            for y in next.y..next.y + WINDOW_SIDE {
                self.clear(Cell { x, y });
            }
        }
    }

    fn mark_mut(&mut self, cell: Cell) -> Option<&mut u8> {
        self.marks.get_mut(slot(*self.origin, cell)?)
    }

    fn clear(&mut self, cell: Cell) {
        let Some(slot) = slot(*self.origin, cell) else {
            return;
        };
        if let (Some(mark), Some(stored)) = (self.marks.get_mut(slot), self.heights.get_mut(slot)) {
            (*mark, *stored) = (0, [0; 2]);
        }
    }

    /// Ground was measured in a cell: into its mean. What is far off the mean is left out, for it may be a false return; but then the mean
    /// counts for less, until it gives way, and where there was but one before, the lower one stays. Then the ground is not gone, and what stands there stands less surely. Outside the
    /// window nothing happens.
    pub fn measure(&mut self, cell: Cell, height_m: f32) {
        self.forget_glimpse(cell);
        self.average(cell, height_m);
    }

    /// Ground was met in a cell from too far off to measure it: into the mean of such, if it was never measured.
    pub fn glimpse(&mut self, cell: Cell, height_m: f32) {
        if self.read().count(cell) > 0 {
            return;
        }
        self.average(cell, height_m);
        if let Some(mark) = self.mark_mut(cell) {
            *mark |= SUNKEN;
        }
    }

    /// What was but glimpsed gives way.
    fn forget_glimpse(&mut self, cell: Cell) {
        if let Some(mark) = self.mark_mut(cell)
            && is_glimpse(*mark)
        {
            *mark &= STANDING;
        }
    }

    /// A height into the mean of a cell.
    fn average(&mut self, cell: Cell, height_m: f32) {
        let Some(slot) = slot(*self.origin, cell) else {
            return;
        };
        let (Some(mark), Some(stored)) = (self.marks.get_mut(slot), self.heights.get_mut(slot))
        else {
            return;
        };
        let count = (*mark & COUNT).saturating_add(1).min(MOST_COUNT);
        let height = I7F9::saturating_from_num(if height_m.is_nan() { 0.0 } else { height_m });
        let mean = i32::from(if count == 1 {
            height.to_bits()
        } else {
            I7F9::from_le_bytes(*stored).to_bits()
        });
        let off = i32::from(height.to_bits()) - mean;
        let n = i32::from(count);
        if off.abs() > OUTLIER {
            *mark = *mark & !COUNT | count.saturating_sub(2).max(1);
            if count == 2 && off < 0 {
                *stored = height.to_le_bytes();
            }
            return;
        }
        // Rounded to nearest, so that a mean does not creep downwards.
        let mean = mean + (2 * off + n).div_euclid(2 * n);
        *stored = I7F9::from_bits(mean as i16).to_le_bytes();
        let standing = (*mark & STANDING).saturating_sub(ONE_STANDING) & STANDING;
        *mark = standing | count;
    }

    /// Something was met that stands in a cell.
    pub fn stand(&mut self, cell: Cell) {
        self.forget_glimpse(cell);
        if let Some(mark) = self.mark_mut(cell) {
            let standing = (*mark & STANDING).saturating_add(2 * ONE_STANDING);
            *mark = *mark & COUNT | standing.min(STANDING);
        }
    }

    /// The ground of a cell that was never measured was seen to be gone.
    pub fn sink(&mut self, cell: Cell) {
        self.doubt(cell, SUNKEN, [0; 2]);
    }

    /// The ground of a cell that was never measured may be gone.
    pub fn suspect(&mut self, cell: Cell) {
        if !self.read().is_sunken(cell) {
            self.doubt(cell, 0, SUSPECT);
        }
    }

    /// Ground that was suspected to be gone, or lies beside such, is held to be.
    pub fn presume(&mut self, cell: Cell) {
        if !self.read().is_sunken(cell) {
            self.doubt(cell, SUNKEN, SUSPECT);
        }
    }

    /// What is said of a cell where no ground was ever met.
    fn doubt(&mut self, cell: Cell, mark: u8, stored: [u8; 2]) {
        if let Some(slot) = slot(*self.origin, cell)
            && let (Some(of_cell), Some(height)) =
                (self.marks.get_mut(slot), self.heights.get_mut(slot))
            && *of_cell & COUNT == 0
        {
            *of_cell |= mark;
            *height = stored;
        }
    }

    /// The robot stands on a cell.
    pub fn tread(&mut self, cell: Cell, height_m: f32) {
        self.forget_glimpse(cell);
        if let Some(mark) = self.mark_mut(cell) {
            *mark &= COUNT;
        }
        self.measure(cell, height_m);
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::{Elevation, Heights, WINDOW_CELLS};
    use crate::geometry::Cell;

    struct Bench {
        heights: Box<[u8]>,
        marks: Box<[u8]>,
        origin: Cell,
    }

    impl Bench {
        fn new() -> Self {
            Self {
                heights: std::vec![0; 2 * WINDOW_CELLS].into(),
                marks: std::vec![0; WINDOW_CELLS].into(),
                origin: Cell::default(),
            }
        }

        fn window(&mut self) -> Elevation<'_> {
            Elevation::new(&mut self.heights, &mut self.marks, &mut self.origin)
        }

        fn read(&self) -> Heights<'_> {
            Heights::new(&self.heights, &self.marks, self.origin)
        }
    }

    const CELL: Cell = Cell { x: -3, y: 7 };

    fn around_zero() -> Bench {
        let mut bench = Bench::new();
        bench.window().follow(Cell::default());
        bench
    }

    #[test]
    fn a_mean_is_the_mean() {
        let mut bench = around_zero();
        let (mut sum, mut count) = (0.0, 0.0);
        for z_m in [-1.30_f32, -1.26, -1.31, -1.25, -1.28, -1.24, -1.33] {
            bench.window().measure(CELL, z_m);
            (sum, count) = (sum + f64::from(z_m), count + 1.0);
            let mean = f64::from(bench.read().height_m(CELL).expect("measured"));
            // Every mean before may have been rounded by half a step of 2 mm.
            assert!((mean - sum / count).abs() < 0.002, "{mean}");
        }
        assert_eq!(bench.read().count(CELL), 7);
        assert_eq!(bench.read().height_m(Cell { x: 7, y: -3 }), None);
    }

    #[test]
    fn one_false_height_changes_nothing_and_many_are_believed() {
        let mut bench = around_zero();
        for _ in 0..4 {
            bench.window().measure(CELL, 0.5);
        }
        bench.window().measure(CELL, 0.9);
        assert_eq!(bench.read().height_m(CELL), Some(0.5));
        // Of two that differ the lower one stays: a beam may meet something above the ground, but nothing below it.
        let other = Cell { x: 0, y: 0 };
        bench.window().measure(other, 0.9);
        bench.window().measure(other, 0.5);
        assert_eq!(bench.read().height_m(other), Some(0.5));
    }

    #[test]
    fn what_leaves_the_window_is_forgotten_and_the_rest_stays() {
        let mut bench = around_zero();
        for k in -31..31 {
            bench.window().measure(Cell { x: k, y: k }, 0.01 * k as f32);
        }
        for (dx, dy) in [(3, 0), (-5, 9), (0, -20), (-2, 2)] {
            let at = bench.origin;
            let before: std::vec::Vec<_> = (-31..31)
                .map(|k| bench.read().height_m(Cell { x: k, y: k }))
                .collect();
            let centre = Cell {
                x: at.x + 32 + dx,
                y: at.y + 32 + dy,
            };
            bench.window().follow(centre);
            for (k, before) in (-31..31).zip(before) {
                let inside = (k - centre.x + 32) as u32 <= 63 && (k - centre.y + 32) as u32 <= 63;
                let expected = before.filter(|_| inside);
                assert_eq!(bench.read().height_m(Cell { x: k, y: k }), expected, "{k}");
            }
        }
        bench.window().follow(Cell { x: 500, y: -9 });
        assert!((-31..31).all(|k| bench.read().count(Cell { x: k, y: k }) == 0));
    }

    #[test]
    fn a_suspicion_ends_with_a_height_and_with_the_window() {
        let mut bench = around_zero();
        bench.window().suspect(CELL);
        assert!(bench.read().is_suspect(CELL) && !bench.read().is_sunken(CELL));
        assert_eq!(bench.read().height_m(CELL), None);
        bench.window().measure(CELL, 0.25);
        bench.window().suspect(CELL);
        assert!(!bench.read().is_suspect(CELL));
        assert_eq!(bench.read().height_m(CELL), Some(0.25));
        let other = Cell { x: -30, y: 2 };
        bench.window().suspect(other);
        bench.window().follow(Cell { x: 9, y: 0 });
        bench.window().follow(Cell { x: 0, y: 0 });
        assert!(!bench.read().is_suspect(other));
        bench.window().suspect(other);
        bench.window().sink(other);
        assert!(!bench.read().is_suspect(other), "it is sure now");
    }

    #[test]
    fn a_glimpse_denies_that_ground_is_gone_and_is_no_height() {
        let mut bench = around_zero();
        bench.window().sink(CELL);
        bench.window().glimpse(CELL, -0.5);
        bench.window().glimpse(CELL, -0.4);
        bench.window().sink(CELL);
        bench.window().suspect(CELL);
        assert!(!bench.read().is_sunken(CELL) && !bench.read().is_suspect(CELL));
        let glimpse_m = bench.read().glimpse_m(CELL).expect("glimpsed");
        assert!((glimpse_m + 0.45).abs() < 0.002, "{glimpse_m}");
        assert_eq!(bench.read().height_m(CELL), None);
        assert_eq!(bench.read().count(CELL), 0);
        // The first measured height counts alone, and later glimpses not at all.
        bench.window().measure(CELL, 0.25);
        bench.window().glimpse(CELL, 0.5);
        assert_eq!(bench.read().height_m(CELL), Some(0.25));
        assert_eq!(bench.read().count(CELL), 1);
        assert_eq!(bench.read().glimpse_m(CELL), None);
    }

    #[test]
    fn what_stands_or_is_stood_on_was_not_glimpsed() {
        let mut bench = around_zero();
        bench.window().glimpse(CELL, 0.0);
        bench.window().stand(CELL);
        bench.window().stand(CELL);
        assert!(bench.read().is_standing(CELL));
        assert_eq!(bench.read().height_m(CELL), None);
        bench.window().glimpse(CELL, 0.0);
        bench.window().tread(CELL, 0.125);
        assert_eq!(bench.read().height_m(CELL), Some(0.125));
        assert!(!bench.read().is_standing(CELL));
    }

    #[test]
    fn marks_come_and_go() {
        let mut bench = around_zero();
        bench.window().sink(CELL);
        assert!(bench.read().is_sunken(CELL));
        // Measured ground is not gone, and cannot be said to be.
        bench.window().measure(CELL, 0.0);
        bench.window().sink(CELL);
        assert!(!bench.read().is_sunken(CELL));
        bench.window().stand(CELL);
        assert!(
            !bench.read().is_standing(CELL),
            "once may be a false return"
        );
        bench.window().stand(CELL);
        assert!(bench.read().is_standing(CELL));
        for _ in 0..2 {
            bench.window().measure(CELL, 0.0);
        }
        assert!(!bench.read().is_standing(CELL));
    }
}
