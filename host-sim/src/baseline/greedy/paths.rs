//! Cheapest paths from the robot to every cell (Dijkstra), as ROS's global planner finds them on an
//! inflated costmap.
//!
//! A step costs its length times the [`Prices`] of the cell that it leads to. A step onto an
//! unknown cell has the highest price, as in navfn with its default `allow_unknown`. Paths lead
//! over passable cells only. Steps are straight or diagonal; a diagonal step needs both cells
//! beside it passable.
//!
//! Invariant: costs are integers, so the same map gives the same path on every machine. Units: a
//! straight step of 10 cm is 100.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

use fieldline_planner::geometry::{CELL_M, Cell, Point};

use super::inflation::{Inflation, Prices, UNKNOWN_PERCENT};
use crate::baseline::chart::Chart;

/// Length of a straight step.
const STRAIGHT: u32 = 100;
/// Length of a diagonal step.
const DIAGONAL: u32 = 141;
/// Cost, length and index that mean "no path".
const NONE: u32 = u32::MAX;

/// The cheapest path to every cell.
#[derive(Clone, Debug)]
pub struct Paths {
    /// Cost of the path.
    cost: Vec<u32>,
    /// Length of the path.
    length: Vec<u32>,
    /// The cell before, on the path.
    before: Vec<u32>,
}

impl Paths {
    /// Finds all paths from `robot`; none if the robot's cell is not passable.
    #[must_use]
    pub fn from(chart: &Chart, inflation: &Inflation, robot: Cell) -> Self {
        let count = chart.area().len();
        let mut paths = Self {
            cost: vec![NONE; count],
            length: vec![NONE; count],
            before: vec![NONE; count],
        };
        let home = chart.area().index(robot);
        if let Some(home) = home.filter(|&home| chart.is_passable(home)) {
            paths.spread(chart, inflation, home);
        }
        paths
    }

    fn spread(&mut self, chart: &Chart, inflation: &Inflation, home: usize) {
        let prices = Prices::new();
        let mut queue = BinaryHeap::new();
        (self.cost[home], self.length[home]) = (0, 0);
        queue.push(Reverse((0, home)));
        while let Some(Reverse((cost, index))) = queue.pop() {
            if cost > self.cost[index] {
                continue;
            }
            for (near, step) in steps(chart, index).into_iter().flatten() {
                let percent = if chart.is_unknown(near) {
                    UNKNOWN_PERCENT
                } else {
                    prices.percent(inflation.square(near))
                };
                let total = cost + step * percent / 100;
                if total < self.cost[near] {
                    self.cost[near] = total;
                    self.length[near] = self.length[index] + step;
                    self.before[near] = index as u32;
                    queue.push(Reverse((total, near)));
                }
            }
        }
    }

    /// Returns the length of the path to a cell, metres; `None` if there is none.
    #[must_use]
    pub fn length_m(&self, index: usize) -> Option<f32> {
        let length = *self.length.get(index)?;
        (length != NONE).then(|| length as f32 / STRAIGHT as f32 * CELL_M)
    }

    /// Returns the cell centres of the path to a cell, the robot's first; empty if there is none.
    #[must_use]
    pub fn path(&self, chart: &Chart, to: usize) -> Vec<Point> {
        let mut path = Vec::new();
        if self.length_m(to).is_some() {
            let mut index = to as u32;
            while index != NONE {
                path.push(chart.area().cell(index as usize).centre());
                index = self.before[index as usize];
            }
            path.reverse();
        }
        path
    }
}

/// Returns the steps from a cell and their lengths.
fn steps(chart: &Chart, index: usize) -> [Option<(usize, u32)>; 8] {
    let four = chart.area().four(index);
    let open = four.map(|near| chart.is_passable(near));
    let width = chart.area().width;
    let [east, north, west, south] = four;
    let straight = |k: usize| open[k].then_some((four[k], STRAIGHT));
    let diagonal = |a: usize, b: usize, to: usize| {
        (open[a] && open[b] && chart.is_passable(to)).then_some((to, DIAGONAL))
    };
    [
        straight(0),
        straight(1),
        straight(2),
        straight(3),
        diagonal(0, 1, east + width),
        diagonal(1, 2, north - 1),
        diagonal(2, 3, west - width),
        diagonal(3, 0, south + 1),
    ]
}

#[cfg(test)]
mod tests {
    use super::Paths;
    use crate::baseline::chart::sketch::{chart, chart_for};
    use crate::baseline::greedy::inflation::Inflation;
    use fieldline_planner::geometry::Cell;

    #[test]
    fn lengths_in_the_open_are_the_shortest() {
        let row = ".".repeat(31);
        let mut rows = vec![row.as_str(); 20];
        rows[10] = "..............R................";
        let (chart, robot) = chart(&rows);
        let paths = Paths::from(&chart, &Inflation::new(&chart), robot.cell());
        let at = |x, y| paths.length_m(chart.area().index(Cell { x, y }).unwrap());
        assert_eq!(at(14, 9), Some(0.0));
        assert!((at(20, 9).unwrap() - 0.6).abs() < 1e-5);
        assert!((at(18, 12).unwrap() - (0.1 + 3.0 * 0.141)).abs() < 1e-5);
        // Unknown cells are passable.
        assert!((at(-1, 9).unwrap() - 1.5).abs() < 1e-5);
    }

    #[test]
    fn a_path_keeps_off_the_walls_and_cuts_no_corner() {
        let rows = [
            "###################", //
            "#.................#",
            "#.................#",
            "#.................#",
            "#.................#",
            "#.................#",
            "#.................#",
            "#R...............G#",
            "###################",
        ];
        let (chart, robot) = chart(&rows);
        let paths = Paths::from(&chart, &Inflation::new(&chart), robot.cell());
        let goal = chart.area().index(Cell { x: 17, y: 1 }).unwrap();
        let path = paths.path(&chart, goal);
        assert_eq!(path.first(), Some(&robot));
        assert_eq!(path.last(), Some(&Cell { x: 17, y: 1 }.centre()));
        let highest = path.iter().map(|point| point.cell().y).max();
        assert_eq!(highest, Some(4), "the middle of the room");
        let corner = ["#####", "#...#", "##..#", "#R#.#", "#####"];
        let (chart, robot) = super::tests::chart(&corner);
        let paths = Paths::from(&chart, &Inflation::new(&chart), robot.cell());
        let beyond = chart.area().index(Cell { x: 2, y: 2 }).unwrap();
        assert_eq!(paths.length_m(beyond), None);
    }

    #[test]
    fn no_path_leads_through_a_gap_too_narrow_for_the_robot() {
        let rows = [
            "#############", //
            "#...........#",
            "#...........#",
            "#...........#",
            "####.....####",
            "#...........#",
            "#...........#",
            "#.....R.....#",
            "#...........#",
            "#############",
        ];
        let across = |radius_m| {
            let (chart, robot) = chart_for(&rows, radius_m);
            let paths = Paths::from(&chart, &Inflation::new(&chart), robot.cell());
            paths.length_m(chart.area().index(Cell { x: 6, y: 7 }).unwrap())
        };
        assert!((across(0.2).unwrap() - 0.5).abs() < 1e-5);
        assert_eq!(across(0.4), None);
    }

    #[test]
    fn a_path_leads_through_the_unknown_only_if_the_path_round_is_dearer() {
        let length = |half_height: usize| {
            let free = ".".repeat(21);
            let mut rows = vec![free.as_str(); 13];
            rows[6 - half_height..=6 + half_height].fill("..........?..........");
            let (chart, _) = chart(&rows);
            let robot = Cell { x: 1, y: 6 };
            let paths = Paths::from(&chart, &Inflation::new(&chart), robot);
            let beyond = chart.area().index(Cell { x: 19, y: 6 });
            paths.length_m(beyond.unwrap()).unwrap()
        };
        // An unknown cell costs 0.406 m more than a free one. Each row aside costs two diagonal
        // steps, 0.082 m.
        assert!((length(3) - (1.8 + 4.0 * 0.082)).abs() < 1e-3);
        assert!((length(5) - 1.8).abs() < 1e-3);
    }
}
