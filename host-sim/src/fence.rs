//! Bounds and no-go polygons of a run: as they are written, as the device is told them, and how far
//! the true hull went beyond them.
//!
//! ```text
//! depth of a point = its distance from the nearest side of a polygon on whose wrong side it lies
//! ```
//!
//! Units: metres in the world's frame. The simulated odometry begins at the true start pose, so
//! that is the frame of the device's map as well.

use fieldline_device::convert;
use fieldline_planner::planner::may_stand;
use fieldline_planner::{Config, LaserMount, Point, RobotShape, Tuning};
use fieldline_protocol::message::{self as wire, FENCE_CORNERS, FENCE_POLYGONS, FencePolygon};
use fixed::types::I16F16;

use crate::robot::{Footprint, Pose};
use crate::spec::{self, SpecError};

/// Spacing of the places in the hull that are looked at, metres.
const SPACING_M: f64 = 0.05;

/// A polygon: its corners, in either direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    corners: Vec<[f64; 2]>,
}

/// Bounds that the robot must not leave, and polygons that it must not enter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fence {
    /// The robot stays inside of each.
    pub bounds: Vec<Polygon>,
    /// The robot stays out of each.
    pub no_go: Vec<Polygon>,
}

impl Polygon {
    /// Returns the rectangle with this least corner and size.
    #[must_use]
    pub fn rectangle([x, y, width, height]: [f64; 4]) -> Self {
        let (right, top) = (x + width, y + height);
        Self {
            corners: vec![[x, y], [right, y], [right, top], [x, top]],
        }
    }

    /// Returns the polygon with these corners; two are those of a rectangle.
    ///
    /// # Errors
    /// A sentence with what to give.
    pub fn of(corners: &[[f64; 2]]) -> Result<Self, SpecError> {
        let is_finite = corners.as_flattened().iter().all(|it| it.is_finite());
        match corners {
            &[[x0, y0], [x1, y1]] if is_finite => {
                let (x, y) = (x0.min(x1), y0.min(y1));
                Ok(Self::rectangle([x, y, (x1 - x0).abs(), (y1 - y0).abs()]))
            }
            all if is_finite && all.len() >= 3 => Ok(Self {
                corners: all.to_vec(),
            }),
            _ => Err(SpecError::new(
                "give corners x0,y0,x1,y1,... in metres, or two corners of a rectangle",
            )),
        }
    }

    /// Returns the corners.
    #[must_use]
    pub fn corners(&self) -> &[[f64; 2]] {
        &self.corners
    }

    fn sides(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(a, b)| [*a, *b])
    }

    /// Returns true if a point lies inside.
    fn holds(&self, [x, y]: [f64; 2]) -> bool {
        let crossed = |side: &[[f64; 2]; 2]| {
            let [a, b] = side;
            let part = (y - a[1]) / (b[1] - a[1]);
            (a[1] > y) != (b[1] > y) && a[0] + part * (b[0] - a[0]) < x
        };
        self.sides().filter(crossed).count() % 2 == 1
    }

    /// Returns the distance of a point from the nearest side.
    fn side_m(&self, [x, y]: [f64; 2]) -> f64 {
        let distance = |[a, b]: [[f64; 2]; 2]| {
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let along = (x - a[0]) * dx + (y - a[1]) * dy;
            let part = (along / (dx * dx + dy * dy)).clamp(0.0, 1.0);
            (a[0] + part * dx - x).hypot(a[1] + part * dy - y)
        };
        self.sides().map(distance).fold(f64::INFINITY, f64::min)
    }
}

impl core::str::FromStr for Polygon {
    type Err = SpecError;

    /// Parses `x0,y0,x1,y1,…`; two corners are those of a rectangle.
    fn from_str(text: &str) -> Result<Self, SpecError> {
        match spec::numbers(text).as_deref().map(<[f64]>::as_chunks::<2>) {
            Some((corners, [])) => Self::of(corners),
            _ => Self::of(&[]),
        }
    }
}

impl core::fmt::Display for Polygon {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let numbers: Vec<String> = self
            .corners
            .as_flattened()
            .iter()
            .map(f64::to_string)
            .collect();
        f.write_str(&numbers.join(","))
    }
}

impl Fence {
    /// Returns true if the robot may be everywhere.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bounds.is_empty() && self.no_go.is_empty()
    }

    /// Returns all polygons, each with true for bounds.
    fn polygons(&self) -> impl Iterator<Item = (&Polygon, bool)> {
        let bounds = self.bounds.iter().map(|polygon| (polygon, true));
        bounds.chain(self.no_go.iter().map(|polygon| (polygon, false)))
    }

    /// Returns the fence as the device is told it. What does not fit is left out:
    /// [`Fence::check`] refuses it.
    #[must_use]
    pub fn message(&self) -> wire::Fence {
        let mut message = wire::Fence::default();
        for (polygon, bounds) in self.polygons() {
            let corners = polygon.corners.len() as u8;
            let _ = message.polygons.push(FencePolygon { corners, bounds });
            for corner in &polygon.corners {
                let [x, y] = corner.map(I16F16::saturating_from_num);
                let _ = message.corners.push((x, y));
            }
        }
        message
    }

    /// Checks that the device takes the fence.
    ///
    /// # Errors
    /// A sentence with the reason.
    pub fn check(&self) -> Result<(), String> {
        let corners: usize = self.polygons().map(|(it, _)| it.corners.len()).sum();
        let polygons = self.polygons().count();
        if corners > FENCE_CORNERS || polygons > FENCE_POLYGONS {
            return Err(format!(
                "the fence has {polygons} polygons with {corners} corners, and the device takes \
                 {FENCE_POLYGONS} with {FENCE_CORNERS}"
            ));
        }
        self.config(RobotShape::PIONEER_3AT).map(|_| ())
    }

    /// Checks that a robot may stand at a pose.
    ///
    /// # Errors
    /// A sentence with the reason.
    pub fn check_start(&self, hull: &Footprint, pose: &Pose) -> Result<(), String> {
        let [length, width] = [hull.half_length_m, hull.half_width_m].map(|it| 2.0 * it as f32);
        let config = self.config(RobotShape::rectangle(length, width, hull.height_m as f32))?;
        if may_stand(&config, &convert::pose(&pose.to_wire())) {
            return Ok(());
        }
        Err(format!(
            "a part of the robot at its start ({:.2}, {:.2}) lies out of the bounds or in a no-go \
             polygon",
            pose.x_m, pose.y_m
        ))
    }

    fn config(&self, shape: RobotShape) -> Result<Config, String> {
        let mut fence = fieldline_planner::Fence::new();
        for (polygon, is_bounds) in self.polygons() {
            let point = |&[x, y]: &[f64; 2]| Point {
                x_m: x as f32,
                y_m: y as f32,
            };
            let corners: Vec<Point> = polygon.corners.iter().map(point).collect();
            fence = if is_bounds {
                fence.bounds(&corners)
            } else {
                fence.no_go(&corners)
            };
        }
        Config::builder(shape)
            .tuning(&Tuning::DEFAULT)
            .laser(LaserMount::level(0.1, 0.4))
            .fence(fence)
            .build()
            .map_err(|error| error.to_string())
    }

    /// Returns how deep a point lies in what is forbidden; 0 where the robot may be.
    #[must_use]
    pub fn depth_m(&self, at: [f64; 2]) -> f64 {
        let wrong = self
            .polygons()
            .filter(|(polygon, is_bounds)| polygon.holds(at) != *is_bounds);
        wrong
            .map(|(polygon, _)| polygon.side_m(at))
            .fold(0.0, f64::max)
    }

    /// Returns how deep the hull of a robot lies in what is forbidden.
    #[must_use]
    pub fn hull_depth_m(&self, hull: &Footprint, pose: &Pose) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let parts = |half_m: f64| (2.0 * half_m / SPACING_M).ceil() as i32;
        let at =
            |k: i32, half_m: f64| half_m * (2.0 * f64::from(k) / f64::from(parts(half_m)) - 1.0);
        let (half_length, half_width) = (hull.half_length_m, hull.half_width_m);
        let (sin, cos) = pose.yaw_rad.sin_cos();
        let mut deepest_m: f64 = 0.0;
        for i in 0..=parts(half_length) {
            for j in 0..=parts(half_width) {
                let (x, y) = (at(i, half_length), at(j, half_width));
                if hull.is_round && x.hypot(y) > half_length {
                    continue;
                }
                let at = [pose.x_m + x * cos - y * sin, pose.y_m + x * sin + y * cos];
                deepest_m = deepest_m.max(self.depth_m(at));
            }
        }
        deepest_m
    }
}

#[cfg(test)]
mod tests {
    use super::{Fence, Polygon};
    use crate::robot::{Footprint, Pose};

    fn polygon(text: &str) -> Polygon {
        text.parse().expect("a polygon")
    }

    #[test]
    fn two_corners_are_a_rectangle() {
        let square = polygon("6,0,0,3.5");
        assert_eq!(square, polygon("0,0,6,0,6,3.5,0,3.5"));
        assert_eq!(square.to_string(), "0,0,6,0,6,3.5,0,3.5");
        for bad in [
            "",
            "1,2",
            "1,2,3",
            "1,2,3,4,5",
            "a,b,c,d",
            "0,0,nan,1",
            "0,0,inf,1",
        ] {
            assert!(bad.parse::<Polygon>().is_err(), "{bad}");
        }
    }

    #[test]
    fn a_fence_that_the_device_refuses_is_refused_with_the_reason() {
        let fence = |text: &str| Fence {
            no_go: vec![polygon(text)],
            ..Fence::default()
        };
        assert_eq!(fence("0,0,1,1").check(), Ok(()));
        let bow = fence("0,0,1,1,1,0,0,1").check().unwrap_err();
        assert!(bow.contains("crossings"), "{bow}");
        assert!(fence("0,0,0,1").check().unwrap_err().contains("area"));
        assert!(fence("0,0,9999,1").check().unwrap_err().contains("corner"));
        let many = Fence {
            no_go: vec![polygon("0,0,1,1"); 9],
            ..Fence::default()
        };
        assert!(many.check().unwrap_err().contains("36 corners"));
    }

    #[test]
    fn the_depth_of_the_hull_is_that_of_its_deepest_place() {
        let fence = Fence {
            bounds: vec![polygon("0,0,4,4")],
            no_go: vec![polygon("2,2,2.2,2.2")],
        };
        let hull = Footprint::rectangle(0.5, 0.5, 0.3);
        let depth = |x_m, y_m| {
            let pose = Pose {
                x_m,
                y_m,
                ..Pose::default()
            };
            fence.hull_depth_m(&hull, &pose)
        };
        assert!(depth(1.0, 1.0) < 1e-9 && depth(0.25, 0.25) < 1e-9);
        assert!((depth(0.1, 1.0) - 0.15).abs() < 1e-9);
        assert!(
            (depth(2.1, 2.1) - 0.1).abs() < 1e-9,
            "a polygon under the hull"
        );
        let start = |x_m, y_m| {
            let pose = Pose {
                x_m,
                y_m,
                ..Pose::default()
            };
            fence.check_start(&hull, &pose)
        };
        assert_eq!(start(1.0, 1.0), Ok(()));
        assert!(start(0.1, 1.0).is_err() && start(2.1, 2.1).is_err());
    }
}
