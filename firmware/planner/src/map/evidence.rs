//! Evidence for and against an obstacle, in a rolling window of 128 × 128 cells around the robot.
//!
//! ```text
//! count = 0                                no evidence yet
//! hit:   count ← min(count + 3, 15)        pass:  count ← max(count − 1, 1)
//! class = obstacle if count ≥ 10, free if count ≤ 7, else as before (hysteresis)
//!         an obstacle where the cell was free has come (`arrivals`)
//! ```
//!
//! A free cell that beams passed often (count 1) needs three hits to become an obstacle, so a
//! single false echo blocks no passage. A wall (count 15) needs eight passes to become free.
//! Outside the window a cell keeps its first class until the robot comes near.
//!
//! Invariant: every cell of the window has a slot of its own ([`Rolling`]), and cells that enter
//! have no evidence.
//! Units: map cells.

use crate::config::MapTuning;
use crate::geometry::Cell;
use crate::grid::{Class, Rolling, masked_mut, wrapped_mut};
use crate::map::arrivals::came;
use crate::map::tiles::TILE_SIDE;

/// Cells along the window's side.
pub(crate) const EVIDENCE_SIDE: i32 = 128;
/// The window moves in steps of this many cells, so that it moves seldom.
const STRIDE: i32 = 16;

/// Greatest count: all that four bits hold.
const MAX_COUNT: u8 = 15;

type Window = Rolling<EVIDENCE_SIDE, STRIDE>;

/// The rolling window of counts.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Evidence {
    /// Two cells per byte, row by row.
    counts: [[u8; EVIDENCE_SIDE as usize / 2]; EVIDENCE_SIDE as usize],
    /// The window's least cell, a multiple of [`STRIDE`].
    origin: Cell,
}

/// Returns the count that a cell of this class starts with.
fn initial(class: Class, tuning: &MapTuning) -> u8 {
    let start = match class {
        Class::Unknown => tuning.unknown_start,
        Class::Free => tuning.free_start,
        Class::Obstacle | Class::Negative => tuning.obstacle_start,
    };
    start.min(MAX_COUNT)
}

impl Evidence {
    /// Creates a window without evidence.
    pub(crate) const fn new() -> Self {
        Self {
            counts: [[0; EVIDENCE_SIDE as usize / 2]; EVIDENCE_SIDE as usize],
            origin: Cell { x: 0, y: 0 },
        }
    }

    /// Clears the window and moves it to `centre`.
    pub(crate) fn reset(&mut self, centre: Cell) {
        self.counts.as_flattened_mut().fill(0);
        self.origin = Window::origin(centre);
    }

    /// Returns the memory of the counts, which the elevation window uses on uneven ground.
    pub(super) fn bytes(&self) -> &[u8] {
        self.counts.as_flattened()
    }

    /// Returns the memory of the counts, which the elevation window uses on uneven ground.
    pub(super) fn bytes_mut(&mut self) -> &mut [u8] {
        self.counts.as_flattened_mut()
    }

    /// Moves the window to `centre`. Cells that enter have no evidence.
    pub(crate) fn follow(&mut self, centre: Cell) {
        let from = core::mem::replace(&mut self.origin, Window::origin(centre));
        let Some([columns, rows]) = Window::entering(from, self.origin) else {
            self.counts.as_flattened_mut().fill(0);
            return;
        };
        for y in rows {
            wrapped_mut(&mut self.counts, y as usize).fill(0);
        }
        for row in &mut self.counts {
            for x in columns.clone().step_by(2) {
                *wrapped_mut(row, (x & (EVIDENCE_SIDE - 1)) as usize / 2) = 0;
            }
        }
    }

    /// Returns true if the window covers the cell.
    pub(crate) const fn covers(&self, cell: Cell) -> bool {
        Window::covers(self.origin, cell)
    }

    /// Returns the byte that holds a cell's count, and the count's shift in it.
    #[inline(always)]
    const fn pair(&mut self, cell: Cell) -> (&mut u8, i32) {
        let row = wrapped_mut(&mut self.counts, cell.y as usize);
        let column = (cell.x & (EVIDENCE_SIDE - 1)) as usize;
        (masked_mut(row, column / 2), (cell.x & 1) * 4)
    }

    #[inline(always)]
    fn update(
        &mut self,
        cell: Cell,
        class: Class,
        tuning: &MapTuning,
        change: impl Fn(u8) -> u8,
    ) -> Class {
        let (pair, shift) = self.pair(cell);
        let count = match *pair >> shift & 15 {
            0 => initial(class, tuning),
            count => count,
        };
        let count = change(count);
        *pair = *pair & !(15 << shift) | count << shift;
        if count >= tuning.obstacle_count {
            came(class)
        } else if count <= tuning.free_count {
            Class::Free
        } else {
            class
        }
    }

    /// Counts a beam that ended in this cell, whose class was `class`. Returns its class now.
    pub(crate) fn hit(&mut self, cell: Cell, class: Class, tuning: &MapTuning) -> Class {
        let raised = |count: u8| (count + tuning.hit_count).min(MAX_COUNT);
        self.update(cell, class, tuning, raised)
    }

    /// Counts a beam that passed this cell, whose class was `class`. Returns its class now.
    pub(crate) fn pass(&mut self, cell: Cell, class: Class, tuning: &MapTuning) -> Class {
        let lowered = |count: u8| count.saturating_sub(1).max(1);
        self.update(cell, class, tuning, lowered)
    }

    /// Forgets the evidence for a cell. Its next count starts from its class, as at the window's
    /// edge.
    pub(crate) fn forget(&mut self, cell: Cell) {
        if self.covers(cell) {
            let (pair, shift) = self.pair(cell);
            *pair &= !(15 << shift);
        }
    }

    /// Forgets the evidence for the cells of a tile.
    pub(super) fn forget_tile(&mut self, (column, row): (i32, i32)) {
        let of = |tile: i32, origin: i32| {
            let least = tile * TILE_SIDE;
            least.max(origin)..(least + TILE_SIDE).min(origin + EVIDENCE_SIDE)
        };
        // A tile's columns are not parted by the window's edge in memory.
        let columns = of(column, self.origin.x);
        let first = (columns.start & (EVIDENCE_SIDE - 1)) as usize / 2;
        let pairs = first..first + columns.len() / 2;
        for y in of(row, self.origin.y) {
            let counts = wrapped_mut(&mut self.counts, y as usize);
            if let Some(counts) = counts.get_mut(pairs.clone()) {
                counts.fill(0);
            }
        }
    }

    /// Counts a beam that passed a free cell, which stays free. Most such cells have count 1.
    #[inline(always)]
    pub(crate) fn pass_free(&mut self, cell: Cell, tuning: &MapTuning) {
        let (pair, shift) = self.pair(cell);
        let count = *pair >> shift & 15;
        if count != 1 {
            let next = match count {
                0 => initial(Class::Free, tuning) - 1,
                count => count - 1,
            };
            *pair = *pair & !(15 << shift) | next << shift;
        }
    }
}

impl Default for Evidence {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{Class, Evidence};
    use crate::config::MapTuning;
    use crate::geometry::Cell;

    const TUNING: MapTuning = MapTuning::DEFAULT;
    const CELL: Cell = Cell { x: 3, y: -4 };

    fn fresh() -> Evidence {
        let mut evidence = Evidence::new();
        evidence.reset(Cell { x: 0, y: 0 });
        evidence
    }

    #[test]
    fn one_beam_decides_an_unknown_cell() {
        assert_eq!(fresh().hit(CELL, Class::Unknown, &TUNING), Class::Obstacle);
        assert_eq!(fresh().pass(CELL, Class::Unknown, &TUNING), Class::Free);
    }

    #[test]
    fn a_false_echo_does_not_block_a_free_cell() {
        let mut evidence = fresh();
        let mut class = Class::Unknown;
        for _ in 0..9 {
            class = evidence.pass(CELL, class, &TUNING);
        }
        class = evidence.hit(CELL, class, &TUNING);
        class = evidence.hit(CELL, class, &TUNING);
        assert_eq!(class, Class::Free);
        assert_eq!(evidence.hit(CELL, class, &TUNING), Class::Negative);
    }

    #[test]
    fn a_wall_takes_eight_passes_to_go() {
        let mut evidence = fresh();
        let mut class = Class::Unknown;
        for _ in 0..9 {
            class = evidence.hit(CELL, class, &TUNING);
        }
        for _ in 0..7 {
            class = evidence.pass(CELL, class, &TUNING);
            assert_eq!(class, Class::Obstacle);
        }
        assert_eq!(evidence.pass(CELL, class, &TUNING), Class::Free);
    }

    #[test]
    fn evidence_is_forgotten_when_the_window_has_moved_away_and_kept_otherwise() {
        let mut evidence = fresh();
        let mut class = Class::Unknown;
        for _ in 0..9 {
            class = evidence.hit(CELL, class, &TUNING);
        }
        evidence.follow(Cell { x: 40, y: 0 });
        assert!(evidence.covers(CELL));
        for _ in 0..7 {
            class = evidence.pass(CELL, class, &TUNING);
        }
        assert_eq!(class, Class::Obstacle, "kept");
        evidence.follow(Cell { x: 200, y: 0 });
        assert!(!evidence.covers(CELL));
        evidence.follow(Cell { x: 0, y: 0 });
        assert_eq!(
            evidence.pass(CELL, Class::Unknown, &TUNING),
            Class::Free,
            "begins anew"
        );
    }
}
