//! The near field seen from the robot, and whether a motion touches it.
//!
//! The robot is its rectangle. A motion is clear if the rectangle, at places at most `CHECK_EVERY_M` apart for any part of it,
//! keeps a margin from every near point; a point that is nearer than the margin already may hardly come nearer.
//!
//! Where the ground is too steep to be crossed, a place is not clear in which the robot leans too far aside ([`Incline`]): a boundary that depends on
//! the heading.
//!
//! What stands behind the robot and was only seen from afar is no near point; there the map's obstacle cells count.
//!
//! Units: metres, seconds, radians; robot frame, x forward.

use heapless::Vec;

use crate::config::Config;
use crate::drive::incline::Incline;
use crate::geometry::{CELL_M, Point, Pose, Twist};
use crate::map::obstacle_points::MAX_POINTS;
use crate::math;
use crate::robot::RobotShape;

/// A place of the robot is checked every so many metres that any part of it moved.
const CHECK_EVERY_M: f32 = 0.05;
/// Cells of the map that count at the most.
const MOST_CELLS: usize = 64;
/// A cell of the map with a near point this near to its middle is known better by that, metres: in the cell, or at its side.
const KNOWN_M: f32 = 0.08;
/// Cells farther ahead than this are in view of the level laser, metres.
const IN_VIEW_M: f32 = 0.1;
/// Time step of the look ahead, seconds.
const TICK_S: f32 = 0.1;
/// Steps of it at the most: one period and the braking from full speed.
const MOST_TICKS: u32 = 40;
/// What a point nearer than the margin may lose of its distance in one motion, metres.
const SLACK_M: f32 = 0.004;
/// Nothing may come nearer than this, however often it loses a little, metres.
const FLOOR_M: f32 = 0.01;

/// A place of the robot relative to where it is now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Metres ahead.
    pub x_m: f32,
    /// Metres to the left.
    pub y_m: f32,
    /// Radians to the left.
    pub yaw_rad: f32,
}

impl Place {
    /// This place after an arc of `length_m` (negative is backwards) that turns by `turn_rad`.
    #[must_use]
    pub fn after(self, length_m: f32, turn_rad: f32) -> Self {
        let (sin, cos) = math::sin_cos(self.yaw_rad + 0.5 * turn_rad);
        Self {
            x_m: self.x_m + length_m * cos,
            y_m: self.y_m + length_m * sin,
            yaw_rad: self.yaw_rad + turn_rad,
        }
    }
}

/// A near point, with its distance from the robot as it stands.
#[derive(Clone, Copy, Debug)]
struct Threat {
    at: Point,
    clearance_m: f32,
}

/// What stands around the robot, in its frame.
#[derive(Debug)]
pub struct CollisionChecker {
    robot: RobotShape,
    threats: Vec<Threat, { MAX_POINTS + MOST_CELLS }>,
    hull: Hull,
    /// How the ground inclines, where that bounds the headings.
    incline: Option<Incline>,
}

/// What the robot covers seen from above, metres from its middle.
#[derive(Clone, Copy, Debug)]
struct Hull {
    front: f32,
    back: f32,
    left: f32,
    right: f32,
}

impl Hull {
    /// On the level.
    const fn level(robot: &RobotShape) -> Self {
        Self {
            front: robot.half_length_m,
            back: robot.half_length_m,
            left: robot.half_width_m,
            right: robot.half_width_m,
        }
    }

    /// Where it leans its top reaches out over what is downhill.
    fn leaning(robot: &RobotShape, pose: &Pose) -> Self {
        let reach = |angle: f32| robot.height_m * math::sin_cos(angle).0;
        let (nose, right) = (reach(pose.pitch_rad), reach(pose.roll_rad));
        Self {
            front: robot.half_length_m + nose.max(0.0),
            back: robot.half_length_m + (-nose).max(0.0),
            left: robot.half_width_m + (-right).max(0.0),
            right: robot.half_width_m + right.max(0.0),
        }
    }

    /// Distance of a point from it, by the larger overhang; negative inside.
    fn overhang(&self, x_m: f32, y_m: f32) -> f32 {
        let along = x_m.abs() - if x_m < 0.0 { self.back } else { self.front };
        let across = y_m.abs() - if y_m < 0.0 { self.right } else { self.left };
        if along > across { along } else { across }
    }
}

/// The robot's frame.
struct Frame {
    origin: Point,
    sin: f32,
    cos: f32,
}

impl Frame {
    fn of(pose: &Pose) -> Self {
        let (sin, cos) = math::sin_cos(pose.yaw_rad);
        let origin = pose.point();
        Self { origin, sin, cos }
    }

    fn within(&self, point: Point) -> Point {
        let (dx, dy) = (point.x_m - self.origin.x_m, point.y_m - self.origin.y_m);
        Point {
            x_m: dx * self.cos + dy * self.sin,
            y_m: dy * self.cos - dx * self.sin,
        }
    }
}

fn towards(from: f32, to: f32, most: f32) -> f32 {
    from + (to - from).clamp(-most, most)
}

impl CollisionChecker {
    /// The points as seen from `pose`.
    #[must_use]
    pub fn new(robot: &RobotShape, pose: &Pose, points: &[Point]) -> Self {
        let mut surround = Self::empty(robot);
        surround.see(pose, points);
        surround
    }

    /// Nothing around.
    #[must_use]
    pub const fn empty(robot: &RobotShape) -> Self {
        Self {
            threats: Vec::new(),
            robot: *robot,
            hull: Hull::level(robot),
            incline: None,
        }
    }

    /// Stand on ground that inclines.
    #[must_use]
    pub fn on(mut self, incline: Option<Incline>) -> Self {
        self.incline = incline;
        self
    }

    /// Whether the ground bounds the headings.
    #[must_use]
    pub const fn inclines(&self) -> bool {
        self.incline.is_some()
    }

    /// Whether the robot stands on ground that it may not turn round on.
    #[must_use]
    pub fn is_steep(&self) -> bool {
        self.incline.as_ref().is_some_and(Incline::is_steep)
    }

    /// See the points from `pose`.
    pub fn see(&mut self, pose: &Pose, points: &[Point]) {
        let frame = Frame::of(pose);
        self.threats.clear();
        for &point in points {
            let at = frame.within(point);
            let clearance_m = self.hull.overhang(at.x_m, at.y_m);
            // A point well inside the robot is a false echo or a passing hand; it cannot be avoided any more.
            if clearance_m > -0.02 {
                // There are no more points than threats.
                let _ = self.threats.push(Threat { at, clearance_m });
            }
        }
    }

    /// Remember the obstacle cells (their middles) that are out of view and without a near point.
    pub fn remember(&mut self, pose: &Pose, cells: impl Iterator<Item = Point>) {
        let frame = Frame::of(pose);
        let seen = self.threats.len();
        for at in cells.map(|cell| frame.within(cell)) {
            let clearance_m = self.hull.overhang(at.x_m, at.y_m);
            let near = |threat: &Threat| {
                let (dx, dy) = (threat.at.x_m - at.x_m, threat.at.y_m - at.y_m);
                dx * dx + dy * dy < KNOWN_M * KNOWN_M
            };
            let points = self.threats.get(..seen).unwrap_or_default();
            if at.x_m < IN_VIEW_M && clearance_m > 0.0 && !points.iter().any(near) {
                // What does not fit is not the only thing behind the robot.
                let _ = self.threats.push(Threat { at, clearance_m });
            }
        }
    }

    /// Keep off cells (their middles) on all sides, as the robot leans, by half a cell more than their middles say: any part of one may be what is not to be
    /// touched; and by so much more as is said of each, metres.
    pub fn keep_off(&mut self, pose: &Pose, cells: impl Iterator<Item = (Point, f32)>) {
        let frame = Frame::of(pose);
        self.hull = Hull::leaning(&self.robot, pose);
        self.threats.clear();
        for (cell, more_m) in cells {
            let at = frame.within(cell);
            let away = math::sqrt(at.x_m * at.x_m + at.y_m * at.y_m);
            let part = ((away - 0.5 * CELL_M - more_m) / away.max(1e-3)).max(0.0);
            let at = Point {
                x_m: at.x_m * part,
                y_m: at.y_m * part,
            };
            let clearance_m = self.hull.overhang(at.x_m, at.y_m);
            if clearance_m > 0.0 {
                // What does not fit is not the only thing around the robot.
                let _ = self.threats.push(Threat { at, clearance_m });
            }
        }
    }

    /// How many points there are.
    #[must_use]
    pub fn points(&self) -> u32 {
        self.threats.len() as u32
    }

    /// Distance of the nearest point from the robot, metres.
    #[must_use]
    pub fn clearance_m(&self) -> f32 {
        self.threats
            .iter()
            .map(|threat| threat.clearance_m)
            .fold(f32::MAX, f32::min)
    }

    /// Whether the robot at this place keeps `margin_m` from every point, and does not lean too far aside.
    #[must_use]
    pub fn is_clear(&self, place: Place, margin_m: f32) -> bool {
        let (sin, cos) = math::sin_cos(place.yaw_rad);
        let stands = |incline: &Incline| incline.admits(place, (sin, cos));
        if !self.incline.as_ref().is_none_or(stands) {
            return false;
        }
        self.threats.iter().all(|threat| {
            let (dx, dy) = (threat.at.x_m - place.x_m, threat.at.y_m - place.y_m);
            let now = self.hull.overhang(dx * cos + dy * sin, dy * cos - dx * sin);
            let least = (threat.clearance_m - SLACK_M).max(FLOOR_M.min(threat.clearance_m));
            now >= margin_m.min(least - 1e-5)
        })
    }

    /// Places at which the robot is checked on so long a way of any part of it.
    #[must_use]
    pub fn places_on(moved_m: f32) -> u32 {
        math::floor(moved_m.abs() / CHECK_EVERY_M) as u32 + 1
    }

    /// Whether an arc of `length_m` that turns by `turn_rad` is clear, from a place on.
    #[must_use]
    pub fn is_arc_clear(&self, from: Place, length_m: f32, turn_rad: f32, margin_m: f32) -> bool {
        let moved = length_m.abs() + turn_rad.abs() * self.robot.half_diagonal_m;
        let parts = Self::places_on(moved);
        let (length, turn) = (length_m / parts as f32, turn_rad / parts as f32);
        let mut place = from;
        (0..parts).all(|_| {
            place = place.after(length, turn);
            self.is_clear(place, margin_m)
        })
    }

    /// Whether following `twist` for one period and braking after it is clear, from the velocity `now` and within the
    /// robot's acceleration.
    #[must_use]
    pub fn admits(&self, twist: Twist, now: Twist, config: &Config, margin_m: f32) -> bool {
        let (most_v, most_w) = (
            config.linear_accel_mps2 * TICK_S,
            config.angular_accel_radps2 * TICK_S,
        );
        let (mut v, mut w) = (now.linear_mps, now.angular_radps);
        let mut place = Place::default();
        let mut left_s = config.period_s;
        let mut since_m = 0.0;
        for _ in 0..MOST_TICKS {
            let braking = left_s <= 1e-3;
            let wanted = if braking { Twist::default() } else { twist };
            left_s -= TICK_S;
            let v_next = towards(v, wanted.linear_mps, most_v);
            let w_next = towards(w, wanted.angular_radps, most_w);
            let (length, turn) = (0.5 * (v + v_next) * TICK_S, 0.5 * (w + w_next) * TICK_S);
            place = place.after(length, turn);
            (v, w) = (v_next, w_next);
            since_m += length.abs() + turn.abs() * self.robot.half_diagonal_m;
            let stopped = left_s <= 1e-3 && v.abs() < 1e-3 && w.abs() < 1e-3;
            if stopped || since_m > CHECK_EVERY_M {
                since_m = 0.0;
                if !self.is_clear(place, margin_m) {
                    return false;
                }
            }
            if stopped {
                return true;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROBOT: RobotShape = RobotShape::PIONEER_3AT;

    fn config() -> Config {
        Config::pioneer_3at(Vec::new())
    }

    fn wall_ahead(distance_m: f32) -> CollisionChecker {
        let points: std::vec::Vec<Point> = (-10..=10)
            .map(|k| Point {
                x_m: distance_m,
                y_m: k as f32 * 0.05,
            })
            .collect();
        CollisionChecker::new(&ROBOT, &Pose::default(), &points)
    }

    #[test]
    fn a_wall_is_admitted_only_beyond_the_braking_distance() {
        let full = Twist {
            linear_mps: 0.7,
            angular_radps: 0.0,
        };
        // 0.14 m in the period and 0.7²/(2·0.3) = 0.82 m of braking.
        let needs = ROBOT.half_length_m + 0.14 + 0.82 + 0.06;
        assert!(wall_ahead(needs + 0.03).admits(full, full, &config(), 0.06));
        assert!(!wall_ahead(needs - 0.03).admits(full, full, &config(), 0.06));
    }

    #[test]
    fn a_turn_on_the_spot_needs_the_diagonal() {
        let turn =
            |distance| wall_ahead(distance).is_arc_clear(Place::default(), 0.0, math::PI, 0.0);
        assert!(turn(0.36));
        assert!(!turn(0.34));
    }

    #[test]
    fn a_point_too_near_may_be_left_but_not_approached() {
        let near = wall_ahead(ROBOT.half_length_m + 0.01);
        assert!(near.is_arc_clear(Place::default(), -0.1, 0.0, 0.05));
        assert!(!near.is_arc_clear(Place::default(), 0.1, 0.0, 0.05));
    }

    #[test]
    fn the_place_after_a_quarter_circle() {
        let mut place = Place::default();
        for _ in 0..90 {
            place = place.after(math::PI / 180.0, math::PI / 180.0);
        }
        assert!((place.x_m - 1.0).abs() < 1e-3 && (place.y_m - 1.0).abs() < 1e-3);
    }

    /// A wall right behind, 0.1 m from the hull: met only in its left half, in the map whole.
    #[test]
    fn what_the_map_knows_behind_the_robot_stops_it_where_no_point_does() {
        let back = -ROBOT.half_length_m - 0.1;
        let wall = |y: i32| Point {
            x_m: back,
            y_m: 0.1 * y as f32,
        };
        let half: std::vec::Vec<Point> = (1..4).map(wall).collect();
        let mut surround = CollisionChecker::new(&ROBOT, &Pose::default(), &half);
        surround.remember(&Pose::default(), (-3..4).map(wall));
        assert_eq!(surround.points(), 3 + 4, "cells with a point are left out");
        assert!(surround.is_arc_clear(Place::default(), -0.08, 0.0, 0.0));
        assert!(!surround.is_arc_clear(Place::default(), -0.15, 0.0, 0.0));
        let mut right = CollisionChecker::empty(&ROBOT);
        right.remember(&Pose::default(), (-3..0).map(wall));
        assert!(!right.is_arc_clear(Place::default(), -0.15, 0.0, 0.0));
    }

    /// Ahead the laser sees for itself, and a cell that the robot stands on is none.
    #[test]
    fn cells_in_view_or_under_the_robot_are_not_remembered() {
        let mut surround = CollisionChecker::empty(&ROBOT);
        let at = |x_m, y_m| Point { x_m, y_m };
        let cells = [at(0.4, 0.0), at(0.15, 0.3), at(0.0, 0.2), at(-0.2, 0.0)];
        surround.remember(&Pose::default(), cells.into_iter());
        assert_eq!(surround.points(), 0);
    }
}
