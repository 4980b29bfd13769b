//! The tractor point: a place behind the robot that it is to come back to by another way [Jorge15, III-A and III-C, second step].
//!
//! It is made on the robot's own path, so it is visited and can be reached, behind the robot and not in the surroundings of a
//! loop that was closed. From skeleton to skeleton it moves to the nearest centre cell. It is gone when the robot
//! has come to it, or when the map has put an obstacle there.
//!
//! Departs from [Jorge15, Algorithm 1, line 5]: a tractor point that no loop is being closed to, and that is far behind,
//! is made anew: the robot would have to go back all that way when it meets a loop at last.
//!
//! Units: metres; map cells.

use crate::geometry::{CELL_M, Cell, Pose};
use crate::math;
use crate::path::breadcrumbs::Crumbs;
use crate::strategy::ouroboros::closed_regions::Marks;

/// A robot this near has reached it [Jorge15, line 7: `Threshold`; the paper gives no value].
pub const REACHED_M: f32 = 1.0;
/// It is made at least this far behind the robot: a shield must find room between.
pub const LEAST_BEHIND_M: f32 = 2.5;
/// A centre cell this far from where the robot was is no place that it visited.
const MOST_ASIDE_M: f32 = 1.5;
/// Farther than this and without a loop it is made anew.
const FAR_M: f32 = 10.0;

/// What becomes of a tractor point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// It stays.
    Stays,
    /// The robot has come to it.
    Reached,
    /// It is too far behind.
    Stale,
}

/// What becomes of the tractor point at `at`, to which a loop is being closed or not.
#[must_use]
pub fn fate(at: Cell, robot: &Pose, is_closing: bool) -> Fate {
    let distance_m = distance_m(at, robot.point().cell());
    if distance_m < REACHED_M {
        Fate::Reached
    } else if distance_m > FAR_M && !is_closing {
        Fate::Stale
    } else {
        Fate::Stays
    }
}

/// Where a tractor point may be made: the last place on the robot's path that is behind it and not marked.
#[must_use]
pub fn candidate<const SLOTS: usize>(
    crumbs: &Crumbs,
    marks: &Marks<SLOTS>,
    robot: &Pose,
) -> Option<Cell> {
    crumbs
        .newest_first()
        .find(|&crumb| is_behind(crumb, robot) && !marks.is_marked(crumb))
}

/// Whether a tractor point may be at a centre cell, the one nearest to a candidate.
#[must_use]
pub fn suits<const SLOTS: usize>(
    centre: Cell,
    candidate: Cell,
    marks: &Marks<SLOTS>,
    robot: &Pose,
) -> bool {
    distance_m(centre, candidate) <= MOST_ASIDE_M
        && is_behind(centre, robot)
        && !marks.is_marked(centre)
}

/// Whether it may be moved to a cell of the way behind the robot: far enough from it, and not marked.
#[must_use]
pub fn may_be_at<const SLOTS: usize>(cell: Cell, marks: &Marks<SLOTS>, robot: &Pose) -> bool {
    distance_m(cell, robot.point().cell()) >= LEAST_BEHIND_M && !marks.is_marked(cell)
}

fn is_behind(cell: Cell, robot: &Pose) -> bool {
    let (sin, cos) = math::sin_cos(robot.yaw_rad);
    let at = robot.point().cell();
    let ahead = (cell.x - at.x) as f32 * cos + (cell.y - at.y) as f32 * sin;
    ahead < 0.0 && distance_m(cell, at) >= LEAST_BEHIND_M
}

fn distance_m(a: Cell, b: Cell) -> f32 {
    let (dx, dy) = ((a.x - b.x) as f32, (a.y - b.y) as f32);
    math::sqrt(dx * dx + dy * dy) * CELL_M
}
