//! A log as a session: its start message and its observations.
//!
//! The scans go on the wire by [`Sectors`]: of a log with more beams than the wire has, neighbours
//! become a sector.
//!
//! A reading beyond the range limit saw nothing, and is free up to it. The limit is 12 m, or the
//! laser's range or the log's greatest reading if that is less: some lasers report their limit for
//! nothing. A robot that the log is said to be of has its own lidar, hull and speeds instead.
//!
//! Units: metres, radians; ranges in millimetres.

use fieldline_protocol::message::{Laser, Observation, Start};
use fixed::types::I4F12;

use super::carmen::{self, LogScan, usual_beams};
use super::relations::{Pose, compose, inverse};
use crate::robot::{self, LaserNoise, Lidar, RobotSpec, Sectors, Sweep, Velocity, wrap};
use crate::sim::announcement;

/// Greatest range limit, metres: that of the simulated lasers.
const LIMIT_M: f64 = 12.0;
/// Height of the laser, metres. It does not matter on flat ground.
const HEIGHT_M: f64 = 0.40;
/// Two mounts closer than this are the same, metres and radians.
const SAME: f64 = 2e-3;
/// Farthest mount from the robot's centre, metres.
const FARTHEST_M: f64 = 1.0;

/// The laser of a log, and how the wire has its beams.
#[derive(Clone, Debug)]
pub struct LogLaser {
    lidar: Lidar,
    sectors: Sectors,
    /// The robot that made the log, if it is known.
    robot: Option<RobotSpec>,
}

impl LogLaser {
    /// Returns the laser of a log's scans.
    #[must_use]
    pub fn of(scans: &[LogScan]) -> Self {
        let readings = || scans.iter().flat_map(|scan| &scan.ranges);
        let measured = readings().copied().filter(|range_m| range_m.is_finite());
        let greatest_m = measured.fold(0.0, f64::max);
        let beams = scans.first().map(|scan| scan.beams);
        let most_m = beams.map_or(LIMIT_M, |beams| beams.most_m);
        let limit_m = LIMIT_M
            .min(most_m)
            .min((greatest_m * 1000.0).floor() / 1000.0)
            .max(0.1);
        let (first_rad, step_rad) = beams.map_or((0.0, 1.0), |it| (it.first_rad, it.step_rad));
        Self::unknown(
            scans,
            &Sweep {
                first_rad,
                step_rad: step_rad.abs(),
                beams: usual_beams(scans).unwrap_or(1),
                most_m: limit_m,
                turn_time_s: 0.0,
            },
            step_rad < 0.0,
        )
    }

    /// Returns the laser of these scans with the sweep that was told: counter-clockwise, of this
    /// range. The mount is the log's.
    ///
    /// # Errors
    /// As [`LogLaser::of_robot`].
    pub fn of_sweep(scans: &[LogScan], sweep: &Sweep) -> Result<Self, String> {
        has_beams(scans, sweep.beams, "--laser has", |usual| {
            format!("give {usual} to --laser")
        })?;
        Ok(Self::unknown(scans, sweep, false))
    }

    /// Returns the laser of a robot that nothing else is known of.
    fn unknown(scans: &[LogScan], sweep: &Sweep, clockwise: bool) -> Self {
        let [x, y, yaw_rad] = mount(scans);
        let lidar = Lidar {
            position_m: [x, y, HEIGHT_M],
            yaw_rad,
            pitch_rad: 0.0,
            upside_down: false,
            clockwise,
            first_rad: sweep.first_rad,
            step_rad: sweep.step_rad,
            beams: sweep.beams,
            turn_time_s: sweep.turn_time_s,
            newest_first: false,
            least_m: 0.0,
            most_m: sweep.most_m,
            noise: LaserNoise::NONE,
            mask: Vec::new(),
            ignores_hull: false,
        };
        Self {
            sectors: Sectors::new(&lidar, &robot::Footprint::PIONEER_3AT),
            lidar,
            robot: None,
        }
    }

    /// Returns the level lidar of a robot that made these scans. Mount, sweep and range are the
    /// robot's, whatever the log tells.
    ///
    /// # Errors
    /// The numbers of beams, if the usual one differs by more than a few, and the remedy.
    pub fn of_robot(scans: &[LogScan], robot: &RobotSpec) -> Result<Self, String> {
        let lidar = robot.lidars.first().cloned();
        let lidar = lidar.ok_or("the robot has no laser; give it one")?;
        has_beams(
            scans,
            lidar.beams,
            &format!("the laser of robot {} has", robot.name),
            |usual| format!("write beams: {usual} into the robot file"),
        )?;
        Ok(Self {
            sectors: Sectors::new(&lidar, &robot.hull),
            lidar,
            robot: Some(robot.clone()),
        })
    }

    /// The lidar, as it was read.
    #[must_use]
    pub const fn lidar(&self) -> &Lidar {
        &self.lidar
    }

    /// Returns the laser as announced to the device.
    #[must_use]
    pub const fn announced(&self) -> &Laser {
        self.sectors.laser()
    }

    /// Returns the ends of a scan's beams that met something, in the robot's frame.
    pub fn ends<'a>(&'a self, scan: &'a LogScan) -> impl Iterator<Item = [f64; 2]> + 'a {
        let laser = self.sectors.laser();
        let [x, y]: [f64; 2] = [laser.x.to_num(), laser.y.to_num()];
        let (right, step) = (self.lidar.rightmost_rad(), self.lidar.step_rad);
        let hits = self.sectors.returns(&scan.ranges);
        hits.map(move |(position, range)| {
            let (sin, cos) = (right + position as f64 * step).sin_cos();
            [x + range * cos, y + range * sin]
        })
    }

    /// Returns the observation of a scan, taken at `time_ms` with this odometry.
    #[must_use]
    pub fn observation(&self, scan: &LogScan, time_ms: u32, odometry: Pose) -> Observation {
        let [x_m, y_m, yaw] = odometry;
        let pose = robot::Pose {
            x_m,
            y_m,
            yaw_rad: wrap(yaw),
            ..robot::Pose::default()
        };
        let velocity = Velocity {
            linear_mps: scan.speed[0],
            angular_radps: scan.speed[1],
        };
        let scan = self.sectors.fold(&scan.ranges);
        Observation {
            time_ms,
            pose: pose.to_wire(),
            velocity: velocity.to_wire(),
            scans: [scan].into_iter().collect(),
        }
    }
}

/// Checks that scans have about this number of beams.
fn has_beams(
    scans: &[LogScan],
    beams: usize,
    whose: &str,
    remedy: impl Fn(usize) -> String,
) -> Result<(), String> {
    match usual_beams(scans) {
        Some(usual) if !carmen::is_near(usual, beams) => Err(format!(
            "the scans have {usual} beams, and {whose} {beams}; {}",
            remedy(usual)
        )),
        _ => Ok(()),
    }
}

/// Returns the laser's pose on the robot: that of the first scan, if it is the same in all scans.
/// A log whose laser poses were corrected has no constant one. Its laser counts as central.
fn mount(scans: &[LogScan]) -> Pose {
    let of = |scan: &LogScan| compose(inverse(scan.odometry), scan.laser);
    let Some(first) = scans.first().map(of) else {
        return [0.0; 3];
    };
    let is_same = |scan: &LogScan| {
        let mount = of(scan);
        (0..2).all(|axis| (mount[axis] - first[axis]).abs() < SAME)
            && wrap(mount[2] - first[2]).abs() < SAME
    };
    if first[0].hypot(first[1]) >= FARTHEST_M || !scans.iter().all(is_same) {
        return [0.0; 3];
    }
    // What is less is the rounding of the log.
    let yaw = wrap(first[2]);
    [first[0], first[1], if yaw.abs() < SAME { 0.0 } else { yaw }]
}

/// Returns the start message of a session that localises and maps.
#[must_use]
pub fn start(laser: &LogLaser) -> Start {
    let body = match &laser.robot {
        Some(robot) => announcement::of_robot(&robot.hull, robot.radius_m, &robot.drive),
        None => unknown_robot(),
    };
    Start {
        lasers: [*laser.announced()].into_iter().collect(),
        period_ms: 200,
        localise: true,
        survey: true,
        ..body
    }
}

/// Returns the body of a robot that nothing is known of.
fn unknown_robot() -> Start {
    Start {
        robot_radius_mm: 300,
        max_linear: I4F12::lit("0.7"),
        max_angular: I4F12::lit("2.44"),
        linear_accel: I4F12::lit("0.3"),
        angular_accel: I4F12::lit("1.75"),
        ..Start::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::carmen::Beams;
    use super::*;
    use fieldline_protocol::message::{INVALID_MM, NO_RETURN_MM};

    fn scan(ranges: Vec<f64>) -> LogScan {
        LogScan {
            line: 1,
            time: 0.0,
            beams: Beams::half_turn(ranges.len()),
            ranges,
            laser: [1.3, 2.0, 0.0],
            odometry: [1.0, 2.0, 0.0],
            speed: [0.0; 2],
        }
    }

    /// A sector of two beams stands half a beam to the left of the first.
    #[test]
    fn beams_and_sectors_have_their_angles() {
        for (beams, sent, step_deg, first_deg, last_deg) in [
            (180, 180, 1.0, -90.0, 89.0),
            (181, 181, 1.0, -90.0, 90.0),
            (360, 180, 1.0, -89.75, 89.25),
            (361, 181, 1.0, -89.75, 90.25),
            (90, 90, 2.0, -90.0, 88.0),
        ] {
            let scan = scan(vec![5.0; beams]);
            let laser = LogLaser::of(core::slice::from_ref(&scan));
            let step = laser.announced().bearing_step.to_num::<f64>().to_degrees();
            let first = laser.announced().first_bearing.to_num::<f64>().to_degrees();
            assert_eq!(usize::from(laser.announced().beams), sent);
            assert!((step - step_deg).abs() < 1e-3, "{beams}: {step}");
            assert!((first - first_deg).abs() < 1e-3);
            let last = first + step * (sent - 1) as f64;
            assert!((last - last_deg).abs() < 0.1, "{beams}: {last}");
            let sent_ranges = &laser.observation(&scan, 0, [0.0; 3]).scans[0].ranges_mm;
            assert_eq!(sent_ranges.len(), sent);
        }
    }

    #[test]
    fn a_reading_beyond_the_limit_saw_nothing_and_one_of_zero_says_nothing() {
        let scan = scan(vec![0.0, 1.5, 81.9, 11.9]);
        let laser = LogLaser::of(core::slice::from_ref(&scan));
        assert_eq!(laser.announced().range_limit_mm, 12_000);
        let ranges = &laser.observation(&scan, 0, [0.0; 3]).scans[0].ranges_mm;
        assert_eq!(ranges[..], [INVALID_MM, 1500, NO_RETURN_MM, 11_900]);
        assert_eq!(laser.ends(&scan).count(), 2);
    }

    #[test]
    fn a_limit_below_12_m_is_the_greatest_reading() {
        let scan = scan(vec![8.191, 2.0, 8.191]);
        let laser = LogLaser::of(core::slice::from_ref(&scan));
        assert_eq!(laser.announced().range_limit_mm, 8191);
        assert_eq!(laser.ends(&scan).count(), 1);
    }

    #[test]
    fn a_robot_brings_its_own_lidar() {
        let scans = [scan(vec![2.0; 450]), scan(vec![2.0; 451])];
        let robot = RobotSpec::open("round-0.35").expect("a preset");
        let laser = LogLaser::of_robot(&scans, &robot).expect("one beam more is no matter");
        for scan in &scans {
            let ranges = &laser.observation(scan, 0, [0.0; 3]).scans[0].ranges_mm;
            assert_eq!(ranges[..], [2000; 150]);
            let ends = laser.ends(scan);
            assert!(
                ends.map(|[x, y]| x.hypot(y))
                    .all(|r| (r - 2.0).abs() < 1e-9)
            );
        }
        assert_eq!(start(&laser).robot_radius_mm, 230);
        let error = LogLaser::of_robot(&[scan(vec![2.0; 360])], &robot).expect_err("too few");
        assert!(error.contains("360") && error.contains("450"), "{error}");
    }

    #[test]
    fn a_constant_place_of_the_laser_is_its_mount() {
        let one = scan(vec![1.0; 2]);
        assert!((mount(core::slice::from_ref(&one))[0] - 0.3).abs() < 1e-9);
        let moved = LogScan {
            laser: [1.4, 2.0, 0.0],
            ..one.clone()
        };
        assert_eq!(mount(&[one, moved]), [0.0; 3]);
    }
}
