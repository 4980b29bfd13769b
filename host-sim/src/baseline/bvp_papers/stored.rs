//! The potential over the known grid, stored from step to step and relaxed by sweeps.
//!
//! ```text
//! p = 1 on obstacles, p = 0 in unexplored cells
//! p ← (p(x+1,y) + p(x−1,y) + p(x,y+1) + p(x,y−1)) / 4     in free cells, in place
//! ```
//!
//! A sweep visits the free cells row by row, by rising y and in a row by rising x, and uses what it
//! has just written: Gauss–Seidel. Nothing is solved to the end. A cell that changes its role keeps
//! its p until a sweep changes it: newly explored cells begin with 0, and what was an obstacle
//! begins with 1.
//!
//! Invariant: every p is in [0, 1], as a mean of values in [0, 1] is.
//!
//! Units: map cells; p has none.

use fieldline_planner::geometry::{Cell, Point};

use super::Precision;
use crate::baseline::chart::Chart;
use crate::baseline::slope::{self, Role};
use crate::metrics::CellArea;

/// Potential of obstacles.
pub(super) const OBSTACLE: f64 = 1.0;
/// Potential of goals.
pub(super) const GOAL: f64 = 0.0;

/// The stored potential.
#[derive(Clone, Debug, Default)]
pub(super) struct Stored {
    area: CellArea,
    roles: Vec<Role>,
    p: Vec<f64>,
    /// Rows of free cells side by side, in the order of a sweep: first index and length.
    runs: Vec<(usize, usize)>,
    cells: usize,
    /// A goal can be reached.
    has_goals: bool,
}

impl Stored {
    /// Takes the roles of the cells from the chart, for a robot in a cell. Unexplored cells for
    /// which `is_goal` is false are free, as is the robot's own cell.
    pub(super) fn charge(&mut self, chart: &Chart, robot: Cell, is_goal: impl Fn(Cell) -> bool) {
        self.move_to(chart.area());
        self.runs.clear();
        self.cells = 0;
        let home = self.area.index(robot);
        for index in 0..self.area.len() {
            let role = if !chart.is_passable(index) {
                Role::Obstacle
            } else if chart.is_unexplored(index)
                && Some(index) != home
                && is_goal(self.area.cell(index))
            {
                Role::Goal
            } else {
                Role::Free
            };
            self.roles[index] = role;
            match role {
                Role::Obstacle => self.p[index] = OBSTACLE,
                Role::Goal => self.p[index] = GOAL,
                Role::Free => self.extend_runs(index),
            }
        }
        self.has_goals = self.reaches_goal(home);
    }

    /// Appends a free cell to the run that ends before it, or begins another. The outermost ring
    /// has no free cell, so no run goes on in the next row.
    fn extend_runs(&mut self, index: usize) {
        self.cells += 1;
        match self.runs.last_mut() {
            Some((first, count)) if *first + *count == index => *count += 1,
            _ => self.runs.push((index, 1)),
        }
    }

    /// Moves the stored values to another area. New cells are unexplored.
    fn move_to(&mut self, area: CellArea) {
        if self.area == area {
            return;
        }
        let value = |index: usize| {
            let before = self.area.index(area.cell(index));
            before.map_or(GOAL, |before| self.p[before])
        };
        self.p = (0..area.len()).map(value).collect();
        self.roles = vec![Role::Obstacle; area.len()];
        self.area = area;
    }

    /// Returns true if free cells lead from `home` to a goal.
    fn reaches_goal(&self, home: Option<usize>) -> bool {
        let home = home.filter(|&home| self.roles[home] == Role::Free);
        let mut pending: Vec<usize> = home.into_iter().collect();
        let mut seen = vec![false; self.area.len()];
        while let Some(index) = pending.pop() {
            for near in self.area.four(index) {
                match self.roles[near] {
                    Role::Goal => return true,
                    Role::Free if !seen[near] => {
                        seen[near] = true;
                        pending.push(near);
                    }
                    _ => {}
                }
            }
        }
        false
    }

    /// Returns true if the robot can reach an unexplored cell.
    pub(super) const fn has_goals(&self) -> bool {
        self.has_goals
    }

    /// Runs sweeps over all free cells.
    pub(super) fn sweep(&mut self, sweeps: u16, precision: Precision) {
        for _ in 0..sweeps {
            for &run in &self.runs {
                relax(&mut self.p, run, self.area.width, precision);
            }
        }
    }

    /// Returns p of a cell; [`OBSTACLE`] outside of the chart.
    pub(super) fn p(&self, cell: Cell) -> f64 {
        let index = self.area.index(cell);
        index.map_or(OBSTACLE, |index| self.p[index])
    }

    /// Returns the role of a cell; an obstacle outside of the chart.
    pub(super) fn role(&self, cell: Cell) -> Role {
        let index = self.area.index(cell);
        index.map_or(Role::Obstacle, |index| self.roles[index])
    }

    /// Returns −2 ∇p at the centre of a free cell, per cell; `None` in other cells.
    fn downhill(&self, cell: Cell) -> Option<(f64, f64)> {
        let index = self.area.index(cell)?;
        if self.roles[index] != Role::Free {
            return None;
        }
        let [east, north, west, south] = self.area.four(index).map(|near| self.p[near]);
        Some((west - east, south - north))
    }

    /// Returns true if the stored values beside a cell show no slope, or if it is not free.
    pub(super) fn is_flat(&self, cell: Cell) -> bool {
        self.downhill(cell).is_none_or(|slope| slope == (0.0, 0.0))
    }

    /// Returns the heading of −∇p at a point of a free cell, interpolated between cell centres;
    /// `None` where p is flat.
    pub(super) fn heading_at(&self, point: Point) -> Option<f32> {
        slope::heading(point, |cell| self.downhill(cell))
    }

    /// Follows the steepest descent of p from a free cell, cell by cell. Returns the goal at its
    /// end and its length in cells; `None` if it ends before one, because p is flat or has a
    /// minimum that the sweeps have not filled yet.
    pub(super) fn descend(&self, from: Cell) -> Option<(Cell, u32)> {
        let mut index = self.area.index(from)?;
        for steps in 0..self.area.len() as u32 {
            match self.roles[index] {
                Role::Goal => return Some((self.area.cell(index), steps)),
                Role::Obstacle => return None,
                Role::Free => {}
            }
            let near = self.area.four(index).into_iter();
            let best = near.min_by(|&a, &b| self.p[a].total_cmp(&self.p[b]))?;
            if self.p[best] >= self.p[index] {
                return None;
            }
            index = best;
        }
        None
    }

    /// Returns the number of free cells.
    pub(super) fn cells(&self) -> usize {
        self.cells
    }
}

/// Relaxes a run of free cells in place. p is stored row by row, `width` cells a row.
fn relax(p: &mut [f64], (first, count): (usize, usize), width: usize, precision: Precision) {
    let (south, rest) = p.split_at_mut(first - 1);
    let (row, north) = rest.split_at_mut(count + 2);
    // `row` begins one cell west of the run and ends one cell east of it.
    let south = &south[first - width..][..count];
    let north = &north[width - count - 1..][..count];
    let mut west = row[0];
    for k in 0..count {
        let mean = 0.25 * (row[k + 2] + south[k] + north[k] + west);
        west = match precision {
            Precision::F32 => f64::from(mean as f32),
            Precision::F64 => mean,
        };
        row[k + 1] = west;
    }
}

#[cfg(test)]
#[path = "stored_tests.rs"]
mod tests;
