//! Evidence for and against an obstacle, in a rolling window of 128 × 128 cells around the robot.
//!
//! Four bits a cell: 0 = no evidence yet, else a count in 1..=15 that a hit raises by 3 and a pass lowers by 1.
//! A cell is obstacle from 10 up and free from 7 down; between, it keeps the class it had (hysteresis). A free cell that
//! was seen often (count 1) needs three hits to turn, so a single false echo does not block a way; a wall (15) needs
//! eight passes. Outside the window the first impression stands until the robot comes near.
//!
//! Invariant: a slot belongs to exactly one cell of the window (cell mod 128), and entering strips are cleared.
//! Units: map cells.

use crate::geometry::Cell;
use crate::grid::Class;

/// Cells along the window's side.
pub const EVIDENCE_SIDE: i32 = 128;
/// The window moves in steps of this many cells, so that it seldom does.
const STRIDE: i32 = 16;

const HIT: u8 = 3;
const OBSTACLE_MIN: u8 = 10;
const FREE_MAX: u8 = 7;
const MAX_COUNT: u8 = 15;

/// The rolling window of counts.
#[derive(Debug, PartialEq, Eq)]
pub struct Evidence {
    /// Two cells a byte, row by row.
    counts: [[u8; EVIDENCE_SIDE as usize / 2]; EVIDENCE_SIDE as usize],
    /// The window's least cell, a multiple of [`STRIDE`].
    origin: Cell,
}

/// Count that a cell of this class starts with.
const fn initial(class: Class) -> u8 {
    match class {
        Class::Unknown => 8,
        Class::Free => 5,
        Class::Obstacle | Class::Negative => 12,
    }
}

impl Evidence {
    /// No evidence anywhere.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            counts: [[0; EVIDENCE_SIDE as usize / 2]; EVIDENCE_SIDE as usize],
            origin: Cell { x: 0, y: 0 },
        }
    }

    /// Forget everything and centre on `centre`.
    pub fn reset(&mut self, centre: Cell) {
        self.counts.as_flattened_mut().fill(0);
        self.origin = Self::origin_around(centre);
    }

    /// The memory of the counts, where there are none to be kept.
    pub(super) fn bytes(&self) -> &[u8] {
        self.counts.as_flattened()
    }

    /// The memory of the counts, where there are none to be kept.
    pub(super) fn bytes_mut(&mut self) -> &mut [u8] {
        self.counts.as_flattened_mut()
    }

    const fn origin_around(centre: Cell) -> Cell {
        let half = EVIDENCE_SIDE / 2;
        Cell {
            x: (centre.x - half) & !(STRIDE - 1),
            y: (centre.y - half) & !(STRIDE - 1),
        }
    }

    /// Keep the window around `centre`; cells that enter have no evidence.
    pub fn follow(&mut self, centre: Cell) {
        let next = Self::origin_around(centre);
        let (dx, dy) = (next.x - self.origin.x, next.y - self.origin.y);
        if dx.abs() >= EVIDENCE_SIDE || dy.abs() >= EVIDENCE_SIDE {
            self.reset(centre);
            return;
        }
        let (old, side) = (self.origin, EVIDENCE_SIDE);
        self.origin = next;
        for y in if dy >= 0 {
            old.y + side..next.y + side
        } else {
            next.y..old.y
        } {
            if let Some(row) = self.counts.get_mut((y & (side - 1)) as usize) {
                row.fill(0);
            }
        }
        let columns = if dx >= 0 {
            old.x + side..next.x + side
        } else {
            next.x..old.x
        };
        for row in &mut self.counts {
            for x in columns.clone().step_by(2) {
                if let Some(pair) = row.get_mut(((x & (side - 1)) / 2) as usize) {
                    *pair = 0;
                }
            }
        }
    }

    /// Whether the window covers this cell.
    #[must_use]
    pub const fn covers(&self, cell: Cell) -> bool {
        let (x, y) = (cell.x - self.origin.x, cell.y - self.origin.y);
        x >= 0 && x < EVIDENCE_SIDE && y >= 0 && y < EVIDENCE_SIDE
    }

    /// The byte that holds a cell's count, and by how much it is shifted up.
    #[inline(always)]
    fn pair(&mut self, cell: Cell) -> Option<(&mut u8, i32)> {
        let (x, y) = (cell.x & (EVIDENCE_SIDE - 1), cell.y & (EVIDENCE_SIDE - 1));
        let row = self.counts.get_mut(y as usize)?;
        Some((row.get_mut(x as usize / 2)?, (x & 1) * 4))
    }

    #[inline(always)]
    fn update(&mut self, cell: Cell, class: Class, change: impl Fn(u8) -> u8) -> Class {
        let Some((pair, shift)) = self.pair(cell) else {
            return class;
        };
        let count = match *pair >> shift & 15 {
            0 => initial(class),
            count => count,
        };
        let count = change(count);
        *pair = *pair & !(15 << shift) | count << shift;
        match count {
            OBSTACLE_MIN.. => Class::Obstacle,
            ..=FREE_MAX => Class::Free,
            _ => class,
        }
    }

    /// A beam ended in this cell, whose class was `class`; returns its class now.
    pub fn hit(&mut self, cell: Cell, class: Class) -> Class {
        self.update(cell, class, |count| (count + HIT).min(MAX_COUNT))
    }

    /// A beam went through this cell, whose class was `class`; returns its class now.
    pub fn pass(&mut self, cell: Cell, class: Class) -> Class {
        self.update(cell, class, |count| count.saturating_sub(1).max(1))
    }

    /// A beam went through this cell, which is known to be free and stays so; most such cells were seen often.
    #[inline(always)]
    pub fn pass_free(&mut self, cell: Cell) {
        let Some((pair, shift)) = self.pair(cell) else {
            return;
        };
        let count = *pair >> shift & 15;
        if count != 1 {
            let next = match count {
                0 => initial(Class::Free) - 1,
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
    use crate::geometry::Cell;

    const CELL: Cell = Cell { x: 3, y: -4 };

    fn fresh() -> Evidence {
        let mut evidence = Evidence::new();
        evidence.reset(Cell { x: 0, y: 0 });
        evidence
    }

    #[test]
    fn one_beam_decides_an_unknown_cell() {
        assert_eq!(fresh().hit(CELL, Class::Unknown), Class::Obstacle);
        assert_eq!(fresh().pass(CELL, Class::Unknown), Class::Free);
    }

    #[test]
    fn a_false_echo_does_not_block_a_free_cell() {
        let mut evidence = fresh();
        let mut class = Class::Unknown;
        for _ in 0..9 {
            class = evidence.pass(CELL, class);
        }
        class = evidence.hit(CELL, class);
        class = evidence.hit(CELL, class);
        assert_eq!(class, Class::Free);
        assert_eq!(evidence.hit(CELL, class), Class::Obstacle);
    }

    #[test]
    fn a_wall_takes_eight_passes_to_go() {
        let mut evidence = fresh();
        let mut class = Class::Unknown;
        for _ in 0..9 {
            class = evidence.hit(CELL, class);
        }
        for _ in 0..7 {
            class = evidence.pass(CELL, class);
            assert_eq!(class, Class::Obstacle);
        }
        assert_eq!(evidence.pass(CELL, class), Class::Free);
    }

    #[test]
    fn evidence_is_forgotten_when_the_window_has_moved_away_and_kept_otherwise() {
        let mut evidence = fresh();
        let mut class = Class::Unknown;
        for _ in 0..9 {
            class = evidence.hit(CELL, class);
        }
        evidence.follow(Cell { x: 40, y: 0 });
        assert!(evidence.covers(CELL));
        for _ in 0..7 {
            class = evidence.pass(CELL, class);
        }
        assert_eq!(class, Class::Obstacle, "kept");
        evidence.follow(Cell { x: 200, y: 0 });
        assert!(!evidence.covers(CELL));
        evidence.follow(Cell { x: 0, y: 0 });
        assert_eq!(
            evidence.pass(CELL, Class::Unknown),
            Class::Free,
            "begins anew"
        );
    }
}
