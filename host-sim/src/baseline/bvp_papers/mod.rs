//! Baseline *bvp-papers*: the boundary-value problem over the full grid \[Prestes02\] as a robot
//! runs it that has no time to solve it. \[Maffei14\] and \[Jorge15\] compare with such a robot.
//!
//! ```text
//! chart → roles → Relaxation::sweeps sweeps of the stored p ([`stored`]) → −∇p at the robot
//! ```
//!
//! The potential is stored from step to step, as p, and each step makes a fixed number of
//! Gauss–Seidel sweeps over the whole known grid. The sweeps say nothing about convergence. So the
//! two failures of the method that the papers name can occur:
//! - *flattening*: far from the goals, and behind narrow passages, 1 − p falls below what the type
//!   can hold near 1, so there is no gradient to follow;
//! - *indecision*: the field lags behind the map, and its gradient turns while the robot follows.
//!
//! # Choices where the papers give none
//! - [`Relaxation::DEFAULT`]: 100 sweeps a step in f64. \[Maffei14\] says that full convergence is
//!   too slow for a robot, and \[Maffei20\] that differences reach 1e-10, which f32 near 1 cannot
//!   hold. No paper gives the number of sweeps. The laboratory's published code
//!   (`phir2-lab/laeg`, `loop_exploration.cpp`) makes 100 in-place iterations of a potential of
//!   type `double` for each plan.
//! - The field is flat where the stored values of the cells beside the robot's are equal:
//!   \[Jorge15\] says "there is no gradient descent to follow". The robot then stands, and the
//!   sweeps go on. If p is flat for [`super::session::FLAT_MS`] the run ends as *nothing attracts*.
//!   A run ends *explored* only if no unexplored cell can be reached.
//! - A goal is never given up because the robot comes no nearer to it. Only one that the robot has
//!   reached, and that its lasers do not show for [`super::bvp::progress::LOOK_MS`], is dropped.
//!   A robot that moves less than 0.3 m in [`STUCK_MS`] is *stuck*.
//!
//! Map, configuration space and drive are those of the other baselines.

mod stored;

use fieldline_planner::geometry::{Cell, Point};
use fieldline_planner::status::ResidualFrontier;
use fieldline_protocol::message::FieldRow;

use super::bvp::progress::{Patience, ProgressChecker};
use super::slope;
use super::strategy::{Outcome, Scene, Strategy};
use stored::Stored;

/// Time with less than 0.3 m of motion after which the robot is stuck, milliseconds. A robot that
/// neither moves nor turns for a minute is *frozen* before.
pub const STUCK_MS: u32 = 600_000;

/// Type in which p is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 24 bits: near p = 1 differences below 6e-8 vanish.
    F32,
    /// 53 bits: near p = 1 differences below 1.1e-16 vanish.
    F64,
}

impl Precision {
    /// Returns the name on the command line and in the report.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// How the stored potential is relaxed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Relaxation {
    /// Sweeps in a step, at least 1.
    pub sweeps: u16,
    /// Type of the stored values.
    pub precision: Precision,
}

impl Relaxation {
    /// 100 sweeps in f64: see the module's documentation.
    pub const DEFAULT: Self = Self {
        sweeps: 100,
        precision: Precision::F64,
    };
}

impl Default for Relaxation {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The strategy.
#[derive(Clone, Debug)]
pub struct BvpPapers {
    relaxation: Relaxation,
    field: Stored,
    robot: Cell,
    progress: ProgressChecker,
    stood: Option<(Point, u32)>,
}

impl BvpPapers {
    /// Makes the strategy for a new session.
    #[must_use]
    pub fn new(relaxation: Relaxation) -> Self {
        Self {
            relaxation,
            field: Stored::default(),
            robot: Cell::default(),
            progress: ProgressChecker::new(Patience::Endless),
            stood: None,
        }
    }

    /// Returns true if the robot has stood for [`STUCK_MS`].
    fn is_stuck(&mut self, at: Point, time_ms: u32) -> bool {
        let near = |from: Point| (at.x_m - from.x_m).hypot(at.y_m - from.y_m) < 0.3;
        let stood = self.stood.filter(|(from, _)| near(*from));
        let (_, since_ms) = *self.stood.insert(stood.unwrap_or((at, time_ms)));
        time_ms.wrapping_sub(since_ms) >= STUCK_MS
    }
}

impl Strategy for BvpPapers {
    fn reset(&mut self) {
        *self = Self::new(self.relaxation);
    }

    fn plan(&mut self, scene: &Scene<'_>) -> Outcome {
        let at = scene.pose.point();
        self.robot = at.cell();
        let progress = &self.progress;
        let is_goal = |cell| !progress.is_dropped(cell);
        self.field.charge(scene.chart, self.robot, is_goal);
        if !self.field.has_goals() {
            return Outcome::Nothing;
        }
        let Relaxation { sweeps, precision } = self.relaxation;
        self.field.sweep(sweeps, precision);
        if let Some(goal) = self.field.descend(self.robot) {
            self.progress.note(at, goal, scene.time_ms);
        }
        if self.is_stuck(at, scene.time_ms) {
            Outcome::Stuck
        } else if self.field.is_flat(self.robot) {
            Outcome::Flat
        } else {
            Outcome::Path
        }
    }

    fn heading_at(&self, _scene: &Scene<'_>, point: Point) -> Option<f32> {
        self.field.heading_at(point)
    }

    /// As for q of the planner: 1 − p. It is 0 where p rounds to 1.
    fn potential_at(&self, scene: &Scene<'_>, point: Point) -> f32 {
        let here = 1.0 - self.field.p(scene.pose.point().cell());
        ((1.0 - self.field.p(point.cell())) / here.max(f64::EPSILON)) as f32
    }

    fn dropped(&self) -> Vec<ResidualFrontier> {
        self.progress.dropped().to_vec()
    }

    /// Returns the sweeps of a step.
    fn cycles(&self) -> u16 {
        self.relaxation.sweeps
    }

    /// Returns a row of the part of the grid around the robot.
    fn field_row(&self, row: u8) -> Option<FieldRow> {
        if self.field.cells() == 0 {
            return None;
        }
        slope::field_row(self.robot, row, |cell| {
            let q = 1.0 - self.field.p(cell);
            (self.field.role(cell), q as f32)
        })
    }
}

#[cfg(test)]
mod tests;
