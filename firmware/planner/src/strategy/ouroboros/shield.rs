//! The shield: a virtual wall across the loop road, behind the robot [Jorge15, III-A and III-C, fourth step].
//!
//! It stands on a centre cell and runs both ways at a right angle to the path until the space ends. Valid is a shield whose two
//! ends are at obstacles and which cuts exactly one branch of the skeleton: else the potential would flow round it, or ways
//! would be blocked that are not the loop's.
//!
//! Its cells are joined by their sides, so that no path slips through, be it diagonal. It is kept as place, direction and
//! lengths in the map's own cells, not the skeleton's, so it lasts while skeletons come and go.
//!
//! Units: coarse cells of 20 cm, named by the least of their four map cells.

use core::fmt;

use crate::geometry::Cell;
use crate::roadmap::branches::{Kind, kind};
use crate::strategy::ouroboros::ground::Ground;

/// Cells of a shield to one side of the path at the most: 6.4 m.
pub const MOST_REACH: u8 = 32;
/// Centre cells that lie on a shield at the most: those of a branch that crosses it aslant.
pub const MOST_CUT: usize = 4;
/// Cells that must be between the robot and the shield, along either axis: its window must leave it room.
const CLEAR_CELLS: i32 = 2;

/// A wall across a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shield {
    /// The centre cell that it stands on.
    at: Cell,
    /// Its direction, to the left of the path's.
    along: (i8, i8),
    /// Cells to the left and to the right of `at`.
    reach: [u8; 2],
}

/// Why a shield cannot stand at a cell of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// The cell is no part of a single branch.
    OffBranch,
    /// An end hangs in the open, or in the unexplored.
    OpenEnd,
    /// It would cut another branch too.
    CutsMore,
    /// It would stand in the robot's way.
    AtRobot,
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OffBranch => "no shield at an end or a junction: look farther along the path",
            Self::OpenEnd => "no shield with an end in the open: look where obstacles are nearer",
            Self::CutsMore => "no shield across two branches: look where they are farther apart",
            Self::AtRobot => "no shield at the robot: look farther along the path",
        })
    }
}

impl core::error::Error for Flaw {}

impl Shield {
    /// The shield across a path at one of its cells, where the path goes from `behind` to `ahead`.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn build<const TILES: usize, const SLOTS: usize>(
        ground: &Ground<'_, TILES, SLOTS>,
        at: Cell,
        [behind, ahead]: [Cell; 2],
        robot: Cell,
    ) -> Result<Self, Flaw> {
        let site = ground.frame.site(at).ok_or(Flaw::OffBranch)?;
        if kind(ground.way, site) != Some(Kind::Passage) {
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
        shield.stretch(ground)?;
        let touches = |cell: Cell| {
            let far = |a: i32, b: i32| ((a >> 1) - (b >> 1)).abs() > CLEAR_CELLS;
            !(far(cell.x, robot.x) || far(cell.y, robot.y))
        };
        if shield.cells().any(touches) {
            return Err(Flaw::AtRobot);
        }
        Ok(shield)
    }

    /// Let it reach from obstacle to obstacle, as they are now.
    ///
    /// # Errors
    /// When they are not there, or it cuts more than a branch.
    pub fn stretch<const TILES: usize, const SLOTS: usize>(
        &mut self,
        ground: &Ground<'_, TILES, SLOTS>,
    ) -> Result<(), Flaw> {
        for side in [0, 1] {
            let reach = self.reach_obstacle(ground, side).ok_or(Flaw::OpenEnd)?;
            if let Some(place) = self.reach.get_mut(side) {
                *place = reach;
            }
        }
        self.check_cut(ground)
    }

    /// Cells to one side before the space ends; `None` if it does not, or what is there was never measured.
    fn reach_obstacle<const TILES: usize, const SLOTS: usize>(
        &self,
        ground: &Ground<'_, TILES, SLOTS>,
        side: usize,
    ) -> Option<u8> {
        (1_u8..).zip(self.ray(side)).find_map(|(reach, cell)| {
            if !ground.is_open(cell) {
                Some(Some(reach))
            } else if reach == MOST_REACH || !ground.is_explored(cell) {
                Some(None)
            } else {
                None
            }
        })?
    }

    /// Only the branch that it stands on has cells on it.
    fn check_cut<const TILES: usize, const SLOTS: usize>(
        &self,
        ground: &Ground<'_, TILES, SLOTS>,
    ) -> Result<(), Flaw> {
        let mut cut = 1;
        for side in [0, 1] {
            // Of one branch are only cells that follow each other on the shield from where it stands.
            let mut is_joined = true;
            for cell in self.ray(side).take(self.length(side)) {
                let is_centre = ground.is_centre(cell);
                if is_centre && !is_joined {
                    return Err(Flaw::CutsMore);
                }
                cut += usize::from(is_centre);
                is_joined &= is_centre;
            }
        }
        if cut > MOST_CUT {
            return Err(Flaw::CutsMore);
        }
        Ok(())
    }

    fn length(&self, side: usize) -> usize {
        self.reach.get(side).copied().map_or(0, usize::from)
    }

    /// The cells from where it stands to one side, without end.
    fn ray(&self, side: usize) -> Ray {
        let (x, y) = self.along;
        let sign = if side == 0 { 1 } else { -1 };
        Ray {
            at: self.at,
            along: (sign * i32::from(x), sign * i32::from(y)),
            steps: (0, 0),
        }
    }

    /// The centre cell that it stands on.
    #[must_use]
    pub const fn at(&self) -> Cell {
        self.at
    }

    /// Its cells, from where it stands to the left and then to the right; the last of each side are beyond the space.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        let side = |side: usize| self.ray(side).take(self.length(side));
        core::iter::once(self.at).chain(side(0)).chain(side(1))
    }

    /// The last cell to the left and the last one to the right.
    #[must_use]
    pub fn ends(&self) -> [Cell; 2] {
        let last = |side: usize| self.ray(side).take(self.length(side)).last();
        [0, 1].map(|side| last(side).unwrap_or(self.at))
    }

    /// Whether a cell is on it.
    #[must_use]
    pub fn holds(&self, cell: Cell) -> bool {
        let longest = 2 * i32::from(self.reach[0].max(self.reach[1]));
        let apart = |a: i32, b: i32| (a - b).abs() > longest;
        !(apart(cell.x, self.at.x) || apart(cell.y, self.at.y)) && self.cells().any(|on| on == cell)
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
            assert!(slant.holds(end), "{end:?}");
        }
        assert_eq!(slant.ends()[1], Cell { x: 6, y: -8 });
    }
}
