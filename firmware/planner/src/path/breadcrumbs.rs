//! Crumbs: the last metres of the robot's path, by which it finds what is behind it.
//!
//! Where the robot was, the space is visited and can be reached, whatever the skeleton looks like by now.
//!
//! Units: map cells; a crumb is dropped every [`STRIDE_CELLS`].

use crate::geometry::Cell;

/// Crumbs that are kept: the last 12.8 m.
pub const CRUMBS: usize = 32;
/// Cells from one crumb to the next.
pub const STRIDE_CELLS: i32 = 4;

/// A crumb this far away says where the robot came from.
const CAME_CELLS: i32 = 8;

/// The last crumbs, in a ring.
#[derive(Debug)]
pub struct Crumbs {
    cells: [[i16; 2]; CRUMBS],
    /// How many were dropped, the last ones of which are kept.
    dropped: u16,
}

impl Crumbs {
    /// None yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cells: [[0; 2]; CRUMBS],
            dropped: 0,
        }
    }

    /// The robot is here.
    pub fn note(&mut self, robot: Cell) {
        let strode =
            |last: Cell| (last.x - robot.x).abs().max((last.y - robot.y).abs()) >= STRIDE_CELLS;
        if !self.newest_first().next().is_none_or(strode) {
            return;
        }
        let place = usize::from(self.dropped) % CRUMBS;
        if let Some(crumb) = self.cells.get_mut(place) {
            *crumb = [robot.x as i16, robot.y as i16];
        }
        // Counting goes on in the ring's own round, so that places follow each other for ever.
        self.dropped = match self.dropped + 1 {
            next if usize::from(next) == 2 * CRUMBS => CRUMBS as u16,
            next => next,
        };
    }

    /// From the last one back.
    pub fn newest_first(&self) -> impl Iterator<Item = Cell> + '_ {
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

    /// Where the robot came from: the last crumb that it has left behind by `CAME_CELLS`; its heading says nothing of it when it
    /// turns on the spot.
    #[must_use]
    pub fn came_from(&self, robot: Cell) -> Option<Cell> {
        let far =
            |crumb: &Cell| (crumb.x - robot.x).abs().max((crumb.y - robot.y).abs()) >= CAME_CELLS;
        self.newest_first().find(far)
    }
}

impl Default for Crumbs {
    fn default() -> Self {
        Self::new()
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
