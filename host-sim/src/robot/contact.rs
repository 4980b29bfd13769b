//! Whether the true ground lets a motion be: edges that stop a wheel, ground that the belly hits, drops, and slopes that tip the robot.
//!
//! - *Blocked*: within a wheel's radius ahead of where it goes, the ground is higher than its contact by more than the limit for
//!   edges; or under the belly it stands higher over the plane of the contacts than the belly does, or before a bumper
//!   that leads higher than an edge may be.
//! - *Fallen*: a wheel has no ground; or the ground went down under it faster than a robot could stand on, by more than
//!   the limit for drops, or by half of that with the belly on the rim. Each wheel's contact is carried along for that: it sinks with the ground, but never more steeply than
//!   the greatest climb,
//!   ```text
//!   carried ← max(ground, carried − way · tan(climb))        fallen if carried − ground > drop
//!   ```
//!   so that a slope of any length is no drop, and a drop is one wherever its rim lies between two samples.
//! - *Tipped*: pitch or roll of the stance is beyond the limits.
//!
//! Nothing here knows the planner's map. Metres, radians.

use super::limits::{Limits, SLACK};
use super::pose::Pose;
use super::stance::{ground_m, resting, wheels};
use crate::world::World;

/// Radius of a wheel, metres.
const WHEEL_RADIUS_M: f64 = 0.111;
/// Height of the belly over the contacts, metres.
const BELLY_M: f64 = 0.08;
/// Where the ground ahead of a wheel is looked at, as shares of its radius.
const AHEAD: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Points of the belly: along the heading and to the left, metres.
const BELLY: [[f64; 2]; 9] = [
    [0.13, 0.1],
    [0.13, 0.0],
    [0.13, -0.1],
    [0.0, 0.1],
    [0.0, 0.0],
    [0.0, -0.1],
    [-0.13, 0.1],
    [-0.13, 0.0],
    [-0.13, -0.1],
];
/// How far ahead of the centre the bumpers are, metres.
const BUMPER_M: f64 = 0.25;
/// Where the bumpers are looked at, metres to the left.
const SIDEWAYS: [f64; 3] = [0.1, 0.0, -0.1];

/// What a motion comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mishap {
    /// Ground is in the way; the robot stays where it is.
    Blocked,
    /// The ground is gone from under a wheel.
    Fallen,
    /// Too steep to stand on.
    Tipped,
}

/// The contacts of the four wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contacts {
    /// The heights that the wheels were carried to.
    carried_m: [f64; 4],
}

impl Contacts {
    /// Of a robot put down at a pose; `None` over a hole.
    #[must_use]
    pub fn at(world: &World, pose: &Pose) -> Option<Self> {
        let carried_m = ground_m(world, &wheels(pose))?;
        Some(Self { carried_m })
    }

    /// Moves the wheels from a stance to a planar pose near by, a centimetre or so, and returns the stance there.
    ///
    /// # Errors
    /// [`Mishap`]. A blocked motion changes nothing.
    pub fn go(
        &mut self,
        world: &World,
        from: &Pose,
        to: &Pose,
        limits: &Limits,
    ) -> Result<Pose, Mishap> {
        let (before, after) = (wheels(from), wheels(to));
        let Some(heights_m) = ground_m(world, &after) else {
            return Err(Mishap::Fallen);
        };
        let stance = resting(to, heights_m);
        let blocked = (0..4).any(|k| {
            rise_ahead_m(world, before[k], after[k], heights_m[k]) > limits.step_m + SLACK
        });
        if blocked {
            return Err(Mishap::Blocked);
        }
        let steepest = libm::tan(limits.climb_rad);
        let carried_m = [0, 1, 2, 3].map(|k| {
            let sunk_m = self.carried_m[k] - distance_m(before[k], after[k]) * steepest;
            heights_m[k].max(sunk_m)
        });
        let dropped_m = (0..4).fold(0.0, |most, k| f64::max(most, carried_m[k] - heights_m[k]));
        if dropped_m > limits.drop_m + SLACK {
            return Err(Mishap::Fallen);
        }
        if touches(world, from, &stance, limits) {
            // What comes down on its belly with a wheel in the air hangs there: nothing came in its way.
            let hangs = dropped_m > 0.5 * limits.drop_m;
            return Err(if hangs {
                Mishap::Fallen
            } else {
                Mishap::Blocked
            });
        }
        if !limits.holds_attitude(stance.pitch_rad, stance.roll_rad) {
            return Err(Mishap::Tipped);
        }
        self.carried_m = carried_m;
        Ok(stance)
    }
}

fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    (dx * dx + dy * dy).sqrt()
}

/// How much higher than its contact the ground is within a wheel's radius along its way; holes are not in the way.
fn rise_ahead_m(world: &World, from: [f64; 2], to: [f64; 2], contact_m: f64) -> f64 {
    let way_m = distance_m(from, to);
    if way_m == 0.0 {
        return 0.0;
    }
    let along = [0, 1].map(|k| (to[k] - from[k]) / way_m);
    rise_along_m(world, to, along, contact_m)
}

/// How much higher than `contact_m` the ground is within a wheel's radius of a point, along a unit vector.
pub(crate) fn rise_along_m(world: &World, point: [f64; 2], along: [f64; 2], contact_m: f64) -> f64 {
    look_along(world, point, along)
        .map(|height_m| height_m - contact_m)
        .fold(0.0, f64::max)
}

/// How much lower than `contact_m` the ground is within a wheel's radius of a point, along a unit vector; endless at a hole.
pub(crate) fn fall_along_m(world: &World, point: [f64; 2], along: [f64; 2], contact_m: f64) -> f64 {
    let looked = look_along(world, point, along);
    let (count, fall_m) = looked.fold((0, 0.0_f64), |(count, fall_m), height_m| {
        (count + 1, fall_m.max(contact_m - height_m))
    });
    if count < AHEAD.len() {
        f64::INFINITY
    } else {
        fall_m
    }
}

/// The ground within a wheel's radius of a point, along a unit vector, where there is any.
fn look_along(world: &World, [x, y]: [f64; 2], along: [f64; 2]) -> impl Iterator<Item = f64> + '_ {
    AHEAD.into_iter().filter_map(move |share| {
        let reach_m = share * WHEEL_RADIUS_M;
        world.ground_m(x + reach_m * along[0], y + reach_m * along[1])
    })
}

/// Does ground that came nearer touch the belly or the bumper that leads?
fn touches(world: &World, from: &Pose, to: &Pose, limits: &Limits) -> bool {
    let (cos, sin) = (libm::cos(to.yaw_rad), libm::sin(to.yaw_rad));
    let way_m = (to.x_m - from.x_m) * cos + (to.y_m - from.y_m) * sin;
    let bumpers = SIDEWAYS.map(|left| [BUMPER_M * way_m.signum(), left]);
    let leading = if way_m == 0.0 { 0 } else { bumpers.len() };
    let meets = |point: [f64; 2], free_m: f64| {
        let rise_m = over_plane_m(world, to, point);
        rise_m > free_m && rise_m > over_plane_m(world, from, point)
    };
    let edge_m = limits.step_m.max(BELLY_M) + SLACK;
    BELLY.into_iter().any(|point| meets(point, BELLY_M))
        || bumpers[..leading].iter().any(|point| meets(*point, edge_m))
}

/// Does the ground touch the belly or a bumper of a robot that stands like this?
pub(crate) fn is_aground(world: &World, stance: &Pose, limits: &Limits) -> bool {
    let bumpers = [BUMPER_M, -BUMPER_M]
        .into_iter()
        .flat_map(|ahead| SIDEWAYS.map(|left| [ahead, left]));
    let meets = |point, free_m| over_plane_m(world, stance, point) > free_m;
    let edge_m = limits.step_m.max(BELLY_M) + SLACK;
    BELLY.into_iter().any(|point| meets(point, BELLY_M))
        || bumpers.into_iter().any(|point| meets(point, edge_m))
}

/// How high the ground stands over the plane of the contacts at a point of the robot; −∞ over a hole.
fn over_plane_m(world: &World, stance: &Pose, [ahead, left]: [f64; 2]) -> f64 {
    let (cos, sin) = (libm::cos(stance.yaw_rad), libm::sin(stance.yaw_rad));
    let place = [
        stance.x_m + ahead * cos - left * sin,
        stance.y_m + ahead * sin + left * cos,
    ];
    let plane_m =
        stance.z_m - ahead * libm::tan(stance.pitch_rad) + left * libm::tan(stance.roll_rad);
    world
        .ground_m(place[0], place[1])
        .map_or(f64::NEG_INFINITY, |ground_m| ground_m - plane_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::stand;
    use crate::world::{Class, Elevation, Occupancy};

    /// 8 × 4 m of ground that depends on x, sampled every 2 cm.
    fn ground(height_m: impl Fn(f64) -> f64) -> World {
        let size = [400, 200];
        let elevation = Elevation::from_fn(size, 0.02, [0.0, 0.0], |x, _| height_m(x));
        let floor = Occupancy::filled(size[0], size[1], 0.02, [0.0, 0.0], Class::Free);
        World::uneven("ground", floor, elevation, Vec::new())
    }

    /// Drives from x = 1 or, `down`, from x = 7 back, and says where and how it ended.
    fn drive(world: &World, yaw_rad: f64, down: bool) -> (f64, Result<(), Mishap>) {
        let flat = Pose {
            x_m: if down { 7.0 } else { 1.0 },
            y_m: 2.0,
            yaw_rad,
            ..Pose::default()
        };
        let mut pose = stand(world, &flat).expect("ground");
        let mut contacts = Contacts::at(world, &pose).expect("ground");
        for _ in 0..1200 {
            let x_m = pose.x_m + if down { -0.005 } else { 0.005 };
            match contacts.go(world, &pose, &Pose { x_m, ..pose }, &Limits::FAILING) {
                Ok(next) => pose = next,
                Err(mishap) => return (pose.x_m, Err(mishap)),
            }
        }
        (pose.x_m, Ok(()))
    }

    fn kerb(height_m: f64) -> World {
        ground(move |x| if x > 4.0 { height_m } else { 0.0 })
    }

    #[test]
    fn kerbs_up_to_the_limit_are_climbed_and_higher_ones_stop_the_wheels() {
        for height_m in [0.02, 0.05, 0.10] {
            assert_eq!(drive(&kerb(height_m), 0.0, false).1, Ok(()), "{height_m}");
        }
        for height_m in [0.12, 0.2, 0.4, 2.0] {
            let (x_m, end) = drive(&kerb(height_m), 0.0, false);
            assert_eq!(end, Err(Mishap::Blocked), "{height_m}");
            // The front axle is 0.134 m ahead, the kerb's ramp begins at 3.99, and a wheel looks 0.111 m ahead.
            assert!((3.70..3.78).contains(&x_m), "{height_m}: {x_m}");
        }
    }

    #[test]
    fn kerbs_down_to_the_limit_are_taken_and_deeper_ones_are_falls() {
        for height_m in [0.05, 0.10, 0.14] {
            assert_eq!(drive(&kerb(height_m), 0.0, true).1, Ok(()), "{height_m}");
        }
        for height_m in [0.17, 0.3, 3.0] {
            let (x_m, end) = drive(&kerb(height_m), 0.0, true);
            assert_eq!(end, Err(Mishap::Fallen), "{height_m}");
            assert!((4.10..4.15).contains(&x_m), "{height_m}: {x_m}");
        }
    }

    #[test]
    fn a_fall_does_not_depend_on_how_finely_the_ground_is_sampled() {
        for resolution in [0.02, 0.05, 0.1, 0.2] {
            let cells = |metres: f64| (metres / resolution).round() as usize;
            let size = [cells(8.0), cells(4.0)];
            let cliff = |x: f64, _| if x > 4.0 { 1.0 } else { 0.0 };
            let elevation = Elevation::from_fn(size, resolution, [0.0, 0.0], cliff);
            let floor = Occupancy::filled(size[0], size[1], resolution, [0.0, 0.0], Class::Free);
            let world = World::uneven("cliff", floor, elevation, Vec::new());
            assert_eq!(
                drive(&world, 0.0, true).1,
                Err(Mishap::Fallen),
                "{resolution}"
            );
            assert_eq!(
                drive(&world, 0.0, false).1,
                Err(Mishap::Blocked),
                "{resolution}"
            );
        }
    }

    #[test]
    fn long_slopes_are_no_drops_and_steep_ones_tip() {
        let slope = |degrees: f64| {
            let grade = degrees.to_radians().tan();
            // Half a metre of transition, so that no bumper meets the foot.
            ground(move |x| {
                let t = x - 3.0;
                grade
                    * if t < 0.0 {
                        0.0
                    } else if t < 0.5 {
                        t * t
                    } else {
                        t - 0.25
                    }
            })
        };
        for degrees in [10.0, 20.0, 28.0] {
            assert_eq!(drive(&slope(degrees), 0.0, false).1, Ok(()), "{degrees}");
            assert_eq!(drive(&slope(degrees), 0.0, true).1, Ok(()), "{degrees}");
        }
        assert_eq!(drive(&slope(33.0), 0.0, false).1, Err(Mishap::Tipped));
        // Across, the limit is 25°.
        let across = core::f64::consts::FRAC_PI_2;
        assert_eq!(drive(&slope(24.0), across, false).1, Ok(()));
        assert_eq!(drive(&slope(27.0), across, false).1, Err(Mishap::Tipped));
    }

    #[test]
    fn a_stone_between_the_wheels_is_passed_over_or_met_by_its_height() {
        let stone = |height_m: f64| {
            let size = [400, 200];
            let elevation = Elevation::from_fn(size, 0.02, [0.0, 0.0], |x, y| {
                if (x - 4.0).abs() < 0.05 && (y - 2.0).abs() < 0.05 {
                    height_m
                } else {
                    0.0
                }
            });
            let floor = Occupancy::filled(size[0], size[1], 0.02, [0.0, 0.0], Class::Free);
            World::uneven("stone", floor, elevation, Vec::new())
        };
        assert_eq!(drive(&stone(0.07), 0.0, false).1, Ok(()));
        let (x_m, end) = drive(&stone(0.12), 0.0, false);
        assert_eq!(end, Err(Mishap::Blocked));
        assert!((3.68..3.71).contains(&x_m), "{x_m}");
    }

    #[test]
    fn after_a_kerb_stopped_it_the_robot_can_leave_it() {
        let world = kerb(0.3);
        let flat = Pose {
            x_m: 3.7,
            y_m: 2.0,
            ..Pose::default()
        };
        let mut pose = stand(&world, &flat).expect("ground");
        let mut contacts = Contacts::at(&world, &pose).expect("ground");
        let mut try_to = |pose: &mut Pose, by_m: f64| {
            let x_m = pose.x_m + by_m;
            let next = contacts.go(&world, pose, &Pose { x_m, ..*pose }, &Limits::FAILING);
            next.map(|next| *pose = next)
        };
        while try_to(&mut pose, 0.005).is_ok() {}
        assert_eq!(try_to(&mut pose, -0.005), Ok(()));
    }

    #[test]
    fn a_hole_is_no_edge_until_a_wheel_is_over_it() {
        let world = ground(|x| if x > 4.0 { f64::NAN } else { 0.0 });
        let (x_m, end) = drive(&world, 0.0, false);
        assert_eq!(end, Err(Mishap::Fallen));
        assert!((3.84..3.87).contains(&x_m), "{x_m}");
    }
}
