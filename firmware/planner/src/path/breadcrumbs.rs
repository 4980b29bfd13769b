//! Breadcrumbs: the last metres of the robot's way.
//!
//! Where the robot was, the space is free and can be reached, whatever the skeleton looks like by
//! now.
//!
//! Units: map cells; the robot drops a crumb every 40 cm.

use crate::geometry::Cell;
use crate::grid::Shifts;

/// Number of crumbs that are kept: the last 12.8 m.
const CRUMBS: usize = 32;
/// Distance from one crumb to the next, cells.
const STRIDE_CELLS: i32 = 4;
/// Distance of the crumb that says where the robot came from, cells.
const CAME_CELLS: i32 = 8;

/// The last crumbs, in a ring.
#[derive(Debug)]
pub(crate) struct Crumbs {
    cells: [[i16; 2]; CRUMBS],
    /// Number of crumbs so far. At twice [`CRUMBS`] it restarts from [`CRUMBS`].
    dropped: u16,
}

/// Chebyshev distance of two cells.
fn apart(a: Cell, b: Cell) -> i32 {
    (a.x - b.x).abs().max((a.y - b.y).abs())
}

impl Crumbs {
    /// Makes an empty ring.
    pub(crate) const fn new() -> Self {
        Self {
            cells: [[0; 2]; CRUMBS],
            dropped: 0,
        }
    }

    /// Drops a crumb at the robot if the last one is a stride behind.
    pub(crate) fn note(&mut self, robot: Cell) {
        let is_behind = |last| apart(last, robot) >= STRIDE_CELLS;
        if !self.newest_first().next().is_none_or(is_behind) {
            return;
        }
        let place = usize::from(self.dropped) % CRUMBS;
        if let Some(crumb) = self.cells.get_mut(place) {
            *crumb = [robot.x as i16, robot.y as i16];
        }
        self.dropped = match self.dropped + 1 {
            next if usize::from(next) == 2 * CRUMBS => CRUMBS as u16,
            next => next,
        };
    }

    /// Returns the crumbs from the last one back.
    pub(crate) fn newest_first(&self) -> impl Iterator<Item = Cell> + '_ {
        let dropped = usize::from(self.dropped);
        let kept = dropped.min(CRUMBS);
        (1..=kept).filter_map(move |back| {
            let [x, y] = *self.cells.get((dropped - back) % CRUMBS)?;
            Some(Cell {
                x: i32::from(x),
                y: i32::from(y),
            })
        })
    }

    /// Moves the crumbs with the tiles that they lie in.
    pub(crate) fn shift(&mut self, shifts: Shifts<'_>) {
        self.cells.iter_mut().for_each(|it| shifts.move_short(it));
    }

    /// Returns where the robot came from: the last crumb that is at least [`CAME_CELLS`] away. The
    /// heading does not say it while the robot turns on the spot.
    pub(crate) fn came_from(&self, robot: Cell) -> Option<Cell> {
        self.newest_first()
            .find(|&crumb| apart(crumb, robot) >= CAME_CELLS)
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{CRUMBS, Crumbs};
    use crate::geometry::Cell;

    #[test]
    fn the_last_crumbs_lead_back() {
        let mut crumbs = Crumbs::new();
        assert_eq!(crumbs.newest_first().count(), 0);
        for x in 0..1000 {
            crumbs.note(Cell { x, y: -7 });
            let back: Vec<i32> = crumbs.newest_first().map(|cell| cell.x).collect();
            let last = x / 4 * 4;
            let expected: Vec<i32> = (0..=last / 4).map(|k| last - 4 * k).take(CRUMBS).collect();
            assert_eq!(back, expected, "at {x}");
        }
    }
}
