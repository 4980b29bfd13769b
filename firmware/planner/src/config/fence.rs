//! The checks of a fence: few corners, within the map's range, each polygon with an area and
//! without crossings.
//!
//! Units: metres.

use crate::config::builder::{ANY, check};
use crate::config::{ConfigError, Parameter};
use crate::fence::Fence;
use crate::geometry::Point;

/// Greatest coordinate of a corner, metres: as for an area.
const CORNER_M: f32 = 3_200.0;
/// Least area of a polygon, square metres. A smaller one is a slip of the pen.
const LEAST_M2: f32 = 1e-3;

/// Returns an error if a fence is none.
pub(super) fn check_fence(fence: &Fence) -> Result<(), ConfigError> {
    let most = Fence::MOST_CORNERS as f32;
    if fence.left_out() {
        check(Parameter::FenceCorners, most + 1.0, (3.0, most))?;
    }
    for (corners, _) in fence.polygons() {
        check(Parameter::FenceCorners, corners.len() as f32, (3.0, most))?;
        for corner in corners {
            for at in [corner.x_m, corner.y_m] {
                check(Parameter::FenceCorner, at, (-CORNER_M, CORNER_M))?;
            }
        }
        check(Parameter::FenceCrossings, crossings(corners), (0.0, 0.0))?;
        check(
            Parameter::FenceArea,
            area_m2(corners),
            (LEAST_M2, ANY * ANY),
        )?;
    }
    Ok(())
}

/// Returns the sides of a polygon.
fn sides(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> + Clone + '_ {
    let next = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(next.copied())
}

/// Returns twice the area of a triangle, positive if its corners turn to the left.
fn turn(a: Point, b: Point, c: Point) -> f32 {
    (b.x_m - a.x_m) * (c.y_m - a.y_m) - (b.y_m - a.y_m) * (c.x_m - a.x_m)
}

/// Returns the area of a polygon, by the triangles on its first corner.
fn area_m2(corners: &[Point]) -> f32 {
    let Some(&first) = corners.first() else {
        return 0.0;
    };
    let doubled: f32 = sides(corners).map(|(a, b)| turn(first, a, b)).sum();
    0.5 * doubled.max(-doubled)
}

/// Returns the number of pairs of sides that cross. Sides that only touch do not.
fn crossings(corners: &[Point]) -> f32 {
    let mut count = 0;
    for (k, (a, b)) in sides(corners).enumerate() {
        for (c, d) in sides(corners).skip(k + 1) {
            let part = |from, to, one, other| turn(from, to, one) * turn(from, to, other) < 0.0;
            count += u16::from(part(a, b, c, d) && part(c, d, a, b));
        }
    }
    f32::from(count)
}

#[cfg(test)]
mod tests {
    use crate::config::{Config, Parameter};
    use crate::fence::Fence;
    use crate::geometry::Point;
    use crate::robot::{LaserMount, RobotShape};

    fn refused(corners: &[(f32, f32)]) -> Option<Parameter> {
        let corners: std::vec::Vec<Point> = corners
            .iter()
            .map(|&(x_m, y_m)| Point { x_m, y_m })
            .collect();
        let build = |fence: Fence| {
            let config = Config::builder(RobotShape::PIONEER_3AT)
                .laser(LaserMount::level(0.1, 0.4))
                .fence(fence);
            config.build().err().map(|error| error.parameter)
        };
        let refused = build(Fence::new().bounds(&corners));
        assert_eq!(build(Fence::new().no_go(&corners)), refused);
        refused
    }

    #[test]
    fn a_fence_that_is_none_is_refused_with_the_reason() {
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)];
        assert_eq!(refused(&square), None);
        let backwards = [square[3], square[2], square[1], square[0]];
        assert_eq!(refused(&backwards), None);
        assert_eq!(refused(&square[..2]), Some(Parameter::FenceCorners));
        assert_eq!(refused(&[]), Some(Parameter::FenceCorners));
        assert_eq!(refused(&[(0.5, 1.0); 33]), Some(Parameter::FenceCorners));
        let bow = [square[0], square[2], square[1], square[3]];
        assert_eq!(refused(&bow), Some(Parameter::FenceCrossings));
        let line = [(0.0, 0.0), (4.0, 4.0), (2.0, 2.0)];
        assert_eq!(refused(&line), Some(Parameter::FenceArea));
        for at in [f32::NAN, f32::INFINITY, 3_201.0] {
            let far = [square[0], square[1], (4.0, at)];
            assert_eq!(refused(&far), Some(Parameter::FenceCorner), "{at}");
        }
    }

    #[test]
    fn many_small_polygons_are_refused_and_not_left_out() {
        let triangle = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x_m, y_m)| Point { x_m, y_m });
        let fence =
            |polygons: usize| (0..polygons).fold(Fence::new(), |fence, _| fence.no_go(&triangle));
        let build = |fence| {
            let config = Config::builder(RobotShape::PIONEER_3AT)
                .laser(LaserMount::level(0.1, 0.4))
                .fence(fence);
            config.build().map(|config| config.fence().clone())
        };
        assert_eq!(build(fence(10)).unwrap(), fence(10));
        assert!(build(fence(11)).is_err());
    }
}
