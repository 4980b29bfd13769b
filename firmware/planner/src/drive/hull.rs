//! The robot's hull and its places: where the rectangle is after a motion, and how far a point is
//! from it.
//!
//! ```text
//! overhang = max(|x| − front or back, |y| − left or right)        of a point in the robot's frame
//! ```
//!
//! On a slope the top of the hull reaches out over the ground downhill, by its height times the
//! sine of the tilt.
//!
//! Invariant: the overhang of a point outside is at most its distance from the rectangle, so a
//! margin of the overhang is a margin of the distance.
//!
//! Units: metres, radians; robot frame, x forward.

use crate::geometry::{Point, Pose};
use crate::math;
use crate::robot::RobotShape;

/// A place of the robot relative to its present pose.
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
    /// Returns the position in the robot's frame.
    #[must_use]
    pub const fn point(self) -> Point {
        Point {
            x_m: self.x_m,
            y_m: self.y_m,
        }
    }

    /// Returns the place after an arc of `length_m` (negative is backwards) that turns by
    /// `turn_rad`.
    #[must_use]
    pub(crate) fn after(self, length_m: f32, turn_rad: f32) -> Self {
        let (sin, cos) = math::sin_cos(self.yaw_rad + 0.5 * turn_rad);
        Self {
            x_m: self.x_m + length_m * cos,
            y_m: self.y_m + length_m * sin,
            yaw_rad: self.yaw_rad + turn_rad,
        }
    }
}

/// The robot's outline seen from above, metres from its centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull {
    front: f32,
    back: f32,
    left: f32,
    right: f32,
}

impl Hull {
    /// Returns the hull on level ground.
    pub(super) const fn level(robot: &RobotShape) -> Self {
        Self {
            front: robot.half_length_m,
            back: robot.half_length_m,
            left: robot.half_width_m,
            right: robot.half_width_m,
        }
    }

    /// Returns the hull of a tilted robot: its top reaches out over the ground downhill.
    pub(super) fn leaning(robot: &RobotShape, pose: &Pose) -> Self {
        let reach = |angle: f32| robot.height_m * math::sin_cos(angle).0;
        let (nose, right) = (reach(pose.pitch_rad), reach(pose.roll_rad));
        Self {
            front: robot.half_length_m + nose.max(0.0),
            back: robot.half_length_m + (-nose).max(0.0),
            left: robot.half_width_m + (-right).max(0.0),
            right: robot.half_width_m + right.max(0.0),
        }
    }

    /// Returns the squared distance from the robot's centre beyond which no point is nearer to the
    /// hull than a margin: that of the farthest corner of the hull grown by it, square metres.
    pub(super) fn reach2(&self, margin_m: f32) -> f32 {
        let along = self.front.max(self.back) + margin_m;
        let across = self.left.max(self.right) + margin_m;
        along * along + across * across
    }

    /// Returns the distance of a point by the larger overhang; negative inside.
    pub(super) fn overhang(&self, x_m: f32, y_m: f32) -> f32 {
        let along = x_m.abs() - if x_m < 0.0 { self.back } else { self.front };
        let across = y_m.abs() - if y_m < 0.0 { self.right } else { self.left };
        if along > across { along } else { across }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_after_a_quarter_circle() {
        let mut place = Place::default();
        for _ in 0..90 {
            place = place.after(math::PI / 180.0, math::PI / 180.0);
        }
        assert!((place.x_m - 1.0).abs() < 1e-3 && (place.y_m - 1.0).abs() < 1e-3);
    }

    /// Points on circles about the robot: beyond the reach none is nearer than the margin, and just
    /// within it some are.
    #[test]
    fn no_point_beyond_the_reach_is_nearer_than_the_margin() {
        let pose = Pose {
            pitch_rad: 0.2,
            roll_rad: -0.1,
            ..Pose::default()
        };
        let hull = Hull::leaning(&RobotShape::PIONEER_3AT, &pose);
        for margin_m in [0.0, 0.02, 0.06] {
            let nearest = |part: f32| {
                let reach_m = part * math::sqrt(hull.reach2(margin_m));
                let overhang = |k: i32| {
                    let (sin, cos) = math::sin_cos(0.001 * k as f32);
                    hull.overhang(reach_m * cos, reach_m * sin)
                };
                (0..6283).map(overhang).fold(f32::MAX, f32::min)
            };
            assert!(nearest(1.001) >= margin_m, "{margin_m}");
            assert!(nearest(0.99) < margin_m, "{margin_m}");
        }
    }

    #[test]
    fn a_tilted_hull_reaches_out_downhill() {
        let robot = RobotShape::PIONEER_3AT;
        let nose_down = Pose {
            pitch_rad: 0.2,
            ..Pose::default()
        };
        let (level, leaning) = (Hull::level(&robot), Hull::leaning(&robot, &nose_down));
        let ahead = |hull: &Hull| hull.overhang(1.0, 0.0);
        let behind = |hull: &Hull| hull.overhang(-1.0, 0.0);
        let reach_m = robot.height_m * math::sin_cos(0.2).0;
        assert!((ahead(&level) - ahead(&leaning) - reach_m).abs() < 1e-6);
        assert_eq!(behind(&level).to_bits(), behind(&leaning).to_bits());
    }
}
