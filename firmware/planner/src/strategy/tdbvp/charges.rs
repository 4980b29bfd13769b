//! The charges of the window: rails by the time of their visit, the unexplored, the preferred side.
//!
//! ```text
//! q = (1 − p) / 1.5      p = −0.5 has a goal's whole charge
//!     not visited 1,   unexplored 2/3,   visited (1 − p) · 2/3       \[Maffei14, IV, eq. 3\]
//! ```
//!
//! Departs from \[Maffei14, IV\], where the unexplored holds 0 and attracts: every centre cell in
//! the window is charged, also those on the frontier, which the skeleton has only as anchors. A
//! frontier that the robot has not visited holds −0.5. If frontier cells were free, explorations
//! would leave out corners that the robot has only seen, and the patrol would drive into them late
//! (measured: docs/MEASURED.md, "Frontier cells charged as rails").
//!
//! Departs from \[Maffei14, IV\]: centre cells near the robot and those in its pending visits are
//! free. The robot is visiting them now; with the potential of the newest, p = 1, they would be a
//! wall along the middle of its corridor.
//!
//! Units: window cells; shares of a goal's charge.

use crate::config::TdbvpTuning;
use crate::field::local_grid::{LocalGrid, Rows};
use crate::field::{Preference, SIDE, Window};
use crate::geometry::{CELL_M, Cell, Point};
use crate::map::Tiles;
use crate::path::nearest::Centres;
use crate::roadmap::branches::{Kind, kind};
use crate::strategy::tdbvp::Rails;
use crate::strategy::tdbvp::pending_visits::PendingVisits;
use crate::strategy::tdbvp::rails::UNVISITED;
use crate::strategy::tdbvp::sides::Side;

/// Potential of the unexplored \[Maffei14, IV\].
const UNEXPLORED: f32 = 0.0;

/// Returns a potential as a share of a goal's charge.
fn share(potential: f32) -> f32 {
    (1.0 - potential) / (1.0 - UNVISITED)
}

/// Charges the window with the rails beyond `free_m` from the robot, and with the unexplored goals.
/// The local grid has the window's cells.
pub(super) fn charge_rails<const TILES: usize, const SLOTS: usize>(
    window: &mut Window,
    grid: &LocalGrid,
    (rails, pending): (&Rails<SLOTS>, &PendingVisits),
    centres: &Centres<'_, TILES, SLOTS>,
    (robot, free_m): (Point, f32),
    unexplored: &Rows,
) {
    let half = SIDE as i32 / 2 + 1;
    let for_each = |visit: &mut dyn FnMut((usize, usize), f32)| {
        centres.for_each_in_square(robot.cell(), half, |_, cell| {
            if distance_m(cell, robot) > free_m && !pending.holds(cell) {
                let share = share(rails.potential(cell));
                let places = cell.quarters().filter_map(|part| grid.place(part));
                places
                    .filter(|&place| LocalGrid::has(&grid.passable, place))
                    .for_each(|place| visit(place, share));
            }
        });
    };
    let (mut free, mut goal) = (grid.passable, *unexplored);
    for_each(&mut |(x, y), share| {
        if share > 0.0 {
            LocalGrid::put(&mut goal, (x, y));
        } else if let Some(row) = free.get_mut(y) {
            // The newest is as an obstacle.
            *row &= !(1 << x);
        }
    });
    window.set_boundary(&free, &goal);
    for (y, row) in unexplored.iter().enumerate() {
        (0..SIDE)
            .filter(|x| row >> x & 1 == 1)
            .for_each(|x| window.charge(x, y, share(UNEXPLORED)));
    }
    for_each(&mut |(x, y), share| {
        if share > 0.0 {
            window.charge(x, y, share);
        }
    });
}

/// Returns the passable window cells of unexplored coarse cells, without those within
/// `dropped_cells` of dropped goals.
pub(super) fn unexplored<const TILES: usize, const SLOTS: usize>(
    grid: &LocalGrid,
    tiles: &Tiles<TILES, SLOTS>,
    dropped: impl Iterator<Item = Cell>,
    dropped_cells: i32,
) -> Rows {
    let mut goal: Rows = [0; SIDE];
    let (x, y) = (grid.origin.x & !1, grid.origin.y & !1);
    let (left, below) = (grid.origin.x - x, grid.origin.y - y);
    let mut reader = tiles.reader(x);
    for pair in 0..=SIDE as i32 / 2 {
        // A coarse cell is unexplored if two of its four cells are unknown.
        let [lower, upper] = [0, 1].map(|k| reader.row(y + 2 * pair + k).unknown());
        let one_in_each = (lower | lower >> 1) & (upper | upper >> 1);
        let two = (lower & lower >> 1) | (upper & upper >> 1) | one_in_each;
        let two = two & 0x5555_5555_5555_5555;
        for row in [2 * pair - below, 2 * pair + 1 - below] {
            let row = usize::try_from(row).unwrap_or(SIDE);
            if let (Some(goal), Some(passable)) = (goal.get_mut(row), grid.passable.get(row)) {
                *goal = (two | two << 1) >> left & passable;
            }
        }
    }
    for cell in dropped {
        let column = cell.x - grid.origin.x;
        let columns = (0..SIDE as i32)
            .filter(|x| (x - column).abs() <= dropped_cells)
            .fold(0, |columns, x| columns | 1u64 << x);
        let middle = cell.y - grid.origin.y;
        for row in middle - dropped_cells..=middle + dropped_cells {
            let row = usize::try_from(row).ok().and_then(|row| goal.get_mut(row));
            if let Some(row) = row {
                *row &= !columns;
            }
        }
    }
    goal
}

/// Returns true if the skeleton has a junction within `disc_m` of the robot.
pub(super) fn has_fork<const TILES: usize, const SLOTS: usize>(
    centres: &Centres<'_, TILES, SLOTS>,
    robot: Point,
    disc_m: f32,
) -> bool {
    let mut has_fork = false;
    centres.for_each_in_square(robot.cell(), (disc_m / CELL_M) as i32, |site, cell| {
        has_fork |=
            distance_m(cell, robot) <= disc_m && kind(centres.cells, site) == Some(Kind::Junction);
    });
    has_fork
}

/// Prefers a side of the half disc that lies ahead of the robot, in the direction `ahead` of any
/// length.
///
/// The direction is where the robot has been driving and not its heading: the preferred side would
/// turn with a robot that turns on the spot, and the robot would turn for ever.
pub(super) fn prefer(
    window: &mut Window,
    grid: &LocalGrid,
    robot: Point,
    (side, [cos, sin]): (Side, [f32; 2]),
    tuning: &TdbvpTuning,
) {
    let (epsilon, disc_m) = (tuning.side_preference, tuning.disc_m);
    let [attracts, repels] = [epsilon, -epsilon].map(Preference::nearest);
    window.set_preferences(|x, y| {
        let at = grid.cell(x, y).corner();
        let (dx, dy) = (at.x_m - robot.x_m, at.y_m - robot.y_m);
        let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
        if ahead <= 0.0 || at.distance2(robot) > disc_m * disc_m {
            Preference::NONE
        } else if (left > 0.0) == (side == Side::Left) {
            attracts
        } else {
            repels
        }
    });
}

/// Returns the distance from the middle of a coarse cell, metres.
pub(super) fn distance_m(cell: Cell, robot: Point) -> f32 {
    let corner = cell.corner();
    let middle = Point {
        x_m: corner.x_m + CELL_M,
        y_m: corner.y_m + CELL_M,
    };
    middle.distance_m(robot)
}
