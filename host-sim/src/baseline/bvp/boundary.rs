//! The boundary of the full-grid field: obstacles, goals, and the free cells in between.
//!
//! Only free cells that the robot can reach are unknowns of the system; the others do not affect
//! them. Units: cells of the chart.

use fieldline_planner::geometry::Cell;

use super::graph::Node;
use crate::baseline::chart::Chart;
use crate::metrics::CellArea;

/// Role of a cell in the boundary-value problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    /// Not passable, or out of the robot's reach: q = 0.
    #[default]
    Obstacle,
    /// Unexplored: q = [`super::field::GOAL`].
    Goal,
    /// An unknown of the system, by number.
    Free(u32),
}

/// The boundary.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Boundary {
    /// The map cells of the chart.
    pub(super) area: CellArea,
    kinds: Vec<Kind>,
    /// Index of every unknown in the chart, ascending.
    homes: Vec<u32>,
    /// Number of unexplored cells beside free cells.
    goals: usize,
}

impl Boundary {
    /// Floods the chart from the robot. Unexplored cells for which `is_goal` is false are free.
    pub(super) fn new(chart: &Chart, robot: Cell, is_goal: impl Fn(Cell) -> bool) -> Self {
        let area = chart.area();
        let mut kinds = vec![Kind::Obstacle; area.len()];
        let home = area.index(robot).filter(|&i| chart.is_passable(i));
        let mut pending: Vec<usize> = home.into_iter().collect();
        let mut goals = 0;
        for &start in &pending {
            kinds[start] = Kind::Free(0);
        }
        while let Some(index) = pending.pop() {
            for near in area.four(index) {
                if kinds[near] != Kind::Obstacle || !chart.is_passable(near) {
                    continue;
                }
                if chart.is_unexplored(near) && is_goal(area.cell(near)) {
                    kinds[near] = Kind::Goal;
                    goals += 1;
                } else {
                    kinds[near] = Kind::Free(0);
                    pending.push(near);
                }
            }
        }
        let mut homes = Vec::new();
        for (home, kind) in (0..).zip(&mut kinds) {
            if let Kind::Free(node) = kind {
                *node = homes.len() as u32;
                homes.push(home);
            }
        }
        Self {
            area,
            kinds,
            homes,
            goals,
        }
    }

    /// Returns the number of unknowns.
    pub(super) fn len(&self) -> usize {
        self.homes.len()
    }

    /// Returns true if the robot can reach a goal.
    pub(super) const fn has_goals(&self) -> bool {
        self.goals > 0
    }

    /// Returns the role of a cell by its index.
    pub(super) fn at(&self, index: usize) -> Kind {
        self.kinds[index]
    }

    /// Returns the role of a cell; an obstacle outside of the chart.
    pub(super) fn kind(&self, cell: Cell) -> Kind {
        let index = self.area.index(cell);
        index.map_or(Kind::Obstacle, |index| self.kinds[index])
    }

    /// Returns the cell of every unknown.
    pub(super) fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        let homes = self.homes.iter();
        homes.map(|&home| self.area.cell(home as usize))
    }

    /// Returns the nodes of the finest level.
    pub(super) fn nodes(&self) -> Vec<Node> {
        let node = |&home: &u32| {
            let near = self.area.four(home as usize).map(|near| self.kinds[near]);
            Node {
                beside: near.map(|kind| match kind {
                    Kind::Free(node) => Some(node),
                    _ => None,
                }),
                goals: (0..4).fold(0, |bits, k| bits | u8::from(near[k] == Kind::Goal) << k),
            }
        };
        self.homes.iter().map(node).collect()
    }

    /// Returns column and row of every unknown.
    pub(super) fn places(&self) -> Vec<(u32, u32)> {
        let place = |&home: &u32| {
            let (x, y) = self.area.place(home as usize);
            (x as u32, y as u32)
        };
        self.homes.iter().map(place).collect()
    }
}
