//! Decides if the true ground lets the robot move: edges, ground under the belly, drops, slopes.
//!
//! - *Blocked*, by an edge: within one wheel radius ahead of a wheel, the ground is higher than
//!   the wheel's contact by more than `step_m`.
//! - *Blocked*, by the belly: the ground under the belly is higher than the belly, or the ground
//!   at the leading bumper is higher than an edge may be. Both heights count from the plane of
//!   the contacts.
//! - *Fallen*: a wheel has no ground. Or the ground under a wheel went down faster than a slope
//!   may, by more than `drop_m`, or by half of `drop_m` while the belly touches the rim.
//!   Each wheel keeps a carried height, which sinks at most as steeply as the greatest climb:
//!   ```text
//!   carried ← max(ground, carried − distance · tan(climb))     fallen if carried − ground > drop
//!   ```
//!   So a slope of any length is no drop, and a drop is found wherever its rim lies between two
//!   samples.
//! - *Tipped*: pitch or roll of the stance is beyond the limits.
//!
//! This module does not know the planner's map. Metres, radians.

use super::limits::{Limits, SLACK};
use super::pose::{Pose, distance_m};
use super::stance::{ground_m, resting, wheels};
use crate::world::World;

/// Radius of a wheel, metres.
const WHEEL_RADIUS_M: f64 = 0.111;
/// Height of the belly over the plane of the contacts, metres.
const BELLY_M: f64 = 0.08;
/// Where the ground ahead of a wheel is sampled, as shares of the wheel's radius.
const AHEAD: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Sampled points of the belly: along the heading and to the left, metres.
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
/// Distance of the bumpers from the centre along the heading, metres.
const BUMPER_M: f64 = 0.25;
/// Sampled points of a bumper, metres to the left.
const SIDEWAYS: [f64; 3] = [0.1, 0.0, -0.1];

/// Why a motion failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mishap {
    /// The ground is in the way; the robot stays where it is.
    Blocked,
    /// A wheel has lost the ground.
    Fallen,
    /// The ground is too steep to stand on.
    Tipped,
}

/// Contacts of the four wheels with the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contacts {
    /// Carried height of each wheel, metres.
    carried_m: [f64; 4],
}

impl Contacts {
    /// Contacts of a robot that is put down at a pose; `None` over a hole.
    #[must_use]
    pub fn at(world: &World, pose: &Pose) -> Option<Self> {
        let carried_m = ground_m(world, &wheels(pose))?;
        Some(Self { carried_m })
    }

    /// Moves the wheels from a stance to a planar pose about a centimetre away and returns the
    /// stance there.
    ///
    /// # Errors
    /// [`Mishap`]. After an error the contacts are as before.
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
            // On its belly with a wheel in the air the robot has fallen: nothing blocked it.
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

/// Rise of the ground over the contact within one wheel radius along the motion; holes count as 0.
fn rise_ahead_m(world: &World, from: [f64; 2], to: [f64; 2], contact_m: f64) -> f64 {
    let way_m = distance_m(from, to);
    if way_m == 0.0 {
        return 0.0;
    }
    let along = [0, 1].map(|k| (to[k] - from[k]) / way_m);
    rise_along_m(world, to, along, contact_m)
}

/// Rise of the ground over `contact_m` within one wheel radius of a point, along a unit vector.
pub(crate) fn rise_along_m(world: &World, point: [f64; 2], along: [f64; 2], contact_m: f64) -> f64 {
    look_along(world, point, along)
        .map(|height_m| height_m - contact_m)
        .fold(0.0, f64::max)
}

/// Fall of the ground below `contact_m` within one wheel radius of a point, along a unit vector;
/// infinite at a hole.
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

/// Ground heights within one wheel radius of a point, along a unit vector; holes are left out.
fn look_along(world: &World, [x, y]: [f64; 2], along: [f64; 2]) -> impl Iterator<Item = f64> + '_ {
    AHEAD.into_iter().filter_map(move |share| {
        let reach_m = share * WHEEL_RADIUS_M;
        world.ground_m(x + reach_m * along[0], y + reach_m * along[1])
    })
}

/// Returns true if ground that came nearer touches the belly or the leading bumper.
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

/// Returns true if the ground touches the belly or a bumper of a robot in this stance.
pub(crate) fn is_aground(world: &World, stance: &Pose, limits: &Limits) -> bool {
    let bumpers = [BUMPER_M, -BUMPER_M]
        .into_iter()
        .flat_map(|ahead| SIDEWAYS.map(|left| [ahead, left]));
    let meets = |point, free_m| over_plane_m(world, stance, point) > free_m;
    let edge_m = limits.step_m.max(BELLY_M) + SLACK;
    BELLY.into_iter().any(|point| meets(point, BELLY_M))
        || bumpers.into_iter().any(|point| meets(point, edge_m))
}

/// Height of the ground over the plane of the contacts at a point of the robot; −∞ over a hole.
fn over_plane_m(world: &World, stance: &Pose, [ahead, left]: [f64; 2]) -> f64 {
    let [x_m, y_m] = stance.planar_frame().to_world([ahead, left]);
    let plane_m =
        stance.z_m - ahead * libm::tan(stance.pitch_rad) + left * libm::tan(stance.roll_rad);
    world
        .ground_m(x_m, y_m)
        .map_or(f64::NEG_INFINITY, |ground_m| ground_m - plane_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::stand;
    use crate::world::{Class, Elevation, Occupancy};

    /// Ground of 8 × 4 m whose height depends on x, sampled every 2 cm.
    fn ground(height_m: impl Fn(f64) -> f64) -> World {
        let size = [400, 200];
        let elevation = Elevation::from_fn(size, 0.02, [0.0, 0.0], |x, _| height_m(x));
        let floor = Occupancy::filled(size[0], size[1], 0.02, [0.0, 0.0], Class::Free);
        World::uneven("ground", floor, elevation, Vec::new())
    }

    /// Drives from x = 1 m, or back from x = 7 m if `down`; returns the last x and the result.
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
    fn kerbs_up_to_the_limit_are_climbed_and_higher_ones_block() {
        for height_m in [0.02, 0.05, 0.10] {
            assert_eq!(drive(&kerb(height_m), 0.0, false).1, Ok(()), "{height_m}");
        }
        for height_m in [0.12, 0.2, 0.4, 2.0] {
            let (x_m, end) = drive(&kerb(height_m), 0.0, false);
            assert_eq!(end, Err(Mishap::Blocked), "{height_m}");
            // The front axle is 0.134 m ahead, the kerb's ramp begins at 3.99 m, and a wheel is
            // sampled 0.111 m ahead.
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
    fn a_fall_does_not_depend_on_the_sampling_of_the_ground() {
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
            // Half a metre of transition, so that no bumper touches the foot of the slope.
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
        // Across the slope the limit is 25°.
        let across = core::f64::consts::FRAC_PI_2;
        assert_eq!(drive(&slope(24.0), across, false).1, Ok(()));
        assert_eq!(drive(&slope(27.0), across, false).1, Err(Mishap::Tipped));
    }

    #[test]
    fn a_low_stone_passes_under_the_belly_and_a_high_one_blocks() {
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
    fn a_robot_stopped_by_a_kerb_can_back_away() {
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
    fn a_hole_is_a_fall_once_a_wheel_is_over_it_and_never_blocks() {
        let world = ground(|x| if x > 4.0 { f64::NAN } else { 0.0 });
        let (x_m, end) = drive(&world, 0.0, false);
        assert_eq!(end, Err(Mishap::Fallen));
        assert!((3.84..3.87).contains(&x_m), "{x_m}");
    }
}
