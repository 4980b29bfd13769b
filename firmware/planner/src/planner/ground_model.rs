//! Everything in which the planner treats flat and uneven ground differently.
//!
//! | | flat | uneven |
//! | --- | --- | --- |
//! | hull keeps clear of | obstacle points of the level lasers | the rims of free cells |
//! | window keeps clear of | the map's obstacles | the same rims |
//! | preferences in the field | none | [`Preferences`]: heights, flatness |
//! | which goals cost more | none | those on other height levels |
//! | side slope | none | the roll limit and the fall line |
//! | blocked passages | opened for the second chance | opened several times more |
//! | looks through gaps | from viewpoints | never: a look measures no ground |
//!
//! Level beams end on slopes, so obstacle points say nothing on uneven ground.
//!
//! Units: metres, milliseconds.

use heapless::Vec;

use crate::config::Config;
use crate::drive::CollisionChecker;
use crate::drive::contact::Contact;
use crate::drive::side_slope::SlopeDirection;
use crate::field::local_grid::LocalGrid;
use crate::field::preference::Preferences;
use crate::geometry::{Cell, OdomPose, Point, Pose, RobotFrame};
use crate::input::Input;
use crate::map::obstacle_points::ObstaclePoints;
use crate::map::{Map, SideTable as _, Tiles, obstacle_points};
use crate::path::height_levels::{HeightLevels, LevelCost};
use crate::roadmap::configuration_space::Footprint;
use crate::robot::RobotShape;
use crate::team::hull::Hull;
use crate::team::peers::{MOST_PEERS, Peers};

use crate::planner::sense::level_scans;

/// A goal whose height differs by less lies level with the robot, metres: twice the rounding of a
/// block of heights.
const LEVEL_M: f32 = 0.2;

/// What the planner keeps of the space beside the map.
///
/// The tag is explicit, so that the initial value is all zeros and a static one costs no flash.
#[derive(Debug)]
#[repr(u8)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; both are about as large with the pool of an image"
)]
pub(super) enum GroundModel<const TILES: usize> {
    /// All ground is flat.
    Flat(ObstaclePoints),
    /// Heights matter.
    Uneven(HeightLevels<TILES>),
}

impl<const TILES: usize> GroundModel<TILES> {
    /// Returns the empty model of flat ground.
    pub(super) const fn new() -> Self {
        Self::Flat(ObstaclePoints::new())
    }

    /// Returns the empty model for a session.
    pub(super) const fn of(config: &Config) -> Self {
        match config.ground {
            None => Self::new(),
            Some(_) => Self::Uneven(HeightLevels::new()),
        }
    }

    /// Returns true if heights matter.
    pub(super) const fn is_uneven(&self) -> bool {
        matches!(self, Self::Uneven(_))
    }

    /// Enters one step's scans, after the map did. Obstacle points lie in the odometry frame.
    pub(super) fn observe<const SLOTS: usize>(
        &mut self,
        config: &Config,
        (input, odom): (&Input<'_>, &OdomPose),
        peers: &Peers,
        map: &mut Map<TILES, SLOTS>,
        preferences: &mut Preferences,
    ) {
        match self {
            Self::Flat(points) => {
                let hulls: Vec<Hull, MOST_PEERS> = peers.seen(input.time_ms).collect();
                let frame = RobotFrame::of(&odom.0);
                let is_robot = |point: Point| {
                    let at = input.pose.to_map(frame.to_robot(point));
                    hulls.iter().any(|hull| hull.holds(at))
                };
                for scan in level_scans(config, input) {
                    points.update(config, &odom.0, scan, is_robot);
                }
            }
            Self::Uneven(levels) => {
                preferences.note_pose(&input.pose, &config.tuning.field);
                levels.note(&map.heights(), map.tiles());
                map.compact(levels);
            }
        }
    }

    /// Replaces a tile of the map by a correction; its heights stay with it.
    pub(super) fn replace<const SLOTS: usize>(
        &mut self,
        map: &mut Map<TILES, SLOTS>,
        tile: (i32, i32),
        planes: &[[u32; 32]; 2],
        in_team: bool,
    ) {
        if let Self::Uneven(levels) = self {
            map.expand(tile, levels);
        }
        let spare = map.replace(tile, planes, in_team);
        if let (Self::Uneven(levels), Some(page)) = (self, spare) {
            levels.release_page(page);
        }
    }

    /// Returns the obstacle points; `None` on uneven ground, which has none.
    pub(super) const fn points(&self) -> Option<&ObstaclePoints> {
        match self {
            Self::Flat(points) => Some(points),
            Self::Uneven(_) => None,
        }
    }

    /// Takes over obstacle points with their counts, for a robot at a place of the odometry's
    /// frame.
    pub(super) fn take_over(&mut self, centre: Point, counted: impl Iterator<Item = (Point, u8)>) {
        if let Self::Flat(points) = self {
            points.take_over(centre, counted);
        }
    }

    /// Notes that nothing has been seen around a robot that starts at `odom`.
    pub(super) fn surround(&mut self, odom: &OdomPose, robot: &RobotShape) {
        if let Self::Flat(points) = self {
            points.surround(&odom.0, robot);
        }
    }

    /// Returns true if a robot at `odom` that turns on the spot would sweep what was never seen.
    pub(super) fn is_surrounded(&self, odom: &OdomPose, robot: &RobotShape) -> bool {
        match self {
            Self::Flat(points) => points.is_surrounded(&odom.0, robot),
            Self::Uneven(_) => false,
        }
    }

    /// Notes where the hull of a robot at `odom` met something.
    pub(super) fn feel(&mut self, odom: &OdomPose, robot: &RobotShape, contact: Contact) {
        if let Self::Flat(points) = self {
            let felt = contact.points(robot).map(|point| odom.0.to_map(point));
            points.feel(odom.0.point(), felt, contact.is_turn());
        }
    }

    /// Opens the trap of what a turning robot at `odom` felt on all sides, or of what was never
    /// seen around it. Returns true if there was one.
    pub(super) fn open_trap(&mut self, odom: &OdomPose, robot: &RobotShape) -> bool {
        match self {
            Self::Flat(points) => points.open_trap(&odom.0, robot),
            Self::Uneven(_) => false,
        }
    }

    /// Returns the cost of goals by their height; `None` where heights do not choose goals.
    pub(super) fn level_cost<'a>(
        &'a self,
        config: &'a Config,
        preferences: &Preferences,
    ) -> Option<LevelCost<'a, TILES>> {
        let ground = config.ground.as_ref()?;
        match self {
            Self::Uneven(heights) if ground.levels => Some(LevelCost {
                heights,
                ground,
                reference_m: preferences.reference_m(),
            }),
            _ => None,
        }
    }

    /// Blocks in the window the rims that the drive keeps the hull clear of. Without this the field
    /// would lead between two cells where the drive does not go.
    pub(super) fn block_rims<const SLOTS: usize>(
        &self,
        config: &Config,
        tiles: &Tiles<TILES, SLOTS>,
        footprint: &Footprint,
        robot: Point,
        grid: &mut LocalGrid,
    ) {
        if self.is_uneven() {
            let rims = obstacle_points::border_cells(tiles, robot, &config.tuning.map);
            grid.keep_off(robot.cell(), rims, footprint);
        }
    }

    /// Adds the obstacles around the robot that lasers and hull have met.
    pub(super) fn obstruct_measured(&self, odom: &OdomPose, checker: &mut CollisionChecker) {
        if let Self::Flat(points) = self {
            checker.see(&odom.0, points.points());
        }
    }

    /// Adds the obstacles around the robot that its hull must not touch. In place: a checker is
    /// large, and a second one does not fit on the chip's stack.
    pub(super) fn obstruct<const SLOTS: usize>(
        &self,
        config: &Config,
        tiles: &Tiles<TILES, SLOTS>,
        (pose, odom): (&Pose, &OdomPose),
        checker: &mut CollisionChecker,
    ) {
        self.obstruct_measured(odom, checker);
        match self {
            Self::Flat(_) => {
                let cells =
                    obstacle_points::obstacle_cells(tiles, pose.point(), &config.tuning.map);
                checker.remember(pose, cells);
            }
            Self::Uneven(_) => {
                let rims =
                    obstacle_points::inflated_border_cells(tiles, pose.point(), config.tuning);
                checker.keep_off(pose, rims);
            }
        }
    }

    /// Returns the slope direction of the goal; `None` if the goal is level with the robot or its
    /// height is unknown.
    pub(super) fn direction_of<const SLOTS: usize>(
        &self,
        tiles: &Tiles<TILES, SLOTS>,
        goal: Cell,
        robot_m: f32,
    ) -> Option<SlopeDirection> {
        let Self::Uneven(levels) = self else {
            return None;
        };
        let rise_m = levels.height_around_m(tiles, goal)? - robot_m;
        if rise_m.abs() < LEVEL_M {
            None
        } else if rise_m > 0.0 {
            Some(SlopeDirection::Up)
        } else {
            Some(SlopeDirection::Down)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::GroundModel;
    use crate::config::{Config, PreferenceMode, UnevenGround};
    use crate::field::preference::Preferences;

    #[test]
    fn levels_are_independent_of_the_preference() {
        for mode in [
            PreferenceMode::Off,
            PreferenceMode::Height,
            PreferenceMode::Global,
            PreferenceMode::Both,
        ] {
            for levels in [false, true] {
                let config = Config {
                    ground: Some(UnevenGround {
                        mode,
                        levels,
                        ..UnevenGround::TABLE_I
                    }),
                    ..Config::pioneer_3at(heapless::Vec::new())
                };
                let model = Box::new(GroundModel::<24>::of(&config));
                let cost = model.level_cost(&config, &Preferences::new());
                assert_eq!(cost.is_some(), levels, "{mode:?}");
            }
        }
        let flat = Config::pioneer_3at(heapless::Vec::new());
        let model = Box::new(GroundModel::<24>::of(&flat));
        assert!(model.level_cost(&flat, &Preferences::new()).is_none());
    }
}
