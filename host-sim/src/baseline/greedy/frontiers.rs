//! Search for frontiers and their costs, by the rules of `explore_lite`.
//!
//! The search covers the free cells connected with the robot's cell. An unknown cell with one of
//! them among its four neighbours is a frontier cell. A frontier is an 8-connected cluster of
//! frontier cells; clusters below a minimum size are ignored. The cheapest frontier is the goal:
//!
//! ```text
//! cost = potential_scale · distance − gain_scale · size
//! ```
//!
//! As in the package, the search ignores inflation, so a door as wide as the minimum size counts;
//! the global planner decides whether the robot fits through. The path to a frontier ends at most
//! 0.5 m from one of its cells, the goal tolerance of ROS 2's default planner.
//!
//! Units: metres; the size of a frontier is its number of cells times their side.

use fieldline_planner::geometry::{CELL_M, Cell};

use super::paths::Paths;
use super::tuning::Tuning;
use crate::baseline::chart::Chart;

/// Greatest distance from a frontier cell to the end of the path to it, cells: 0.5 m.
const APPROACH_CELLS: i32 = 5;

/// A frontier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frontier {
    /// Number of cells.
    pub cells: usize,
    /// Length of the shortest path to its cells, metres.
    pub distance_m: f32,
    /// The cell nearest to its centroid, among those with a path.
    pub goal: Cell,
    /// Index of the end of the path to that cell, in the chart.
    pub approach: usize,
}

impl Frontier {
    /// Returns the size: cells times their side, metres.
    #[must_use]
    pub fn size_m(&self) -> f32 {
        self.cells as f32 * CELL_M
    }

    /// Returns the cost; the least is the best.
    #[must_use]
    pub fn cost(&self, tuning: &Tuning) -> f32 {
        tuning.potential_scale * self.distance_m - tuning.gain_scale * self.size_m()
    }
}

/// Result of a search.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Frontiers with a path, the cheapest first; equal ones in the order of their indices.
    pub frontiers: Vec<Frontier>,
    /// Frontiers without a path: a cell of each, and its number of cells.
    pub unreachable: Vec<(Cell, usize)>,
}

/// Finds all frontiers of at least the minimum size.
#[must_use]
pub fn search(chart: &Chart, paths: &Paths, robot: Cell, tuning: &Tuning) -> Found {
    let mut open = frontier_cells(chart, robot);
    let mut found = Found::default();
    for first in 0..open.len() {
        if !open[first] {
            continue;
        }
        let cells = cluster(&mut open, chart.area().width, first);
        // 0.1 mm less, against rounding: eight cells pass for 0.75 m and for 0.8 m.
        if (cells.len() as f32) * CELL_M > tuning.min_frontier_size_m - 1e-4 {
            match frontier(chart, paths, &cells) {
                Some(frontier) => found.frontiers.push(frontier),
                None => found
                    .unreachable
                    .push((chart.area().cell(first), cells.len())),
            }
        }
    }
    found
        .frontiers
        .sort_by(|a, b| a.cost(tuning).total_cmp(&b.cost(tuning)));
    found
}

/// Marks the unknown cells beside free cells that are connected with the robot's cell.
fn frontier_cells(chart: &Chart, robot: Cell) -> Vec<bool> {
    let frame = chart.area();
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

/// Removes the 8-connected cluster around `first` from `open` and returns it.
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

/// Returns the cell with a path that is nearest to a cell, within the tolerance; the first of equal
/// ones.
fn approach(chart: &Chart, paths: &Paths, cell: Cell) -> Option<usize> {
    let reach = -APPROACH_CELLS..=APPROACH_CELLS;
    let around = reach
        .clone()
        .flat_map(|dy| reach.clone().map(move |dx| (dx, dy)));
    let near = around.filter_map(|(dx, dy)| {
        let square = dx * dx + dy * dy;
        let index = chart.area().index(Cell {
            x: cell.x + dx,
            y: cell.y + dy,
        })?;
        paths.length_m(index)?;
        (square <= APPROACH_CELLS * APPROACH_CELLS).then_some((square, index))
    });
    near.min_by_key(|(square, _)| *square)
        .map(|(_, index)| index)
}

/// Makes a frontier from its cells; `None` if there is no path to any.
fn frontier(chart: &Chart, paths: &Paths, cells: &[usize]) -> Option<Frontier> {
    let members = || cells.iter().map(|&index| chart.area().cell(index));
    let count = cells.len() as f32;
    let sum = members().fold((0.0, 0.0), |sum, cell| {
        (sum.0 + cell.x as f32, sum.1 + cell.y as f32)
    });
    let from_centroid =
        |cell: Cell| (cell.x as f32 - sum.0 / count).hypot(cell.y as f32 - sum.1 / count);
    let ends = members().filter_map(|cell| Some((cell, approach(chart, paths, cell)?)));
    let ends: Vec<(Cell, usize)> = ends.collect();
    let lengths = ends.iter().filter_map(|&(_, end)| paths.length_m(end));
    let goal = ends
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
    use crate::baseline::greedy::paths::Paths;
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
        let paths = Paths::from(&chart, &Inflation::new(&chart), robot.cell());
        search(&chart, &paths, robot.cell(), tuning)
    }

    /// Number of cells and goal of each frontier.
    fn summary(found: &Found) -> Vec<(usize, (i32, i32))> {
        let row = |f: &Frontier| (f.cells, (f.goal.x, f.goal.y));
        found.frontiers.iter().map(row).collect()
    }

    #[test]
    fn clusters_are_eight_connected_and_lie_in_the_unknown() {
        // A staircase is one frontier, the cells behind the wall are another. Unknown cells behind
        // frontier cells are none.
        let rows = [
            "############", //
            "#..????#???#",
            "#...???#???#",
            "#....??....#",
            "#R.......###",
            "############",
        ];
        let mut found = summary(&found(&rows, 0.05, &tuning(0.0)));
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
        // The centroid of the ring is the robot itself.
        let found = summary(&found(&rows, 0.05, &tuning(0.0)));
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
        let goals = |tuning: &Tuning| summary(&found(&rows, 0.05, tuning));
        let near = goals(&tuning(0.0));
        let far = goals(&Tuning {
            potential_scale: -3.0,
            ..tuning(0.0)
        });
        assert_eq!(near, [(3, (2, 1)), (3, (17, 1))]);
        assert_eq!(far, [(3, (17, 1)), (3, (2, 1))]);
    }
}
