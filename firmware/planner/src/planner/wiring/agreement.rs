//! How well a scan fits an earlier one under a motion of the robot.
//!
//! ```text
//! q = t + R(θ) p            p: a beam's end now, q: where it lies in the earlier scan
//! d = |ρ(q) − r(β(q))| cos  r: the earlier range at q's bearing, cos: of its surface
//! v = max(0, 1 − d / (near + slope ρ))
//! ```
//!
//! A beam that leaves the earlier scan's field of view, or that meets a beam without information,
//! says nothing. One that ends where the earlier scan saw nothing up to its range contradicts it.
//!
//! All lies in the laser's frame. Units: metres, radians; ranges in millimetres.

use heapless::Vec;

use crate::input::{INVALID_MM, has_company};
use crate::math::{self, PI};
use crate::robot::LaserMount;

use super::{LEG, STRAIGHT_RAD};

/// Greatest number of beams that are compared.
const MOST_BEAMS: usize = 48;
/// Least number of them.
const LEAST_BEAMS: usize = 16;
/// Distance at which a beam no longer agrees, metres, and what a metre of range adds to it.
const NEAR: (f32, f32) = (0.10, 0.03);
/// Two neighbours whose ranges differ by less than this share are of one surface.
const SURFACE: f32 = 0.1;
/// Errors of a turn that are tried, radians.
const TRIES: [f32; 7] = [-0.15, -0.1, -0.05, 0.0, 0.05, 0.1, 0.15];

/// A motion of the robot: its shift in its frame before, and its turn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shift {
    /// Metres ahead.
    pub x_m: f32,
    /// Metres to the left.
    pub y_m: f32,
    /// Radians, counter-clockwise.
    pub turn_rad: f32,
}

impl Shift {
    /// Returns true if the way is as long as a leg, and nearly straight.
    pub(super) fn is_straight(&self) -> bool {
        self.length_m() >= LEG.1 && self.turn_rad.abs() <= STRAIGHT_RAD
    }

    /// Returns the length of the way, metres.
    pub(super) fn length_m(&self) -> f32 {
        math::sqrt(self.x_m * self.x_m + self.y_m * self.y_m)
    }
}

/// A laser, its earlier scan and its present one.
pub type Scans<'a> = (&'a LaserMount, &'a [u16], &'a [u16]);

/// How well each beam agrees, 0 to 100; `None` if it says nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct Values(Vec<Option<u8>, MOST_BEAMS>);

impl Values {
    /// Returns the beams that agree better here than there, and those that agree better there.
    pub(super) fn against(&self, other: &Self) -> (f32, f32) {
        let (mut more, mut less) = (0.0, 0.0);
        for pair in self.0.iter().zip(&other.0) {
            if let (Some(here), Some(there)) = pair {
                let lead = (f32::from(*here) - f32::from(*there)) * 0.01;
                if lead > 0.0 {
                    more += lead;
                } else {
                    less -= lead;
                }
            }
        }
        (more, less)
    }

    /// Returns those of the two that agree better.
    pub(super) fn better(self, other: Self) -> Self {
        if other.mean() > self.mean() {
            other
        } else {
            self
        }
    }

    /// Returns the mean agreement; 0 with too few beams.
    fn mean(&self) -> f32 {
        let told = || self.0.iter().flatten();
        let count = told().count();
        if count < LEAST_BEAMS {
            return 0.0;
        }
        told().map(|&value| f32::from(value)).sum::<f32>() / count as f32
    }
}

/// Returns the beams of a scan that count, evenly spread.
fn beams<'a>(laser: &LaserMount, ranges_mm: &'a [u16]) -> impl Iterator<Item = (usize, f32)> + 'a {
    let (limit_mm, stride) = (laser.range_limit_mm, ranges_mm.len().div_ceil(MOST_BEAMS));
    let beams = ranges_mm.iter().enumerate().step_by(stride.max(1));
    let returned = move |&(number, range_mm): &(usize, &u16)| {
        *range_mm != INVALID_MM && *range_mm < limit_mm && has_company(ranges_mm, number)
    };
    beams
        .filter(returned)
        .map(|(number, &range_mm)| (number, f32::from(range_mm) * 1e-3))
}

/// Returns true if a scan has beams enough to compare.
pub(super) fn is_rich(laser: &LaserMount, ranges_mm: &[u16]) -> bool {
    beams(laser, ranges_mm).count() >= LEAST_BEAMS
}

/// Returns how well the beams agree under the best of the motions near this one.
#[inline(never)]
pub(super) fn best(scans: Scans<'_>, motion: &Shift) -> Values {
    let mut best = Values::default();
    for error_rad in TRIES {
        let found = values(
            scans,
            &Shift {
                turn_rad: motion.turn_rad + error_rad,
                ..*motion
            },
        );
        best = best.better(found);
    }
    best
}

/// Returns how well two scans agree under a motion, 0 to 1; 0 if fewer than 16 beams say anything.
#[cfg(feature = "internals")]
#[must_use]
pub fn agreement(scans: Scans<'_>, motion: &Shift) -> f32 {
    0.01 * values(scans, motion).mean()
}

/// Returns how well the beams agree under a motion.
#[inline(never)]
fn values((laser, key_mm, ranges_mm): Scans<'_>, motion: &Shift) -> Values {
    let (sin, cos) = math::sin_cos(motion.turn_rad);
    // The laser goes around the robot's centre.
    let from = (
        motion.x_m + cos * laser.x_m - sin * laser.y_m - laser.x_m,
        motion.y_m + sin * laser.x_m + cos * laser.y_m - laser.y_m,
    );
    let mut values = Values::default();
    for (number, range_m) in beams(laser, ranges_mm) {
        let bearing_rad = laser.first_bearing_rad + number as f32 * laser.bearing_step_rad;
        let (s, c) = math::sin_cos(bearing_rad + motion.turn_rad);
        let end = (from.0 + range_m * c, from.1 + range_m * s);
        let _ = values.0.push(value(laser, key_mm, end));
    }
    values
}

/// Returns how well a place agrees with a scan, 0 to 100; `None` if it says nothing.
fn value(laser: &LaserMount, key_mm: &[u16], (x, y): (f32, f32)) -> Option<u8> {
    let range_m = math::sqrt(x * x + y * y);
    let bearing_rad = math::atan2(y, x) - laser.first_bearing_rad;
    let bearing_rad = bearing_rad - 2.0 * PI * math::floor(bearing_rad / (2.0 * PI)) as f32;
    let at = bearing_rad / laser.bearing_step_rad;
    let number = usize::try_from(math::floor(at)).ok()?;
    let is_told = |&&range_mm: &&u16| range_mm != INVALID_MM;
    let right = key_mm.get(number).filter(is_told)?;
    let left = key_mm.get(number + 1).filter(is_told).unwrap_or(right);
    let limit_mm = laser.range_limit_mm;
    if *right.min(left) >= limit_mm {
        // Nothing stood there.
        let limit_m = f32::from(limit_mm) * 1e-3;
        return (range_m < 0.9 * limit_m).then_some(0);
    }
    let part = at - number as f32;
    let (right, left) = (f32::from(*right) * 1e-3, f32::from(*left) * 1e-3);
    let gap = left - right;
    let (there_m, cos) = if gap.abs() < SURFACE * right.min(left) {
        let there_m = right + part * gap;
        let slope = gap / (there_m * laser.bearing_step_rad);
        (there_m, 1.0 / math::sqrt(1.0 + slope * slope))
    } else if (range_m - right).abs() < (range_m - left).abs() {
        (right, 1.0)
    } else {
        (left, 1.0)
    };
    let off = (range_m - there_m).abs() * cos / (NEAR.0 + NEAR.1 * range_m);
    Some((100.0 * (1.0 - off).max(0.0)) as u8)
}
