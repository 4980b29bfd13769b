//! The path: the way down a wave from the robot's centre cell to a goal, and the local goals on it.
//!
//! The local goal is the last cell of the path within 2 m of the robot \[Jorge15, III-C, sixth
//! step\] and within [`MOST_STEPS_AHEAD`] steps along it: with the distance alone, a long way round
//! inside the window would make the field underflow.
//!
//! Units: coarse cells of 20 cm, named by the least of their four map cells.

use heapless::Vec;

use crate::geometry::{Cell, Point};
use crate::grid::{Shifts, Site};
use crate::roadmap::Residues;
use crate::roadmap::skeleton::Frame;

/// Maximum number of cells that a path keeps, 19 m. The next path is planned long before the robot
/// has used them up.
const PATH_CELLS: usize = 96;
/// Radius of the circle around the robot that holds the local goal, metres \[Jorge15, III-C\].
pub(crate) const LOCAL_GOAL_M: f32 = 2.0;
/// Maximum number of steps along the path to the local goal: twice the radius.
const MOST_STEPS_AHEAD: usize = 20;

/// A path to a goal. Default: the empty path.
#[derive(Clone, Debug, Default)]
pub struct Path {
    cells: Vec<Cell, PATH_CELLS>,
    /// Steps to the goal, those of cells not kept included.
    steps: u32,
    goal: Cell,
    /// See [`Self::shares_trip`].
    shares_trip: bool,
}

/// The centre of a coarse cell.
fn centre(cell: Cell) -> Point {
    Cell {
        x: cell.x + 1,
        y: cell.y + 1,
    }
    .corner()
}

impl Path {
    /// Makes the empty path.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cells: Vec::new(),
            steps: 0,
            goal: Cell { x: 0, y: 0 },
            shares_trip: false,
        }
    }

    /// Makes the path along these cells, from the robot to the goal.
    pub(crate) fn along(cells: impl Iterator<Item = Cell>) -> Self {
        let mut path = Self::new();
        for cell in cells {
            path.push(cell);
        }
        path
    }

    /// Makes the path along the cells `before`, and then from a centre cell down the wave.
    pub(crate) fn down(
        before: impl Iterator<Item = Cell>,
        frame: Frame,
        residues: &Residues<'_>,
        from: Site,
    ) -> Self {
        let sites = core::iter::once(from).chain(residues.descent(from));
        Self::along(before.chain(sites.map(|site| frame.cell(site))))
    }

    /// Makes the path of `steps` steps to a goal from its cells backwards: the goal first, then
    /// `count` − 1 others.
    pub(crate) fn back(cells: impl Iterator<Item = Cell>, count: usize, steps: u32) -> Self {
        let mut cells = cells.peekable();
        let goal = cells.peek().copied().unwrap_or_default();
        let mut path = Self::along(cells.skip(count.saturating_sub(PATH_CELLS)));
        path.cells.reverse();
        Self {
            steps,
            goal,
            ..path
        }
    }

    /// Returns the path prolonged straight to a place, which becomes the goal. The field finds the
    /// way round what stands between.
    pub(crate) fn leading_to(mut self, place: Cell) -> Self {
        let from = self.goal;
        let goal = Cell {
            x: place.x & !1,
            y: place.y & !1,
        };
        let (dx, dy) = (goal.x - from.x, goal.y - from.y);
        let steps = dx.abs().max(dy.abs()) / 2;
        for step in 1..=steps {
            self.push(Cell {
                x: (from.x + dx * step / steps) & !1,
                y: (from.y + dy * step / steps) & !1,
            });
        }
        self.goal = goal;
        self
    }

    /// Moves the path with the tiles that it lies in. Between two tiles it may be torn.
    pub(crate) fn shift(&mut self, shifts: Shifts<'_>) {
        for cell in self.cells.iter_mut().chain([&mut self.goal]) {
            *cell = shifts.moved_coarse(*cell);
        }
    }

    /// Returns the path with so many more steps, which lead from the robot to its first cell.
    pub(crate) const fn after(mut self, steps: u32) -> Self {
        self.steps += steps;
        self
    }

    /// Appends a cell beyond the goal, without a change of the goal and its steps.
    pub(crate) fn extend(&mut self, cell: Option<Cell>) {
        if let Some(cell) = cell {
            // A full path is long enough.
            let _ = self.cells.push(cell);
        }
    }

    fn push(&mut self, cell: Cell) {
        // A cell that does not fit only counts.
        let _ = self.cells.push(cell);
        self.steps += 1;
        self.goal = cell;
    }

    /// Returns true if the goal is worth its trip only together with other goals.
    pub(crate) const fn shares_trip(&self) -> bool {
        self.shares_trip
    }

    /// Sets whether the goal is worth its trip only together with other goals.
    pub(crate) const fn set_shares_trip(&mut self, shares_trip: bool) {
        self.shares_trip = shares_trip;
    }

    /// Returns true for the empty path.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Makes the path empty.
    pub(crate) fn clear(&mut self) {
        *self = Self::new();
    }

    /// Returns the number of steps from the robot to the goal.
    #[must_use]
    pub const fn steps(&self) -> u32 {
        self.steps
    }

    /// Returns the goal: the cell that the wave started from.
    #[must_use]
    pub const fn goal(&self) -> Cell {
        self.goal
    }

    /// Returns the cells, from the robot to the goal.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Returns the cells that may be the local goal: from the one nearest to the robot to the last
    /// one in the circle.
    pub(crate) fn ahead_of(&self, robot: Point) -> &[Cell] {
        let distance2 = |cell: &Cell| centre(*cell).distance2(robot);
        let ahead = self
            .cells
            .get(..self.cells.len().min(MOST_STEPS_AHEAD))
            .unwrap_or_default();
        let nearest = ahead
            .iter()
            .enumerate()
            .fold((0, f32::MAX), |best, (k, cell)| {
                if distance2(cell) < best.1 {
                    (k, distance2(cell))
                } else {
                    best
                }
            })
            .0;
        let end = (nearest + MOST_STEPS_AHEAD).min(self.cells.len());
        let beyond = self.cells.get(nearest..end).unwrap_or_default();
        let within = beyond
            .iter()
            .take_while(|cell| distance2(cell) <= LOCAL_GOAL_M * LOCAL_GOAL_M)
            .count();
        beyond.get(..within.max(1)).unwrap_or(beyond)
    }
}
