//! A room, a robot that drives and turns in it, and its lidar, cast in f64 beam by beam.
//!
//! Units: metres, radians, seconds; milliseconds where a name says so.

use std::vec::Vec;

use super::super::{Moved, Room, deskew};
use crate::config::Config;
use crate::geometry::{Pose, Twist};
use crate::input::{INVALID_MM, Input, NO_RETURN_MM};
use crate::robot::{LaserMount, MAX_BEAMS};

/// Half of the sides of the room, metres.
const HALF_M: (f64, f64) = (4.0, 3.0);

/// Two beams beside a corner are at most so far apart, metres.
const CORNER_M: f64 = 0.25;

/// A lidar of a full turn that stands aside of the robot's centre.
pub(super) fn round() -> LaserMount {
    LaserMount {
        x_m: 0.2,
        y_m: -0.1,
        first_bearing_rad: -core::f32::consts::PI,
        bearing_step_rad: core::f32::consts::PI / 90.0,
        beams: 180,
        ..LaserMount::level(0.2, 0.3)
    }
    .turning(200)
}

pub(super) fn config(laser: LaserMount) -> Config {
    Config::pioneer_3at([laser].into_iter().collect())
}

/// Returns the pose of the robot so long before now, on an arc.
pub(super) fn pose(now: [f64; 3], [speed, rate]: [f64; 2], age_s: f64) -> [f64; 3] {
    let [x, y, yaw] = now;
    let turn = -rate * age_s;
    let chord = if turn == 0.0 {
        1.0
    } else {
        (0.5 * turn).sin() / (0.5 * turn)
    };
    let (sin, cos) = (yaw + 0.5 * turn).sin_cos();
    let way = -speed * age_s * chord;
    [x + way * cos, y + way * sin, yaw + turn]
}

/// Returns the range from a robot's pose along a beam to the room's walls, metres.
pub(super) fn cast(laser: &LaserMount, [x, y, yaw]: [f64; 3], number: usize) -> f64 {
    let (sin, cos) = yaw.sin_cos();
    let (mount_x, mount_y) = (f64::from(laser.x_m), f64::from(laser.y_m));
    let (x, y) = (
        x + cos * mount_x - sin * mount_y,
        y + sin * mount_x + cos * mount_y,
    );
    let bearing =
        f64::from(laser.first_bearing_rad) + number as f64 * f64::from(laser.bearing_step_rad);
    let (up, along) = (yaw + bearing).sin_cos();
    let to = |place: f64, half: f64, way: f64| (half * way.signum() - place) / way;
    to(x, HALF_M.0, along).min(to(y, HALF_M.1, up))
}

/// Returns the range as a lidar tells it.
pub(super) fn told(laser: &LaserMount, range_m: f64) -> u16 {
    let range_mm = (1000.0 * range_m).round() as u16;
    if range_mm < laser.range_limit_mm {
        range_mm
    } else {
        NO_RETURN_MM
    }
}

/// Returns the share of the turn by which a beam is older than the newest one.
pub(super) fn share(laser: &LaserMount, number: usize) -> f64 {
    let place = number as f64 / f64::from(laser.beams - 1);
    if laser.newest_first {
        place
    } else {
        1.0 - place
    }
}

/// Returns a scan of a robot that moves.
pub(super) fn scan(laser: &LaserMount, now: [f64; 3], twist: [f64; 2]) -> Vec<u16> {
    let turn_s = 1e-3 * f64::from(laser.turn_time_ms);
    (0..usize::from(laser.beams))
        .map(|number| {
            let at = pose(now, twist, turn_s * share(laser, number));
            told(laser, cast(laser, at, number))
        })
        .collect()
}

pub(super) fn narrow([x, y, yaw]: [f64; 3]) -> Pose {
    Pose {
        x_m: x as f32,
        y_m: y as f32,
        yaw_rad: yaw as f32,
        ..Pose::default()
    }
}

/// Returns the motion of 200 ms that ends now.
pub(super) fn moved(config: &Config, now: [f64; 3], twist: [f64; 2]) -> Option<Moved> {
    let then = narrow(pose(now, twist, 0.2));
    Moved::between(config, &(1_000, then), &(1_200, narrow(now)))
}

/// Returns the scan of one instant.
pub(super) fn at_once(config: &Config, ranges_mm: &[u16], moved: Option<&Moved>) -> Vec<u16> {
    let mut room: Room = [[7; MAX_BEAMS as usize]; 2];
    let input = Input {
        time_ms: 0,
        pose: Pose::default(),
        velocity: Twist::default(),
        scans: [ranges_mm, &[]],
    };
    deskew(config, &input, moved, &mut room).scans[0].to_vec()
}

/// Returns how far a scan's ends lie off the walls, the greatest first, metres, and the number of
/// beams without information. Ends beside a corner count as 0.
pub(super) fn off_walls(laser: &LaserMount, now: [f64; 3], ranges_mm: &[u16]) -> (Vec<f64>, usize) {
    let told = ranges_mm.iter().enumerate();
    let off = told.filter(|(_, range)| **range != INVALID_MM);
    let off = off.map(|(number, &range_mm)| {
        let [x, y, yaw] = now;
        let range_m = 1e-3 * f64::from(range_mm);
        let bearing =
            f64::from(laser.first_bearing_rad) + number as f64 * f64::from(laser.bearing_step_rad);
        let (mount_x, mount_y) = (f64::from(laser.x_m), f64::from(laser.y_m));
        let (ahead, left) = (
            mount_x + range_m * bearing.cos(),
            mount_y + range_m * bearing.sin(),
        );
        let (x, y) = (
            x + yaw.cos() * ahead - yaw.sin() * left,
            y + yaw.sin() * ahead + yaw.cos() * left,
        );
        let (aside_x, aside_y) = (x.abs() - HALF_M.0, y.abs() - HALF_M.1);
        // The chord between two beams cuts a corner.
        if aside_x.min(aside_y) > -CORNER_M {
            0.0
        } else {
            aside_x.max(aside_y).abs()
        }
    });
    let holes = ranges_mm.iter().filter(|it| **it == INVALID_MM).count();
    let mut off: Vec<f64> = off.collect();
    off.sort_by(|one, other| other.total_cmp(one));
    (off, holes)
}

/// Numbers that a seed decides, 0 to 1.
pub(super) struct Dice(pub(super) u64);

impl Dice {
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 40) as f64 / f64::from(1 << 24)
    }

    pub(super) fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.next()
    }
}

/// Returns bearing, in steps, and range of a beam's end as seen now, by the equation of the file.
pub(super) fn end_in_f64(
    laser: &LaserMount,
    twist: [f64; 2],
    number: usize,
    range_mm: u16,
) -> (f64, f64) {
    let age = share(laser, number) * f64::from(laser.turn_time_ms) / 200.0;
    let [back_x, back_y, back_yaw] = pose([0.0; 3], twist, 0.2);
    let (sin, cos) = (age * back_yaw).sin_cos();
    let step = f64::from(laser.bearing_step_rad);
    let bearing = f64::from(laser.first_bearing_rad) + number as f64 * step;
    let range_m = 1e-3 * f64::from(range_mm);
    let (mount_x, mount_y) = (f64::from(laser.x_m), f64::from(laser.y_m));
    let (x, y) = (
        mount_x + range_m * bearing.cos(),
        mount_y + range_m * bearing.sin(),
    );
    let (x, y) = (
        age * back_x + cos * x - sin * y - mount_x,
        age * back_y + sin * x + cos * y - mount_y,
    );
    let first = f64::from(laser.first_bearing_rad);
    let at = (y.atan2(x) - first).rem_euclid(2.0 * core::f64::consts::PI) / step;
    (at, x.hypot(y))
}
