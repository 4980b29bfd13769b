//! The known space as one flat array of cells, drawn from the planner's map, for algorithms that look at all of it.
//!
//! A cell is *passable* where the robot's centre may be: the same disc around the same obstacle cells as the planner's own
//! strategy uses. What is not passable counts as obstacle, so an unknown cell that the robot does not fit into is nobody's goal.
//! The chart reaches one tile beyond the known extent, as far as the map's box has room: what could never be stored is no goal
//! either.
//!
//! Invariant: the cells of the outermost ring are not passable, so a passable cell has eight neighbours by plain index
//! arithmetic. Units: map cells of 10 cm; index = row · width + column.

use fieldline_planner::geometry::{Cell, Point};
use fieldline_planner::map::Tiles;
use fieldline_planner::map::tiles::{Extent, TILE_SIDE};
use fieldline_planner::roadmap::configuration_space::{Footprint, for_each_strip};

const PASSABLE: u8 = 1;
const UNKNOWN: u8 = 2;
const OBSTACLE: u8 = 4;

/// Cells around a robot that stands too near to something in which it may look for a way out.
const LET_OUT_CELLS: i32 = 4;

/// Where a chart lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// The map cell of index 0.
    pub origin: Cell,
    /// Cells across.
    pub width: usize,
    /// Cells up.
    pub height: usize,
}

impl Frame {
    /// The index of a map cell, if it is in the frame.
    #[must_use]
    pub fn index(&self, cell: Cell) -> Option<usize> {
        let x = usize::try_from(cell.x - self.origin.x).ok()?;
        let y = usize::try_from(cell.y - self.origin.y).ok()?;
        (x < self.width && y < self.height).then(|| y * self.width + x)
    }

    /// The map cell of an index.
    #[must_use]
    pub fn cell(&self, index: usize) -> Cell {
        let (x, y) = self.place(index);
        Cell {
            x: self.origin.x + x as i32,
            y: self.origin.y + y as i32,
        }
    }

    /// Column and row of an index.
    #[must_use]
    pub fn place(&self, index: usize) -> (usize, usize) {
        let width = self.width.max(1);
        (index % width, index / width)
    }

    /// Cells in it.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.width * self.height
    }

    /// Whether it holds nothing.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The four neighbours of an inner cell: east, north, west, south.
    #[must_use]
    pub const fn four(&self, index: usize) -> [usize; 4] {
        [index + 1, index + self.width, index - 1, index - self.width]
    }

    /// Whether an index is on the outermost ring.
    #[must_use]
    pub fn is_rim(&self, index: usize) -> bool {
        let (x, y) = self.place(index);
        x == 0 || y == 0 || x + 1 >= self.width || y + 1 >= self.height
    }

    fn around(extent: Extent, (across, up): (i32, i32)) -> Self {
        let widen = |least: i32, greatest: i32, most: i32| {
            let spare = most - (greatest - least + 1);
            (
                least - i32::from(spare > 1),
                greatest + i32::from(spare > 0),
            )
        };
        let (west, east) = widen(extent.least.0, extent.greatest.0, across);
        let (south, north) = widen(extent.least.1, extent.greatest.1, up);
        let cells = |tiles: i32| usize::try_from(tiles * TILE_SIDE).unwrap_or(0);
        Self {
            origin: Cell {
                x: west * TILE_SIDE,
                y: south * TILE_SIDE,
            },
            width: cells(east - west + 1),
            height: cells(north - south + 1),
        }
    }
}

/// The cells.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    frame: Frame,
    flags: Vec<u8>,
    /// Cells that are passable only for the robot that stands among them.
    freed: Vec<usize>,
    /// The state of the map that this was drawn from.
    drawn: Option<(Extent, u32)>,
}

impl Chart {
    /// Nothing known.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Draw the map as it is now, for a robot at `robot`.
    pub fn draw<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        disc: &Footprint,
        robot: Point,
    ) {
        let Some(extent) = tiles.extent() else {
            *self = Self::new();
            return;
        };
        for index in self.freed.drain(..) {
            self.flags[index] &= !PASSABLE;
        }
        let state = Some((extent, tiles.edits()));
        if self.drawn != state {
            self.drawn = state;
            self.frame = Frame::around(extent, tiles.box_tiles());
            self.flags.clear();
            self.flags.resize(self.frame.len(), 0);
            self.copy(tiles, disc);
            self.close_ring();
        }
        self.let_out(robot.cell());
    }

    /// Where it lies.
    #[must_use]
    pub const fn frame(&self) -> Frame {
        self.frame
    }

    /// Whether the robot's centre may be here.
    #[must_use]
    pub fn is_passable(&self, index: usize) -> bool {
        self.has(index, PASSABLE)
    }

    /// Whether this was never measured.
    #[must_use]
    pub fn is_unknown(&self, index: usize) -> bool {
        self.has(index, UNKNOWN)
    }

    /// Whether something stands here.
    #[must_use]
    pub fn is_obstacle(&self, index: usize) -> bool {
        self.has(index, OBSTACLE)
    }

    /// Whether the robot's centre may be here, and it was measured.
    #[must_use]
    pub fn is_way(&self, index: usize) -> bool {
        self.flags
            .get(index)
            .is_some_and(|flags| flags & (PASSABLE | UNKNOWN) == PASSABLE)
    }

    /// Whether an unexplored cell that the robot would fit into is here.
    #[must_use]
    pub fn is_unexplored(&self, index: usize) -> bool {
        self.has(index, PASSABLE | UNKNOWN)
    }

    /// Known cells that the robot's centre can get to from `robot`, counted up to `most`.
    #[must_use]
    pub fn room(&self, robot: Cell, most: usize) -> usize {
        let home = self.frame.index(robot).filter(|&home| self.is_way(home));
        let mut reached: Vec<usize> = home.into_iter().collect();
        let mut next = 0;
        while let Some(&index) = reached.get(next).filter(|_| reached.len() < most) {
            next += 1;
            for near in self.frame.four(index) {
                if self.is_way(near) && !reached.contains(&near) {
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
        disc: &Footprint,
    ) {
        let Frame {
            origin,
            width,
            height,
        } = self.frame;
        for column in (0..width).step_by(32) {
            let corner = (origin.x + column as i32, origin.y);
            for_each_strip(tiles, disc, corner, height as i32, |y, strip| {
                let first = (y - origin.y) as usize * width + column;
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
        let Frame { width, height, .. } = self.frame;
        for x in 0..width {
            self.flags[x] &= !PASSABLE;
            self.flags[(height - 1) * width + x] &= !PASSABLE;
        }
        for y in 0..height {
            self.flags[y * width] &= !PASSABLE;
            self.flags[y * width + width - 1] &= !PASSABLE;
        }
    }

    /// The planner's own rule for a robot that stands nearer to something than its radius: around it, whatever does not
    /// touch an obstacle is passable; failing that, whatever is no obstacle.
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
        self.is_obstacle(index)
            || self
                .frame
                .four(index)
                .into_iter()
                .any(|beside| self.is_obstacle(beside))
    }

    /// The index of a cell that is not on the outermost ring.
    fn inner(&self, cell: Cell) -> Option<usize> {
        self.frame
            .index(cell)
            .filter(|&index| !self.frame.is_rim(index))
    }
}

/// Charts drawn from characters, for the tests of the baselines.
#[cfg(test)]
pub(super) mod sketch {
    use super::Chart;
    use fieldline_planner::geometry::{Cell, Point};
    use fieldline_planner::map::{Class, Tiles};
    use fieldline_planner::roadmap::configuration_space::Footprint;

    /// A chart of rows of characters, greatest y first, least x and y at cell (0, 0): `#` obstacle, `?` unknown, `R` the robot on
    /// a free cell, anything else free. The robot is a point, so that every cell but the obstacles is passable. Beyond the
    /// picture everything is unknown.
    pub(crate) fn chart(rows: &[&str]) -> (Chart, Point) {
        chart_for(rows, 0.05)
    }

    /// The same for a robot of this radius.
    pub(crate) fn chart_for(rows: &[&str], radius_m: f32) -> (Chart, Point) {
        let mut tiles: Box<Tiles<128, 128>> = Box::new(Tiles::new());
        let long = rows.iter().any(|row| row.len() > 200);
        let (across, up) = if long { (32, 4) } else { (10, 10) };
        tiles.reset(across, up);
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
    fn what_is_drawn_is_what_is_there() {
        let (chart, _) = chart(&[
            "#####", //
            "#R.?#", "#####",
        ]);
        let at = |x, y| chart.frame().index(Cell { x, y }).unwrap();
        assert!(chart.is_obstacle(at(0, 1)) && !chart.is_passable(at(0, 1)));
        assert!(chart.is_way(at(2, 1)) && !chart.is_unexplored(at(2, 1)));
        assert!(chart.is_unexplored(at(3, 1)) && !chart.is_way(at(3, 1)));
        assert!(
            chart.is_unexplored(at(-3, 1)),
            "the outside is unknown, too"
        );
        assert_eq!(chart.frame().cell(at(-3, 1)), Cell { x: -3, y: 1 });
    }

    #[test]
    fn the_outermost_ring_is_closed() {
        let (chart, _) = chart(&["R"]);
        let frame = chart.frame();
        for index in 0..frame.len() {
            let (x, y) = frame.place(index);
            let outer = x == 0 || y == 0 || x + 1 == frame.width || y + 1 == frame.height;
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
        let at = |x, y| chart.frame().index(Cell { x, y }).unwrap();
        assert!(chart.is_unknown(at(4, 0)) && !chart.is_unexplored(at(4, 0)));
        assert!(chart.is_passable(at(4, 2)) && !chart.is_passable(at(4, 1)));
    }

    #[test]
    fn room_is_what_can_be_come_to() {
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
        let at = |x, y| chart.frame().index(Cell { x, y }).unwrap();
        assert!(chart.is_passable(at(4, 3)), "its own cell");
        assert!(chart.is_passable(at(8, 3)) && !chart.is_passable(at(9, 3)));
        assert!(!chart.is_passable(at(4, 4)), "this one touches the wall");
        let (chart, _) = chart_for(&["#####", "..R..", "....."], 0.3);
        let at = |x, y| chart.frame().index(Cell { x, y }).unwrap();
        assert!(
            chart.is_passable(at(1, 1)),
            "failing that, what is no obstacle"
        );
        assert!(!chart.is_passable(at(1, 2)));
    }
}
