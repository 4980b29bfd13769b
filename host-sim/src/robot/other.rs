//! Another robot as a thing in the world: lasers see it and hulls touch it.
//!
//! It is a box on the plane of its wheels, as long and wide as its hull. Lasers see the box up to
//! the top of the mast that carries its own lasers, so two robots see each other with both. A ray
//! is cut with the box's three slabs in the box's own frame; the first face that it enters is the
//! hit. Hulls touch if the rectangles of [`Footprint`] overlap, seen from above. Metres.

use super::footprint::{Footprint, disc_crossing};
use super::pose::Pose;
use crate::world::Ray;

/// Least height up to which a robot is seen, metres: the top of the mast with both lasers.
pub const MAST_M: f64 = 0.50;

/// Another robot at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherRobot {
    footprint: Footprint,
    pose: Pose,
    axes: [[f64; 3]; 3],
}

impl OtherRobot {
    /// A robot of this hull at this pose.
    #[must_use]
    pub fn new(footprint: Footprint, pose: Pose) -> Self {
        Self {
            footprint,
            pose,
            axes: pose.axes(),
        }
    }

    /// Its hull.
    #[must_use]
    pub const fn footprint(&self) -> &Footprint {
        &self.footprint
    }

    /// Its pose.
    #[must_use]
    pub const fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Metres along a ray to the first face of the box, if it is within `limit_m`. A ray that
    /// begins in the box sees out of it.
    #[must_use]
    pub fn cast(&self, ray: &Ray, limit_m: f64) -> Option<f64> {
        let top_m = self.footprint.height_m.max(MAST_M);
        let reach_m = limit_m + self.footprint.circumradius_m() + top_m;
        let offset = [
            ray.origin_m[0] - self.pose.x_m,
            ray.origin_m[1] - self.pose.y_m,
            ray.origin_m[2] - self.pose.z_m,
        ];
        if dot(&offset, &offset) > reach_m * reach_m {
            return None;
        }
        if self.footprint.is_round {
            return self.cast_disc(ray, &offset, top_m, limit_m);
        }
        let (a, b) = (self.footprint.half_length_m, self.footprint.half_width_m);
        let slabs = [[-a, a], [-b, b], [0.0, top_m]];
        let (mut enter_m, mut leave_m) = (f64::NEG_INFINITY, f64::INFINITY);
        for (axis, [low, high]) in self.axes.iter().zip(slabs) {
            let (start, speed) = (dot(&offset, axis), dot(&ray.direction, axis));
            if speed == 0.0 {
                if start < low || start > high {
                    return None;
                }
                continue;
            }
            let ends = [(low - start) / speed, (high - start) / speed];
            enter_m = enter_m.max(ends[0].min(ends[1]));
            leave_m = leave_m.min(ends[0].max(ends[1]));
        }
        (enter_m > 0.0 && enter_m <= leave_m && enter_m <= limit_m).then_some(enter_m)
    }

    /// As [`Self::cast`], for an upright cylinder.
    fn cast_disc(&self, ray: &Ray, offset: &[f64; 3], top_m: f64, limit_m: f64) -> Option<f64> {
        let [start, along] = [offset, &ray.direction]
            .map(|vector| [0, 1, 2].map(|axis| dot(vector, &self.axes[axis])));
        let radius_m = self.footprint.half_length_m;
        let side = disc_crossing(radius_m, [start[0], start[1]], [along[0], along[1]])?;
        let between = if along[2] == 0.0 {
            (0.0..=top_m).contains(&start[2]).then_some(side)?
        } else {
            let ends = [0.0, top_m].map(|height| (height - start[2]) / along[2]);
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        };
        let (enter_m, leave_m) = (side[0].max(between[0]), side[1].min(between[1]));
        (enter_m > 0.0 && enter_m <= leave_m && enter_m <= limit_m).then_some(enter_m)
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Metres along a ray to the nearest of some robots, if one is within `limit_m`.
#[must_use]
pub fn nearest_m(others: &[OtherRobot], ray: &Ray, limit_m: f64) -> Option<f64> {
    let hits = others.iter().filter_map(|other| other.cast(ray, limit_m));
    hits.min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    const HULL: Footprint = Footprint::PIONEER_3AT;

    fn ray(origin_m: [f64; 3], direction: [f64; 3]) -> Ray {
        let length = dot(&direction, &direction).sqrt();
        Ray {
            origin_m,
            direction: direction.map(|d| d / length),
        }
    }

    #[test]
    fn the_hit_is_where_a_march_in_small_steps_enters_the_box() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut uniform =
            |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / 4_294_967_295.0;
        let (mut met, mut missed) = (0, 0);
        for _ in 0..1_500 {
            let pose = Pose {
                x_m: uniform(-1.0, 1.0),
                y_m: uniform(-1.0, 1.0),
                z_m: uniform(-0.2, 0.2),
                roll_rad: uniform(-0.3, 0.3),
                pitch_rad: uniform(-0.3, 0.3),
                yaw_rad: uniform(-3.1, 3.1),
            };
            let other = OtherRobot::new(HULL, pose);
            let beam = ray(
                [uniform(2.0, 3.0), uniform(-1.0, 1.0), uniform(0.2, 0.6)],
                [-1.0, uniform(-0.6, 0.6), uniform(-0.3, 0.1)],
            );
            let inside = |t: f64| {
                let at = [
                    beam.origin_m[0] + t * beam.direction[0] - pose.x_m,
                    beam.origin_m[1] + t * beam.direction[1] - pose.y_m,
                    beam.origin_m[2] + t * beam.direction[2] - pose.z_m,
                ];
                let [x, y, z] = pose.axes().map(|axis| dot(&at, &axis));
                x.abs() <= HULL.half_length_m
                    && y.abs() <= HULL.half_width_m
                    && (0.0..=MAST_M).contains(&z)
            };
            let marched = (0..6_000).map(|k| f64::from(k) * 1e-3).find(|t| inside(*t));
            match (other.cast(&beam, 6.0), marched) {
                (Some(hit_m), Some(t)) => {
                    assert!(hit_m <= t + 1e-9 && t - hit_m < 2e-3, "{hit_m} {t}");
                    met += 1;
                }
                // The march may step over a corner.
                (Some(hit_m), None) => assert!(inside(hit_m + 1e-9)),
                (None, Some(t)) => panic!("{beam:?} passed the box at {t}"),
                (None, None) => missed += 1,
            }
        }
        assert!(met > 150 && missed > 150, "{met} {missed}");
    }

    #[test]
    fn a_robot_beyond_the_range_or_around_the_ray_is_not_hit() {
        let other = OtherRobot::new(HULL, Pose::default());
        let towards = |x_m: f64| ray([x_m, 0.0, 0.4], [-1.0, 0.0, 0.0]);
        let hit_m = other.cast(&towards(3.0), 12.0).expect("in range");
        assert!((hit_m - (3.0 - HULL.half_length_m)).abs() < 1e-12);
        assert_eq!(other.cast(&towards(3.0), 2.7), None);
        assert_eq!(other.cast(&towards(0.1), 12.0), None);
        assert_eq!(other.cast(&towards(-3.0), 12.0), None);
        assert_eq!(nearest_m(&[], &towards(3.0), 12.0), None);
    }

    #[test]
    fn rays_hit_a_round_robot_where_sampling_finds_it() {
        let hull = Footprint::disc(0.2, 0.3);
        let pose = Pose {
            x_m: 2.0,
            y_m: 1.0,
            pitch_rad: 0.2,
            roll_rad: -0.1,
            yaw_rad: 0.7,
            ..Pose::default()
        };
        let robot = OtherRobot::new(hull, pose);
        let is_within = |point: &[f64; 3]| {
            let offset = [point[0] - 2.0, point[1] - 1.0, point[2]];
            let [x, y, z] = [0, 1, 2].map(|axis| dot(&offset, &robot.axes[axis]));
            x * x + y * y <= 0.04 && (0.0..=MAST_M).contains(&z)
        };
        let mut hits = 0;
        for k in 0..200 {
            let angle = 0.5 * f64::from(k % 50 - 25) / 25.0;
            let down = -0.4 + 0.2 * f64::from(k / 50);
            let direction = [angle.cos(), angle.sin(), down];
            let length = dot(&direction, &direction).sqrt();
            let ray = Ray {
                origin_m: [0.0, 0.5, 0.4],
                direction: direction.map(|part| part / length),
            };
            let at = |range_m: f64| {
                [0, 1, 2].map(|axis| ray.origin_m[axis] + range_m * ray.direction[axis])
            };
            let steps = (0..4000).map(|step| 0.001 * f64::from(step));
            let sampled = steps.into_iter().find(|range_m| is_within(&at(*range_m)));
            let cast = robot.cast(&ray, 4.0);
            match (cast, sampled) {
                (Some(a), Some(b)) => assert!((a - b).abs() < 2e-3, "{k}: {a} {b}"),
                // A ray may graze the rim between two samples.
                (Some(a), None) => assert!(!is_within(&at(a + 0.02)), "{k}"),
                (None, Some(_)) => panic!("{k}"),
                (None, None) => {}
            }
            hits += u32::from(cast.is_some());
        }
        assert!(hits > 10, "{hits}");
    }
}
