//! The potential over the whole known grid [Prestes et al.]: obstacles p = 1, every unexplored cell p = 0, in between
//! ∇²p = 0, solved for q = 1 − p so that far cells keep their digits.
//!
//! A goal holds q = 2^1000 (the equation is homogeneous), which leaves f64 2074 binary orders of magnitude below it.
//! Departs from [Prestes et al.], who relax p itself: in p a cell whose 1 − p is below the rounding of 1 is flat, and in a
//! real building that is most of them. The baseline is better for it, never worse.
//!
//! Only free cells that the robot can come to are unknowns of the system, and those need no value for the others.
//!
//! Units: cells of the chart; headings in radians, counter-clockwise from x.

use fieldline_planner::geometry::{CELL_M, Cell, Point};
use fieldline_planner::math;

use super::graph::Node;
use super::multigrid::Multigrid;
use crate::baseline::chart::{Chart, Frame};

/// q of a goal: 2^1000.
pub(super) const GOAL: f64 = f64::from_bits((1023 + 1000) << 52);

/// What a cell is in the boundary-value problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    /// Not passable, or out of the robot's reach: q = 0.
    #[default]
    Obstacle,
    /// Unexplored: q = [`GOAL`].
    Goal,
    /// An unknown of the system, by number.
    Free(u32),
}

/// Boundary and field.
#[derive(Clone, Debug, Default)]
pub(super) struct Field {
    frame: Frame,
    kinds: Vec<Kind>,
    /// The chart's index of every unknown.
    homes: Vec<u32>,
    /// Unexplored cells beside free ones.
    goals: usize,
    solver: Multigrid,
}

impl Field {
    /// Take the boundary from the chart, keeping the field of cells that were free before. Unexplored cells for which
    /// `is_goal` is false are free cells of the field.
    pub(super) fn charge(&mut self, chart: &Chart, robot: Cell, is_goal: impl Fn(Cell) -> bool) {
        let frame = chart.frame();
        let (kinds, homes, goals) = bounds(chart, robot, is_goal);
        self.goals = goals;
        if frame == self.frame && kinds == self.kinds {
            return;
        }
        let updates = self.solver.updates;
        let mut solver = Multigrid::new(&nodes(frame, &kinds, &homes), places(frame, &homes), GOAL);
        for (node, &home) in homes.iter().enumerate() {
            if let Some(before) = self.value(frame.cell(home as usize)) {
                solver.set(node, before);
            }
        }
        solver.updates = updates;
        *self = Self {
            frame,
            kinds,
            homes,
            goals,
            solver,
        };
    }

    /// Whether any unexplored cell can be come to.
    pub(super) const fn has_goals(&self) -> bool {
        self.goals > 0
    }

    /// One multigrid cycle.
    pub(super) fn cycle(&mut self) {
        self.solver.cycle();
    }

    /// Unknowns of the system.
    pub(super) fn cells(&self) -> usize {
        self.homes.len()
    }

    /// Cell updates so far.
    pub(super) const fn updates(&self) -> u64 {
        self.solver.updates
    }

    /// What a cell is.
    pub(super) fn kind(&self, cell: Cell) -> Kind {
        let index = self.frame.index(cell);
        index.map_or(Kind::Obstacle, |index| self.kinds[index])
    }

    /// q of a cell: 0 on obstacles and outside.
    pub(super) fn q(&self, cell: Cell) -> f64 {
        self.frame.index(cell).map_or(0.0, |index| self.at(index))
    }

    /// q of a free cell that has one.
    fn value(&self, cell: Cell) -> Option<f64> {
        match self.kind(cell) {
            Kind::Free(node) => Some(self.solver.values()[node as usize]).filter(|q| *q > 0.0),
            _ => None,
        }
    }

    fn at(&self, index: usize) -> f64 {
        match self.kinds[index] {
            Kind::Obstacle => 0.0,
            Kind::Goal => GOAL,
            Kind::Free(node) => self.solver.values()[node as usize],
        }
    }

    /// The heading of −∇p at a point of a free cell, interpolated between cell centres; `None` where there is no slope.
    pub(super) fn heading_at(&self, point: Point) -> Option<f32> {
        self.gradient(point.cell())?;
        let (x, y) = (point.x_m / CELL_M - 0.5, point.y_m / CELL_M - 0.5);
        let (west, south) = (math::floor(x), math::floor(y));
        let (along, up) = (f64::from(x - west as f32), f64::from(y - south as f32));
        let mut sum = (0.0, 0.0);
        for (dx, dy, weight) in [
            (0, 0, (1.0 - along) * (1.0 - up)),
            (1, 0, along * (1.0 - up)),
            (0, 1, (1.0 - along) * up),
            (1, 1, along * up),
        ] {
            let cell = Cell {
                x: west + dx,
                y: south + dy,
            };
            if let Some((gx, gy)) = self.gradient(cell) {
                sum = (sum.0 + weight * gx, sum.1 + weight * gy);
            }
        }
        // The gradient's size means nothing, and f32 could not hold it.
        let size = sum.0.abs().max(sum.1.abs());
        (size > 0.0).then(|| math::atan2((sum.1 / size) as f32, (sum.0 / size) as f32))
    }

    /// Twice ∇q at the centre of a free cell.
    fn gradient(&self, cell: Cell) -> Option<(f64, f64)> {
        let index = self.frame.index(cell)?;
        let Kind::Free(_) = self.kinds[index] else {
            return None;
        };
        let [east, north, west, south] = self.frame.four(index).map(|near| self.at(near));
        Some((east - west, north - south))
    }

    /// The way of steepest descent of p from a free cell, cell by cell: the goal it leads to and its length, or `None` where
    /// the field has a local minimum (it has not converged yet) or is flat.
    pub(super) fn descend(&self, from: Cell) -> Option<(Cell, u32)> {
        let mut index = self.frame.index(from)?;
        for steps in 0..self.frame.len() as u32 {
            if self.kinds[index] == Kind::Goal {
                return Some((self.frame.cell(index), steps));
            }
            let Kind::Free(_) = self.kinds[index] else {
                return None;
            };
            let near = self.frame.four(index);
            let best = near
                .into_iter()
                .max_by(|&a, &b| self.at(a).total_cmp(&self.at(b)))?;
            if self.at(best) <= self.at(index) {
                return None;
            }
            index = best;
        }
        None
    }
}

/// What every cell is, the unknowns in order of their index, and the number of goals beside them.
fn bounds(
    chart: &Chart,
    robot: Cell,
    is_goal: impl Fn(Cell) -> bool,
) -> (Vec<Kind>, Vec<u32>, usize) {
    let frame = chart.frame();
    let mut kinds = vec![Kind::Obstacle; frame.len()];
    let mut pending: Vec<usize> = frame
        .index(robot)
        .filter(|&i| chart.is_passable(i))
        .into_iter()
        .collect();
    let mut goals = 0;
    for &start in &pending {
        kinds[start] = Kind::Free(0);
    }
    while let Some(index) = pending.pop() {
        for near in frame.four(index) {
            if kinds[near] != Kind::Obstacle || !chart.is_passable(near) {
                continue;
            }
            if chart.is_unexplored(near) && is_goal(frame.cell(near)) {
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
    (kinds, homes, goals)
}

fn nodes(frame: Frame, kinds: &[Kind], homes: &[u32]) -> Vec<Node> {
    let node = |&home: &u32| {
        let near = frame.four(home as usize).map(|near| kinds[near]);
        Node {
            beside: near.map(|kind| match kind {
                Kind::Free(node) => Some(node),
                _ => None,
            }),
            goals: near.iter().filter(|kind| **kind == Kind::Goal).count() as u8,
        }
    };
    homes.iter().map(node).collect()
}

fn places(frame: Frame, homes: &[u32]) -> Vec<(u32, u32)> {
    let place = |&home: &u32| {
        let (x, y) = frame.place(home as usize);
        (x as u32, y as u32)
    };
    homes.iter().map(place).collect()
}
