//! Reports as a host may send them, and what the door makes of them.

use super::{Door, MOST_GAP_MS};
use crate::config::Config;
use crate::geometry::{Pose, Twist};
use crate::input::{Input, InputError, InputFaults};
use crate::robot::LaserMount;

/// Metres and radians by which rounding may move a corrected pose.
const ROUNDING: f32 = 1e-4;

/// A door, and the host in front of it.
struct Host {
    door: Door,
    config: Config,
}

impl Host {
    fn new() -> Self {
        let lasers = [LaserMount::level(0.10, 0.40)].into_iter().collect();
        Self {
            door: Door::new(),
            config: Config::pioneer_3at(lasers),
        }
    }

    /// Reports a pose; returns the session's clock and pose.
    fn report(&mut self, time_ms: u32, pose: Pose) -> Result<(u32, Pose), InputError> {
        self.report_all(time_ms, pose, Twist::default(), &[])
            .map(|(time_ms, pose, _)| (time_ms, pose))
    }

    /// Reports a pose; returns true if the robot's motion since the last report is known.
    fn knows_motion(&mut self, time_ms: u32, pose: Pose) -> bool {
        let input = Input {
            time_ms,
            pose,
            velocity: Twist::default(),
            scans: [&[], &[]],
        };
        let admitted = self.door.admit(&self.config, &input);
        admitted.is_ok_and(|(_, moved)| moved.is_some())
    }

    fn report_all(
        &mut self,
        time_ms: u32,
        pose: Pose,
        velocity: Twist,
        ranges_mm: &[u16],
    ) -> Result<(u32, Pose, Twist), InputError> {
        let input = Input {
            time_ms,
            pose,
            velocity,
            scans: [ranges_mm, &[]],
        };
        let (admitted, _) = self.door.admit(&self.config, &input)?;
        Ok((admitted.time_ms, admitted.pose, admitted.velocity))
    }
}

const fn at(x_m: f32, y_m: f32, yaw_rad: f32) -> Pose {
    Pose {
        x_m,
        y_m,
        z_m: 0.0,
        roll_rad: 0.0,
        pitch_rad: 0.0,
        yaw_rad,
    }
}

fn is_near(found: &Pose, expected: &Pose) -> bool {
    let apart = [
        found.x_m - expected.x_m,
        found.y_m - expected.y_m,
        found.z_m - expected.z_m,
        found.yaw_rad - expected.yaw_rad,
    ];
    apart.iter().all(|apart| apart.abs() < ROUNDING)
}

#[test]
fn an_ordinary_report_passes_bit_for_bit() {
    let mut host = Host::new();
    for k in 0..20 {
        let pose = at(0.1 * k as f32, -0.05 * k as f32, 0.3 - 0.02 * k as f32);
        assert_eq!(host.report(200 * k, pose), Ok((200 * k, pose)));
    }
    assert_eq!(host.door.faults(), InputFaults::default());
}

#[test]
fn no_number_that_is_not_finite_passes() {
    let spoil: [fn(&mut Pose, &mut Twist, f32); 8] = [
        |pose, _, number| pose.x_m = number,
        |pose, _, number| pose.y_m = number,
        |pose, _, number| pose.z_m = number,
        |pose, _, number| pose.roll_rad = number,
        |pose, _, number| pose.pitch_rad = number,
        |pose, _, number| pose.yaw_rad = number,
        |_, velocity, number| velocity.linear_mps = number,
        |_, velocity, number| velocity.angular_radps = number,
    ];
    let mut host = Host::new();
    for spoil in spoil {
        for number in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (mut pose, mut velocity) = (Pose::default(), Twist::default());
            spoil(&mut pose, &mut velocity, number);
            let refused = host.report_all(0, pose, velocity, &[]);
            assert_eq!(refused, Err(InputError::NotFinite), "{pose:?} {velocity:?}");
        }
    }
    assert_eq!(host.door.faults().refused, 24);
}

#[test]
fn what_no_robot_reports_is_refused_and_the_session_goes_on() {
    let mut host = Host::new();
    assert!(host.report(0, Pose::default()).is_ok());
    let fallen = Pose {
        roll_rad: -1.3,
        ..Pose::default()
    };
    for pose in [at(1e30, 0.0, 0.0), at(0.0, -4e4, 0.0), fallen] {
        assert_eq!(host.report(200, pose), Err(InputError::OutOfRange));
    }
    for beams in [1, 180, 182] {
        let short = host.report_all(200, Pose::default(), Twist::default(), &[9; 182][..beams]);
        assert_eq!(short, Err(InputError::Scans), "{beams} beams");
    }
    let whole = host.report_all(200, Pose::default(), Twist::default(), &[9; 181]);
    assert_eq!(whole, Ok((200, Pose::default(), Twist::default())));
    assert_eq!(host.door.faults().refused, 6);
}

#[test]
fn a_clock_that_begins_anywhere_or_wraps_gives_the_same_times() {
    for first_ms in [0, 17_000, 1 << 31, u32::MAX - 700, u32::MAX] {
        let mut host = Host::new();
        for k in 0..10 {
            let found = host.report(first_ms.wrapping_add(200 * k), Pose::default());
            assert_eq!(found.map(|(time_ms, _)| time_ms), Ok(200 * k));
        }
        assert_eq!(host.door.faults().clock, 0);
    }
}

#[test]
fn a_clock_that_stands_or_goes_back_counts_a_period_and_one_that_leaps_a_minute() {
    let mut host = Host::new();
    let times = [5_000, 5_000, 4_000, 4_200, 4_200 + 3_600_000, 0, 200];
    let found = times.map(|time_ms| host.report(time_ms, Pose::default()).unwrap().0);
    let after = 600 + MOST_GAP_MS;
    assert_eq!(found, [0, 200, 400, 600, after, after + 200, after + 400]);
    assert_eq!(host.door.faults().clock, 4);
}

#[test]
fn odometry_that_begins_anew_goes_on_where_the_robot_stood() {
    let mut host = Host::new();
    let stood = at(12.0, -7.0, 1.5);
    assert!(host.report(0, stood).is_ok());
    // The odometry begins anew at its origin, and the robot drives 0.1 m ahead.
    let (_, anew) = host.report(200, Pose::default()).unwrap();
    assert!(is_near(&anew, &stood), "{anew:?}");
    let (_, ahead) = host.report(400, at(0.1, 0.0, 0.0)).unwrap();
    let (sin, cos) = 1.5_f32.sin_cos();
    let expected = at(12.0 + 0.1 * cos, -7.0 + 0.1 * sin, 1.5);
    assert!(is_near(&ahead, &expected), "{ahead:?}");
    assert_eq!(host.door.faults().jumps, 1);
}

#[test]
fn a_jump_and_back_leaves_the_pose_where_it_was() {
    let mut host = Host::new();
    let stood = at(3.0, 4.0, -2.0);
    for (time_ms, pose) in [
        (0, stood),
        (200, at(900.0, 4.0, -2.0)),
        (400, stood),
        (600, at(3.0, 4.0, 1.0)),
        (800, stood),
        (
            1_000,
            Pose {
                z_m: 300.0,
                ..stood
            },
        ),
    ] {
        let (_, found) = host.report(time_ms, pose).unwrap();
        assert!(is_near(&found, &stood), "{time_ms} ms: {found:?}");
    }
    assert_eq!(host.door.faults().jumps, 5);
}

#[test]
fn behind_the_door_no_robot_is_faster_than_it_can_be() {
    let mut host = Host::new();
    let seed = &mut 1_u32;
    let mut random = || {
        *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        // −1 to 1.
        *seed as i32 as f32 / (1_u32 << 31) as f32
    };
    let mut last = None;
    for k in 0..20_000 {
        let wide = if k % 3 == 0 { 9e3 } else { 2.0 };
        let pose = at(wide * random(), wide * random(), wide * random());
        let velocity = Twist {
            linear_mps: 9.0 * random(),
            angular_radps: 9.0 * random(),
        };
        let found = host.report_all(200 * k, pose, velocity, &[]);
        let (_, pose, velocity) = found.unwrap();
        let speed = host.config.max_speed();
        assert!(velocity.linear_mps.abs() <= 2.0 * speed.linear_mps);
        assert!(velocity.angular_radps.abs() <= 2.0 * speed.angular_radps);
        let from: Pose = last.replace(pose).unwrap_or(pose);
        let moved_m = pose.point().distance_m(from.point());
        // A correction of f32 at 30 km rounds by millimetres.
        assert!(moved_m <= 1.0 + 2.0 * 0.7 * 0.2 + 0.02, "{moved_m} m");
    }
}

/// The beams of a scan are moved by the motion since the last report, so both must be right.
#[test]
fn a_motion_is_known_between_two_right_reports() {
    let mut host = Host::new();
    let lasers = [LaserMount::level(0.10, 0.40).turning(200)];
    host.config = Config::pioneer_3at(lasers.into_iter().collect());
    assert!(!host.knows_motion(0, at(0.0, 0.0, 0.0)), "the first one");
    assert!(host.knows_motion(200, at(0.1, 0.0, 0.0)));
    assert!(
        !host.knows_motion(400, at(50.0, 0.0, 0.0)),
        "odometry began anew"
    );
    assert!(host.knows_motion(600, at(50.1, 0.0, 0.0)));
    assert!(
        !host.knows_motion(300, at(50.2, 0.0, 0.0)),
        "the clock went back"
    );
    assert!(
        !host.knows_motion(90_000, at(50.3, 0.0, 0.0)),
        "the clock leapt"
    );
    assert!(host.knows_motion(90_200, at(50.4, 0.0, 0.1)));
    assert!(
        !host.knows_motion(90_400, at(f32::NAN, 0.0, 0.1)),
        "refused"
    );
    assert!(host.knows_motion(90_600, at(50.5, 0.0, 0.1)));
    assert!(!host.knows_motion(90_800, at(50.5, 0.0, 0.1)), "it stands");
    host.config = Config::pioneer_3at([LaserMount::level(0.10, 0.40)].into_iter().collect());
    assert!(
        !host.knows_motion(91_000, at(50.6, 0.0, 0.1)),
        "no scan needs it"
    );
}
