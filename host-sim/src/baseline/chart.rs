//! The known space as one flat array of cells, copied from the planner's map.
//!
//! A cell is *passable* if the robot's centre may be there: outside of the planner's own footprint
//! around each obstacle cell. All other cells count as obstacles, so an unknown cell into which the
//! robot does not fit is no goal. The chart reaches one tile beyond the known extent.
//!
//! Invariant: the cells of the outermost ring are not passable, so a passable cell has eight
//! neighbours by plain index arithmetic. Units: map cells of 10 cm; index = row · width + column.

use fieldline_planner::geometry::{Cell, Point};
use fieldline_planner::map::Tiles;
use fieldline_planner::map::tiles::TILE_SIDE;
use fieldline_planner::roadmap::configuration_space::{Footprint, for_each_strip};

use crate::metrics::CellArea;

const PASSABLE: u8 = 1;
const UNKNOWN: u8 = 2;
const OBSTACLE: u8 = 4;

/// Half the side of the square around a blocked robot in which cells may be freed, cells.
const LET_OUT_CELLS: i32 = 4;

/// The chart.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    area: CellArea,
    flags: Vec<u8>,
    /// Cells that are passable only because the robot stands beside them.
    freed: Vec<usize>,
    /// Edit count of the map at the last copy.
    drawn: Option<u32>,
}

impl Chart {
    /// Makes an empty chart.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Copies the map for a robot at `robot`. Does nothing if the map has not changed since.
    pub fn draw<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        footprint: &Footprint,
        robot: Point,
    ) {
        let Some(area) = around(tiles) else {
            *self = Self::new();
            return;
        };
        for index in self.freed.drain(..) {
            self.flags[index] &= !PASSABLE;
        }
        let state = Some(tiles.edits());
        if self.drawn != state {
            self.drawn = state;
            self.area = area;
            self.flags.clear();
            self.flags.resize(self.area.len(), 0);
            self.copy(tiles, footprint);
            self.close_ring();
        }
        self.let_out(robot.cell());
    }

    /// Returns the map cells of the chart.
    #[must_use]
    pub const fn area(&self) -> CellArea {
        self.area
    }

    /// Returns true if the robot's centre may be in a cell.
    #[must_use]
    pub fn is_passable(&self, index: usize) -> bool {
        self.has(index, PASSABLE)
    }

    /// Returns true if a cell was never measured.
    #[must_use]
    pub fn is_unknown(&self, index: usize) -> bool {
        self.has(index, UNKNOWN)
    }

    /// Returns true if a cell is an obstacle.
    #[must_use]
    pub fn is_obstacle(&self, index: usize) -> bool {
        self.has(index, OBSTACLE)
    }

    /// Returns true if a cell is passable and was measured.
    #[must_use]
    pub fn is_known_passable(&self, index: usize) -> bool {
        self.flags
            .get(index)
            .is_some_and(|flags| flags & (PASSABLE | UNKNOWN) == PASSABLE)
    }

    /// Returns true if a cell is passable and was never measured.
    #[must_use]
    pub fn is_unexplored(&self, index: usize) -> bool {
        self.has(index, PASSABLE | UNKNOWN)
    }

    /// Counts the known cells that the robot's centre can reach from `robot`, at most `most`.
    #[must_use]
    pub fn room(&self, robot: Cell, most: usize) -> usize {
        let home = self.area.index(robot);
        let home = home.filter(|&home| self.is_known_passable(home));
        let mut reached: Vec<usize> = home.into_iter().collect();
        let mut next = 0;
        while let Some(&index) = reached.get(next).filter(|_| reached.len() < most) {
            next += 1;
            for near in self.area.four(index) {
                if self.is_known_passable(near) && !reached.contains(&near) {
                    reached.push(near);
                }
            }
        }
        reached.len().min(most)
    }

    fn has(&self, index: usize, what: u8) -> bool {
        self.flags
            .get(index)
            .is_some_and(|flags| flags & what == what)
    }

    fn copy<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        footprint: &Footprint,
    ) {
        let CellArea {
            x,
            y,
            width,
            height,
        } = self.area;
        for column in (0..width).step_by(32) {
            let corner = (x + column as i32, y);
            for_each_strip(tiles, footprint, corner, height as i32, |row, strip| {
                let first = (row - y) as usize * width + column;
                for (k, flags) in self.flags[first..first + 32].iter_mut().enumerate() {
                    let bit = |word: u32| (word >> k & 1) as u8;
                    *flags = (bit(strip.passable) * PASSABLE)
                        | (bit(strip.unknown) * UNKNOWN)
                        | (bit(strip.obstacle) * OBSTACLE);
                }
            });
        }
    }

    fn close_ring(&mut self) {
        let CellArea { width, height, .. } = self.area;
        for x in 0..width {
            self.flags[x] &= !PASSABLE;
            self.flags[(height - 1) * width + x] &= !PASSABLE;
        }
        for y in 0..height {
            self.flags[y * width] &= !PASSABLE;
            self.flags[y * width + width - 1] &= !PASSABLE;
        }
    }

    /// Frees cells around a robot that stands nearer to an obstacle than its radius, as the planner
    /// does.
    ///
    /// In a square around the robot, cells that touch no obstacle become passable. If the robot's
    /// own cell touches one, all cells that are no obstacles become passable.
    fn let_out(&mut self, robot: Cell) {
        let Some(home) = self.inner(robot) else {
            return;
        };
        if self.is_passable(home) {
            return;
        }
        let roomy = !self.touches_obstacle(home);
        for dy in -LET_OUT_CELLS..=LET_OUT_CELLS {
            for dx in -LET_OUT_CELLS..=LET_OUT_CELLS {
                let Some(index) = self.inner(Cell {
                    x: robot.x + dx,
                    y: robot.y + dy,
                }) else {
                    continue;
                };
                let taken = if roomy {
                    self.touches_obstacle(index)
                } else {
                    self.is_obstacle(index)
                };
                if (index == home || !taken) && !self.is_passable(index) {
                    self.flags[index] |= PASSABLE;
                    self.freed.push(index);
                }
            }
        }
    }

    fn touches_obstacle(&self, index: usize) -> bool {
        let four = self.area.four(index);
        self.is_obstacle(index) || four.into_iter().any(|beside| self.is_obstacle(beside))
    }

    /// Returns the index of a cell; `None` on the outermost ring and outside.
    fn inner(&self, cell: Cell) -> Option<usize> {
        let index = self.area.index(cell)?;
        (!self.area.is_rim(index)).then_some(index)
    }
}

/// Returns the cells of a map's extent, widened by one tile on each side; `None` if it is empty.
fn around<const TILES: usize, const SLOTS: usize>(tiles: &Tiles<TILES, SLOTS>) -> Option<CellArea> {
    let ends = |of: fn((i32, i32)) -> i32| {
        let least = tiles.touched().map(of).min()?;
        let greatest = tiles.touched().map(of).max()?;
        Some((least - 1, usize::try_from(greatest - least + 3).ok()?))
    };
    let ((west, across), (south, up)) = (ends(|(x, _)| x)?, ends(|(_, y)| y)?);
    let side = TILE_SIDE as usize;
    Some(CellArea {
        x: west * TILE_SIDE,
        y: south * TILE_SIDE,
        width: across * side,
        height: up * side,
    })
}

/// Charts from characters, for the tests of the baselines.
#[cfg(test)]
pub(super) mod sketch {
    use super::Chart;
    use fieldline_planner::geometry::{Cell, Point};
    use fieldline_planner::map::{Class, Tiles};
    use fieldline_planner::roadmap::configuration_space::Footprint;

    /// Makes a chart from rows of characters, and the position of the robot.
    ///
    /// The first row has the greatest y; the last row begins at cell (0, 0). `#` is an obstacle,
    /// `?` unknown, `R` the robot in a free cell, any other character free. All cells outside are
    /// unknown. The robot is a point, so only obstacles are not passable.
    pub(crate) fn chart(rows: &[&str]) -> (Chart, Point) {
        chart_for(rows, 0.05)
    }

    /// Does the same for a robot of this radius, metres.
    pub(crate) fn chart_for(rows: &[&str], radius_m: f32) -> (Chart, Point) {
        let mut tiles: Box<Tiles<128, 128>> = Box::new(Tiles::new());
        tiles.reset();
        let mut robot = Cell::default();
        for (y, row) in (0..).zip(rows.iter().rev()) {
            for (x, character) in (0..).zip(row.chars()) {
                let cell = Cell { x, y };
                let class = match character {
                    '#' => Class::Obstacle,
                    '?' => Class::Unknown,
                    _ => Class::Free,
                };
                if character == 'R' {
                    robot = cell;
                }
                tiles.set(cell, class).expect("the picture fits");
            }
        }
        let mut chart = Chart::new();
        chart.draw(&tiles, &Footprint::new(radius_m), robot.centre());
        (chart, robot.centre())
    }
}

#[cfg(test)]
mod tests {
    use super::sketch::{chart, chart_for};
    use fieldline_planner::geometry::Cell;

    #[test]
    fn the_chart_has_the_classes_of_the_map() {
        let (chart, _) = chart(&[
            "#####", //
            "#R.?#", "#####",
        ]);
        let at = |x, y| chart.area().index(Cell { x, y }).unwrap();
        assert!(chart.is_obstacle(at(0, 1)) && !chart.is_passable(at(0, 1)));
        assert!(chart.is_known_passable(at(2, 1)) && !chart.is_unexplored(at(2, 1)));
        assert!(chart.is_unexplored(at(3, 1)) && !chart.is_known_passable(at(3, 1)));
        assert!(chart.is_unexplored(at(-3, 1)), "outside is unknown");
        assert_eq!(chart.area().cell(at(-3, 1)), Cell { x: -3, y: 1 });
    }

    #[test]
    fn the_outermost_ring_is_closed() {
        let (chart, _) = chart(&["R"]);
        let area = chart.area();
        for index in 0..area.len() {
            let (x, y) = area.place(index);
            let outer = x == 0 || y == 0 || x + 1 == area.width || y + 1 == area.height;
            assert_eq!(chart.is_passable(index), !outer, "({x}, {y})");
        }
    }

    #[test]
    fn an_unknown_cell_that_the_robot_does_not_fit_into_is_no_goal() {
        let rows = [
            "#########", //
            ".........",
            "....R....",
            ".........",
            "####?####",
        ];
        let (chart, _) = chart_for(&rows, 0.2);
        let at = |x, y| chart.area().index(Cell { x, y }).unwrap();
        assert!(chart.is_unknown(at(4, 0)) && !chart.is_unexplored(at(4, 0)));
        assert!(chart.is_passable(at(4, 2)) && !chart.is_passable(at(4, 1)));
    }

    #[test]
    fn room_counts_only_reachable_cells() {
        let rows = [
            "#######", //
            "#..#..#", "#.R#..#", "#######",
        ];
        let (chart, robot) = chart(&rows);
        assert_eq!(chart.room(robot.cell(), 100), 4);
        assert_eq!(chart.room(robot.cell(), 3), 3);
        assert_eq!(chart.room(Cell { x: 0, y: 0 }, 100), 0, "inside the wall");
    }

    #[test]
    fn a_robot_too_near_to_a_wall_is_let_out_only_while_it_stands_there() {
        let rows = [
            "##########", //
            "..........",
            "....R.....",
            "..........",
            "..........",
            "..........",
        ];
        let (chart, _) = chart_for(&rows, 0.3);
        let at = |x, y| chart.area().index(Cell { x, y }).unwrap();
        assert!(chart.is_passable(at(4, 3)), "its own cell");
        assert!(chart.is_passable(at(8, 3)) && !chart.is_passable(at(9, 3)));
        assert!(!chart.is_passable(at(4, 4)), "this one touches the wall");
        let (chart, _) = chart_for(&["#####", "..R..", "....."], 0.3);
        let at = |x, y| chart.area().index(Cell { x, y }).unwrap();
        assert!(
            chart.is_passable(at(1, 1)),
            "in a narrow place all that is no obstacle"
        );
        assert!(!chart.is_passable(at(1, 2)));
    }
}
