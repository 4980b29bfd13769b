//! A log as a session: its start message and its observations.
//!
//! A scan on the wire has at most 181 beams. A log with more keeps every k-th, each at its own
//! angle. The session's laser states these angles, so no beam is turned to another one.
//!
//! A reading beyond the range limit saw nothing, and is free up to it. The limit is 12 m, or the
//! laser's range or the log's greatest reading if that is less: some lasers report their limit for
//! nothing.
//!
//! Units: metres, radians; ranges in millimetres.

use fieldline_protocol::message::{
    INVALID_MM, Laser, MAX_BEAMS, NO_RETURN_MM, Observation, Scan, Start,
};
use fixed::types::{I4F12, I16F16};

use super::carmen::LogScan;
use super::relations::{Pose, compose, inverse};
use crate::robot::{self, Velocity, wrap};

/// Greatest range limit, metres: that of the simulated lasers.
const LIMIT_M: f64 = 12.0;
/// Height of the laser, metres. It does not matter on flat ground.
const HEIGHT_M: f64 = 0.40;
/// Two mounts closer than this are the same, metres and radians.
const SAME: f64 = 2e-3;
/// Farthest mount from the robot's centre, metres.
const FARTHEST_M: f64 = 1.0;

/// The laser of a log, and which of its beams the wire has.
#[derive(Clone, Debug)]
pub struct LogLaser {
    /// As announced to the device.
    pub laser: Laser,
    /// Every so many beams of the log are sent.
    pub stride: usize,
    limit_m: f64,
}

impl LogLaser {
    /// Returns the laser of a log's scans.
    #[must_use]
    pub fn of(scans: &[LogScan]) -> Self {
        let readings = || scans.iter().flat_map(|scan| &scan.ranges);
        let greatest_m = readings().copied().fold(0.0, f64::max);
        let most_m = scans.first().map_or(LIMIT_M, |scan| scan.beams.most_m);
        let limit_m = LIMIT_M
            .min(most_m)
            .min((greatest_m * 1000.0).floor() / 1000.0)
            .max(0.1);
        let beams = scans.first().map_or(1, |scan| scan.ranges.len());
        let stride = beams.div_ceil(MAX_BEAMS);
        let angle = |beam| scans.first().map_or(0.0, |scan| scan.angle(beam));
        let [x, y, _] = mount(scans);
        let laser = Laser {
            x: I4F12::saturating_from_num(x),
            y: I4F12::saturating_from_num(y),
            z: I4F12::from_num(HEIGHT_M),
            pitch: I4F12::ZERO,
            first_bearing: I16F16::from_num(angle(0)),
            bearing_step: I16F16::from_num(angle(stride) - angle(0)),
            beams: beams.div_ceil(stride) as u16,
            range_limit_mm: (limit_m * 1000.0).round() as u16,
        };
        Self {
            laser,
            stride,
            limit_m,
        }
    }

    /// Returns a range for the wire, millimetres or a code.
    fn code(&self, range_m: f64) -> u16 {
        if range_m <= 0.0 {
            INVALID_MM
        } else if range_m >= self.limit_m {
            NO_RETURN_MM
        } else {
            ((range_m * 1000.0).round() as u16).clamp(INVALID_MM + 1, NO_RETURN_MM - 1)
        }
    }

    /// Returns the ends of a scan's beams that met something, in the robot's frame.
    pub fn ends<'a>(&'a self, scan: &'a LogScan) -> impl Iterator<Item = [f64; 2]> + 'a {
        let [x, y]: [f64; 2] = [self.laser.x.to_num(), self.laser.y.to_num()];
        let beams = scan.ranges.iter().enumerate().step_by(self.stride);
        let hits = beams.filter(|(_, range)| **range > 0.0 && **range < self.limit_m);
        hits.map(move |(beam, range)| {
            let (sin, cos) = scan.angle(beam).sin_cos();
            [x + range * cos, y + range * sin]
        })
    }

    /// Returns the observation of a scan, taken at `time_ms` with this odometry.
    #[must_use]
    pub fn observation(&self, scan: &LogScan, time_ms: u32, odometry: Pose) -> Observation {
        let [x_m, y_m, yaw] = odometry;
        let ranges = scan.ranges.iter().step_by(self.stride);
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
        let scan = Scan {
            ranges_mm: ranges.map(|range| self.code(*range)).collect(),
        };
        Observation {
            time_ms,
            pose: pose.to_wire(),
            velocity: velocity.to_wire(),
            scans: [scan].into_iter().collect(),
        }
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
        (0..2).all(|axis| (mount[axis] - first[axis]).abs() < SAME) && wrap(mount[2]).abs() < SAME
    };
    if first[0].hypot(first[1]) < FARTHEST_M && scans.iter().all(is_same) {
        first
    } else {
        [0.0; 3]
    }
}

/// Returns the start message of a session that localises and maps.
#[must_use]
pub fn start(laser: &LogLaser) -> Start {
    Start {
        lasers: [laser.laser].into_iter().collect(),
        robot_radius_mm: 300,
        max_linear: I4F12::lit("0.7"),
        max_angular: I4F12::lit("2.44"),
        linear_accel: I4F12::lit("0.3"),
        angular_accel: I4F12::lit("1.75"),
        period_ms: 200,
        localise: true,
        survey: true,
        ..Start::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::carmen::Beams;
    use super::*;

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

    #[test]
    fn beams_keep_their_angles() {
        for (beams, sent, step_deg, last_deg) in [
            (180, 180, 1.0, 89.0),
            (181, 181, 1.0, 90.0),
            (360, 180, 1.0, 89.0),
            (361, 181, 1.0, 90.0),
            (90, 90, 2.0, 88.0),
        ] {
            let scan = scan(vec![5.0; beams]);
            let laser = LogLaser::of(core::slice::from_ref(&scan));
            let step = laser.laser.bearing_step.to_num::<f64>().to_degrees();
            let first = laser.laser.first_bearing.to_num::<f64>().to_degrees();
            assert_eq!(usize::from(laser.laser.beams), sent);
            assert!((step - step_deg).abs() < 1e-3, "{beams}: {step}");
            assert!((first + 90.0).abs() < 1e-3);
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
        assert_eq!(laser.laser.range_limit_mm, 12_000);
        let ranges = &laser.observation(&scan, 0, [0.0; 3]).scans[0].ranges_mm;
        assert_eq!(ranges[..], [INVALID_MM, 1500, NO_RETURN_MM, 11_900]);
        assert_eq!(laser.ends(&scan).count(), 2);
    }

    #[test]
    fn a_limit_below_12_m_is_the_greatest_reading() {
        let scan = scan(vec![8.191, 2.0, 8.191]);
        let laser = LogLaser::of(core::slice::from_ref(&scan));
        assert_eq!(laser.laser.range_limit_mm, 8191);
        assert_eq!(laser.ends(&scan).count(), 1);
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
