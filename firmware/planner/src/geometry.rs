//! Points, poses, cells, and the only conversions between them.
//!
//! ```text
//! cell (i, j) covers [i, i + 1) × [j, j + 1) · CELL_M in the odometry frame
//! ```
//!
//! Units: metres and radians; x east, y north, angles counter-clockwise from x. The robot's frame
//! has x forward and y left.

use crate::math;

/// Side of a map cell, metres \[Maffei20, Table I\].
pub const CELL_M: f32 = 0.1;

/// A planar point, metres.
///
/// ```
/// use fieldline_planner::{CELL_M, Cell, Point};
///
/// let cell = Point { x_m: 1.23, y_m: -0.04 }.cell();
/// assert_eq!(cell, Cell { x: 12, y: -1 });
/// assert_eq!(cell.corner().x_m, 12.0 * CELL_M);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Metres east, or forward in the robot's frame.
    pub x_m: f32,
    /// Metres north, or left in the robot's frame.
    pub y_m: f32,
}

/// A pose of the robot: in the odometry frame, or in the map's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Metres east of the start.
    pub x_m: f32,
    /// Metres north of the start.
    pub y_m: f32,
    /// Metres above the start.
    pub z_m: f32,
    /// Radians about the forward axis.
    pub roll_rad: f32,
    /// Radians about the left axis; positive is nose down.
    pub pitch_rad: f32,
    /// Radians about the up axis.
    pub yaw_rad: f32,
}

/// A pose in the odometry frame. It moves smoothly and drifts: what protects the hull lies there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OdomPose(pub Pose);

/// A pose in the map's frame. A correction may shift it: what is remembered lies there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapPose(pub Pose);

/// The motion that takes the odometry frame to the map's: a turn, then a shift.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapFromOdom {
    /// Metres east.
    pub x_m: f32,
    /// Metres north.
    pub y_m: f32,
    /// Radians, counter-clockwise.
    pub yaw_rad: f32,
}

/// A planar velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Metres per second, forward.
    pub linear_mps: f32,
    /// Radians per second, counter-clockwise.
    pub angular_radps: f32,
}

/// A cell of the map, by column and row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Column of the cell; grows with x.
    pub x: i32,
    /// Row of the cell; grows with y.
    pub y: i32,
}

impl Point {
    /// Returns the map cell that holds this point.
    #[inline(never)]
    #[must_use]
    pub fn cell(self) -> Cell {
        Cell {
            x: math::floor(self.x_m / CELL_M),
            y: math::floor(self.y_m / CELL_M),
        }
    }

    /// Returns the squared distance to another point, square metres.
    #[must_use]
    pub fn distance2(self, other: Self) -> f32 {
        let (dx, dy) = (self.x_m - other.x_m, self.y_m - other.y_m);
        dx * dx + dy * dy
    }

    /// Returns the distance to another point, metres.
    #[must_use]
    pub fn distance_m(self, other: Self) -> f32 {
        math::sqrt(self.distance2(other))
    }

    /// Returns the squared distance to a straight line between two points, square metres.
    #[must_use]
    pub(crate) fn to_line2(self, from: Self, to: Self) -> f32 {
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        let length2 = dx * dx + dy * dy;
        let along = (self.x_m - from.x_m) * dx + (self.y_m - from.y_m) * dy;
        let part = if length2 > 0.0 {
            (along / length2).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let foot = Self {
            x_m: from.x_m + part * dx,
            y_m: from.y_m + part * dy,
        };
        foot.distance2(self)
    }
}

impl Pose {
    /// Returns the position in the plane.
    #[must_use]
    pub fn point(&self) -> Point {
        Point {
            x_m: self.x_m,
            y_m: self.y_m,
        }
    }

    /// Converts a point of the robot's frame to the odometry frame.
    #[must_use]
    pub fn to_map(&self, local: Point) -> Point {
        RobotFrame::of(self).to_map(local)
    }

    /// Converts a point of the odometry frame to the robot's frame.
    #[must_use]
    pub fn to_robot(&self, point: Point) -> Point {
        RobotFrame::of(self).to_robot(point)
    }
}

impl Point {
    /// Where a frame begins.
    pub(crate) const ORIGIN: Self = Self { x_m: 0.0, y_m: 0.0 };
}

impl Pose {
    /// Where a frame begins, upright.
    pub(crate) const ORIGIN: Self = Self {
        x_m: 0.0,
        y_m: 0.0,
        z_m: 0.0,
        roll_rad: 0.0,
        pitch_rad: 0.0,
        yaw_rad: 0.0,
    };
}

impl Twist {
    /// No motion.
    pub(crate) const STILL: Self = Self {
        linear_mps: 0.0,
        angular_radps: 0.0,
    };
}

impl MapFromOdom {
    /// No motion.
    pub(crate) const IDENTITY: Self = Self {
        x_m: 0.0,
        y_m: 0.0,
        yaw_rad: 0.0,
    };

    /// Returns the motion of an odometry whose origin has this pose in the map.
    pub(crate) const fn of(origin: &Pose) -> Self {
        Self {
            x_m: origin.x_m,
            y_m: origin.y_m,
            yaw_rad: origin.yaw_rad,
        }
    }

    /// Returns the motion that takes one pose to the other.
    #[inline(never)]
    #[must_use]
    pub fn between(odom: &OdomPose, map: &MapPose) -> Self {
        let yaw_rad = math::wrap(map.0.yaw_rad - odom.0.yaw_rad);
        let turn = Self {
            yaw_rad,
            ..Self::default()
        };
        let Point { x_m, y_m } = turn.apply(odom).0.point();
        Self {
            x_m: map.0.x_m - x_m,
            y_m: map.0.y_m - y_m,
            yaw_rad,
        }
    }

    /// Returns the motion back.
    #[must_use]
    pub(crate) fn inverse(&self) -> Self {
        let turn = Self {
            yaw_rad: -self.yaw_rad,
            ..Self::IDENTITY
        };
        let Point { x_m, y_m } = turn.point(Point {
            x_m: self.x_m,
            y_m: self.y_m,
        });
        Self {
            x_m: -x_m,
            y_m: -y_m,
            ..turn
        }
    }

    /// Returns the motion that makes `first` and then this one.
    #[must_use]
    pub(crate) fn after(&self, first: &Self) -> Self {
        let MapPose(origin) = self.apply(&OdomPose(Pose {
            x_m: first.x_m,
            y_m: first.y_m,
            yaw_rad: first.yaw_rad,
            ..Pose::default()
        }));
        Self::of(&origin)
    }

    /// Returns where the motion takes a point.
    #[must_use]
    pub(crate) fn point(&self, Point { x_m, y_m }: Point) -> Point {
        let at = Pose {
            x_m,
            y_m,
            ..Pose::default()
        };
        self.apply(&OdomPose(at)).0.point()
    }

    /// Returns the pose in the map's frame. Height, roll and pitch stay.
    #[inline(never)]
    #[must_use]
    pub fn apply(&self, odom: &OdomPose) -> MapPose {
        let (sin, cos) = math::sin_cos(self.yaw_rad);
        let OdomPose(pose) = odom;
        MapPose(Pose {
            x_m: self.x_m + pose.x_m * cos - pose.y_m * sin,
            y_m: self.y_m + pose.x_m * sin + pose.y_m * cos,
            yaw_rad: math::wrap(self.yaw_rad + pose.yaw_rad),
            ..*pose
        })
    }
}

/// The robot's frame (x forward, y left) at a pose, for many points at the cost of one sine.
#[derive(Clone, Copy, Debug)]
pub struct RobotFrame {
    origin: Point,
    sin: f32,
    cos: f32,
}

impl RobotFrame {
    /// Returns the frame of a robot at `pose`.
    #[inline(never)]
    #[must_use]
    pub fn of(pose: &Pose) -> Self {
        let (sin, cos) = math::sin_cos(pose.yaw_rad);
        let origin = pose.point();
        Self { origin, sin, cos }
    }

    /// Returns a point of this frame as a point of the map.
    #[must_use]
    pub fn to_map(self, local: Point) -> Point {
        Point {
            x_m: self.origin.x_m + local.x_m * self.cos - local.y_m * self.sin,
            y_m: self.origin.y_m + local.x_m * self.sin + local.y_m * self.cos,
        }
    }

    /// Returns a point of the map as a point of this frame.
    #[must_use]
    pub fn to_robot(self, point: Point) -> Point {
        let (dx, dy) = (point.x_m - self.origin.x_m, point.y_m - self.origin.y_m);
        Point {
            x_m: dx * self.cos + dy * self.sin,
            y_m: dy * self.cos - dx * self.sin,
        }
    }
}

impl Cell {
    /// Returns the cell `dx` columns and `dy` rows away.
    #[inline(always)]
    #[must_use]
    pub const fn offset(self, dx: i32, dy: i32) -> Self {
        Self {
            x: self.x + dx,
            y: self.y + dy,
        }
    }

    /// Returns the corner of this cell with the least coordinates.
    #[must_use]
    pub fn corner(self) -> Point {
        Point {
            x_m: self.x as f32 * CELL_M,
            y_m: self.y as f32 * CELL_M,
        }
    }

    /// Returns the centre of this cell.
    #[must_use]
    pub fn centre(self) -> Point {
        Point {
            x_m: (self.x as f32 + 0.5) * CELL_M,
            y_m: (self.y as f32 + 0.5) * CELL_M,
        }
    }

    /// Returns the four map cells of the coarse cell (20 cm) whose least map cell this is.
    pub fn quarters(self) -> impl Iterator<Item = Self> {
        (0..4).map(move |k| self.offset(k & 1, k >> 1))
    }

    /// Returns the squared distance between the centres of two cells, square metres.
    #[must_use]
    pub fn distance2(self, other: Self) -> f32 {
        let dx = (self.x - other.x) as f32 * CELL_M;
        let dy = (self.y - other.y) as f32 * CELL_M;
        dx * dx + dy * dy
    }

    /// Returns the distance between the centres of two cells, metres.
    #[must_use]
    pub fn distance_m(self, other: Self) -> f32 {
        let (dx, dy) = ((self.x - other.x) as f32, (self.y - other.y) as f32);
        math::sqrt(dx * dx + dy * dy) * CELL_M
    }
}

#[cfg(test)]
mod tests;
