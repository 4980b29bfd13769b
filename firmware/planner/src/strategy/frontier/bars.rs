//! Where a way that cannot be driven is barred: at the first cell of the path that the window has no way to, or where the robot's front
//! meets what stops it. Units: map cells, metres.

use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows};
use crate::geometry::{Cell, Point};
use crate::path::Path;
use crate::path::PlanningContext;
use crate::strategy::frontier::near;

/// A robot that cannot go on is barred from its path this far ahead, metres: where its front meets what stops it.
const BAR_AHEAD_M: f32 = 0.5;

/// The first cell of the path that the window's passable cells do not lead to.
pub(super) fn leak<const TILES: usize, const SLOTS: usize>(
    path: &Path,
    known: &PlanningContext<'_, TILES, SLOTS>,
    robot: Point,
    view: &mut LocalGrid,
) -> Option<Cell> {
    view.look_around(known.tiles, known.disc, robot.cell(), 1);
    view.free_robot(robot.cell());
    let reached = view.reachable(robot.cell())?;
    let mut wet: Rows = [0; SIDE];
    path.cells().iter().copied().find(|&cell| {
        wet.fill(0);
        view.mark(&mut wet, cell);
        wet.iter()
            .zip(&reached)
            .all(|(cell, reached)| cell & reached == 0)
    })
}

/// The first cell of the path that is as far ahead of the robot as what stops it.
pub(super) fn ahead(path: &Path, robot: Point) -> Option<Cell> {
    let robot = robot.cell();
    path.cells()
        .iter()
        .copied()
        .find(|&cell| !near(cell, robot, BAR_AHEAD_M))
}
