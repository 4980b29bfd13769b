//! The path: the way down the wave from the robot's centre cell to the goal it comes from, and the local goal on it.
//!
//! The local goal is the last cell of the path within 2 m of the robot [Jorge15, III-C, sixth step] and within
//! [`MOST_STEPS_AHEAD`] steps along it: by distance alone a long way round inside the window would make the field underflow.
//!
//! Units: coarse cells of 20 cm, named by the least of their four map cells.

use heapless::Vec;

use crate::geometry::{Cell, Point};
use crate::grid::Site;
use crate::roadmap::Residues;
use crate::roadmap::skeleton::Frame;

/// Cells kept of a path; a new one is made long before the robot has used up the last.
pub const ROAD_CELLS: usize = 96;
/// Radius of the circle that the local goal lies in, metres [Jorge15, III-C].
pub const LOCAL_GOAL_M: f32 = 2.0;
/// Steps along the path to the local goal at the most.
pub const MOST_STEPS_AHEAD: usize = 20;

/// The way to a goal.
#[derive(Clone, Debug, Default)]
pub struct Path {
    cells: Vec<Cell, ROAD_CELLS>,
    /// Steps to the goal, also those not kept.
    steps: u32,
    /// The cell that the wave came from.
    goal: Cell,
}

/// The middle of a coarse cell.
fn middle(cell: Cell) -> Point {
    Cell {
        x: cell.x + 1,
        y: cell.y + 1,
    }
    .corner()
}

fn distance2(a: Point, b: Point) -> f32 {
    let (dx, dy) = (a.x_m - b.x_m, a.y_m - b.y_m);
    dx * dx + dy * dy
}

impl Path {
    /// No path.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cells: Vec::new(),
            steps: 0,
            goal: Cell { x: 0, y: 0 },
        }
    }

    /// The path along these cells, the robot's end first.
    pub fn along(cells: impl Iterator<Item = Cell>) -> Self {
        let mut path = Self::new();
        for cell in cells {
            // What does not fit is counted only.
            let _ = path.cells.push(cell);
            path.steps += 1;
            path.goal = cell;
        }
        path
    }

    /// The path along the cells `before`, and then from a centre cell down the wave.
    pub(crate) fn down(
        before: impl Iterator<Item = Cell>,
        frame: Frame,
        residues: &Residues<'_>,
        from: Site,
    ) -> Self {
        let sites = core::iter::once(from).chain(residues.descent(from));
        Self::along(before.chain(sites.map(|site| frame.cell(site))))
    }

    /// The path that leads straight on to a place, which becomes the goal; the window finds the way round what stands between.
    #[must_use]
    pub fn leading_to(mut self, place: Cell) -> Self {
        let from = self.goal;
        let goal = Cell {
            x: place.x & !1,
            y: place.y & !1,
        };
        let (dx, dy) = (goal.x - from.x, goal.y - from.y);
        let steps = dx.abs().max(dy.abs()) / 2;
        for step in 1..=steps {
            // What does not fit is counted only.
            let _ = self.cells.push(Cell {
                x: (from.x + dx * step / steps) & !1,
                y: (from.y + dy * step / steps) & !1,
            });
            self.steps += 1;
        }
        self.goal = goal;
        self
    }

    /// The path that begins so many steps away from the robot.
    #[must_use]
    pub const fn after(mut self, steps: u32) -> Self {
        self.steps += steps;
        self
    }

    /// Let the path end one cell farther, without changing its goal.
    pub fn extend(&mut self, cell: Option<Cell>) {
        if let Some(cell) = cell {
            // A full path is long enough.
            let _ = self.cells.push(cell);
        }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Forget it.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// Steps to the goal.
    #[must_use]
    pub const fn steps(&self) -> u32 {
        self.steps
    }

    /// The cell that the wave came from.
    #[must_use]
    pub const fn goal(&self) -> Cell {
        self.goal
    }

    /// The cells, the robot's end first.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// The cells of the path that may be the local goal, the best first: from the last one in the circle back to the one
    /// nearest to the robot.
    pub fn local_goals(&self, robot: Point) -> impl Iterator<Item = Cell> + '_ {
        let near = |cell: &Cell| distance2(middle(*cell), robot);
        let ahead = self
            .cells
            .get(..self.cells.len().min(MOST_STEPS_AHEAD))
            .unwrap_or_default();
        let nearest = ahead
            .iter()
            .enumerate()
            .fold((0, f32::MAX), |best, (k, cell)| {
                if near(cell) < best.1 {
                    (k, near(cell))
                } else {
                    best
                }
            })
            .0;
        let end = (nearest + MOST_STEPS_AHEAD).min(self.cells.len());
        let beyond = self.cells.get(nearest..end).unwrap_or_default();
        let within = beyond
            .iter()
            .take_while(move |cell| near(cell) <= LOCAL_GOAL_M * LOCAL_GOAL_M)
            .count();
        beyond
            .get(..within.max(1))
            .unwrap_or(beyond)
            .iter()
            .rev()
            .copied()
    }
}
