//! Blocked passages: places where the robot could not drive on although the skeleton leads through.
//!
//! A blocked passage is closed in the skeleton, in the local grid and where viewpoints are searched
//! for, so that no path leads around the cut and none is found that another part holds for closed.
//! It is never closed where the robot stands, or farther from its middle than that. A passage is
//! blocked at the first path cell that the local grid has no way to, or, ahead of a robot that
//! stands, [`AHEAD_M`] from its centre in the direction of the path (measured: docs/MEASURED.md,
//! "Where blocked passages are closed").
//!
//! A full list loses its oldest passage: what was blocked long ago may be tried again, and no goal
//! is lost for want of room.
//!
//! Units: map cells, metres.

use heapless::Vec;

use crate::field::local_grid::LocalGrid;
use crate::geometry::{Cell, Point};
use crate::grid::Shifts;
use crate::map::Tiles;
use crate::path::open_stretch::OpenStretch;
use crate::path::{Path, PlanningContext};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::reachability::Reachability;
use crate::roadmap::skeleton::Skeleton;

/// Maximum number of blocked passages. In a full list the oldest gives way (measured:
/// docs/MEASURED.md, "Number of blocked passages").
const MOST_PASSAGES: usize = 24;
/// Radius of the cut in the skeleton around a blocked passage, metres: half the width of a door.
const CUT_RADIUS_M: f32 = 0.4;
/// Distance from a standing robot's centre to the passage that it blocks, metres: its front, where
/// it meets what stops it.
const AHEAD_M: f32 = 0.5;

/// The list of blocked passages, the oldest first, by x and y of their cells.
#[derive(Clone, Debug)]
pub(crate) struct BlockedPassages {
    cells: Vec<[i16; 2], MOST_PASSAGES>,
}

/// No passage is blocked.
pub(crate) static NONE: BlockedPassages = BlockedPassages::new();

impl BlockedPassages {
    /// Makes an empty list.
    pub(crate) const fn new() -> Self {
        Self { cells: Vec::new() }
    }

    /// Returns true if no passage is blocked.
    pub(crate) fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Blocks the passage at a cell.
    pub(crate) fn block(&mut self, cell: Cell) {
        if self.cells.is_full() {
            self.cells.remove(0);
        }
        // There is room now.
        let _ = self.cells.push([cell.x, cell.y].map(|at| at as i16));
    }

    /// Opens the passage that was blocked last.
    pub(crate) fn open_last(&mut self) {
        self.cells.pop();
    }

    /// Moves the passages with the tiles that they lie in.
    pub(crate) fn shift(&mut self, shifts: Shifts<'_>) {
        self.cells.iter_mut().for_each(|it| shifts.move_short(it));
    }

    /// Opens all passages.
    pub(crate) fn open_all(&mut self) {
        self.cells.clear();
    }

    /// Returns true if something holds for the middle of a passage and its radius, metres.
    pub(crate) fn any(&self, holds: impl Fn(Point, f32) -> bool) -> bool {
        self.cells().any(|cell| holds(cell.centre(), CUT_RADIUS_M))
    }

    /// Cuts the published skeleton around each blocked passage.
    pub(crate) fn cut<const SLOTS: usize>(&self, skeleton: &mut Skeleton<SLOTS>) {
        for cell in self.cells() {
            skeleton.cut(cell, CUT_RADIUS_M);
        }
    }

    /// Closes the passages to a search for viewpoints.
    pub(crate) fn close(&self, robot: Cell, reachability: &mut Reachability<'_>) {
        for cell in self.cells() {
            reachability.close(cell, CUT_RADIUS_M, robot);
        }
    }

    /// Reads the local grid around a robot, with the passages closed. It is called from five
    /// places, so it is not inlined.
    #[inline(never)]
    pub(crate) fn read<const TILES: usize, const SLOTS: usize>(
        &self,
        grid: &mut LocalGrid,
        (tiles, footprint): (&Tiles<TILES, SLOTS>, &Footprint),
        robot: Cell,
        scale: i32,
    ) {
        grid.update(tiles, footprint, robot, scale);
        for cell in self.cells() {
            grid.close_disc(cell, CUT_RADIUS_M, robot);
        }
    }

    fn cells(&self) -> impl Iterator<Item = Cell> {
        self.cells.iter().map(|&[x, y]| Cell {
            x: x.into(),
            y: y.into(),
        })
    }
}

/// Returns the first cell of the path that the local grid has no way to.
pub(crate) fn first_unreachable<const TILES: usize, const SLOTS: usize>(
    path: &Path,
    context: &PlanningContext<'_, TILES, SLOTS>,
    grid: &mut LocalGrid,
) -> Option<Cell> {
    let robot = context.pose.point();
    let map = (context.tiles, context.footprint);
    context.blocked.read(grid, map, robot.cell(), 1);
    grid.free_robot(robot.cell());
    OpenStretch::of(grid, robot.cell(), path.ahead_of(robot)).next
}

/// Returns the cell [`AHEAD_M`] away from the robot, towards the first cell of the path that is as
/// far; `None` if the path is shorter.
pub(crate) fn ahead(path: &Path, robot: Point) -> Option<Cell> {
    let mut places = path.cells().iter().map(|cell| cell.centre());
    let to = places.find(|place| place.distance2(robot) >= AHEAD_M * AHEAD_M)?;
    let part = AHEAD_M / to.distance_m(robot);
    let at = Point {
        x_m: robot.x_m + part * (to.x_m - robot.x_m),
        y_m: robot.y_m + part * (to.y_m - robot.y_m),
    };
    Some(at.cell())
}

#[cfg(test)]
mod tests {
    use super::{AHEAD_M, BlockedPassages, MOST_PASSAGES, ahead};
    use crate::geometry::{CELL_M, Cell, Point};
    use crate::path::Path;

    #[test]
    fn a_full_list_loses_its_oldest_passage() {
        let mut blocked = BlockedPassages::new();
        for x in 0..MOST_PASSAGES as i32 + 2 {
            blocked.block(Cell { x, y: -x });
        }
        assert_eq!(blocked.cells.len(), MOST_PASSAGES);
        assert_eq!(blocked.cells.first(), Some(&[2, -2]));
        blocked.open_last();
        assert_eq!(blocked.cells.last(), Some(&[24, -24]));
    }

    /// Returns the distance of the passage ahead of a robot at the origin, on a path to the east
    /// from x = `first` cells, metres.
    fn ahead_m(first: i32, last: i32) -> Option<f32> {
        let cells = (first..=last).rev().map(|x| Cell { x, y: 0 });
        let steps = (last - first + 1) as usize;
        let path = Path::back(cells, steps, steps as u32);
        let robot = Point::default();
        ahead(&path, robot).map(|cell| cell.centre().distance_m(robot))
    }

    #[test]
    fn the_passage_ahead_is_beside_the_robot_wherever_the_path_begins() {
        for first in [0, 4, 20] {
            let far_m = ahead_m(first, 40).expect("the path is long enough");
            assert!((far_m - AHEAD_M).abs() <= CELL_M, "{far_m} m");
        }
        assert_eq!(ahead_m(0, 3), None, "it ends before");
    }
}
