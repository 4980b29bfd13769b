//! How the ground inclines around the robot, and how far it would lean aside there.
//!
//! Slopes are taken from the window of heights at places 0.3 m apart, once a step; a place of a motion has that of the nearest.
//!
//! Invariant: where the ground was not measured it is taken as level, and holds nothing up. Units: metres, tangents, radians; robot frame, x forward.

use crate::config::UnevenGround;
use crate::drive::collision::Place;
use crate::drive::side_slope::{Hysteresis, Slope, SlopeDirection};
use crate::geometry::{Point, Pose};
use crate::ground::Heights;
use crate::math;
use crate::robot::RobotShape;

/// From one place to the next, metres.
const STEP_M: f32 = 0.3;
/// Places to each side of the robot.
const REACH: i32 = 2;
const SIDE: usize = 2 * REACH as usize + 1;
/// So far ahead of its front the robot turns to what comes, metres: the way in which it brakes from half its speed.
const BEFORE_M: f32 = 0.196;
/// The part of the limit that a measured lean may take: on ground of 15° a slope is measured to about half a degree, and a robot that turns on the
/// spot there leans by all of it.
const SURE: f32 = 0.95;

/// Slopes around the robot, and the greatest lean.
#[derive(Clone, Debug)]
pub struct Incline {
    slopes: [[Slope; SIDE]; SIDE],
    most: f32,
    /// How far ahead of its centre the robot turns to what comes, metres.
    ahead_m: f32,
    /// A robot that leans more than that already may go on to lean as much.
    now: f32,
}

impl Incline {
    /// As seen from `pose`; `None` where everything that may be climbed may be crossed.
    #[must_use]
    pub fn new(
        robot: &RobotShape,
        terrain: &UnevenGround,
        heights: &Heights<'_>,
        pose: &Pose,
    ) -> Option<Self> {
        let most = terrain.most_lean()?;
        let (sin, cos) = math::sin_cos(pose.yaw_rad);
        let slope = |row: usize, column: usize| {
            let metres = |index: usize| (index as i32 - REACH) as f32 * STEP_M;
            let (x_m, y_m) = (metres(column), metres(row));
            let at = Point {
                x_m: pose.x_m + x_m * cos - y_m * sin,
                y_m: pose.y_m + x_m * sin + y_m * cos,
            };
            let slope = Slope::around(heights, at.cell()).unwrap_or_default();
            slope.turned(pose.yaw_rad)
        };
        let slopes = core::array::from_fn(|row| core::array::from_fn(|column| slope(row, column)));
        let mut incline = Self {
            slopes,
            most,
            ahead_m: robot.half_length_m + BEFORE_M,
            now: 0.0,
        };
        incline.now = incline.lean(Place::default(), (0.0, 1.0));
        Some(incline)
    }

    /// The slope at a place.
    fn at(&self, place: Place) -> Slope {
        let index = |metres: f32| {
            let steps = math::floor(metres / STEP_M + 0.5).clamp(-REACH, REACH);
            (steps + REACH) as usize
        };
        let row = self.slopes.get(index(place.y_m));
        let slope = row.and_then(|row| row.get(index(place.x_m)));
        slope.copied().unwrap_or_default()
    }

    fn lean(&self, place: Place, heading: (f32, f32)) -> f32 {
        self.at(place).lean(heading).abs()
    }

    /// Whether the robot may stand at a place, by the sine and cosine of its heading there.
    #[must_use]
    pub fn admits(&self, place: Place, heading: (f32, f32)) -> bool {
        self.lean(place, heading) <= (SURE * self.most).max(self.now)
    }

    /// Whether the robot stands on ground that it may not turn on.
    #[must_use]
    pub fn is_steep(&self) -> bool {
        self.at(Place::default()).steepness() > SURE * self.most
    }

    /// The heading for one that is wanted at a place: turned towards the fall line of the slope there, or else of the slope ahead. In which
    /// wedge it is, if there are wedges.
    #[must_use]
    pub fn heading(
        &self,
        place: Place,
        wanted_rad: f32,
        bias: Hysteresis,
    ) -> (f32, Option<SlopeDirection>) {
        let ahead = Place {
            yaw_rad: wanted_rad,
            ..place
        }
        .after(self.ahead_m, 0.0);
        let (towards_rad, coming) = self.at(ahead).heading(wanted_rad, self.most, bias);
        let (here_rad, wedge) = self.at(place).heading(towards_rad, self.most, bias);
        (here_rad, wedge.or(coming))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Cell;
    use crate::ground::elevation::{Elevation, WINDOW_CELLS};

    /// 15° across, 20° up.
    const TERRAIN: UnevenGround = UnevenGround {
        roll: 0.268,
        ..UnevenGround::TABLE_I
    };

    /// A robot at (0, 0), and ground that rises to the north by 0.34 from `y_m` on.
    fn slope_from(y_m: f32, yaw_rad: f32) -> Incline {
        let (mut heights, mut marks) = ([0; 2 * WINDOW_CELLS], [0; WINDOW_CELLS]);
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell::default());
        for x in -20..20 {
            for y in -20..20 {
                let cell = Cell { x, y };
                let above_m = (cell.centre().y_m - y_m).max(0.0);
                window.measure(cell, 0.34 * above_m);
            }
        }
        let pose = Pose {
            yaw_rad,
            ..Pose::default()
        };
        Incline::new(&RobotShape::PIONEER_3AT, &TERRAIN, &window.read(), &pose).expect("a limit")
    }

    fn facing(yaw_rad: f32) -> (f32, f32) {
        math::sin_cos(yaw_rad)
    }

    #[test]
    fn on_a_slope_the_robot_stands_up_and_down_and_not_across() {
        // It faces north, so that what is wanted counts from there.
        let incline = slope_from(-9.0, 0.5 * math::PI);
        assert!(incline.is_steep());
        let stands = |degrees: f32| incline.admits(Place::default(), facing(degrees.to_radians()));
        let turns = [0.0, 40.0, -40.0, 180.0, 140.0].map(stands);
        assert_eq!(turns, [true; 5]);
        assert_eq!([60.0, 90.0, -90.0, 120.0].map(stands), [false; 4]);
    }

    #[test]
    fn ground_as_steep_as_the_limit_is_not_turned_on_and_ground_that_surely_is_less_is() {
        let ground = |part: f32| Incline {
            slopes: [[Slope {
                x: 0.0,
                y: part * TERRAIN.roll,
            }; SIDE]; SIDE],
            ..slope_from(9.0, 0.0)
        };
        let everywhere = |part: f32| {
            (0..48).all(|k| ground(part).admits(Place::default(), facing(0.13 * k as f32)))
        };
        assert!(everywhere(0.9) && !ground(0.9).is_steep());
        assert!(!everywhere(0.98) && ground(0.98).is_steep());
    }

    #[test]
    fn a_robot_that_leans_too_far_may_lean_less_and_not_more() {
        // It faces east by north-east, across.
        let incline = slope_from(-9.0, 0.3);
        let stands = |turn: f32| incline.admits(Place::default(), facing(turn));
        assert!(stands(0.0) && stands(0.3));
        assert!(!stands(-0.3));
    }

    #[test]
    fn it_turns_to_a_slope_head_on_before_it_comes_to_it() {
        let before = slope_from(0.35, 0.0);
        assert!(!before.is_steep());
        // North-east by east is wanted.
        let (heading, wedge) = before.heading(Place::default(), 0.5, Hysteresis::default());
        assert_eq!(wedge, None, "0.45 m that way the slope has not begun");
        assert_eq!(heading, 0.5);
        let (heading, wedge) =
            slope_from(0.1, 0.0).heading(Place::default(), 0.5, Hysteresis::default());
        assert_eq!(wedge, Some(SlopeDirection::Up));
        assert!(heading > 0.7 && heading < 0.9, "{heading}");
    }

    #[test]
    fn ground_that_was_not_measured_is_level() {
        let (heights, marks) = ([0; 2 * WINDOW_CELLS], [0; WINDOW_CELLS]);
        let heights = Heights::new(&heights, &marks, Cell::default());
        let incline = Incline::new(
            &RobotShape::PIONEER_3AT,
            &TERRAIN,
            &heights,
            &Pose::default(),
        )
        .expect("a limit");
        assert!(!incline.is_steep());
        assert!(incline.admits(Place::default(), facing(1.0)));
    }
}
