//! The shield: a virtual wall across the loop road, behind the robot
//! \[Jorge15, III-A and III-C, fourth step\].
//!
//! It stands on a centre cell and extends to both sides at a right angle to the path, until the
//! space ends. A shield is valid if both ends are at obstacles and it cuts exactly one branch of
//! the skeleton. Otherwise the potential flows round it, or it blocks ways that are not the loop's.
//!
//! Its cells share sides, so no path passes between them, not even a diagonal one. It is kept as
//! place, direction and lengths in cells of the map, so it outlasts the skeletons.
//!
//! Units: coarse cells of 20 cm, each named by its map cell with the least x and y.

use crate::config::OuroborosTuning;
use crate::geometry::Cell;
use crate::grid::Shifts;
use crate::path::nearest::Centres;
use crate::roadmap::branches::{Kind, kind};

/// A wall across a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shield {
    /// The centre cell that it stands on.
    at: Cell,
    /// Its direction: that of the path, turned to the left.
    along: (i8, i8),
    /// Cells to the left and to the right of `at`.
    reach: [u8; 2],
}

/// The reason why a shield cannot stand on a cell of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flaw {
    /// The cell is an end or a junction.
    OffBranch,
    /// An end is not at an obstacle.
    OpenEnd,
    /// It cuts a second branch.
    CutsMore,
    /// It is in the robot's way.
    AtRobot,
}

impl Shield {
    /// Builds the shield across a path at its cell `at`, where the path goes from `behind` to
    /// `ahead`.
    ///
    /// # Errors
    /// The first [`Flaw`] found.
    pub(super) fn build<const TILES: usize, const SLOTS: usize>(
        centres: &Centres<'_, TILES, SLOTS>,
        at: Cell,
        [behind, ahead]: [Cell; 2],
        robot: Cell,
        tuning: &OuroborosTuning,
    ) -> Result<Self, Flaw> {
        let site = centres.frame.site(at).ok_or(Flaw::OffBranch)?;
        if kind(centres.cells, site) != Some(Kind::Passage) {
            return Err(Flaw::OffBranch);
        }
        let half = |from: i32, to: i32| ((to - from) / 2).clamp(-16, 16) as i8;
        let (x, y) = (half(behind.x, ahead.x), half(behind.y, ahead.y));
        let mut shield = Self {
            at,
            along: (-y, x),
            reach: [0; 2],
        };
        if shield.along == (0, 0) {
            return Err(Flaw::OffBranch);
        }
        shield.stretch(centres, tuning)?;
        let touches = |cell: Cell| {
            let far = |a: i32, b: i32| ((a >> 1) - (b >> 1)).abs() > tuning.clear_cells;
            !(far(cell.x, robot.x) || far(cell.y, robot.y))
        };
        if shield.cells().any(touches) {
            return Err(Flaw::AtRobot);
        }
        Ok(shield)
    }

    /// Moves it with the tile that it stands in.
    pub(super) fn shift(&mut self, shifts: Shifts<'_>) {
        self.at = shifts.moved_coarse(self.at);
    }

    /// Extends it to the obstacles on both sides, as they are now.
    ///
    /// # Errors
    /// [`Flaw::OpenEnd`] or [`Flaw::CutsMore`].
    pub(super) fn stretch<const TILES: usize, const SLOTS: usize>(
        &mut self,
        centres: &Centres<'_, TILES, SLOTS>,
        tuning: &OuroborosTuning,
    ) -> Result<(), Flaw> {
        for side in [0, 1] {
            let reach = self.reach_obstacle(centres, side, tuning.most_reach_cells);
            let reach = reach.ok_or(Flaw::OpenEnd)?;
            if let Some(place) = self.reach.get_mut(side) {
                *place = reach;
            }
        }
        self.check_cut(centres)
    }

    /// Returns the cells to one side up to the first one that is not open; `None` if there is none
    /// among the first `most_cells`, or a cell before it was never measured.
    fn reach_obstacle<const TILES: usize, const SLOTS: usize>(
        &self,
        centres: &Centres<'_, TILES, SLOTS>,
        side: usize,
        most_cells: u8,
    ) -> Option<u8> {
        (1_u8..).zip(self.ray(side)).find_map(|(reach, cell)| {
            if !centres.is_open(cell) {
                Some(Some(reach))
            } else if reach == most_cells || !centres.is_explored(cell) {
                Some(None)
            } else {
                None
            }
        })?
    }

    /// Checks that only the branch that it stands on has cells on it.
    fn check_cut<const TILES: usize, const SLOTS: usize>(
        &self,
        centres: &Centres<'_, TILES, SLOTS>,
    ) -> Result<(), Flaw> {
        for side in [0, 1] {
            // Cells that follow each other from where it stands are of the same branch.
            let mut is_joined = true;
            for cell in self.ray(side).take(self.length(side)) {
                let is_centre = centres.is_centre(cell);
                if is_centre && !is_joined {
                    return Err(Flaw::CutsMore);
                }
                is_joined &= is_centre;
            }
        }
        Ok(())
    }

    fn length(&self, side: usize) -> usize {
        self.reach.get(side).copied().map_or(0, usize::from)
    }

    /// Returns the cells from where it stands to one side, without end.
    fn ray(&self, side: usize) -> Ray {
        let (x, y) = self.along;
        let sign = if side == 0 { 1 } else { -1 };
        Ray {
            at: self.at,
            along: (sign * i32::from(x), sign * i32::from(y)),
            steps: (0, 0),
        }
    }

    /// Returns its cells: where it stands, then to the left, then to the right. The last one of
    /// each side is beyond the space.
    pub(crate) fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        let side = |side: usize| self.ray(side).take(self.length(side));
        core::iter::once(self.at).chain(side(0)).chain(side(1))
    }

    /// Returns the neighbours of one of its cells that lie behind it, on the tractor point's side.
    pub(super) fn behind(self, on_it: Cell) -> impl Iterator<Item = Cell> {
        let (x, y) = self.along;
        // The path ahead is the direction turned to the right.
        let (ahead_x, ahead_y) = (i32::from(y), -i32::from(x));
        let is_behind = move |cell: &Cell| {
            let ahead = (cell.x - self.at.x) * ahead_x + (cell.y - self.at.y) * ahead_y;
            ahead < 0 && self.cells().all(|own| own != *cell)
        };
        let around = (0..9).map(move |k| on_it.offset(2 * (k % 3 - 1), 2 * (k / 3 - 1)));
        around.filter(is_behind)
    }

    /// Returns the last cell to the left and the last one to the right.
    #[must_use]
    pub(crate) fn ends(&self) -> [Cell; 2] {
        let last = |side: usize| self.ray(side).take(self.length(side)).last();
        [0, 1].map(|side| last(side).unwrap_or(self.at))
    }
}

/// Cells along a line, each beside the last.
#[derive(Clone, Debug)]
struct Ray {
    at: Cell,
    along: (i32, i32),
    steps: (i32, i32),
}

impl Iterator for Ray {
    type Item = Cell;

    fn next(&mut self) -> Option<Cell> {
        let (x, y) = (self.along.0.abs(), self.along.1.abs());
        // Cross the nearer of the two edges ahead.
        if (2 * self.steps.0 + 1) * y < (2 * self.steps.1 + 1) * x {
            self.steps.0 += 1;
            self.at.x += 2 * self.along.0.signum();
        } else {
            self.steps.1 += 1;
            self.at.y += 2 * self.along.1.signum();
        }
        Some(self.at)
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::Shield;
    use crate::geometry::Cell;

    #[test]
    fn the_ends_are_the_last_cells_of_each_side() {
        let shield = Shield {
            at: Cell { x: 10, y: -4 },
            along: (0, 1),
            reach: [3, 0],
        };
        assert_eq!(shield.ends(), [Cell { x: 10, y: 2 }, Cell { x: 10, y: -4 }]);
        let slant = Shield {
            along: (1, 1),
            reach: [2, 4],
            ..shield
        };
        for end in slant.ends() {
            assert!(slant.cells().any(|cell| cell == end), "{end:?}");
        }
        assert_eq!(slant.ends()[1], Cell { x: 6, y: -8 });
    }

    #[test]
    fn behind_it_is_where_the_path_came_from() {
        let at = Cell { x: 10, y: -4 };
        let driven = |x: i8, y: i8| Shield {
            at,
            along: (-y, x),
            reach: [3, 3],
        };
        let behind = |shield: Shield| -> Vec<(i32, i32)> {
            let cells = shield.behind(at);
            cells
                .map(|c| ((c.x - at.x) / 2, (c.y - at.y) / 2))
                .collect()
        };
        assert_eq!(behind(driven(2, 0)), [(-1, -1), (-1, 0), (-1, 1)]);
        assert_eq!(behind(driven(0, -1)), [(-1, 1), (0, 1), (1, 1)]);
        let slant = behind(driven(2, 2));
        assert!(
            slant.contains(&(-1, -1)) && !slant.contains(&(1, 1)),
            "{slant:?}"
        );
        let own = driven(2, 2);
        assert!(
            own.cells()
                .all(|cell| own.behind(at).all(|behind| behind != cell))
        );
    }
}
