//! The tractor point: a place behind the robot, to which it is to return by another way
//! \[Jorge15, III-A and III-C, second step\].
//!
//! It is made on the robot's own path, so it is visited and reachable. It lies behind the robot and
//! in no closed region. On each new skeleton it moves to the nearest centre cell \[Jorge15,
//! Algorithm 1, line 6\]. It is disabled when the robot reaches it [line 8], or when the map has an
//! obstacle there.
//!
//! Departs from \[Jorge15, Algorithm 1, line 5\], which keeps a tractor point until it is reached:
//! one that is far behind while no loop is being closed is made again nearer by. The robot would
//! have to drive all that way back in the first loop that it meets.
//!
//! Units: metres; map cells.

use crate::config::OuroborosTuning;
use crate::geometry::{Cell, Pose};
use crate::math;
use crate::path::breadcrumbs::Crumbs;
use crate::strategy::ouroboros::closed_regions::ClosedRegions;

/// The outcome for a tractor point on a new skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// It stays.
    Stays,
    /// The robot has reached it.
    Reached,
    /// It is too far behind.
    Stale,
}

/// Decides about the tractor point at `at`; `is_closing` says that a loop is being closed to it.
pub(super) fn fate(at: Cell, robot: &Pose, is_closing: bool, tuning: &OuroborosTuning) -> Fate {
    let distance_m = at.distance_m(robot.point().cell());
    if distance_m < tuning.reached_m {
        Fate::Reached
    } else if distance_m > tuning.far_m && !is_closing {
        Fate::Stale
    } else {
        Fate::Stays
    }
}

/// Returns the last place of the robot's path that lies behind it and in no closed region.
pub(super) fn candidate<const SLOTS: usize>(
    crumbs: &Crumbs,
    regions: &ClosedRegions<SLOTS>,
    robot: &Pose,
    tuning: &OuroborosTuning,
) -> Option<Cell> {
    crumbs
        .newest_first()
        .find(|&crumb| suits(crumb, regions, robot, tuning))
}

/// Returns true if a cell lies behind the robot and in no closed region.
pub(super) fn suits<const SLOTS: usize>(
    centre: Cell,
    regions: &ClosedRegions<SLOTS>,
    robot: &Pose,
    tuning: &OuroborosTuning,
) -> bool {
    is_behind(centre, robot, tuning) && !regions.is_closed(centre)
}

/// Returns true if a tractor point may move to a cell on the loop road's back.
pub(super) fn may_be_at<const SLOTS: usize>(
    cell: Cell,
    regions: &ClosedRegions<SLOTS>,
    robot: &Pose,
    tuning: &OuroborosTuning,
) -> bool {
    cell.distance_m(robot.point().cell()) >= tuning.least_behind_m && !regions.is_closed(cell)
}

fn is_behind(cell: Cell, robot: &Pose, tuning: &OuroborosTuning) -> bool {
    let (sin, cos) = math::sin_cos(robot.yaw_rad);
    let at = robot.point().cell();
    let ahead = (cell.x - at.x) as f32 * cos + (cell.y - at.y) as f32 * sin;
    ahead < 0.0 && cell.distance_m(at) >= tuning.least_behind_m
}
