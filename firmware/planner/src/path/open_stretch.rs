//! The stretch of the path along which the local grid leads: its cells may be the local goal.
//!
//! Coarse cells may join where the local grid is closed. If the local grid led to a goal behind
//! such a place by another way, the robot would drive to and fro: towards the closed place while
//! the goal lies before it, and away from it once the goal lies behind it. So the way in the local
//! grid to a goal must not be much longer than the path:
//!
//! ```text
//! way(k) ≤ |p₀ − robot| + Σ |pᵢ − pᵢ₋₁| + DETOUR_CELLS,    i = 1 … k
//! ```
//!
//! with distances along the axes. The path is closed before the first cell to which the way is
//! longer.
//!
//! Units: map cells.

use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows};
use crate::geometry::Cell;
use crate::grid::flood;

/// Length by which a way in the local grid may exceed the path's, map cells: 2 m, the radius around
/// the robot that holds the local goal (measured: docs/MEASURED.md, "Length of a way to a local
/// goal").
const DETOUR_CELLS: u32 = 20;
/// Most steps of the flood that measures the ways, which bounds its time. A path that winds through
/// the window for longer ends there.
const MOST_STEPS: u32 = 8 * SIDE as u32;

/// How far the local grid leads along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct OpenStretch {
    /// The last cell that it leads to.
    pub(crate) last: Option<Cell>,
    /// The first cell behind, to which it leads by too long a way or not at all.
    pub(crate) next: Option<Cell>,
    /// The path is closed before `next`: a passable cell lies behind. Without one the path may end
    /// in unexplored cells.
    pub(crate) is_closed: bool,
}

impl OpenStretch {
    /// Follows the path, from the cell nearest to the robot.
    pub(crate) fn of(grid: &LocalGrid, robot: Cell, path: &[Cell]) -> Self {
        let mut stretch = Self::default();
        let Some(place) = grid.place(robot) else {
            return stretch;
        };
        let mut reached: Rows = [0; SIDE];
        LocalGrid::put(&mut reached, place);
        let (mut steps, mut length, mut before) = (0, 0, robot);
        for &cell in path {
            length += cell.x.abs_diff(before.x) + cell.y.abs_diff(before.y);
            before = cell;
            let most = (length + DETOUR_CELLS) / grid.scale.unsigned_abs().max(1);
            if most > MOST_STEPS {
                stretch.next = stretch.next.or(Some(cell));
                break;
            }
            // In the open, to follow the rows that change costs more than to grow all.
            while steps < most {
                flood::grow(&grid.passable, &mut reached, 0..SIDE);
                steps += 1;
            }
            let mut parts: Rows = [0; SIDE];
            let is_passable = grid.mark(&mut parts, cell);
            let mut both = parts.iter().zip(&reached);
            if both.any(|(part, reached)| part & reached != 0) {
                (stretch.last, stretch.next) = (Some(cell), None);
                continue;
            }
            stretch.next = stretch.next.or(Some(cell));
            if is_passable {
                stretch.is_closed = true;
                break;
            }
        }
        stretch
    }
}

#[cfg(test)]
mod tests {
    use super::OpenStretch;
    use crate::field::local_grid::LocalGrid;
    use crate::geometry::Cell;

    /// Returns the local grid of a picture, `#` for a closed cell, the first row at the top, and
    /// the robot's cell, `R`.
    fn grid<const N: usize>(picture: [&str; N]) -> (LocalGrid, Cell) {
        let mut grid = LocalGrid::new();
        grid.scale = 1;
        let mut robot = Cell::default();
        for (y, line) in picture.iter().rev().enumerate() {
            for (x, mark) in line.bytes().enumerate() {
                if mark != b'#' {
                    LocalGrid::put(&mut grid.passable, (x, y));
                }
                if mark == b'R' {
                    robot = Cell {
                        x: x as i32,
                        y: y as i32,
                    };
                }
            }
        }
        (grid, robot)
    }

    const fn cell(x: i32, y: i32) -> Cell {
        Cell { x, y }
    }

    /// The path leads up through the wall, where the coarse cells join.
    #[test]
    fn a_goal_behind_a_wall_is_no_goal_although_a_door_leads_there() {
        let (grid, robot) = grid([
            "................................",
            "................................",
            ".###############################",
            ".###############################",
            "..........................R.....",
            "................................",
        ]);
        let path = [cell(26, 0), cell(26, 2), cell(26, 4)];
        let closed = OpenStretch {
            last: Some(cell(26, 0)),
            next: Some(cell(26, 2)),
            is_closed: true,
        };
        assert_eq!(OpenStretch::of(&grid, robot, &path), closed);
    }

    #[test]
    fn the_rim_of_an_obstacle_on_the_path_is_no_end() {
        let (grid, robot) = grid([
            "..........",
            "..........",
            "####......",
            "####......",
            ".R........",
            "..........",
        ]);
        let path = [cell(0, 0), cell(0, 2), cell(0, 4)];
        let open = OpenStretch {
            last: Some(cell(0, 4)),
            ..OpenStretch::default()
        };
        assert_eq!(OpenStretch::of(&grid, robot, &path), open);
    }

    #[test]
    fn cells_that_are_closed_whole_end_the_stretch_and_close_nothing() {
        let (grid, robot) = grid(["######", "######", "......", ".R...."]);
        let path = [cell(0, 0), cell(0, 2)];
        let ended = OpenStretch {
            last: Some(cell(0, 0)),
            next: Some(cell(0, 2)),
            is_closed: false,
        };
        assert_eq!(OpenStretch::of(&grid, robot, &path), ended);
    }
}
