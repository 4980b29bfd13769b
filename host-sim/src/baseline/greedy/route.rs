//! Cheapest ways from where the robot stands (Dijkstra), as ROS's global planner finds them on an inflated costmap.
//!
//! A step costs its length times the [`Prices`] of the cell that it leads to; one onto an unknown cell the dearest price, as
//! navfn has it with its default `allow_unknown`. Ways lead over passable cells only, and steps are straight or diagonal, a
//! diagonal one only between two passable cells.
//!
//! Invariant: costs are integers, so that the same map gives the same way everywhere. Units: a straight step is
//! `STRAIGHT`.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

use fieldline_planner::geometry::{CELL_M, Cell, Point};

use super::inflation::{Inflation, Prices, UNKNOWN_PERCENT};
use crate::baseline::chart::Chart;

/// Length of a straight step, and of a diagonal one.
const STRAIGHT: u32 = 100;
const DIAGONAL: u32 = 141;
/// No way.
const NONE: u32 = u32::MAX;

/// The ways to every cell.
#[derive(Clone, Debug)]
pub struct Routes {
    /// Cost so far.
    cost: Vec<u32>,
    /// Length of the cheapest way.
    length: Vec<u32>,
    /// The cell before.
    before: Vec<u32>,
}

impl Routes {
    /// All ways from `robot`.
    #[must_use]
    pub fn from(chart: &Chart, inflation: &Inflation, robot: Cell) -> Self {
        let count = chart.frame().len();
        let mut routes = Self {
            cost: vec![NONE; count],
            length: vec![NONE; count],
            before: vec![NONE; count],
        };
        let home = chart
            .frame()
            .index(robot)
            .filter(|&home| chart.is_passable(home));
        if let Some(home) = home {
            routes.spread(chart, inflation, home);
        }
        routes
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

    /// Length of the way to a cell, metres; `None` where there is none.
    #[must_use]
    pub fn length_m(&self, index: usize) -> Option<f32> {
        let length = *self.length.get(index)?;
        (length != NONE).then(|| length as f32 / STRAIGHT as f32 * CELL_M)
    }

    /// The cell centres of the way to a cell, the robot's first; empty where there is none.
    #[must_use]
    pub fn way(&self, chart: &Chart, to: usize) -> Vec<Point> {
        let mut way = Vec::new();
        if self.length_m(to).is_some() {
            let mut index = to as u32;
            while index != NONE {
                way.push(chart.frame().cell(index as usize).centre());
                index = self.before[index as usize];
            }
            way.reverse();
        }
        way
    }
}

/// The steps from a cell and their lengths.
fn steps(chart: &Chart, index: usize) -> [Option<(usize, u32)>; 8] {
    let four = chart.frame().four(index);
    let open = four.map(|near| chart.is_passable(near));
    let width = chart.frame().width;
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
    use super::Routes;
    use crate::baseline::chart::sketch::{chart, chart_for};
    use crate::baseline::greedy::inflation::Inflation;
    use fieldline_planner::geometry::Cell;

    #[test]
    fn lengths_are_those_of_the_shortest_way_in_the_open() {
        let row = ".".repeat(31);
        let mut rows = vec![row.as_str(); 20];
        rows[10] = "..............R................";
        let (chart, robot) = chart(&rows);
        let routes = Routes::from(&chart, &Inflation::new(&chart), robot.cell());
        let at = |x, y| routes.length_m(chart.frame().index(Cell { x, y }).unwrap());
        assert_eq!(at(14, 9), Some(0.0));
        assert!((at(20, 9).unwrap() - 0.6).abs() < 1e-5);
        assert!((at(18, 12).unwrap() - (0.1 + 3.0 * 0.141)).abs() < 1e-5);
        // The robot fits into the unknown, too.
        assert!((at(-1, 9).unwrap() - 1.5).abs() < 1e-5);
    }

    #[test]
    fn a_way_keeps_off_the_walls_and_cuts_no_corner() {
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
        let routes = Routes::from(&chart, &Inflation::new(&chart), robot.cell());
        let goal = chart.frame().index(Cell { x: 17, y: 1 }).unwrap();
        let way = routes.way(&chart, goal);
        assert_eq!(way.first(), Some(&robot));
        assert_eq!(way.last(), Some(&Cell { x: 17, y: 1 }.centre()));
        let highest = way.iter().map(|point| point.cell().y).max();
        assert_eq!(highest, Some(4), "the middle of the room");
        let corner = ["#####", "#...#", "##..#", "#R#.#", "#####"];
        let (chart, robot) = super::tests::chart(&corner);
        let routes = Routes::from(&chart, &Inflation::new(&chart), robot.cell());
        let beyond = chart.frame().index(Cell { x: 2, y: 2 }).unwrap();
        assert_eq!(routes.length_m(beyond), None);
    }

    #[test]
    fn a_gap_too_narrow_for_the_robot_is_no_way() {
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
            let routes = Routes::from(&chart, &Inflation::new(&chart), robot.cell());
            routes.length_m(chart.frame().index(Cell { x: 6, y: 7 }).unwrap())
        };
        assert!((across(0.2).unwrap() - 0.5).abs() < 1e-5);
        assert_eq!(across(0.4), None);
    }

    #[test]
    fn a_way_leads_through_the_unknown_only_where_the_way_round_is_dearer() {
        let length = |half_height: usize| {
            let free = ".".repeat(21);
            let mut rows = vec![free.as_str(); 13];
            rows[6 - half_height..=6 + half_height].fill("..........?..........");
            let (chart, _) = chart(&rows);
            let robot = Cell { x: 1, y: 6 };
            let routes = Routes::from(&chart, &Inflation::new(&chart), robot);
            let beyond = chart.frame().index(Cell { x: 19, y: 6 });
            routes.length_m(beyond.unwrap()).unwrap()
        };
        // An unknown cell is 0.406 m dearer than a free one; every row aside is two diagonal steps, 0.082 m.
        assert!((length(3) - (1.8 + 4.0 * 0.082)).abs() < 1e-3);
        assert!((length(5) - 1.8).abs() < 1e-3);
    }
}
