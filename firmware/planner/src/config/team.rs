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
///         // It was put there by hand.
///         sd_m: 0.3,
///         sd_rad: 0.09,
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
    /// Standard deviation of the robot's start along each axis, metres; 0 if the start is known.
    /// With both deviations above 0 the robot keeps its own map until it knows how the map lies in
    /// the team's coordinates. For flat ground; on uneven ground the start counts as known.
    pub sd_m: f32,
    /// Standard deviation of its yaw at the start, radians; 0 if it is known.
    pub sd_rad: f32,
}
