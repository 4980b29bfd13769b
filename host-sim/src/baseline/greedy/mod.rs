//! Baseline *greedy-frontier*: what ROS users run, `explore_lite` (m-explore) over a global planner and a path follower.
//!
//! Every 3 s ([`Tuning::planner_period_ms`]), and at once where a goal is reached, the [`frontiers`] are found anew and the
//! cheapest that is not blacklisted is the goal. A goal to which the robot comes no nearer for 30 s is blacklisted, as is one
//! without a way. The [`route`] to it is planned anew every second (the rate of ROS 2's default behaviour tree), and
//! [`pursuit`] follows it. The exploration ends when no frontier is left, or only blacklisted ones.
//!
//! Parameters are those of the package's `explore.launch`: `planner_frequency` 0.33, `progress_timeout` 30, `potential_scale` 3.0,
//! `orientation_scale` 0, `gain_scale` 1.0, `min_frontier_size` 0.75
//! (<https://github.com/hrnr/m-explore>, `explore/launch/explore.launch` at 46223c4, `explore/src/frontier_search.cpp` and
//! `explore/src/explore.cpp` at 18526a7).
//!
//! Departs from the package, each time to the baseline's advantage:
//! - distance is the length of the way, not the straight line to the nearest cell of the frontier;
//! - the goal is the free cell at the frontier that is nearest to its centroid, not the centroid, which for a frontier around
//!   the robot is where the robot stands (the package then waits for its timeout);
//! - a frontier needs a way to it; the package finds out by the planner's failure;
//! - two goals count as the same if they lie within the blacklist's tolerance, not within 1 cm; otherwise a centroid that
//!   trembles would never time out;
//! - at a goal the robot looks around, where `move_base` turns to a heading of zero.
//!
//! Map, clearance and drive are the planner's.

pub mod frontiers;
pub mod inflation;
pub mod pursuit;
pub mod route;
pub mod tuning;

use fieldline_planner::geometry::{Cell, Point};
use fieldline_planner::status::{Frontier as Leftover, Residue};

use super::chart::Chart;
use super::session::{Outlook, Plan, Scene};
use frontiers::Frontier;
use inflation::Inflation;
use route::Routes;
pub use tuning::Tuning;

/// Goals nearer to each other than this in both axes are the same to the blacklist, cells: the package's tolerance.
const TOLERANCE_CELLS: i32 = 5;
/// Time from one planning of the route to the next, milliseconds.
const ROUTE_PERIOD_MS: u32 = 1_000;
/// The potential along the way doubles in this, metres.
const DOUBLES_IN_M: f32 = 0.1;

/// The goal of the moment.
#[derive(Clone, Copy, Debug)]
struct Goal {
    cell: Cell,
    /// Where the way to it ends.
    approach: Cell,
    cells: usize,
    /// Nearest that the robot was to it, metres, and when it came so near, milliseconds.
    nearest_m: f32,
    since_ms: u32,
}

/// The strategy.
#[derive(Clone, Debug, Default)]
pub struct GreedyFrontier {
    tuning: Tuning,
    goal: Option<Goal>,
    way: Vec<Point>,
    inflation: Inflation,
    blacklist: Vec<Leftover>,
    /// Frontiers without a way to them at the last choice.
    unreachable: Vec<(Cell, usize)>,
    chosen_ms: u32,
    routed_ms: u32,
    /// The goal was reached, and chosen anew since.
    reached: bool,
}

fn same(a: Cell, b: Cell) -> bool {
    (a.x - b.x).abs() < TOLERANCE_CELLS && (a.y - b.y).abs() < TOLERANCE_CELLS
}

impl GreedyFrontier {
    /// With these parameters.
    #[must_use]
    pub fn new(tuning: Tuning) -> Self {
        Self {
            tuning,
            ..Self::default()
        }
    }

    /// Choose a goal.
    fn choose(&mut self, chart: &Chart, routes: &Routes, robot: Cell, time_ms: u32) {
        self.chosen_ms = time_ms;
        let found = frontiers::search(chart, routes, robot, &self.tuning);
        self.unreachable = found.unreachable;
        for frontier in found.frontiers {
            let listed = |black: &Leftover| same(black.cell, frontier.goal);
            if !self.blacklist.iter().any(listed) && self.pursue(chart, &frontier, time_ms) {
                return;
            }
        }
        self.goal = None;
    }

    /// Make this the goal; false if it was the goal for too long without progress, and is blacklisted now.
    fn pursue(&mut self, chart: &Chart, frontier: &Frontier, time_ms: u32) -> bool {
        let before = self.goal.filter(|goal| same(goal.cell, frontier.goal));
        let (nearest_m, since_ms) = match before {
            Some(goal) if goal.nearest_m <= frontier.distance_m => (goal.nearest_m, goal.since_ms),
            _ => (frontier.distance_m, time_ms),
        };
        self.reached &= before.is_some();
        let goal = Goal {
            cell: frontier.goal,
            approach: chart.frame().cell(frontier.approach),
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

    fn give_up(&mut self, goal: Goal) {
        let reason = if self.reached {
            Residue::Unobservable
        } else {
            Residue::NoProgress
        };
        self.blacklist.push(Leftover {
            cell: goal.cell,
            cells: u16::try_from(goal.cells).unwrap_or(u16::MAX),
            reason,
        });
        self.goal = None;
        self.reached = false;
    }
}

impl Plan for GreedyFrontier {
    fn reset(&mut self) {
        *self = Self::new(self.tuning);
    }

    fn plan(&mut self, scene: &Scene<'_>) -> Outlook {
        let (at, time_ms) = (scene.pose.point(), scene.time_ms);
        let elapsed = |since_ms: u32, period_ms| time_ms.wrapping_sub(since_ms) >= period_ms;
        let arrives = self.goal.is_some() && !self.reached && pursuit::has_arrived(&self.way, at);
        let choosing = self.goal.is_none()
            || arrives
            || elapsed(self.chosen_ms, self.tuning.planner_period_ms);
        if choosing || elapsed(self.routed_ms, ROUTE_PERIOD_MS) {
            self.routed_ms = time_ms;
            self.reached |= arrives;
            self.inflation = Inflation::new(scene.chart);
            let routes = Routes::from(scene.chart, &self.inflation, at.cell());
            if choosing {
                self.choose(scene.chart, &routes, at.cell(), time_ms);
            }
            self.way.clear();
            if let Some(goal) = self.goal {
                let index = scene.chart.frame().index(goal.approach);
                self.way = index.map_or_else(Vec::new, |index| routes.way(scene.chart, index));
                if self.way.is_empty() {
                    self.give_up(goal);
                    self.choose(scene.chart, &routes, at.cell(), time_ms);
                }
            }
        }
        match self.goal {
            Some(_) => Outlook::Way,
            None => Outlook::Nothing,
        }
    }

    fn heading_at(&self, scene: &Scene<'_>, point: Point) -> Option<f32> {
        pursuit::heading(scene.chart, &self.inflation, &self.way, point)
    }

    fn potential_at(&self, scene: &Scene<'_>, point: Point) -> f32 {
        let remaining_m = |at: Point| pursuit::remaining_m(&self.way, at);
        let ahead_m = remaining_m(scene.pose.point()) - remaining_m(point);
        libm::exp2f(ahead_m / DOUBLES_IN_M)
    }

    fn dropped(&self) -> Vec<Leftover> {
        let unreachable = self.unreachable.iter().map(|&(cell, cells)| Leftover {
            cell,
            cells: u16::try_from(cells).unwrap_or(u16::MAX),
            reason: Residue::Unreachable,
        });
        self.blacklist.iter().copied().chain(unreachable).collect()
    }
}
