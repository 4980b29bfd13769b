//! Slopes of the ground around the robot, and the side slope at its places.
//!
//! Slopes are measured once per step, at points [`STEP_M`] apart; a place has the slope of the
//! nearest point.
//!
//! Invariant: ground without measured heights counts as level and blocks nothing.
//!
//! Units: metres, tangents, radians; robot frame, x forward.

use crate::config::UnevenGround;
use crate::drive::hull::Place;
use crate::drive::side_slope::{Hysteresis, Slope, SlopeDirection};
use crate::geometry::{Point, Pose, RobotFrame};
use crate::ground::Heights;
use crate::math;
use crate::robot::RobotShape;

/// Distance between two measured points, metres.
const STEP_M: f32 = 0.3;
/// Measured points to each side of the robot.
const REACH: i32 = 2;
const SIDE: usize = 2 * REACH as usize + 1;
/// Distance ahead of its front at which the robot turns for a slope, metres: its braking distance
/// from half its speed.
const BEFORE_M: f32 = 0.196;
/// Part of the limit that a measured side slope may reach. On ground of 15° a slope is measured to
/// about 0.5°, and a robot that turns on the spot there has all of it as side slope.
const SURE_PART: f32 = 0.95;

/// Slopes around the robot, and the limit of the side slope.
#[derive(Clone, Debug)]
pub(crate) struct Incline {
    slopes: [[Slope; SIDE]; SIDE],
    limit: f32,
    /// Distance ahead of its centre at which the robot turns for a slope, metres.
    ahead_m: f32,
    /// Side slope at the robot's pose: a robot beyond the limit may keep this much.
    present: f32,
}

impl Incline {
    /// Measures the slopes around `pose`; `None` if every slope that may be climbed may be crossed.
    #[must_use]
    pub(crate) fn new(
        robot: &RobotShape,
        ground: &UnevenGround,
        heights: &Heights<'_>,
        pose: &Pose,
    ) -> Option<Self> {
        let limit = ground.side_slope_limit()?;
        let frame = RobotFrame::of(pose);
        let slope = |row: usize, column: usize| {
            let metres = |index: usize| (index as i32 - REACH) as f32 * STEP_M;
            let at = frame.to_map(Point {
                x_m: metres(column),
                y_m: metres(row),
            });
            let slope = Slope::around(heights, at.cell()).unwrap_or_default();
            slope.turned(pose.yaw_rad)
        };
        let slopes = core::array::from_fn(|row| core::array::from_fn(|column| slope(row, column)));
        let mut incline = Self {
            slopes,
            limit,
            ahead_m: robot.half_length_m + BEFORE_M,
            present: 0.0,
        };
        incline.present = incline.side_slope(Place::default(), (0.0, 1.0));
        Some(incline)
    }

    /// Returns the slope at a place.
    fn at(&self, place: Place) -> Slope {
        let index = |metres: f32| {
            let steps = math::floor(metres / STEP_M + 0.5).clamp(-REACH, REACH);
            (steps + REACH) as usize
        };
        let row = self.slopes.get(index(place.y_m));
        let slope = row.and_then(|row| row.get(index(place.x_m)));
        slope.copied().unwrap_or_default()
    }

    /// Returns the size of the side slope at a place, for the sine and cosine of a heading.
    fn side_slope(&self, place: Place, heading: (f32, f32)) -> f32 {
        self.at(place).side_slope(heading).abs()
    }

    /// Returns true if the robot may stand at a place, by the sine and cosine of its heading there.
    #[must_use]
    pub(crate) fn admits(&self, place: Place, heading: (f32, f32)) -> bool {
        self.side_slope(place, heading) <= (SURE_PART * self.limit).max(self.present)
    }

    /// Returns true if the robot stands on ground too steep to turn fully.
    #[must_use]
    pub(crate) fn is_steep(&self) -> bool {
        self.at(Place::default()).steepness() > SURE_PART * self.limit
    }

    /// Returns the heading to drive at a place instead of `wanted_rad`: turned towards the fall
    /// line of the slope ahead, and then of the slope at the place. Also returns its slope
    /// direction, if one of the slopes is beyond the limit.
    #[must_use]
    pub(crate) fn heading(
        &self,
        place: Place,
        wanted_rad: f32,
        hysteresis: Hysteresis,
    ) -> (f32, Option<SlopeDirection>) {
        let ahead = Place {
            yaw_rad: wanted_rad,
            ..place
        }
        .after(self.ahead_m, 0.0);
        let slope_ahead = self.at(ahead);
        let (towards_rad, coming) = slope_ahead.heading(wanted_rad, self.limit, hysteresis);
        let (here_rad, here) = self.at(place).heading(towards_rad, self.limit, hysteresis);
        (here_rad, here.or(coming))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Cell;
    use crate::ground::elevation::WINDOW_CELLS;
    use crate::ground::elevation::tests::OwnedWindow;

    /// 15° across, 20° up.
    const GROUND: UnevenGround = UnevenGround {
        roll: 0.268,
        ..UnevenGround::TABLE_I
    };

    /// Returns the slopes around a robot at (0, 0), on ground that rises to the north by 0.34 m per
    /// metre from `y_m` on.
    fn slope_from(y_m: f32, yaw_rad: f32) -> Incline {
        let mut owned = OwnedWindow::new(Cell::default());
        let mut window = owned.write();
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
        Incline::new(&RobotShape::PIONEER_3AT, &GROUND, &window.read(), &pose).expect("a limit")
    }

    fn facing(yaw_rad: f32) -> (f32, f32) {
        math::sin_cos(yaw_rad)
    }

    #[test]
    fn on_a_slope_the_robot_stands_up_and_down_and_not_across() {
        // It faces north, so headings count from there.
        let incline = slope_from(-9.0, 0.5 * math::PI);
        assert!(incline.is_steep());
        let stands = |degrees: f32| incline.admits(Place::default(), facing(degrees.to_radians()));
        let turns = [0.0, 40.0, -40.0, 180.0, 140.0].map(stands);
        assert_eq!(turns, [true; 5]);
        assert_eq!([60.0, 90.0, -90.0, 120.0].map(stands), [false; 4]);
    }

    #[test]
    fn the_robot_turns_on_ground_surely_below_the_limit_and_not_on_ground_near_it() {
        let ground = |part: f32| Incline {
            slopes: [[Slope {
                x: 0.0,
                y: part * GROUND.roll,
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
    fn a_robot_beyond_the_limit_may_reduce_its_side_slope_and_not_increase_it() {
        // It faces east by north-east, across the slope.
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
        let (heading, direction) = before.heading(Place::default(), 0.5, Hysteresis::default());
        assert_eq!(direction, None, "0.45 m ahead the slope has not begun");
        assert_eq!(heading, 0.5);
        let (heading, direction) =
            slope_from(0.1, 0.0).heading(Place::default(), 0.5, Hysteresis::default());
        assert_eq!(direction, Some(SlopeDirection::Up));
        assert!(heading > 0.7 && heading < 0.9, "{heading}");
    }

    #[test]
    fn ground_that_was_not_measured_is_level() {
        let (heights, marks) = ([0; 2 * WINDOW_CELLS], [0; WINDOW_CELLS]);
        let heights = Heights::new(&heights, &marks, Cell::default());
        let incline = Incline::new(
            &RobotShape::PIONEER_3AT,
            &GROUND,
            &heights,
            &Pose::default(),
        )
        .expect("a limit");
        assert!(!incline.is_steep());
        assert!(incline.admits(Place::default(), facing(1.0)));
    }
}
