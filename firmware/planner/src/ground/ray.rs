//! A laser beam in three dimensions, from the tilted robot.
//!
//! ```text
//! body:   (cos b cos t, sin b, −cos b sin t)        b bearing, t tilt of the mount
//! world:  R_z(yaw) R_y(pitch) R_x(roll) · body      positive pitch is nose down
//! ```
//!
//! Positions along a beam are lengths over ground, s: the beam has the height `from.z + slope · s`.
//! Units: metres, radians; slopes are tangents.

use crate::geometry::{Cell, Point, Pose};
use crate::math;
use crate::robot::LaserMount;

/// Least cosine between the robot's up axis and the vertical: 84°. A steeper robot has no plane.
const MIN_UPRIGHT: f32 = 0.1;
/// Least cosine between a beam and the horizontal: 87°. A steeper beam has no direction.
const MIN_HORIZONTAL: f32 = 0.05;

/// The robot's attitude: its forward, left and up axes in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attitude {
    axes: [[f32; 3]; 3],
    pose: Pose,
}

/// One beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ray {
    /// Its start: the laser's position.
    pub(crate) from: Point,
    /// Height of the start, metres.
    pub(crate) from_z_m: f32,
    /// Its direction over ground, a unit vector.
    pub(crate) along: (f32, f32),
    /// Height gained for each metre over ground.
    pub(crate) slope: f32,
    /// Length over ground, metres.
    pub(crate) length_m: f32,
}

impl Ray {
    /// Returns the point over ground at length `s_m`.
    pub(crate) fn at(&self, s_m: f32) -> Point {
        Point {
            x_m: self.from.x_m + self.along.0 * s_m,
            y_m: self.from.y_m + self.along.1 * s_m,
        }
    }

    /// Returns the beam's height at length `s_m`, metres.
    pub(crate) fn height_m(&self, s_m: f32) -> f32 {
        self.from_z_m + self.slope * s_m
    }

    /// Returns the point over ground where the beam ends.
    pub(crate) fn end(&self) -> Point {
        self.at(self.length_m)
    }

    /// Returns the cell of what the beam hit, `depth_m` behind its end.
    pub(crate) fn hit_cell(&self, depth_m: f32) -> Cell {
        self.at(self.length_m + depth_m).cell()
    }
}

impl Attitude {
    /// The attitude of a robot at a pose.
    pub(crate) fn of(pose: &Pose) -> Self {
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

    /// Turns a vector of the robot's frame into the world's.
    fn to_world(self, body: [f32; 3]) -> [f32; 3] {
        let [forward, left, up] = &self.axes;
        let [x, y, z] = body;
        [
            forward[0] * x + left[0] * y + up[0] * z,
            forward[1] * x + left[1] * y + up[1] * z,
            forward[2] * x + left[2] * y + up[2] * z,
        ]
    }

    /// Returns the height of the robot's plane (the ground under its wheels) at a point, metres.
    pub(crate) fn plane_m(&self, point: Point) -> f32 {
        let (dx, dy) = (point.x_m - self.pose.x_m, point.y_m - self.pose.y_m);
        self.pose.z_m + self.rise(dx, dy)
    }

    /// Returns the rise of the robot's plane over a distance along x and y, metres; 0 if the plane
    /// is steeper than 84°.
    pub(crate) fn rise(&self, dx_m: f32, dy_m: f32) -> f32 {
        let [_, _, up] = &self.axes;
        if up[2] > MIN_UPRIGHT {
            -(up[0] * dx_m + up[1] * dy_m) / up[2]
        } else {
            0.0
        }
    }

    /// Returns beam `number` of a laser with a length of `range_m`; `None` if it runs steeper than
    /// 87°.
    pub(crate) fn ray(&self, mount: &Mount<'_>, number: usize, range_m: f32) -> Option<Ray> {
        let laser = mount.laser;
        let bearing = laser.first_bearing_rad + number as f32 * laser.bearing_step_rad;
        let (sin, cos) = math::sin_cos(bearing);
        let [dx, dy, dz] = self.to_world([cos * mount.cos_tilt, sin, -cos * mount.sin_tilt]);
        let across = math::sqrt(dx * dx + dy * dy);
        (across > MIN_HORIZONTAL).then(|| Ray {
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
pub(crate) struct Mount<'a> {
    laser: &'a LaserMount,
    /// From the robot's position to the laser's, in the world's axes, metres.
    offset: [f32; 3],
    sin_tilt: f32,
    cos_tilt: f32,
}

impl<'a> Mount<'a> {
    /// A laser on a robot in this attitude.
    pub(crate) fn new(attitude: &Attitude, laser: &'a LaserMount) -> Self {
        let (sin_tilt, cos_tilt) = math::sin_cos(laser.pitch_rad);
        Self {
            laser,
            offset: attitude.to_world([laser.x_m, laser.y_m, laser.z_m]),
            sin_tilt,
            cos_tilt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Attitude, Mount};
    use crate::geometry::{Point, Pose};
    use crate::robot::LaserMount;

    /// The laser of these tests, which looks down by `pitch_rad`.
    const fn laser(pitch_rad: f32) -> LaserMount {
        LaserMount::tilted(0.15, 0.45, pitch_rad)
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
        let end = ray.end();
        assert!(
            (end.x_m - 1.3864).abs() < 1e-3 && end.y_m.abs() < 1e-4,
            "{end:?}"
        );
    }

    /// On a slope the robot's plane is the slope. A level beam runs along it at every heading.
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
                let (near, far) = (ray.at(0.1), ray.end());
                let near_m = over(near, ray.height_m(0.1));
                let far_m = over(far, ray.height_m(ray.length_m));
                assert!((near_m - far_m).abs() < 1e-4, "{near_m} {far_m}");
                // Measured along the vertical, the distance from a tilted plane is longer.
                assert!(near_m > 0.449 && near_m < 0.49, "{near_m}");
            }
        }
    }

    #[test]
    fn pitch_up_raises_the_front_and_positive_roll_raises_the_left() {
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
