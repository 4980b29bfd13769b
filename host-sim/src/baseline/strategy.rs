//! A strategy of a host-only baseline, and the scene that it plans in.

use fieldline_planner::config::UnevenGround;
use fieldline_planner::geometry::{Point, Pose};
use fieldline_planner::status::ResidualFrontier;
use fieldline_protocol::message::FieldRow;

use super::chart::Chart;
use super::heights::HeightGrid;

/// Input of one planning step.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The known space.
    pub chart: &'a Chart,
    /// Pose of the robot.
    pub pose: Pose,
    /// Clock of the host, milliseconds.
    pub time_ms: u32,
    /// The ground; `None` in a session for flat ground.
    pub uneven: Option<UnevenScene<'a>>,
}

/// Uneven ground of a scene.
#[derive(Clone, Copy, Debug)]
pub struct UnevenScene<'a> {
    /// Parameters of the session.
    pub ground: &'a UnevenGround,
    /// All heights measured so far.
    pub heights: &'a HeightGrid,
}

/// Result of one planning step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// There is a path to unexplored space.
    Path,
    /// There is no path to unexplored space.
    Nothing,
    /// Unexplored space can be reached, but nothing tells the robot in which direction.
    Flat,
    /// The robot cannot move, whatever its goal.
    Stuck,
}

/// A strategy: decides where the robot goes next.
pub trait Strategy {
    /// Forgets everything, for a new session.
    fn reset(&mut self);

    /// Plans for the scene of this step.
    fn plan(&mut self, scene: &Scene<'_>) -> Outcome;

    /// Returns the heading of the plan at a point near the robot, radians; `None` if the plan has
    /// no direction there.
    fn heading_at(&self, scene: &Scene<'_>, point: Point) -> Option<f32>;

    /// Returns the progress along the plan at a point near the robot.
    ///
    /// It is a factor that is 1 at the robot. In a passage as wide as the robot it doubles every
    /// 0.1 m or so, like q of the planner.
    fn potential_at(&self, scene: &Scene<'_>, point: Point) -> f32;

    /// Returns the goals that were given up, each with its reason.
    fn dropped(&self) -> Vec<ResidualFrontier>;

    /// Returns the solver cycles of the last plan.
    fn cycles(&self) -> u16 {
        0
    }

    /// Returns true if the solver of the last plan ran out of cycles.
    fn is_exhausted(&self) -> bool {
        false
    }

    /// Returns a row of the last field around the robot.
    fn field_row(&self, _row: u8) -> Option<FieldRow> {
        None
    }
}
