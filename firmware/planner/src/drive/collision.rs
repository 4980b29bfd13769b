//! The collision checker: obstacle points in the robot's frame, and the motions that touch none.
//!
//! The robot is its rectangle. A motion is clear if the rectangle keeps a margin from every
//! obstacle point at places along it. Between two of them no part of the robot moves more than
//! twice the margin: then it touches no point between them either. A point that is nearer than the
//! margin already may lose at most [`SLACK_M`] of its distance.
//!
//! On ground too steep to cross, a place is clear only if the side slope there is within its limit
//! ([`Incline`]): that bounds the heading.
//!
//! An obstacle behind the robot that was only seen from afar is no obstacle point; there the map's
//! obstacle cells count.
//!
//! Units: metres, seconds, radians; robot frame, x forward.

use heapless::Vec;

use crate::config::Config;
use crate::drive::hull::{Hull, Place};
use crate::drive::incline::Incline;
use crate::fence::Fence;
use crate::geometry::{CELL_M, Point, Pose, RobotFrame, Twist};
use crate::map::obstacle_points::MAX_POINTS;
use crate::math;
use crate::robot::RobotShape;

/// Least clearance of the robot, metres: while it drives a recovery, and of a point after repeated
/// losses. With less, runs touch something (measured: docs/MEASURED.md, "Clearances of searches
/// and of the drive").
pub(super) const LEAST_MARGIN_M: f32 = 0.016;
/// Capacity for map cells beside the obstacle points.
const MOST_CELLS: usize = 64;
/// Capacity for points on the hulls of other robots.
const MOST_HULL_POINTS: usize = 96;
/// Distance of an obstacle point from a map cell's centre within which the point replaces the cell,
/// metres: in the cell, or at its side.
const KNOWN_M: f32 = 0.08;
/// Map cells farther ahead than this are in view of the level laser, metres.
const IN_VIEW_M: f32 = 0.1;
/// A point deeper inside the hull is a false echo or a passing hand, metres: no motion avoids it.
const FALSE_ECHO_M: f32 = 0.02;
/// Time step of the prediction, seconds.
const TICK_S: f32 = 0.1;
/// Most steps of the prediction: one period and the braking from full speed.
const MOST_TICKS: u32 = 40;
/// Greatest loss of distance in one motion, of a point nearer than the margin, metres.
const SLACK_M: f32 = 0.004;
/// Tolerance for the rounding of a distance, metres.
const ROUNDING_M: f32 = 1e-5;
/// A remaining time, speed or turn rate below this is zero: s, m/s, rad/s.
const ZERO: f32 = 1e-3;

/// An obstacle point, with its distance from the hull at the present pose.
#[derive(Clone, Copy, Debug)]
struct Threat {
    at: Point,
    clearance_m: f32,
}

/// The obstacles around the robot, in its frame.
#[derive(Debug)]
pub struct CollisionChecker {
    robot: RobotShape,
    threats: Vec<Threat, { MAX_POINTS + MOST_CELLS + MOST_HULL_POINTS }>,
    hull: Hull,
    /// Slopes of the ground, where they bound the headings.
    incline: Option<Incline>,
    /// Another robot is near.
    has_robots: bool,
    /// Another robot is near that may drive on.
    has_company: bool,
}

/// Returns `from` moved towards `to` by at most `most`.
pub(super) fn towards(from: f32, to: f32, most: f32) -> f32 {
    from + (to - from).clamp(-most, most)
}

/// Returns the greatest distance between two checked places with this margin, metres.
fn spacing_m(margin_m: f32) -> f32 {
    2.0 * margin_m.max(LEAST_MARGIN_M)
}

/// Returns the point of a cell at this centre that is nearest to the robot's centre, by half a cell
/// and a margin, metres.
fn inflated(centre: Point, margin_m: f32) -> Point {
    let away = centre.distance_m(Point::default());
    let part = ((away - 0.5 * CELL_M - margin_m) / away.max(1e-3)).max(0.0);
    Point {
        x_m: centre.x_m * part,
        y_m: centre.y_m * part,
    }
}

impl CollisionChecker {
    /// Returns a checker of these obstacle points of the map, for a robot at `pose`.
    #[must_use]
    pub fn new(robot: &RobotShape, pose: &Pose, points: &[Point]) -> Self {
        let mut checker = Self::empty(robot);
        checker.see(pose, points);
        checker
    }

    /// Returns a checker without obstacles.
    #[must_use]
    pub const fn empty(robot: &RobotShape) -> Self {
        Self {
            threats: Vec::new(),
            robot: *robot,
            hull: Hull::level(robot),
            incline: None,
            has_robots: false,
            has_company: false,
        }
    }

    /// Returns true if another robot is near.
    #[must_use]
    pub(crate) const fn has_robots(&self) -> bool {
        self.has_robots
    }

    /// Returns true if another robot is near that may drive on.
    #[must_use]
    pub(crate) const fn has_company(&self) -> bool {
        self.has_company
    }

    /// Sets the slopes that bound the headings.
    pub(crate) fn stand_on(&mut self, incline: Option<Incline>) {
        self.incline = incline;
    }

    /// Returns true if slopes bound the headings.
    #[must_use]
    pub(crate) const fn bounds_headings(&self) -> bool {
        self.incline.is_some()
    }

    /// Returns true if the robot stands on ground too steep to turn fully.
    #[must_use]
    pub(crate) fn is_steep(&self) -> bool {
        self.incline.as_ref().is_some_and(Incline::is_steep)
    }

    /// Replaces the obstacles by these points of the map, for a robot at `pose`. It is called from
    /// two places, so it is not inlined.
    #[inline(never)]
    pub(crate) fn see(&mut self, pose: &Pose, points: &[Point]) {
        let frame = RobotFrame::of(pose);
        self.threats.clear();
        for &point in points {
            let at = frame.to_robot(point);
            let clearance_m = self.hull.overhang(at.x_m, at.y_m);
            if clearance_m > -FALSE_ECHO_M {
                // There is room for all points.
                let _ = self.threats.push(Threat { at, clearance_m });
            }
        }
    }

    /// Adds points on the hull of another robot, which may drive on or stands.
    pub(crate) fn keep_off_hull(
        &mut self,
        pose: &Pose,
        points: impl Iterator<Item = Point>,
        may_move: bool,
    ) {
        self.has_robots = true;
        self.has_company |= may_move;
        let frame = RobotFrame::of(pose);
        for at in points.map(|point| frame.to_robot(point)) {
            let clearance_m = self.hull.overhang(at.x_m, at.y_m);
            if clearance_m > -FALSE_ECHO_M {
                // Points beyond the capacity are dropped: those of the other robots remain.
                let _ = self.threats.push(Threat { at, clearance_m });
            }
        }
    }

    /// Adds forbidden cells (their centres), each inflated by half a cell. A robot that a
    /// correction of its pose put over one may leave it, and come no deeper. In a full list they
    /// take the place of what is farthest off.
    pub(crate) fn fence_off(&mut self, pose: &Pose, fence: &Fence, reach: i32) {
        let frame = RobotFrame::of(pose);
        fence.for_each_rim(pose.point().cell(), reach, |cell| {
            let at = inflated(frame.to_robot(cell.centre()), 0.0);
            let clearance_m = self.hull.overhang(at.x_m, at.y_m);
            let threat = Threat { at, clearance_m };
            if self.threats.push(threat).is_ok() {
                return;
            }
            let farther =
                |a: &&mut Threat, b: &&mut Threat| a.clearance_m.total_cmp(&b.clearance_m);
            let farthest = self.threats.iter_mut().max_by(farther);
            if let Some(farthest) = farthest.filter(|it| it.clearance_m > clearance_m) {
                *farthest = threat;
            }
        });
    }

    /// Adds the obstacle cells of the map (their centres) that are out of view and have no obstacle
    /// point, each inflated by half a cell.
    pub(crate) fn remember(&mut self, pose: &Pose, cells: impl Iterator<Item = Point>) {
        let frame = RobotFrame::of(pose);
        let seen = self.threats.len();
        for at in cells.map(|cell| frame.to_robot(cell)) {
            let edge = inflated(at, 0.0);
            let clearance_m = self.hull.overhang(edge.x_m, edge.y_m);
            let near = |threat: &Threat| threat.at.distance2(at) < KNOWN_M * KNOWN_M;
            let points = self.threats.get(..seen).unwrap_or_default();
            if at.x_m < IN_VIEW_M && clearance_m > 0.0 && !points.iter().any(near) {
                // Cells beyond the capacity are dropped: others behind the robot remain.
                let _ = self.threats.push(Threat {
                    at: edge,
                    clearance_m,
                });
            }
        }
    }

    /// Replaces the obstacles by cells of the map (their centres), each inflated by half a cell
    /// plus its own margin in metres. The hull is that of the tilted robot.
    pub fn keep_off(&mut self, pose: &Pose, cells: impl Iterator<Item = (Point, f32)>) {
        let frame = RobotFrame::of(pose);
        self.hull = Hull::leaning(&self.robot, pose);
        self.threats.clear();
        for (cell, margin_m) in cells {
            let at = inflated(frame.to_robot(cell), margin_m);
            let clearance_m = self.hull.overhang(at.x_m, at.y_m);
            if clearance_m > 0.0 {
                // Cells beyond the capacity are dropped: others around the robot remain.
                let _ = self.threats.push(Threat { at, clearance_m });
            }
        }
    }

    /// Returns the obstacle points.
    pub(crate) fn places_of_points(&self) -> impl Iterator<Item = Point> {
        self.threats.iter().map(|threat| threat.at)
    }

    /// Returns half the hull's width, metres.
    pub(crate) const fn half_width_m(&self) -> f32 {
        self.robot.half_width_m
    }

    /// Returns the number of obstacle points.
    #[must_use]
    pub(crate) fn points(&self) -> u32 {
        self.threats.len() as u32
    }

    /// Returns the distance of the nearest point from the hull, metres.
    #[cfg(test)]
    pub(crate) fn clearance_m(&self) -> f32 {
        self.threats
            .iter()
            .map(|threat| threat.clearance_m)
            .fold(f32::MAX, f32::min)
    }

    /// Returns true if the robot at this place keeps `margin_m` from every point and the side slope
    /// is within its limit.
    #[must_use]
    #[inline(never)]
    pub(crate) fn is_clear(&self, place: Place, margin_m: f32) -> bool {
        let (sin, cos) = math::sin_cos(place.yaw_rad);
        let stands = |incline: &Incline| incline.admits(place, (sin, cos));
        if !self.incline.as_ref().is_none_or(stands) {
            return false;
        }
        let reach2 = self.hull.reach2(margin_m);
        self.threats.iter().all(|threat| {
            let (dx, dy) = (threat.at.x_m - place.x_m, threat.at.y_m - place.y_m);
            if dx * dx + dy * dy > reach2 {
                return true;
            }
            let now = self.hull.overhang(dx * cos + dy * sin, dy * cos - dx * sin);
            let least = (threat.clearance_m - SLACK_M).max(LEAST_MARGIN_M.min(threat.clearance_m));
            now >= margin_m.min(least - ROUNDING_M)
        })
    }

    /// Returns true if there is room for every turn on the spot at a place.
    #[must_use]
    pub(crate) fn has_room_to_turn(&self, place: Place, margin_m: f32) -> bool {
        let reach_m = self.robot.half_diagonal_m + margin_m;
        let is_off = |threat: &Threat| threat.at.distance2(place.point()) >= reach_m * reach_m;
        self.threats.iter().all(is_off)
    }

    /// Returns the number of places checked on an arc.
    #[must_use]
    pub(crate) fn places_on(&self, length_m: f32, turn_rad: f32, margin_m: f32) -> u32 {
        math::floor(self.moved_m(length_m, turn_rad) / spacing_m(margin_m)) as u32 + 1
    }

    /// Returns the way on an arc of the part of the robot that moves most, at most, metres.
    fn moved_m(&self, length_m: f32, turn_rad: f32) -> f32 {
        length_m.abs() + turn_rad.abs() * self.robot.half_diagonal_m
    }

    /// Returns true if an arc of `length_m` from a place, with a turn of `turn_rad`, is clear.
    #[must_use]
    pub(crate) fn is_arc_clear(
        &self,
        from: Place,
        length_m: f32,
        turn_rad: f32,
        margin_m: f32,
    ) -> bool {
        let parts = self.places_on(length_m, turn_rad, margin_m);
        let (length, turn) = (length_m / parts as f32, turn_rad / parts as f32);
        let mut place = from;
        (0..parts).all(|_| {
            place = place.after(length, turn);
            self.is_clear(place, margin_m)
        })
    }

    /// Returns true if the robot can follow `twist` for one period and then brake to a stop, from
    /// the velocity `now` and within its acceleration limits, and keeps `margin_m` all the time.
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
            let braking = left_s <= ZERO;
            let wanted = if braking { Twist::default() } else { twist };
            left_s -= TICK_S;
            let v_next = towards(v, wanted.linear_mps, most_v);
            let w_next = towards(w, wanted.angular_radps, most_w);
            let (length, turn) = (0.5 * (v + v_next) * TICK_S, 0.5 * (w + w_next) * TICK_S);
            place = place.after(length, turn);
            (v, w) = (v_next, w_next);
            let moved_m = self.moved_m(length, turn);
            since_m += moved_m;
            let stopped = left_s <= ZERO && v.abs() < ZERO && w.abs() < ZERO;
            // The next tick moves the robot by about as much.
            if stopped || since_m + moved_m > spacing_m(margin_m) {
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
mod tests;
