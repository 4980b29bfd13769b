//! A user's own order of goals.
//!
//! Units: map cells; coarse cells of 20 cm; levels of 10 m of path.

use crate::geometry::Cell;

/// A frontier cell of the skeleton that the robot may drive to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Goal {
    /// Its place: the least of its four map cells.
    pub cell: Cell,
    /// The size of its frontier: the number of coarse frontier cells that are connected with it,
    /// counted up to [`Goal::MAX_CELLS`].
    pub cells: u16,
}

impl Goal {
    /// The greatest size of a frontier that is counted, coarse cells.
    pub const MAX_CELLS: u16 = 64;
}

/// A user's own order of goals: returns the level of a goal, 0 to 8. A goal counts as 10 m farther
/// away for each level.
///
/// It must be a pure function of the goal. The planner calls it once per frontier cell and planning
/// round. The goal that the robot drives to keeps its head start within a level only, so a level
/// that changes often makes the robot oscillate.
///
/// ```
/// use fieldline_planner::{Config, Goal, GoalLevel, LaserMount, RobotShape};
///
/// // Large frontiers first: those of 64 cells have level 0, the smallest ones level 8.
/// fn largest_first(goal: &Goal) -> u8 {
///     ((Goal::MAX_CELLS - goal.cells) / 8) as u8
/// }
/// let order: GoalLevel = largest_first;
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .goal_level(order)
///     .build()?;
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
pub type GoalLevel = fn(&Goal) -> u8;
