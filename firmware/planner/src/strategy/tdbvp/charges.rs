//! What the window is charged with: rails by the time of their visit, the unexplored, the preferred side.
//!
//! ```text
//! q = 1 − p, a goal's charge being that of p = −0.5:     not visited 1,   unexplored 2/3,   visited (1 − p) · 2/3
//! ```
//!
//! Every centre cell in the window is charged [Maffei14, IV]. Departs from the paper: centre cells near the robot
//! and those in its last metres are free: those are what the robot is visiting. Charged as the newest, p = 1, they would be a wall along the middle
//! of its way.
//!
//! Units: window cells; shares of a goal's charge.

use crate::field::local_grid::{LocalGrid, Rows};
use crate::field::{Preference, SIDE, Window};
use crate::geometry::{CELL_M, Cell, Point};
use crate::grid::{Plane, Site};
use crate::map::Tiles;
use crate::math;
use crate::roadmap::branches::{Kind, kind};
use crate::roadmap::skeleton::Frame;
use crate::strategy::tdbvp::Rails;
use crate::strategy::tdbvp::pending_visits::Fresh;
use crate::strategy::tdbvp::sides::{DISC_M, EPSILON, Side};

/// The unexplored around a goal that was given up is no goal, cells.
const GIVEN_UP_CELLS: i32 = 7;

/// The share of a goal's charge that goes with a potential.
fn share(potential: f32) -> f32 {
    (1.0 - potential) / (1.0 - super::rails::UNVISITED)
}

/// The centre cells, by their least map cells.
pub(super) struct CentreCells<'a> {
    pub(super) frame: Frame,
    pub(super) way: Plane<'a>,
}

impl CentreCells<'_> {
    /// Visit those in the square of so many map cells around a cell.
    pub(super) fn around(&self, middle: Cell, cells: i32, mut visit: impl FnMut(Cell)) {
        let steps = |from: i32, origin: i32, most: usize| {
            let least = (from - cells - origin).div_euclid(2).max(0);
            let last = (from + cells - origin).div_euclid(2).min(most as i32 - 1);
            least..=last
        };
        let columns = self.way.shape().words_per_row() * 32;
        for y in steps(middle.y, self.frame.origin.y, self.way.shape().rows()) {
            let row = self.way.row(y as usize);
            for x in steps(middle.x, self.frame.origin.x, columns) {
                let word = row.get(x as usize / 32).copied().unwrap_or(0);
                if word >> (x % 32) & 1 == 1 {
                    let (x, y) = (x as u16, y as u16);
                    visit(self.frame.cell(Site { x, y }));
                }
            }
        }
    }
}

/// Charge the window with the rails around the robot, those nearer than `room_m` left out, and with the unexplored if it is a goal. The view has the window's cells.
pub(super) fn charge_rails<const SLOTS: usize>(
    window: &mut Window,
    view: &LocalGrid,
    (rails, fresh): (&Rails<SLOTS>, &Fresh),
    centres: &CentreCells<'_>,
    (robot, room_m): (Point, f32),
    unexplored: &Rows,
) {
    let (mut free, mut goal) = (view.passable, *unexplored);
    let half = SIDE as i32 / 2 + 1;
    let each = |visit: &mut dyn FnMut((usize, usize), f32)| {
        centres.around(robot.cell(), half, |cell| {
            if distance_m(cell, robot) > room_m && !fresh.holds(cell) {
                let share = share(rails.potential(cell));
                for_each_part(view, cell, |place| visit(place, share));
            }
        });
    };
    each(&mut |(x, y), share| {
        let rows = if share > 0.0 { &mut goal } else { &mut free };
        if let Some(row) = rows.get_mut(y) {
            *row = if share > 0.0 {
                *row | 1 << x
            } else {
                *row & !(1 << x)
            };
        }
    });
    window.set_boundary(&free, &goal);
    for (y, row) in unexplored.iter().enumerate() {
        (0..SIDE)
            .filter(|x| row >> x & 1 == 1)
            .for_each(|x| window.charge(x, y, share(0.0)));
    }
    each(&mut |(x, y), share| {
        if share > 0.0 {
            window.charge(x, y, share);
        }
    });
}

/// The passable window cells of the unexplored coarse cells, without those around goals that were given up.
pub(super) fn unexplored<const TILES: usize, const SLOTS: usize>(
    view: &LocalGrid,
    tiles: &Tiles<TILES, SLOTS>,
    given_up: impl Iterator<Item = Cell>,
) -> Rows {
    let mut goal: Rows = [0; SIDE];
    let (x, y) = (view.origin.x & !1, view.origin.y & !1);
    let (left, below) = (view.origin.x - x, view.origin.y - y);
    for pair in 0..=SIDE as i32 / 2 {
        let [lower, upper] = [0, 1].map(|k| tiles.row(x, y + 2 * pair + k).unknown());
        let one_in_each = (lower | lower >> 1) & (upper | upper >> 1);
        let two = (lower & lower >> 1) | (upper & upper >> 1) | one_in_each;
        let two = two & 0x5555_5555_5555_5555;
        for row in [2 * pair - below, 2 * pair + 1 - below] {
            let row = usize::try_from(row).unwrap_or(SIDE);
            if let (Some(goal), Some(passable)) = (goal.get_mut(row), view.passable.get(row)) {
                *goal = (two | two << 1) >> left & passable;
            }
        }
    }
    for cell in given_up {
        let column = cell.x - view.origin.x;
        let columns = (0..SIDE as i32)
            .filter(|x| (x - column).abs() <= GIVEN_UP_CELLS)
            .fold(0, |columns, x| columns | 1u64 << x);
        for row in cell.y - view.origin.y - GIVEN_UP_CELLS..=cell.y - view.origin.y + GIVEN_UP_CELLS
        {
            let row = usize::try_from(row).ok().and_then(|row| goal.get_mut(row));
            if let Some(row) = row {
                *row &= !columns;
            }
        }
    }
    goal
}

/// Whether the way parts within the disc around the robot.
pub(super) fn parts(centres: &CentreCells<'_>, robot: Point) -> bool {
    let mut parts = false;
    centres.around(robot.cell(), (DISC_M / CELL_M) as i32, |cell| {
        let is_near = distance_m(cell, robot) <= DISC_M;
        let site = centres.frame.site(cell).filter(|_| is_near);
        parts |= site.and_then(|site| kind(centres.way, site)) == Some(Kind::Junction);
    });
    parts
}

/// Prefer a side of the half disc that lies `ahead` of the robot.
///
/// Ahead is where the robot has been going, not where it looks: if the preferred side turned with a robot that turns on the spot, it would turn
/// for ever.
pub(super) fn prefer(
    window: &mut Window,
    view: &LocalGrid,
    robot: Point,
    (side, [cos, sin]): (Side, [f32; 2]),
) {
    let [attracts, repels] = [EPSILON, -EPSILON].map(Preference::nearest);
    window.set_preferences(|x, y| {
        let at = view.cell(x, y).corner();
        let (dx, dy) = (at.x_m - robot.x_m, at.y_m - robot.y_m);
        let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
        if ahead <= 0.0 || dx * dx + dy * dy > DISC_M * DISC_M {
            Preference::NONE
        } else if (left > 0.0) == (side == Side::Left) {
            attracts
        } else {
            repels
        }
    });
}

/// The passable window cells of a coarse cell.
fn for_each_part(view: &LocalGrid, least: Cell, mut visit: impl FnMut((usize, usize))) {
    for k in 0..4 {
        let part = Cell {
            x: least.x + (k & 1),
            y: least.y + (k >> 1),
        };
        if let Some(place) = view
            .place(part)
            .filter(|&place| LocalGrid::has(&view.passable, place))
        {
            visit(place);
        }
    }
}

/// From the middle of a coarse cell, metres.
pub(super) fn distance_m(cell: Cell, robot: Point) -> f32 {
    let middle = cell.corner();
    let (dx, dy) = (
        middle.x_m + CELL_M - robot.x_m,
        middle.y_m + CELL_M - robot.y_m,
    );
    math::sqrt(dx * dx + dy * dy)
}
