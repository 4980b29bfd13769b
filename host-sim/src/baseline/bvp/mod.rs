//! Baseline *bvp*: the frontier-guided boundary-value problem over the full grid [Prestes et al.], the method that all four
//! papers start from.
//!
//! Obstacles hold p = 1, every cell not measured yet p = 0, and the free cells are relaxed over the whole known grid; the robot
//! follows −∇p from where it stands. It chooses no goal and remembers none: it is drawn to the nearest and largest
//! frontiers, and the exploration is finished when no unexplored cell can be come to.
//!
//! What is the same as for the planner's strategy: map, clearance (cells in which the robot does not fit are obstacles, so
//! unexplored cells among them attract nothing), drive, and the rule that ends every run: an unexplored cell that the field
//! leads to and that comes no nearer for [`PATIENCE_MS`] is given up, with those within [`DROP_RADIUS_M`] of it; they
//! hold no value from then on but are relaxed like free cells. What is stronger than in [Prestes et al.]: the field is solved
//! for 1 − p to convergence by `multigrid`, where a fixed number of sweeps of p leaves it flat away from the frontiers. So
//! the paper's known failure, flattening, cannot end a run here. The other one, indecision between far goals, is in the
//! method and stays.
//!
//! # What it would cost on the chip
//! See [`Work`]: the grid grows with the building, which is why this baseline lives on the host.

mod field;
mod graph;
mod multigrid;

use fieldline_planner::geometry::{CELL_M, Cell, Point};
use fieldline_planner::status::{Frontier, Residue};
use fieldline_protocol::message::{FIELD_SIDE, FieldRow};

use super::session::{Outlook, Plan, Scene};
use field::{Field, GOAL, Kind};

/// Time without progress towards the goal that the field leads to, after which that goal is dropped, milliseconds.
pub const PATIENCE_MS: u32 = 12_000;
/// Around a dropped goal no other is one, metres.
pub const DROP_RADIUS_M: f32 = 0.5;
/// Goals nearer to each other than this are the same goal, metres.
const SAME_GOAL_M: f32 = 1.0;
/// Cycles in a step at the most.
const MOST_CYCLES: u16 = 12;
/// A heading that a cycle changes by less than this has converged, radians.
const SETTLED_RAD: f32 = 0.01;

/// What a run has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Steps.
    pub steps: u64,
    /// Free cells of the field, summed over the steps.
    pub cells: u64,
    /// Most free cells in a step.
    pub most_cells: u64,
    /// Cells of the known box in the largest step.
    pub box_cells: u64,
    /// Cell updates of the solver.
    pub updates: u64,
    /// Cycles.
    pub cycles: u64,
}

/// The strategy.
#[derive(Clone, Debug, Default)]
pub struct Bvp {
    field: Field,
    robot: Cell,
    dropped: Vec<Frontier>,
    pursuit: Option<Pursuit>,
    cycles: u16,
    work: Work,
}

/// The goal that the field leads to now.
#[derive(Clone, Copy, Debug)]
struct Pursuit {
    goal: Cell,
    /// Fewest steps to it so far, and when.
    fewest: u32,
    since_ms: u32,
}

fn near(a: Cell, b: Cell, radius_m: f32) -> bool {
    let (dx, dy) = ((a.x - b.x) as f32 * CELL_M, (a.y - b.y) as f32 * CELL_M);
    dx * dx + dy * dy < radius_m * radius_m
}

impl Bvp {
    /// At the start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What the run has cost.
    #[must_use]
    pub const fn work(&self) -> Work {
        self.work
    }

    /// Cycles until the heading has settled, or no slope is left to find.
    fn relax(&mut self, at: Point) {
        let mut before = None;
        self.cycles = 0;
        while self.cycles < MOST_CYCLES {
            self.field.cycle();
            self.cycles += 1;
            let heading = self.field.heading_at(at);
            let settled = before.zip(heading).is_some_and(|(a, b): (f32, f32)| {
                fieldline_planner::math::wrap(a - b).abs() < SETTLED_RAD
            });
            if settled && self.field.descend(at.cell()).is_some() {
                break;
            }
            before = heading;
        }
    }

    /// Drop the goal that the field leads to if the robot comes no nearer to it.
    fn keep_going(&mut self, time_ms: u32) {
        let Some((goal, steps)) = self.field.descend(self.robot) else {
            return;
        };
        let pursuit = match self.pursuit {
            Some(old) if near(old.goal, goal, SAME_GOAL_M) && steps >= old.fewest => old,
            _ => Pursuit {
                goal,
                fewest: steps,
                since_ms: time_ms,
            },
        };
        self.pursuit = Some(pursuit);
        if time_ms.wrapping_sub(pursuit.since_ms) > PATIENCE_MS {
            self.dropped.push(Frontier {
                cell: goal,
                cells: 1,
                reason: Residue::NoProgress,
            });
            self.pursuit = None;
        }
    }

    fn account(&mut self, box_cells: usize) {
        let cells = self.field.cells() as u64;
        self.work.steps += 1;
        self.work.cells += cells;
        self.work.most_cells = self.work.most_cells.max(cells);
        self.work.box_cells = self.work.box_cells.max(box_cells as u64);
        self.work.updates = self.field.updates();
        self.work.cycles += u64::from(self.cycles);
    }
}

impl Plan for Bvp {
    fn reset(&mut self) {
        *self = Self::new();
    }

    fn plan(&mut self, scene: &Scene<'_>) -> Outlook {
        let at = scene.pose.point();
        self.robot = at.cell();
        let dropped = &self.dropped;
        self.field.charge(scene.chart, self.robot, |cell| {
            !dropped
                .iter()
                .any(|goal| near(goal.cell, cell, DROP_RADIUS_M))
        });
        if !self.field.has_goals() {
            return Outlook::Nothing;
        }
        self.relax(at);
        self.account(scene.chart.frame().len());
        self.keep_going(scene.time_ms);
        Outlook::Way
    }

    fn heading_at(&self, _scene: &Scene<'_>, point: Point) -> Option<f32> {
        self.field.heading_at(point)
    }

    fn dropped(&self) -> Vec<Frontier> {
        self.dropped.clone()
    }

    fn cycles(&self) -> u16 {
        self.cycles
    }

    /// The part of the grid around the robot.
    fn field_row(&self, row: u8) -> Option<FieldRow> {
        let half = FIELD_SIDE as i32 / 2;
        if usize::from(row) >= FIELD_SIDE || self.field.cells() == 0 {
            return None;
        }
        let y = self.robot.y - half + i32::from(row);
        let cells = (0..FIELD_SIDE as i32).map(|x| Cell {
            x: self.robot.x - half + x,
            y,
        });
        let mut packed = [0u8; FIELD_SIDE.div_ceil(4)];
        for (x, cell) in cells.clone().enumerate() {
            let code = match self.field.kind(cell) {
                Kind::Free(_) => 0,
                Kind::Obstacle => 1,
                Kind::Goal => 2,
            };
            packed[x / 4] |= code << (2 * (x % 4));
        }
        Some(FieldRow {
            row,
            origin_x: (self.robot.x - half) as i16,
            origin_y: (self.robot.y - half) as i16,
            scale: 1,
            q: cells
                .map(|cell| (self.field.q(cell) / GOAL) as f32)
                .collect(),
            cells: packed.into_iter().collect(),
        })
    }
}
