//! Distances to obstacles, and the cost of a step: the inflation of `costmap_2d` with its defaults,
//! as navfn sees it.
//!
//! A step onto a cell costs its length times
//!
//! ```text
//! 1 + 4.03 · exp(−10 · (d − r))   for d ≤ 0.55 m,   1 for more
//! ```
//!
//! with d the distance from the cell's centre to the nearest obstacle cell's, and r the robot's
//! radius, metres. The inflation layer gives a cell 252 · exp(−10 · (d − r)), and navfn's cost of a
//! step onto a cell of cost c is 50 + 0.8 · c.
//!
//! Units: cells; distances are squared integers.

use fieldline_planner::geometry::CELL_M;

use crate::baseline::chart::Chart;
use crate::metrics::CellArea;

/// Least squared distance without inflation: beyond 5.5 cells, 0.55 m.
const FREE_FROM: u8 = 31;
/// Greatest distance in x or y of a cell with inflation, cells.
const REACH: i32 = 5;
/// Radius of the robot, cells.
const RADIUS: f32 = 3.0;

/// Price of an unknown cell, per cent: navfn counts it as 253, the highest passable cost.
pub const UNKNOWN_PERCENT: u32 = 506;

/// Squared distance from each cell to the nearest obstacle, at most `FREE_FROM`.
#[derive(Clone, Debug, Default)]
pub struct Inflation {
    area: CellArea,
    squares: Vec<u8>,
}

impl Inflation {
    /// Measures the distances in a chart.
    #[must_use]
    pub fn new(chart: &Chart) -> Self {
        let area = chart.area();
        let mut squares = vec![FREE_FROM; area.len()];
        let (width, height) = (area.width as i32, area.height as i32);
        for index in (0..area.len()).filter(|&index| chart.is_obstacle(index)) {
            let (x, y) = area.place(index);
            let (x, y) = (x as i32, y as i32);
            for dy in -REACH.min(y)..=REACH.min(height - 1 - y) {
                for dx in -REACH.min(x)..=REACH.min(width - 1 - x) {
                    let square = (dx * dx + dy * dy).min(i32::from(FREE_FROM)) as u8;
                    let cell = &mut squares[((y + dy) * width + x + dx) as usize];
                    *cell = square.min(*cell);
                }
            }
        }
        Self { area, squares }
    }

    /// Returns the map cells of the chart.
    #[must_use]
    pub const fn area(&self) -> CellArea {
        self.area
    }

    /// Returns the squared distance of a cell, at most 31; 0 outside.
    #[must_use]
    pub fn square(&self, index: usize) -> u8 {
        self.squares.get(index).copied().unwrap_or(0)
    }
}

/// Cost of a step in per cent of its length, by squared distance.
#[derive(Clone, Debug)]
pub struct Prices([u32; FREE_FROM as usize + 1]);

impl Prices {
    /// Makes the table.
    #[must_use]
    pub fn new() -> Self {
        Self(core::array::from_fn(|square| {
            let beyond_m = ((square as f32).sqrt() - RADIUS).max(0.0) * CELL_M;
            let inflation = if square >= usize::from(FREE_FROM) {
                0.0
            } else {
                0.8 * 252.0 / 50.0 * libm::expf(-10.0 * beyond_m)
            };
            (100.0 * (1.0 + inflation)) as u32
        }))
    }

    /// Returns the price at a squared distance.
    #[must_use]
    pub fn percent(&self, square: u8) -> u32 {
        self.0[usize::from(square.min(FREE_FROM))]
    }
}

impl Default for Prices {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{Inflation, Prices};
    use crate::baseline::chart::sketch::chart;
    use fieldline_planner::geometry::Cell;

    #[test]
    fn distances_are_those_to_the_nearest_obstacle() {
        let rows = [
            "#...........", //
            "............",
            "............",
            "R......#....",
        ];
        let (chart, _) = chart(&rows);
        let inflation = Inflation::new(&chart);
        let at = |x, y| inflation.square(chart.area().index(Cell { x, y }).unwrap());
        assert_eq!((at(0, 3), at(1, 3), at(2, 1)), (0, 1, 4 + 4));
        assert_eq!((at(5, 1), at(7, 3)), (4 + 1, 9));
        assert_eq!(at(11, 3), 16 + 9);
        assert_eq!(at(-6, 3), 31, "out of reach");
    }

    #[test]
    fn prices_fall_from_five_times_to_one() {
        let prices = Prices::new();
        assert_eq!(prices.percent(9), 503);
        assert_eq!(prices.percent(31), 100);
        let falling = (0..31).all(|square| prices.percent(square) >= prices.percent(square + 1));
        assert!(falling);
        // 0.4 m: 1 + 4.032 / e.
        assert_eq!(prices.percent(16), 248);
    }
}
