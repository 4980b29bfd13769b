//! A person: an upright cylinder that lasers see and hulls touch.
//!
//! A person walks straight to a goal at one speed. Where the next step would bring it within
//! [`KEEP_M`] of the robot or of another person, and nearer than it is, it stands. After
//! [`PATIENCE_S`] of standing it wants another goal. Metres and seconds.

use crate::metrics::CellSet;
use crate::robot::{Footprint, Noise, Pose, distance_m};
use crate::world::{Ray, World};

/// Radius of a person, metres.
pub const RADIUS_M: f64 = 0.25;
/// Height of a person, metres.
const HEIGHT_M: f64 = 1.7;
/// Gap to the robot, and to other people, at which a person stops, metres.
pub const KEEP_M: f64 = 0.3;
/// Slowest and fastest walk, metres per second.
const SPEED_MPS: [f64; 2] = [0.3, 1.4];
/// Time after which a person that cannot go on wants another goal, seconds.
const PATIENCE_S: f64 = 2.0;
/// Farthest goal, metres.
const GOAL_M: f64 = 8.0;
/// Number of goals that are tried in a step.
const TRIES: u32 = 16;
/// Distance between points of a way that are tested, metres.
const STRIDE_M: f64 = 0.05;

/// A person at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Person {
    pub(super) at_m: [f64; 2],
    goal_m: [f64; 2],
    speed_mps: f64,
    stood_s: f64,
}

/// What else walks or drives where a person walks.
pub(super) struct Company<'a> {
    /// The robot.
    pub(super) robot: (&'a Footprint, &'a Pose),
    /// The other people, where they are now.
    pub(super) people: &'a [[f64; 2]],
}

impl Company<'_> {
    /// Returns the least gap from a person here to anything else.
    pub(super) fn gap_m(&self, at_m: [f64; 2]) -> f64 {
        let (footprint, pose) = self.robot;
        let robot_m = footprint.gap_to_disc_m(pose, at_m, RADIUS_M);
        let people = self.people.iter();
        let gaps_m = people.map(|other_m| (distance_m(at_m, *other_m) - 2.0 * RADIUS_M).max(0.0));
        gaps_m.fold(robot_m, f64::min)
    }
}

impl Person {
    /// Returns a person who stands and wants a goal.
    pub(super) const fn standing(at_m: [f64; 2]) -> Self {
        Self {
            at_m,
            goal_m: at_m,
            speed_mps: SPEED_MPS[0],
            stood_s: 0.0,
        }
    }

    /// Returns the middle, metres.
    #[must_use]
    pub const fn at_m(&self) -> [f64; 2] {
        self.at_m
    }

    /// Walks for some seconds.
    pub(super) fn walk(&mut self, company: &Company<'_>, seconds: f64) {
        let left_m = distance_m(self.at_m, self.goal_m);
        let share = (self.speed_mps * seconds / left_m.max(1e-9)).min(1.0);
        let next_m = [0, 1].map(|k| self.at_m[k] + share * (self.goal_m[k] - self.at_m[k]));
        let gap_m = company.gap_m(next_m);
        if gap_m < KEEP_M && gap_m <= company.gap_m(self.at_m) {
            self.stood_s += seconds;
        } else {
            self.at_m = next_m;
            self.stood_s = 0.0;
        }
    }

    /// Returns true if the person is at its goal, or has stood for too long.
    pub(super) fn wants_goal(&self) -> bool {
        self.at_m == self.goal_m || self.stood_s >= PATIENCE_S
    }

    /// Chooses a goal in sight within `ground`, and a speed. Stays if no try finds one.
    pub(super) fn choose(&mut self, world: &World, ground: &CellSet, random: &mut Noise) {
        let [slowest, fastest] = SPEED_MPS;
        self.speed_mps = slowest + (fastest - slowest) * random.uniform();
        for _ in 0..TRIES {
            let bearing = core::f64::consts::TAU * random.uniform();
            let reach_m = GOAL_M * random.uniform();
            let goal_m = [
                self.at_m[0] + reach_m * libm::cos(bearing),
                self.at_m[1] + reach_m * libm::sin(bearing),
            ];
            if reach_m > STRIDE_M && is_free(world, ground, self.at_m, goal_m) {
                self.goal_m = goal_m;
                self.stood_s = 0.0;
                return;
            }
        }
    }

    /// Returns the metres along a ray to the cylinder, if it is within `limit_m`. A ray that begins
    /// within sees out of it.
    #[must_use]
    pub fn cast(&self, world: &World, ray: &Ray, limit_m: f64) -> Option<f64> {
        let [dx, dy, dz] = ray.direction;
        let [x, y] = [0, 1].map(|k| ray.origin_m[k] - self.at_m[k]);
        // |(x, y) + t (dx, dy)|² = r², of which the lesser root enters.
        let (a, half_b) = (dx * dx + dy * dy, x * dx + y * dy);
        let under_root = half_b * half_b - a * (x * x + y * y - RADIUS_M * RADIUS_M);
        if a == 0.0 || under_root < 0.0 {
            return None;
        }
        let enter_m = (-half_b - under_root.sqrt()) / a;
        let feet_m = world.ground_m(self.at_m[0], self.at_m[1]).unwrap_or(0.0);
        let up_m = ray.origin_m[2] + enter_m * dz - feet_m;
        let hits = enter_m > 0.0 && enter_m <= limit_m && (0.0..=HEIGHT_M).contains(&up_m);
        hits.then_some(enter_m)
    }

    /// Returns the gap from a hull at a pose, metres; 0 if they overlap.
    #[must_use]
    pub fn gap_m(&self, footprint: &Footprint, pose: &Pose) -> f64 {
        footprint.gap_to_disc_m(pose, self.at_m, RADIUS_M)
    }
}

/// Returns true if a person can walk straight from a place to another within `ground`.
fn is_free(world: &World, ground: &CellSet, from_m: [f64; 2], to_m: [f64; 2]) -> bool {
    let strides = (distance_m(from_m, to_m) / STRIDE_M).ceil();
    (0..=strides as u32).all(|stride| {
        let share = f64::from(stride) / strides;
        let [x, y] = [0, 1].map(|k| from_m[k] + share * (to_m[k] - from_m[k]));
        ground.contains(world.occupancy().cell_at(x, y))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Source;

    fn hall() -> World {
        World::picture("hall", 0.5, &["................"; 8])
    }

    #[test]
    fn the_hit_is_where_a_march_in_small_steps_enters_the_cylinder() {
        let world = hall();
        let mut random = Noise::new(3, Source::People);
        let mut uniform = |low: f64, high: f64| low + (high - low) * random.uniform();
        let (mut met, mut missed) = (0, 0);
        for _ in 0..2_000 {
            let person = Person::standing([uniform(3.0, 5.0), uniform(1.0, 3.0)]);
            let direction = [1.0, uniform(-0.6, 0.6), uniform(-0.4, 0.6)];
            let length = direction.iter().map(|it| it * it).sum::<f64>().sqrt();
            let ray = Ray {
                origin_m: [0.5, uniform(0.5, 3.5), 0.45],
                direction: direction.map(|it| it / length),
            };
            let inside = |t: f64| {
                let [x, y, z] = [0, 1, 2].map(|k| ray.origin_m[k] + t * ray.direction[k]);
                distance_m([x, y], person.at_m) <= RADIUS_M && (0.0..=HEIGHT_M).contains(&z)
            };
            let marched = (0..6_000).map(|k| f64::from(k) * 1e-3).find(|t| inside(*t));
            match (person.cast(&world, &ray, 6.0), marched) {
                (Some(hit_m), Some(t)) => {
                    assert!(hit_m <= t + 1e-9 && t - hit_m < 2e-3, "{hit_m} {t}");
                    met += 1;
                }
                // The march may step over a grazed side.
                (Some(hit_m), None) => assert!(inside(hit_m + 1e-6), "{ray:?}"),
                // The ray enters through the top, which no laser sees from below it.
                (None, Some(t)) => {
                    let up_m = ray.origin_m[2] + t * ray.direction[2];
                    assert!((HEIGHT_M - up_m).abs() < 2e-3, "{ray:?} passed at {t}");
                }
                (None, None) => missed += 1,
            }
        }
        assert!(met > 100 && missed > 100, "{met} {missed}");
    }

    #[test]
    fn a_person_stops_before_the_robot_and_walks_away_from_it() {
        let (hull, robot) = (Footprint::PIONEER_3AT, Pose::default());
        let company = Company {
            robot: (&hull, &robot),
            people: &[],
        };
        let mut person = Person::standing([3.0, 0.0]);
        (person.goal_m, person.speed_mps) = ([-3.0, 0.0], 1.4);
        for _ in 0..400 {
            person.walk(&company, 0.01);
        }
        let gap_m = person.gap_m(&hull, &robot);
        assert!((KEEP_M..KEEP_M + 0.02).contains(&gap_m), "{gap_m}");
        assert!(person.wants_goal());
        person.goal_m = [3.0, 1.0];
        person.walk(&company, 0.01);
        assert!(person.gap_m(&hull, &robot) > gap_m);
    }
}
