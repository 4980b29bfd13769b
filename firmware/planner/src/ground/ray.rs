//! A beam in three dimensions, from the robot as it stands.
//!
//! ```text
//! body:   (cos b cos t, sin b, −cos b sin t)        b bearing, t tilt of the mount
//! world:  R_z(yaw) R_y(pitch) R_x(roll) · body      positive pitch is nose down
//! ```
//!
//! Along a beam everything counts by its length over ground, s: it runs at `from.z + slope · s`. Units: metres, radians.

use crate::geometry::{Point, Pose};
use crate::math;
use crate::robot::LaserMount;

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
    laser: &'a LaserMount,
    /// From the robot's place to the laser's, in the world.
    offset: [f32; 3],
    sin_tilt: f32,
    cos_tilt: f32,
}

impl<'a> Mount<'a> {
    /// A laser on a robot in this attitude.
    #[must_use]
    pub fn new(attitude: &Attitude, laser: &'a LaserMount) -> Self {
        let (sin_tilt, cos_tilt) = math::sin_cos(laser.pitch_rad);
        Self {
            laser,
            offset: attitude.turn([laser.x_m, laser.y_m, laser.z_m]),
            sin_tilt,
            cos_tilt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Attitude, Mount};
    use crate::geometry::{Point, Pose};
    use crate::math;
    use crate::robot::LaserMount;

    fn laser(pitch_rad: f32) -> LaserMount {
        LaserMount {
            x_m: 0.15,
            y_m: 0.0,
            z_m: 0.45,
            pitch_rad,
            first_bearing_rad: -0.5 * math::PI,
            bearing_step_rad: math::PI / 180.0,
            beams: 181,
            range_limit_mm: 12_000,
        }
    }

    #[test]
    fn a_tilted_beam_meets_level_ground_where_trigonometry_says() {
        let attitude = Attitude::of(&Pose::default());
        let laser = laser(20.0_f32.to_radians());
        let mount = Mount::new(&attitude, &laser);
        let range_m = 0.45 / 20.0_f32.to_radians().sin();
        let ray = attitude.ray(&mount, 90, range_m).expect("it goes ahead");
        assert!((ray.length_m - 0.45 / 20.0_f32.to_radians().tan()).abs() < 1e-4);
        assert!(ray.height_m(ray.length_m).abs() < 1e-4);
        let end = ray.at(ray.length_m);
        assert!(
            (end.x_m - 1.3864).abs() < 1e-3 && end.y_m.abs() < 1e-4,
            "{end:?}"
        );
    }

    /// On a slope the plane under the robot is the slope, and a level beam runs along it, whichever way the robot faces.
    #[test]
    fn level_beams_keep_their_height_over_the_robots_plane() {
        for (pitch_rad, roll_rad, yaw_rad) in [
            (-0.3, 0.0, 0.0),
            (0.2, 0.1, 1.0),
            (0.0, -0.25, -2.5),
            (0.1, 0.2, 3.0),
        ] {
            let pose = Pose {
                x_m: 3.0,
                y_m: -2.0,
                z_m: 1.5,
                roll_rad,
                pitch_rad,
                yaw_rad,
            };
            let attitude = Attitude::of(&pose);
            let laser = laser(0.0);
            let mount = Mount::new(&attitude, &laser);
            let over = |point: Point, z_m: f32| z_m - attitude.plane_m(point);
            for number in [0, 45, 90, 120, 180] {
                let ray = attitude.ray(&mount, number, 2.0).expect("no cliff face");
                let (near, far) = (ray.at(0.1), ray.at(ray.length_m));
                let near_m = over(near, ray.height_m(0.1));
                let far_m = over(far, ray.height_m(ray.length_m));
                assert!((near_m - far_m).abs() < 1e-4, "{near_m} {far_m}");
                // Measured upright the distance from a tilted plane is longer.
                assert!(near_m > 0.449 && near_m < 0.49, "{near_m}");
            }
        }
    }

    #[test]
    fn nose_up_looks_farther_and_the_left_wheel_up_lifts_the_left() {
        let at = |pitch_rad, roll_rad| {
            Attitude::of(&Pose {
                pitch_rad,
                roll_rad,
                ..Pose::default()
            })
        };
        assert!(at(-0.2, 0.0).rise(1.0, 0.0) > 0.2);
        assert!(at(0.0, 0.2).rise(0.0, 1.0) > 0.2);
        let laser = laser(0.35);
        let slope = |attitude: Attitude| {
            let mount = Mount::new(&attitude, &laser);
            attitude.ray(&mount, 90, 1.0).expect("ahead").slope
        };
        assert!(slope(at(-0.2, 0.0)) > slope(at(0.0, 0.0)));
    }
}
