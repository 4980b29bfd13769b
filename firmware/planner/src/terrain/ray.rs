//! A beam in three dimensions, from the robot as it stands.
//!
//! ```text
//! body:   (cos b cos t, sin b, −cos b sin t)        b bearing, t tilt of the mount
//! world:  R_z(yaw) R_y(pitch) R_x(roll) · body      positive pitch is nose down
//! ```
//!
//! Along a beam everything counts by its length over ground, s: it runs at `from.z + slope · s`. Units: metres, radians.

use crate::config::Laser;
use crate::geometry::{Point, Pose};
use crate::math;

/// The robot's attitude: its forward, left and up axes in the world.
#[derive(Clone, Copy, Debug)]
pub struct Attitude {
    axes: [[f32; 3]; 3],
    pose: Pose,
}

/// One beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub from: Point,
    /// How high that is.
    pub from_z_m: f32,
    /// Unit vector over ground.
    pub along: (f32, f32),
    /// Height gained a metre over ground.
    pub slope: f32,
    /// Length over ground.
    pub length_m: f32,
}

impl Ray {
    /// The point over ground that far along.
    #[must_use]
    pub fn at(&self, s_m: f32) -> Point {
        Point {
            x_m: self.from.x_m + self.along.0 * s_m,
            y_m: self.from.y_m + self.along.1 * s_m,
        }
    }

    /// Its height there.
    #[must_use]
    pub fn height_m(&self, s_m: f32) -> f32 {
        self.from_z_m + self.slope * s_m
    }
}

impl Attitude {
    /// Of a robot at a pose.
    #[must_use]
    pub fn of(pose: &Pose) -> Self {
        let (sr, cr) = math::sin_cos(pose.roll_rad);
        let (sp, cp) = math::sin_cos(pose.pitch_rad);
        let (sy, cy) = math::sin_cos(pose.yaw_rad);
        Self {
            axes: [
                [cy * cp, sy * cp, -sp],
                [cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr],
                [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr],
            ],
            pose: *pose,
        }
    }

    fn turn(&self, body: [f32; 3]) -> [f32; 3] {
        let [forward, left, up] = &self.axes;
        let [x, y, z] = body;
        [
            forward[0] * x + left[0] * y + up[0] * z,
            forward[1] * x + left[1] * y + up[1] * z,
            forward[2] * x + left[2] * y + up[2] * z,
        ]
    }

    /// Height of the plane that the robot stands on, at a point; the robot's own height if it stands upright on a wall.
    #[must_use]
    pub fn plane_m(&self, point: Point) -> f32 {
        let (dx, dy) = (point.x_m - self.pose.x_m, point.y_m - self.pose.y_m);
        self.pose.z_m + self.rise(dx, dy)
    }

    /// How much that plane rises over a way.
    #[must_use]
    pub fn rise(&self, dx_m: f32, dy_m: f32) -> f32 {
        let [_, _, up] = &self.axes;
        if up[2] > 0.1 {
            -(up[0] * dx_m + up[1] * dy_m) / up[2]
        } else {
            0.0
        }
    }

    /// Beam `number` of a laser, `range_m` long; `None` for one that goes straight up or down.
    #[must_use]
    pub fn ray(&self, mount: &Mount<'_>, number: usize, range_m: f32) -> Option<Ray> {
        let laser = mount.laser;
        let bearing = laser.first_bearing_rad + number as f32 * laser.bearing_step_rad;
        let (sin, cos) = math::sin_cos(bearing);
        let [dx, dy, dz] = self.turn([cos * mount.cos_tilt, sin, -cos * mount.sin_tilt]);
        let across = math::sqrt(dx * dx + dy * dy);
        (across > 0.05).then(|| Ray {
            from: Point {
                x_m: self.pose.x_m + mount.offset[0],
                y_m: self.pose.y_m + mount.offset[1],
            },
            from_z_m: self.pose.z_m + mount.offset[2],
            along: (dx / across, dy / across),
            slope: dz / across,
            length_m: range_m * across,
        })
    }
}

/// A laser on the tilted robot.
#[derive(Clone, Copy, Debug)]
pub struct Mount<'a> {
    laser: &'a Laser,
    /// From the robot's place to the laser's, in the world.
    offset: [f32; 3],
    sin_tilt: f32,
    cos_tilt: f32,
}

impl<'a> Mount<'a> {
    /// A laser on a robot in this attitude.
    #[must_use]
    pub fn new(attitude: &Attitude, laser: &'a Laser) -> Self {
        let (sin_tilt, cos_tilt) = math::sin_cos(laser.pitch_rad);
        Self {
            laser,
            offset: attitude.turn([laser.x_m, laser.y_m, laser.z_m]),
            sin_tilt,
            cos_tilt,
        }
    }
}
