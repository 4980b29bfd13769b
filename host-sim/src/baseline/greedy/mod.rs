//! Baseline *greedy-frontier*: `explore_lite` (m-explore), which many ROS robots run, over a global
//! planner and a path follower.
//!
//! The [`frontiers`] are searched every 3 s ([`Tuning::planner_period_ms`]), and at once when a
//! goal is reached; the cheapest that is not blacklisted is the goal. A goal is blacklisted if the
//! robot comes no nearer to it for 30 s, or if there is no path to it. The path to the goal is
//! planned anew every second, the rate of ROS 2's default behaviour tree ([`paths`]), and followed
//! by [`pursuit`]. The exploration ends when all frontiers are blacklisted or none is left.
//!
//! Parameters are those of the package's `explore.launch`: `planner_frequency` 0.33,
//! `progress_timeout` 30, `potential_scale` 3.0, `orientation_scale` 0, `gain_scale` 1.0,
//! `min_frontier_size` 0.75 (<https://github.com/hrnr/m-explore>: `explore/launch/explore.launch`
//! at 46223c4, `explore/src/frontier_search.cpp` and `explore/src/explore.cpp` at 18526a7).
//!
//! Departs from the package in five points, each to the advantage of the baseline:
//! - The distance of a frontier is the length of the path, not of the straight line to its nearest
//!   cell.
//! - The goal is the cell of the frontier nearest to its centroid. The package takes the centroid
//!   itself; for a frontier around the robot that is the robot's place, and it waits for its
//!   timeout there.
//! - A frontier without a path is no goal. The package sends the goal and waits for the failure.
//! - Two goals are the same if they lie within the tolerance of the blacklist. The package asks for
//!   1 cm, so a centroid that jitters never times out.
//! - At a goal the robot looks around. `move_base` turns to a heading of zero.
//!
//! Map, configuration space and drive are the planner's.

pub mod frontiers;
pub mod inflation;
pub mod paths;
pub mod pursuit;
pub mod tuning;

use fieldline_planner::geometry::{Cell, Point};
use fieldline_planner::status::{ResidualFrontier, ResidualReason};

use super::chart::Chart;
use super::strategy::{Outcome, Scene, Strategy};
use frontiers::Frontier;
use inflation::Inflation;
use paths::Paths;
pub use tuning::Tuning;

/// Tolerance of the blacklist, cells: nearer goals in x and in y are the same. The package's.
const TOLERANCE_CELLS: i32 = 5;
/// Time between two plannings of the path, milliseconds.
const PATH_PERIOD_MS: u32 = 1_000;
/// Distance along the path in which the potential doubles, metres.
const DOUBLES_IN_M: f32 = 0.1;

/// The present goal.
#[derive(Clone, Copy, Debug)]
struct Goal {
    cell: Cell,
    /// End of the path to it.
    approach: Cell,
    cells: usize,
    /// Least distance so far, metres, and the time of that, milliseconds.
    nearest_m: f32,
    since_ms: u32,
}

/// The strategy.
#[derive(Clone, Debug, Default)]
pub struct GreedyFrontier {
    tuning: Tuning,
    goal: Option<Goal>,
    path: Vec<Point>,
    inflation: Inflation,
    blacklist: Vec<ResidualFrontier>,
    /// Frontiers without a path at the last choice.
    unreachable: Vec<(Cell, usize)>,
    chosen_ms: u32,
    planned_ms: u32,
    /// True if the goal was reached and chosen again since.
    reached: bool,
}

/// Returns true if two goals are the same for the blacklist.
fn same(a: Cell, b: Cell) -> bool {
    (a.x - b.x).abs() < TOLERANCE_CELLS && (a.y - b.y).abs() < TOLERANCE_CELLS
}

impl GreedyFrontier {
    /// Makes the strategy with these parameters.
    #[must_use]
    pub fn new(tuning: Tuning) -> Self {
        Self {
            tuning,
            ..Self::default()
        }
    }

    /// Chooses a goal.
    fn choose(&mut self, chart: &Chart, paths: &Paths, robot: Cell, time_ms: u32) {
        self.chosen_ms = time_ms;
        let found = frontiers::search(chart, paths, robot, &self.tuning);
        self.unreachable = found.unreachable;
        for frontier in found.frontiers {
            let listed = |black: &ResidualFrontier| same(black.cell, frontier.goal);
            if !self.blacklist.iter().any(listed) && self.pursue(chart, &frontier, time_ms) {
                return;
            }
        }
        self.goal = None;
    }

    /// Makes a frontier the goal. Returns false if it was the goal for too long without progress;
    /// it is blacklisted then.
    fn pursue(&mut self, chart: &Chart, frontier: &Frontier, time_ms: u32) -> bool {
        let before = self.goal.filter(|goal| same(goal.cell, frontier.goal));
        let (nearest_m, since_ms) = match before {
            Some(goal) if goal.nearest_m <= frontier.distance_m => (goal.nearest_m, goal.since_ms),
            _ => (frontier.distance_m, time_ms),
        };
        self.reached &= before.is_some();
        let goal = Goal {
            cell: frontier.goal,
            approach: chart.area().cell(frontier.approach),
            cells: frontier.cells,
            nearest_m,
            since_ms,
        };
        self.goal = Some(goal);
        if time_ms.wrapping_sub(since_ms) > self.tuning.progress_timeout_ms {
            self.give_up(goal);
            return false;
        }
        true
    }

    /// Blacklists the goal.
    fn give_up(&mut self, goal: Goal) {
        let reason = if self.reached {
            ResidualReason::Unobservable
        } else {
            ResidualReason::NoProgress
        };
        self.blacklist.push(ResidualFrontier {
            cell: goal.cell,
            cells: u16::try_from(goal.cells).unwrap_or(u16::MAX),
            reason,
        });
        self.goal = None;
        self.reached = false;
    }
}

impl Strategy for GreedyFrontier {
    fn reset(&mut self) {
        *self = Self::new(self.tuning);
    }

    fn plan(&mut self, scene: &Scene<'_>) -> Outcome {
        let (at, time_ms) = (scene.pose.point(), scene.time_ms);
        let elapsed = |since_ms: u32, period_ms| time_ms.wrapping_sub(since_ms) >= period_ms;
        let arrives = self.goal.is_some() && !self.reached && pursuit::has_arrived(&self.path, at);
        let choosing = self.goal.is_none()
            || arrives
            || elapsed(self.chosen_ms, self.tuning.planner_period_ms);
        if choosing || elapsed(self.planned_ms, PATH_PERIOD_MS) {
            self.planned_ms = time_ms;
            self.reached |= arrives;
            self.inflation = Inflation::new(scene.chart);
            let paths = Paths::from(scene.chart, &self.inflation, at.cell());
            if choosing {
                self.choose(scene.chart, &paths, at.cell(), time_ms);
            }
            self.path.clear();
            if let Some(goal) = self.goal {
                let index = scene.chart.area().index(goal.approach);
                self.path = index.map_or_else(Vec::new, |index| paths.path(scene.chart, index));
                if self.path.is_empty() {
                    self.give_up(goal);
                    self.choose(scene.chart, &paths, at.cell(), time_ms);
                }
            }
        }
        match self.goal {
            Some(_) => Outcome::Path,
            None => Outcome::Nothing,
        }
    }

    fn heading_at(&self, scene: &Scene<'_>, point: Point) -> Option<f32> {
        pursuit::heading(scene.chart, &self.inflation, &self.path, point)
    }

    fn potential_at(&self, scene: &Scene<'_>, point: Point) -> f32 {
        let remaining_m = |at: Point| pursuit::remaining_m(&self.path, at);
        let ahead_m = remaining_m(scene.pose.point()) - remaining_m(point);
        libm::exp2f(ahead_m / DOUBLES_IN_M)
    }

    fn dropped(&self) -> Vec<ResidualFrontier> {
        let unreachable = self
            .unreachable
            .iter()
            .map(|&(cell, cells)| ResidualFrontier {
                cell,
                cells: u16::try_from(cells).unwrap_or(u16::MAX),
                reason: ResidualReason::Unreachable,
            });
        self.blacklist.iter().copied().chain(unreachable).collect()
    }
}
