//! The ends of a level scan's beams in the robot's frame, and the surface that each lies on.
//!
//! ```text
//!  left ·──────●──────· right      normal ⊥ right − left, if ● lies on their line
//! ```
//!
//! A beam counts if something came back and a neighbour ended near it: a lone return is false. A
//! smooth surface says nothing along itself, however rough its cells in the map are. So a beam on
//! one measures along its normal only. A beam on an edge or a corner has no normal: it measures in
//! both directions.
//!
//! On uneven ground the ends are seen from above: the robot's roll and pitch turn each beam. They
//! lie as far behind the surface as the map's obstacles do.
//!
//! Units: metres, robot frame.

use heapless::Vec;

use crate::config::{Config, LocaliseTuning};
use crate::geometry::{CELL_M, Point, Pose};
use crate::ground::ray::{Attitude, Mount};
use crate::input::has_company;
use crate::map::integrate::level_beams;
use crate::math;
use crate::robot::{LaserMount, MAX_BEAMS};

/// Greatest number of points.
const MAX_POINTS: usize = MAX_BEAMS as usize;
/// A neighbour is at least this far away, metres: noise of 1 cm then turns a normal by 3°.
const LEAST_GAP_M: f32 = 2.0 * CELL_M;
/// A neighbour is at most this many beams away.
const MOST_BEAMS: usize = 8;

/// The points of a scan.
pub(crate) type ScanPoints = Vec<ScanPoint, MAX_POINTS>;

/// A beam's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScanPoint {
    /// The end.
    pub(crate) end: Point,
    /// Unit normal of the surface; `None` on an edge or a corner.
    pub(crate) normal: Option<(f32, f32)>,
}

/// Adds the points of a scan. They are too many to return by value.
pub(super) fn scan_points(
    config: &Config,
    pose: &Pose,
    (laser, ranges_mm): (&LaserMount, &[u16]),
    points: &mut ScanPoints,
) {
    let tuning = &config.tuning.localise;
    let stride = usize::from(tuning.beam_stride);
    let beams = level_beams(&Pose::default(), laser, ranges_mm, &config.tuning.map);
    let counts = |number: usize| number.checked_rem(stride) == Some(0);
    let beams =
        beams.filter(|beam| beam.hit && counts(beam.number) && has_company(ranges_mm, beam.number));
    // A scan has no more beams than there is room.
    let mut add = |end: Point| {
        let _ = points.push(ScanPoint { end, normal: None });
    };
    if config.ground.is_some() {
        let attitude = Attitude::of(&Pose {
            roll_rad: pose.roll_rad,
            pitch_rad: pose.pitch_rad,
            ..Pose::default()
        });
        let mount = Mount::new(&attitude, laser);
        let depth_m = config.tuning.ground.hit_depth_m;
        beams
            .filter_map(|beam| attitude.ray(&mount, beam.number, beam.length_m))
            .for_each(|ray| add(ray.at(ray.length_m + depth_m)));
    } else {
        beams.for_each(|beam| add(beam.end()));
    }
    for k in 0..points.len() {
        let normal = normal(points, k, tuning);
        if let Some(point) = points.get_mut(k) {
            point.normal = normal;
        }
    }
}

/// Returns the normal of the surface at a point.
fn normal(points: &[ScanPoint], k: usize, tuning: &LocaliseTuning) -> Option<(f32, f32)> {
    let (before, rest) = points.split_at_checked(k)?;
    let (point, after) = rest.split_first()?;
    let at = point.end;
    let is_far = |it: &&ScanPoint| square(away(at, it.end)) >= LEAST_GAP_M * LEAST_GAP_M;
    let left = before.iter().rev().take(MOST_BEAMS).find(is_far)?;
    let right = after.iter().take(MOST_BEAMS).find(is_far)?;
    let line = away(left.end, right.end);
    let length = math::sqrt(square(line));
    let normal = (-line.1 / length, line.0 / length);
    let side = away(left.end, at);
    let off = normal.0 * side.0 + normal.1 * side.1;
    let along = line.0 * side.0 + line.1 * side.1;
    // A point that is not between its neighbours is the tip of a fold.
    let is_between = along > 0.0 && along < length * length;
    (off.abs() < tuning.flat_m && is_between).then_some(normal)
}

/// Returns the shift from a point to another.
fn away(from: Point, to: Point) -> (f32, f32) {
    (to.x_m - from.x_m, to.y_m - from.y_m)
}

fn square((x, y): (f32, f32)) -> f32 {
    x * x + y * y
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{ScanPoint, ScanPoints, normal, scan_points};
    use crate::config::{Config, LocaliseTuning, UnevenGround};
    use crate::geometry::{Point, Pose};
    use crate::ground::ray::{Attitude, Mount};
    use crate::input::NO_RETURN_MM;
    use crate::robot::LaserMount;

    /// Returns the normals of points.
    fn normals(ends: &[(f32, f32)]) -> Vec<Option<(f32, f32)>> {
        let point = |&(x_m, y_m): &(f32, f32)| ScanPoint {
            end: Point { x_m, y_m },
            normal: None,
        };
        let points: Vec<ScanPoint> = ends.iter().map(point).collect();
        let normal = |k| normal(&points, k, &LocaliseTuning::DEFAULT);
        (0..points.len()).map(normal).collect()
    }

    #[test]
    fn a_wall_has_its_normal_whatever_its_gaps() {
        for (step, degrees) in [(0.05_f32, 20.0_f32), (0.3, 75.0), (2.0, 140.0)] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let ends: Vec<_> = (0..20).map(|k| step * k as f32).collect();
            let ends: Vec<_> = ends.iter().map(|it| (3.0 + cos * it, sin * it)).collect();
            let normals = normals(&ends);
            assert_eq!((normals[0], normals[19]), (None, None), "the wall's ends");
            for normal in &normals[5..15] {
                let (x, y) = normal.expect("a surface");
                assert!((x * cos + y * sin).abs() < 1e-5 && (x * x + y * y - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn corners_edges_and_tips_have_none() {
        let corner = [(0.0, 1.0), (0.0, 0.5), (0.0, 0.0), (0.5, 0.0), (1.0, 0.0)];
        let found = normals(&corner);
        assert_eq!(found[2], None);
        assert!(found[1].is_some() && found[3].is_some());
        // A step from a near wall to a far one.
        let step = [
            (1.0, 0.0),
            (1.0, 0.3),
            (1.0, 0.6),
            (4.0, 2.4),
            (4.0, 2.7),
            (4.0, 3.0),
        ];
        let found = normals(&step);
        assert_eq!((found[2], found[3]), (None, None));
        assert!(found[1].is_some() && found[4].is_some());
        let tip = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.01)];
        assert_eq!(normals(&tip)[1], None);
    }

    #[test]
    fn a_point_without_two_neighbours_has_none() {
        assert_eq!(normals(&[]), []);
        assert_eq!(normals(&[(1.0, 0.0), (1.0, 0.5)]), [None, None]);
        let heap = [(1.0, 0.0), (1.0, 0.05), (1.0, 0.1)];
        assert_eq!(normals(&heap)[1], None, "all within two cells");
    }

    /// The ends on an upright wall lie in its plane, however the robot is tilted.
    #[test]
    fn the_ends_of_a_tilted_robot_are_seen_from_above() {
        let laser = LaserMount::level(0.1, 0.4);
        let config = Config {
            ground: Some(UnevenGround::TABLE_I),
            ..Config::pioneer_3at([laser].into_iter().collect())
        };
        for (roll_rad, pitch_rad) in [(0.0, 0.0), (0.2, 0.0), (0.0, -0.25), (-0.15, 0.2)] {
            let pose = Pose {
                x_m: 4.0,
                yaw_rad: 1.0,
                roll_rad,
                pitch_rad,
                ..Pose::default()
            };
            let attitude = Attitude::of(&Pose {
                x_m: 0.0,
                yaw_rad: 0.0,
                ..pose
            });
            let mount = Mount::new(&attitude, &laser);
            let ranges_mm: [u16; 181] = core::array::from_fn(|number| {
                let ray = attitude.ray(&mount, number, 1.0).expect("not upright");
                let range_m = (3.0 - ray.from.x_m) / (ray.along.0 * ray.length_m);
                if (30..150).contains(&number) {
                    (1000.0 * range_m) as u16
                } else {
                    NO_RETURN_MM
                }
            });
            let mut points = ScanPoints::new();
            scan_points(&config, &pose, (&laser, &ranges_mm), &mut points);
            assert!(points.len() > 100);
            for point in &points {
                // Behind the wall by the depth, along a beam.
                let behind_m = point.end.x_m - 3.0;
                assert!((0.01..0.032).contains(&behind_m), "{behind_m} {point:?}");
            }
            let middle = points[points.len() / 2].normal.expect("a surface");
            assert!(middle.0.abs() > 0.999, "{middle:?}");
        }
    }
}
