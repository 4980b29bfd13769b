//! The robot's place in a team.
//!
//! Units: metres, radians.

use crate::geometry::Pose;

/// A robot of a team.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Member {
    /// The robot's number, unique in the team.
    pub id: u8,
    /// A number that grows each time the robot begins a session: its map is then empty again.
    pub boot: u16,
}

/// The robot's place in a team.
///
/// ```
/// use fieldline_planner::{Config, LaserMount, Member, Pose, RobotShape, TeamPlace};
///
/// // The second robot starts 2 m east of the first, whose odometry is the team's.
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .team(TeamPlace {
///         member: Member { id: 2, boot: 0 },
///         map_from_odom: Pose { x_m: 2.0, ..Pose::default() },
///     })
///     .build()?;
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TeamPlace {
    /// This robot.
    pub member: Member,
    /// The pose of the odometry's origin in the team's coordinates; only x, y and yaw count.
    pub map_from_odom: Pose,
}
