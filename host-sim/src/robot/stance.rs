//! The stance of the robot: height, roll and pitch from the ground under its four wheels.
//!
//! ```text
//! z     = mean of the four
//! pitch = atan((rear − front) / wheelbase)
//! roll  = atan((left − right) / track)
//! ```
//!
//! with the means of the two wheels at each end and side. This is the least-squares plane through
//! the four contacts: a chassis on four stiff wheels touches with at most three of them. A wheel
//! touches at the point under its axle; a real wheel is round and meets an edge a little earlier.
//! Over a hole there is no stance. Metres, radians.

use super::pose::Pose;
use crate::world::World;

/// Distance between the axles of the 3-AT, metres.
const WHEELBASE_M: f64 = 0.268;
/// Distance between the wheels of an axle, metres.
const TRACK_M: f64 = 0.394;
/// Wheel contacts, as shares of half the wheelbase (ahead) and of half the track (left).
const WHEELS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];

/// Contact points of the four wheels: front left, front right, rear left, rear right.
#[must_use]
pub(crate) fn wheels(pose: &Pose) -> [[f64; 2]; 4] {
    let frame = pose.planar_frame();
    WHEELS.map(|[ahead, left]| {
        let (x, y) = (0.5 * WHEELBASE_M * ahead, 0.5 * TRACK_M * left);
        frame.to_world([x, y])
    })
}

/// The ground under the four wheels, metres; `None` if one of them has none.
#[must_use]
pub(crate) fn ground_m(world: &World, wheels: &[[f64; 2]; 4]) -> Option<[f64; 4]> {
    let mut heights_m = [0.0; 4];
    for (height_m, [x_m, y_m]) in heights_m.iter_mut().zip(wheels) {
        *height_m = world.ground_m(*x_m, *y_m)?;
    }
    Some(heights_m)
}

/// The stance at a planar pose; `None` if a wheel has no ground under it.
#[must_use]
pub fn stand(world: &World, pose: &Pose) -> Option<Pose> {
    if world.elevation().is_none() {
        return Some(Pose {
            z_m: 0.0,
            roll_rad: 0.0,
            pitch_rad: 0.0,
            ..*pose
        });
    }
    Some(resting(pose, ground_m(world, &wheels(pose))?))
}

/// The stance at a planar pose on ground of these heights under the wheels.
#[must_use]
pub(crate) fn resting(pose: &Pose, heights_m: [f64; 4]) -> Pose {
    let [front_left, front_right, rear_left, rear_right] = heights_m;
    let fall = 0.5 * (rear_left + rear_right - front_left - front_right);
    let lean = 0.5 * (front_left + rear_left - front_right - rear_right);
    Pose {
        z_m: 0.25 * (front_left + front_right + rear_left + rear_right),
        pitch_rad: libm::atan(fall / WHEELBASE_M),
        roll_rad: libm::atan(lean / TRACK_M),
        ..*pose
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Class, Elevation, Occupancy};

    /// Ground of 8 × 4 m that rises along x by 0.2 m per metre, with a hole from x = 6 m.
    fn slope() -> World {
        let ground = Elevation::from_fn([80, 40], 0.1, [0.0, 0.0], |x, _| {
            if x > 6.0 { f64::NAN } else { 0.2 * (x - 0.05) }
        });
        let floor = Occupancy::filled(80, 40, 0.1, [0.0, 0.0], Class::Free);
        World::uneven("slope", floor, ground, Vec::new())
    }

    fn at(x_m: f64, yaw_rad: f64) -> Pose {
        Pose {
            x_m,
            y_m: 2.0,
            yaw_rad,
            ..Pose::default()
        }
    }

    #[test]
    fn uphill_lifts_the_nose_and_across_the_slope_the_robot_leans() {
        let world = slope();
        let angle = 0.2_f64.atan();
        let up = stand(&world, &at(3.0, 0.0)).expect("ground");
        assert!((up.pitch_rad + angle).abs() < 1e-9 && up.roll_rad.abs() < 1e-9);
        // The first sample, at x = 0.05, lies at 0.
        assert!((up.z_m - 0.2 * 2.95).abs() < 1e-9, "{}", up.z_m);
        let down = stand(&world, &at(3.0, core::f64::consts::PI)).expect("ground");
        assert!((down.pitch_rad - angle).abs() < 1e-9);
        // Facing along y the higher ground is on the right.
        let across = stand(&world, &at(3.0, core::f64::consts::FRAC_PI_2)).expect("ground");
        assert!((across.roll_rad + angle).abs() < 1e-9 && across.pitch_rad.abs() < 1e-9);
        // Its forward axis lies on the slope.
        let [forward, ..] = up.axes();
        assert!((forward[2] / forward[0] - 0.2).abs() < 1e-9);
    }

    #[test]
    fn there_is_no_stance_over_a_hole() {
        assert!(stand(&slope(), &at(5.7, 0.0)).is_some());
        assert_eq!(stand(&slope(), &at(5.95, 0.0)), None);
    }
}
