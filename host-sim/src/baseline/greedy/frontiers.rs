//! Frontiers and what they cost: the rule of `explore_lite`.
//!
//! The free cells connected with the robot's are searched; an unknown cell with one of them among its four neighbours is a
//! frontier cell. Frontiers are the 8-connected clusters of them; those shorter than a minimum size are ignored. The cheapest
//! is the goal:
//!
//! ```text
//! cost = potential_scale · distance − gain_scale · size
//! ```
//!
//! As the package does by default, the search looks at the map without inflation, so that a door as wide as the minimum size
//! counts; whether the robot fits through is the global planner's business. A frontier is driven to at a cell with a way to it
//! at most `APPROACH_CELLS` from one of its own, the goal tolerance of ROS 2's default planner.
//!
//! Units: metres; a frontier's size is its number of cells times the side of one.

use fieldline_planner::geometry::{CELL_M, Cell};

use super::route::Routes;
use super::tuning::Tuning;
use crate::baseline::chart::Chart;

/// How far from a frontier's cell the way to it may end, cells: 0.5 m.
const APPROACH_CELLS: i32 = 5;

/// A frontier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frontier {
    /// Cells in it.
    pub cells: usize,
    /// Length of the shortest of the ways to its cells, metres.
    pub distance_m: f32,
    /// Its cell nearest to its centroid of those that can be approached.
    pub goal: Cell,
    /// The end of the way to that cell, by the chart's index.
    pub approach: usize,
}

impl Frontier {
    /// Cells times their side, metres.
    #[must_use]
    pub fn size_m(&self) -> f32 {
        self.cells as f32 * CELL_M
    }

    /// The cost; the least is the best.
    #[must_use]
    pub fn cost(&self, tuning: &Tuning) -> f32 {
        tuning.potential_scale * self.distance_m - tuning.gain_scale * self.size_m()
    }
}

/// What a search found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Frontiers of at least the minimum size with a way to them, the cheapest first; of equal ones the one of least index first.
    pub frontiers: Vec<Frontier>,
    /// Those without a way: a cell of each, and how many it has.
    pub unreachable: Vec<(Cell, usize)>,
}

/// All frontiers of at least the minimum size.
#[must_use]
pub fn search(chart: &Chart, routes: &Routes, robot: Cell, tuning: &Tuning) -> Found {
    let mut open = frontier_cells(chart, robot);
    let mut found = Found::default();
    for first in 0..open.len() {
        if !open[first] {
            continue;
        }
        let cells = cluster(&mut open, chart.frame().width, first);
        // A hair is taken off against rounding: 0.75 m are eight cells, 0.8 m too.
        if (cells.len() as f32) * CELL_M > tuning.min_frontier_size_m - 1e-4 {
            match frontier(chart, routes, &cells) {
                Some(frontier) => found.frontiers.push(frontier),
                None => found
                    .unreachable
                    .push((chart.frame().cell(first), cells.len())),
            }
        }
    }
    found
        .frontiers
        .sort_by(|a, b| a.cost(tuning).total_cmp(&b.cost(tuning)));
    found
}

/// The unknown cells beside free cells that are connected with the robot's.
fn frontier_cells(chart: &Chart, robot: Cell) -> Vec<bool> {
    let frame = chart.frame();
    let mut frontier = vec![false; frame.len()];
    let mut seen = vec![false; frame.len()];
    let mut pending: Vec<usize> = frame.index(robot).into_iter().collect();
    while let Some(index) = pending.pop() {
        if frame.is_rim(index) {
            continue;
        }
        for near in frame.four(index) {
            if chart.is_unknown(near) {
                frontier[near] = !frame.is_rim(near);
            } else if !chart.is_obstacle(near) && !seen[near] {
                seen[near] = true;
                pending.push(near);
            }
        }
    }
    frontier
}

/// Take the 8-connected cluster that `first` is in out of `open`.
fn cluster(open: &mut [bool], width: usize, first: usize) -> Vec<usize> {
    let mut cells = vec![first];
    open[first] = false;
    let mut next = 0;
    while let Some(&index) = cells.get(next) {
        next += 1;
        for row in [index - width, index, index + width] {
            for near in [row - 1, row, row + 1] {
                if open[near] {
                    open[near] = false;
                    cells.push(near);
                }
            }
        }
    }
    cells
}

/// The cell with a way to it that is nearest to a cell, within the tolerance; the first one of equal ones.
fn approach(chart: &Chart, routes: &Routes, cell: Cell) -> Option<usize> {
    let reach = -APPROACH_CELLS..=APPROACH_CELLS;
    let around = reach
        .clone()
        .flat_map(|dy| reach.clone().map(move |dx| (dx, dy)));
    let near = around.filter_map(|(dx, dy)| {
        let square = dx * dx + dy * dy;
        let index = chart.frame().index(Cell {
            x: cell.x + dx,
            y: cell.y + dy,
        })?;
        routes.length_m(index)?;
        (square <= APPROACH_CELLS * APPROACH_CELLS).then_some((square, index))
    });
    near.min_by_key(|(square, _)| *square)
        .map(|(_, index)| index)
}

fn frontier(chart: &Chart, routes: &Routes, cells: &[usize]) -> Option<Frontier> {
    let members = || cells.iter().map(|&index| chart.frame().cell(index));
    let count = cells.len() as f32;
    let sum = members().fold((0.0, 0.0), |sum, cell| {
        (sum.0 + cell.x as f32, sum.1 + cell.y as f32)
    });
    let from_centroid =
        |cell: Cell| (cell.x as f32 - sum.0 / count).hypot(cell.y as f32 - sum.1 / count);
    let ways = members().filter_map(|cell| Some((cell, approach(chart, routes, cell)?)));
    let ways: Vec<(Cell, usize)> = ways.collect();
    let lengths = ways.iter().filter_map(|&(_, way)| routes.length_m(way));
    let goal = ways
        .iter()
        .min_by(|a, b| from_centroid(a.0).total_cmp(&from_centroid(b.0)));
    let &(goal, approach) = goal?;
    Some(Frontier {
        cells: cells.len(),
        distance_m: lengths.min_by(f32::total_cmp)?,
        goal,
        approach,
    })
}

#[cfg(test)]
mod tests {
    use super::{Found, Frontier, search};
    use crate::baseline::chart::sketch::chart_for;
    use crate::baseline::greedy::inflation::Inflation;
    use crate::baseline::greedy::route::Routes;
    use crate::baseline::greedy::tuning::Tuning;
    use fieldline_planner::geometry::Cell;

    fn tuning(min_frontier_size_m: f32) -> Tuning {
        Tuning {
            min_frontier_size_m,
            ..Tuning::default()
        }
    }

    fn found(rows: &[&str], radius_m: f32, tuning: &Tuning) -> Found {
        let (chart, robot) = chart_for(rows, radius_m);
        let routes = Routes::from(&chart, &Inflation::new(&chart), robot.cell());
        search(&chart, &routes, robot.cell(), tuning)
    }

    /// Cells and goal of each frontier.
    fn told(found: &Found) -> Vec<(usize, (i32, i32))> {
        let tell = |f: &Frontier| (f.cells, (f.goal.x, f.goal.y));
        found.frontiers.iter().map(tell).collect()
    }

    #[test]
    fn clusters_are_eight_connected_and_lie_in_the_unknown() {
        // A staircase is one frontier; the cells behind the wall are another; those behind them are none.
        let rows = [
            "############", //
            "#..????#???#",
            "#...???#???#",
            "#....??....#",
            "#R.......###",
            "############",
        ];
        let mut found = told(&found(&rows, 0.05, &tuning(0.0)));
        found.sort_unstable();
        assert_eq!(found, [(3, (9, 3)), (4, (4, 3))]);
    }

    #[test]
    fn short_frontiers_are_ignored() {
        let rows = [
            "##############", //
            "#R...........#",
            "#????????##?##",
            "##############",
        ];
        let sizes = |least_m| {
            let found = found(&rows, 0.05, &tuning(least_m));
            found.frontiers.iter().map(|f| f.cells).collect::<Vec<_>>()
        };
        assert_eq!(sizes(0.0), [8, 1]);
        assert_eq!(sizes(0.75), [8], "eight cells are 0.8 m");
        assert!(sizes(0.85).is_empty());
    }

    #[test]
    fn a_door_counts_with_its_full_width_not_with_its_lanes() {
        let door = [
            "???????????????", //
            "???????????????",
            "####.......####",
            "#.............#",
            "#.............#",
            "#.............#",
            "#......R......#",
            "#.............#",
            "###############",
        ];
        let wide = found(&door, 0.3, &tuning(0.65));
        assert_eq!(wide.frontiers.first().map(|f| f.cells), Some(7));
    }

    #[test]
    fn a_frontier_seen_through_a_gap_that_the_robot_does_not_fit_through_is_unreachable() {
        let mut rows = vec!["################"; 1];
        rows.extend(["#??????????????#"; 3]);
        rows.extend(["#..............#"; 7]);
        rows.extend(["######...#######"; 2]);
        rows.extend(["#..............#"; 4]);
        rows.extend(["#......R.......#"; 1]);
        rows.extend(["#..............#"; 4]);
        rows.extend(["################"; 1]);
        let found = found(&rows, 0.3, &tuning(0.75));
        assert!(found.frontiers.is_empty());
        assert_eq!(found.unreachable, [(Cell { x: 1, y: 19 }, 14)]);
    }

    #[test]
    fn the_goal_is_on_the_frontier_even_where_its_centroid_is_not() {
        let rows = [
            "#############", //
            "#???????????#",
            "#?.........?#",
            "#?.........?#",
            "#?....R....?#",
            "#?.........?#",
            "#?.........?#",
            "#???????????#",
            "#############",
        ];
        // The ring's centroid is the robot itself.
        let found = told(&found(&rows, 0.05, &tuning(0.0)));
        assert!(found.len() == 1 && found[0].0 == 28, "{found:?}");
        let (x, y) = found[0].1;
        assert!(x == 1 || x == 11 || y == 1 || y == 7, "({x}, {y})");
    }

    #[test]
    fn near_and_large_are_cheap() {
        let tuning = Tuning::default();
        let cost = |cells, distance_m| {
            let frontier = Frontier {
                cells,
                distance_m,
                goal: Cell::default(),
                approach: 0,
            };
            frontier.cost(&tuning)
        };
        assert!(cost(10, 2.0) < cost(10, 3.0));
        assert!(cost(20, 2.0) < cost(10, 2.0));
        assert!((cost(15, 2.0) - (3.0 * 2.0 - 1.0 * 1.5)).abs() < 1e-5);
    }

    #[test]
    fn the_cheapest_is_first() {
        let rows = [
            "####################", //
            "#.....R............#",
            "#???############???#",
            "####################",
        ];
        let goals = |tuning: &Tuning| told(&found(&rows, 0.05, tuning));
        let near = goals(&tuning(0.0));
        let far = goals(&Tuning {
            potential_scale: -3.0,
            ..tuning(0.0)
        });
        assert_eq!(near, [(3, (2, 1)), (3, (17, 1))]);
        assert_eq!(far, [(3, (17, 1)), (3, (2, 1))]);
    }
}
