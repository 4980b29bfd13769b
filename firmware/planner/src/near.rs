//! The near field: the laser's own points around the robot, exact where the map's cells are coarse.
//!
//! A door of 0.65 m leaves 8 cm beside a 3-AT, less than a map cell. So the points within `REACH_M` are kept as measured, also
//! those that have left the field of view: a point is dropped when the scan that replaces it looks at or beyond its place,
//! and kept while it is out of view or hidden. Behind the robot, where it only turns and backs out, less is kept.
//!
//! Invariant: at most [`MOST_POINTS`] points, the farthest give way.
//! Units: metres, odometry frame.

use heapless::Vec;

use crate::config::Laser;
use crate::geometry::{Point, Pose};
use crate::map::integrate::{informative_range_mm, level_beams, sensor_point};
use crate::math;

/// Points kept at the most.
pub const MOST_POINTS: usize = 256;
/// Distance from the robot's centre within which points ahead are kept, metres: half the robot and its braking distance.
pub const REACH_M: f32 = 1.2;
/// The same to the sides and behind, metres: half its diagonal and the longest leg backwards.
const REACH_BEHIND_M: f32 = 0.8;
/// Least distance between neighbours of one scan, metres.
const SPACING_M: f32 = 0.03;
/// Difference of range within which two adjacent beams hit the same thing, millimetres.
const COMPANY_MM: u16 = 250;
/// A beam that ends this little short of a point still looked at it, metres: five sigma of a range.
const LOOKED_AT_M: f32 = 0.05;

/// What stands around the robot.
#[derive(Debug, Default)]
pub struct NearField {
    points: Vec<Point, MOST_POINTS>,
}

fn distance2(a: Point, b: Point) -> f32 {
    let (dx, dy) = (a.x_m - b.x_m, a.y_m - b.y_m);
    dx * dx + dy * dy
}

impl NearField {
    /// Nothing around.
    #[must_use]
    pub const fn new() -> Self {
        Self { points: Vec::new() }
    }

    /// Forget everything.
    pub fn clear(&mut self) {
        self.points.clear();
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Enter the level laser's scan, taken at `pose`.
    pub fn update(&mut self, pose: &Pose, laser: &Laser, ranges_mm: &[u16]) {
        let from = sensor_point(pose, laser);
        self.points.retain(|&point| {
            within_reach(pose, point) && !looked_at(pose, laser, ranges_mm, from, point)
        });
        let mut last: Option<Point> = None;
        for beam in level_beams(pose, laser, ranges_mm).filter(|beam| beam.hit) {
            if !has_company(ranges_mm, beam.number) {
                continue;
            }
            let end = beam.end();
            let crowded = last.is_some_and(|last| distance2(last, end) < SPACING_M * SPACING_M);
            if !crowded && within_reach(pose, end) {
                self.insert(pose.point(), end);
                last = Some(end);
            }
        }
    }

    fn insert(&mut self, centre: Point, point: Point) {
        if self.points.is_full() {
            let farther = |best: (usize, f32), (k, &point): (usize, &Point)| {
                let far = distance2(point, centre);
                if far > best.1 { (k, far) } else { best }
            };
            let (farthest, far) = self.points.iter().enumerate().fold((0, 0.0), farther);
            if far < distance2(point, centre) {
                return;
            }
            self.points.swap_remove(farthest);
        }
        // There is room now, so this cannot fail.
        let _ = self.points.push(point);
    }
}

/// Whether a beam beside this one ended about as far. Within reach even a pole of 4 cm is hit by two; a lone point is a false
/// return, and one that fell behind the robot would never be seen through.
fn has_company(ranges_mm: &[u16], number: usize) -> bool {
    let range = |k: Option<usize>| k.and_then(|k| ranges_mm.get(k)).copied();
    let here = range(Some(number)).unwrap_or(0);
    let near =
        |beside: Option<u16>| beside.is_some_and(|beside| beside.abs_diff(here) < COMPANY_MM);
    near(range(number.checked_sub(1))) || near(range(Some(number + 1)))
}

fn within_reach(pose: &Pose, point: Point) -> bool {
    let far2 = distance2(point, pose.point());
    let (sin, cos) = math::sin_cos(pose.yaw_rad);
    let ahead = (point.x_m - pose.x_m) * cos + (point.y_m - pose.y_m) * sin > 0.0;
    let reach = if ahead { REACH_M } else { REACH_BEHIND_M };
    far2 < reach * reach
}

/// Whether this scan saw the place of `point`: in its view, and not hidden behind something nearer.
fn looked_at(pose: &Pose, laser: &Laser, ranges_mm: &[u16], from: Point, point: Point) -> bool {
    let (dx, dy) = (point.x_m - from.x_m, point.y_m - from.y_m);
    let bearing = math::wrap(math::atan2(dy, dx) - pose.yaw_rad - laser.first_bearing_rad);
    let index = math::floor(bearing / laser.bearing_step_rad + 0.5);
    if index < 0 || index >= ranges_mm.len() as i32 {
        return false;
    }
    let distance = math::sqrt(dx * dx + dy * dy);
    informative_range_mm(ranges_mm, index as usize, laser.range_limit_mm)
        .is_some_and(|range| f32::from(range) * 1e-3 + LOOKED_AT_M >= distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planner::{INVALID_MM, NO_RETURN_MM};

    fn laser() -> Laser {
        Laser {
            x_m: 0.0,
            y_m: 0.0,
            z_m: 0.4,
            pitch_rad: 0.0,
            first_bearing_rad: -math::PI / 2.0,
            bearing_step_rad: math::PI / 180.0,
            beams: 181,
            range_limit_mm: 12_000,
        }
    }

    #[test]
    fn a_lone_false_return_is_not_kept() {
        let mut near = NearField::new();
        let mut scan = [NO_RETURN_MM; 181];
        scan[90] = 500;
        near.update(&Pose::default(), &laser(), &scan);
        assert!(near.points().is_empty());
    }

    /// A scan that sees one thing, 4 beams wide, at a bearing (degrees) and range; nothing else.
    fn thing(bearing: i32, range_mm: u16) -> [u16; 181] {
        let mut scan = [NO_RETURN_MM; 181];
        for k in -2..2 {
            scan[(bearing + 90 + k) as usize] = range_mm;
        }
        scan
    }

    #[test]
    fn a_point_is_remembered_behind_the_robot_and_forgotten_when_seen_through() {
        let mut near = NearField::new();
        let here = Pose::default();
        near.update(&here, &laser(), &thing(0, 800));
        assert!(!near.points().is_empty());
        let turned = Pose {
            yaw_rad: math::PI,
            ..here
        };
        near.update(&turned, &laser(), &[NO_RETURN_MM; 181]);
        assert!(!near.points().is_empty(), "out of view");
        near.update(&here, &laser(), &[NO_RETURN_MM; 181]);
        assert!(near.points().is_empty(), "seen through");
    }

    #[test]
    fn a_hidden_point_stays_and_a_far_one_goes() {
        let mut near = NearField::new();
        let here = Pose::default();
        near.update(&here, &laser(), &thing(0, 1000));
        let count = near.points().len();
        near.update(&here, &laser(), &thing(0, 500));
        assert!(
            near.points().len() > count,
            "hidden behind the nearer thing"
        );
        let away = Pose { x_m: -2.0, ..here };
        near.update(&away, &laser(), &[INVALID_MM; 181]);
        assert!(near.points().is_empty());
    }

    #[test]
    fn a_wall_is_thinned_and_the_store_never_overflows() {
        let mut near = NearField::new();
        for k in 0..400 {
            let pose = Pose {
                yaw_rad: k as f32 * 0.7,
                ..Pose::default()
            };
            near.update(&pose, &laser(), &[400 + (k % 7) as u16 * 100; 181]);
            assert!(near.points().len() <= MOST_POINTS);
        }
    }
}
