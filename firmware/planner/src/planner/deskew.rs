//! Scans of a lidar that turns while the robot moves, brought to the one instant of the pose.
//!
//! A pose stands for the newest beam of its scan. Of n beams in a turn time T, beam i is older:
//!
//! ```text
//! age(i) = T (n − 1 − i) / (n − 1)        T i / (n − 1) if the first beam is the newest
//! ```
//!
//! In the robot's frame now, its last report was made at b, turned by −φ. Between two reports the
//! robot is taken to have moved evenly. So an end at range r and bearing β of a laser at m lies,
//! as seen from that laser now, at
//!
//! ```text
//! q = f b + R(−f φ) (m + r u(β)) − m        f = age / time between the reports
//! ```
//!
//! The moved ends are put back into the mount's even bearings. Two neighbours are a stretch without
//! a gap if both hit nothing, if both hit things at about the same range, or if one of them lies on
//! the line from the other to the next end. Each bearing between them gets the range of their
//! chord. Any other end goes to the nearest bearing. The least range of a bearing counts, so a
//! no-return never covers a return. A bearing that nothing moved to has no information.
//!
//! A no-return is moved as an end at the range limit, and stays free up to the limit. A lone
//! no-return between two returns is no information, as everywhere.
//!
//! A scan stays as it is, bit for bit, if the turn time is 0, without an earlier report, after a
//! jump of odometry or clock, after more than [`MOST_MS`], and if odometry tells a motion that no
//! robot makes. Units: metres, radians, milliseconds; bearings in steps of the mount.

use crate::config::Config;
use crate::geometry::{Point, Pose};
use crate::input::{INVALID_MM, Input, NO_RETURN_MM, informative_range_mm, is_same_thing};
use crate::math;
use crate::robot::{LaserMount, MAX_BEAMS};

/// Most time between two reports over which the robot is taken to have moved evenly, milliseconds.
const MOST_MS: u32 = 1_000;
/// Most bearings between neighbours of a stretch, steps. It bounds the work of a scan.
const MOST_STEPS: f32 = 4.0;
/// Most angle between neighbours of a stretch, radians. A chord is then right to a part in 800.
const MOST_RAD: f32 = 0.1;

/// A beam between two others ends on their surface if its range differs by less from their chord's,
/// metres.
const FLAT_M: f32 = 0.06;

/// Room for the moved scans of a step.
pub(super) type Room = [[u16; MAX_BEAMS as usize]; 2];

/// The session's clock and its odometry at a report.
pub(super) type Report = (u32, Pose);

/// How the robot moved between two reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moved {
    /// Where the earlier report was made, in the robot's frame now.
    back: Point,
    /// The turn since then.
    turn_rad: f32,
    elapsed_ms: f32,
}

impl Moved {
    /// Returns the motion between two reports; `None` if nothing moved, or if it cannot be told.
    #[inline(never)]
    pub(super) fn between(
        config: &Config,
        (then_ms, then): &Report,
        (now_ms, now): &Report,
    ) -> Option<Self> {
        let elapsed_ms = now_ms.wrapping_sub(*then_ms);
        if elapsed_ms == 0 || elapsed_ms > MOST_MS {
            return None;
        }
        let moved = Self {
            back: now.to_robot(then.point()),
            turn_rad: math::wrap(now.yaw_rad - then.yaw_rad),
            elapsed_ms: elapsed_ms as f32,
        };
        let (most, elapsed_s) = (config.sliding_speed(), moved.elapsed_ms * 1e-3);
        let (most_m, most_rad) = (most.linear_mps * elapsed_s, most.angular_radps * elapsed_s);
        let moves = moved.back != Point::ORIGIN || moved.turn_rad != 0.0;
        let is_possible = moved.back.distance2(Point::ORIGIN) <= most_m * most_m
            && moved.turn_rad.abs() <= most_rad;
        (moves && is_possible).then_some(moved)
    }
}

/// The end of a beam, as seen from the laser at the pose's instant.
#[derive(Clone, Copy, Debug)]
struct End {
    /// Its bearing, steps from the first beam of the mount.
    at: f32,
    /// Its distance, metres.
    range_m: f32,
    /// Its range, millimetres; [`NO_RETURN_MM`] if nothing came back.
    range_mm: u16,
}

impl End {
    /// Returns true if something came back.
    const fn returned(&self) -> bool {
        self.range_mm != NO_RETURN_MM
    }
}

/// The beams of a mount, and the motion under them.
struct Turn<'a> {
    laser: &'a LaserMount,
    ranges_mm: &'a [u16],
    moved: &'a Moved,
    /// A whole turn, steps.
    round: f32,
}

/// Returns an input whose scans are of the pose's instant.
pub(super) fn deskew<'a>(
    config: &Config,
    input: &Input<'a>,
    moved: Option<&Moved>,
    room: &'a mut Room,
) -> Input<'a> {
    let mut input = *input;
    let Some(moved) = moved else {
        return input;
    };
    let places = config.lasers.iter().zip(&mut input.scans).zip(room);
    for ((laser, scan), room) in places {
        if laser.turn_time_ms == 0 {
            continue;
        }
        if let Some(room) = room.get_mut(..scan.len()) {
            Turn::new(laser, scan, moved).write(room);
            *scan = room;
        }
    }
    input
}

impl<'a> Turn<'a> {
    fn new(laser: &'a LaserMount, ranges_mm: &'a [u16], moved: &'a Moved) -> Self {
        Self {
            laser,
            ranges_mm,
            moved,
            round: 2.0 * math::PI / laser.bearing_step_rad,
        }
    }

    /// Writes the moved scan.
    #[inline(never)]
    fn write(&self, scan: &mut [u16]) {
        scan.fill(INVALID_MM);
        let mut ends = [None, None, self.end(0), self.end(1)];
        let mut is_joined = false;
        for number in 0..self.ranges_mm.len() {
            let [_, before, here, after] = ends;
            ends = [before, here, after, self.end(number + 2)];
            let before = before.filter(|_| is_joined);
            is_joined = self.is_stretch(&ends);
            let after = after.filter(|_| is_joined);
            if let Some(end) = &here {
                if let Some(after) = &after {
                    for round in self.rounds() {
                        self.join(scan, (end, after), round);
                    }
                }
                self.put_alone(scan, end, [before, after]);
            }
        }
    }

    /// Returns the age of a beam as a share of the time between the reports.
    fn age(&self, number: usize) -> f32 {
        let last = self.ranges_mm.len().saturating_sub(1).max(1);
        let later = if self.laser.newest_first {
            number
        } else {
            last.saturating_sub(number)
        };
        let turn_ms = f32::from(self.laser.turn_time_ms);
        turn_ms * (later as f32 / last as f32) / self.moved.elapsed_ms
    }

    /// Returns where the end of a beam is now; `None` if the beam carries no information.
    fn end(&self, number: usize) -> Option<End> {
        let limit_mm = self.laser.range_limit_mm;
        let range_mm = informative_range_mm(self.ranges_mm, number, limit_mm)?.min(limit_mm);
        let age = self.age(number);
        let bearing = self.laser.first_bearing_rad + number as f32 * self.laser.bearing_step_rad;
        let (sin, cos) = math::sin_cos(bearing);
        let (turn_sin, turn_cos) = math::sin_cos(-age * self.moved.turn_rad);
        let range_m = f32::from(range_mm) * 1e-3;
        let (x_m, y_m) = (self.laser.x_m, self.laser.y_m);
        let (from_x, from_y) = (x_m + range_m * cos, y_m + range_m * sin);
        let x = age * self.moved.back.x_m + turn_cos * from_x - turn_sin * from_y - x_m;
        let y = age * self.moved.back.y_m + turn_sin * from_x + turn_cos * from_y - y_m;
        let aside = math::atan2(cos * y - sin * x, cos * x + sin * y);
        let range_m = math::sqrt(x * x + y * y);
        Some(End {
            at: number as f32 + aside / self.laser.bearing_step_rad,
            range_m,
            range_mm: if range_mm == limit_mm {
                NO_RETURN_MM
            } else {
                self.code(range_m)
            },
        })
    }

    /// Returns the code of a distance.
    fn code(&self, range_m: f32) -> u16 {
        let range_mm = (range_m * 1e3 + 0.5) as u16;
        if range_mm >= self.laser.range_limit_mm {
            NO_RETURN_MM
        } else {
            range_mm.max(INVALID_MM + 1)
        }
    }

    /// Returns true if nothing else can stand between the second and the third of four ends.
    fn is_stretch(&self, [before, one, other, after]: &[Option<End>; 4]) -> bool {
        let (Some(one), Some(other)) = (one, other) else {
            return false;
        };
        let gap = (other.at - one.at).abs();
        let is_flat = |ends: [Option<&End>; 3]| match ends {
            [Some(one), Some(middle), Some(other)] => is_flat(one, middle, other),
            _ => false,
        };
        gap <= MOST_STEPS
            && gap * self.laser.bearing_step_rad <= MOST_RAD
            && one.returned() == other.returned()
            && (is_same_thing(one.range_mm, other.range_mm)
                || is_flat([before.as_ref(), Some(one), Some(other)])
                || is_flat([Some(one), Some(other), after.as_ref()]))
    }

    /// Writes the chord of a stretch to every bearing between its ends, so much further round.
    #[inline(never)]
    fn join(&self, scan: &mut [u16], (one, other): (&End, &End), round: f32) {
        let gap = other.at - one.at;
        let (first, last) = (one.at.min(other.at), one.at.max(other.at));
        // The least whole number that is not below the first.
        let from = -math::floor(-(first + round));
        let to = math::floor(last + round);
        for number in from.max(0)..=to.min(scan.len() as i32 - 1) {
            let share = if gap == 0.0 {
                0.0
            } else {
                (number as f32 - round - one.at) / gap
            };
            put(scan, number, self.chord(one, other, share));
        }
    }

    /// Returns the code of the chord between two ends, at a share of the angle between them.
    fn chord(&self, one: &End, other: &End, share: f32) -> u16 {
        if one.returned() {
            self.code(chord_m(one, other, share))
        } else {
            NO_RETURN_MM
        }
    }

    /// Writes an end to the nearest bearing, unless a stretch of it has a range there.
    fn put_alone(&self, scan: &mut [u16], end: &End, stretches: [Option<End>; 2]) {
        let nearest = math::floor(end.at + 0.5);
        let aside = nearest as f32 - end.at;
        let has_range = |other: End| aside == 0.0 || aside * (other.at - end.at) > 0.0;
        if stretches.into_iter().flatten().any(has_range) {
            return;
        }
        for round in self.rounds() {
            put(scan, math::floor(end.at + round + 0.5), end.range_mm);
        }
    }

    /// Returns the shifts under which a bearing is the same, steps.
    const fn rounds(&self) -> [f32; 3] {
        [0.0, self.round, -self.round]
    }
}

/// Writes a range to a bearing, if it is less than what is there.
#[inline(never)]
fn put(scan: &mut [u16], number: i32, range_mm: u16) {
    let place = usize::try_from(number).ok().and_then(|it| scan.get_mut(it));
    if let Some(place) = place
        && (*place == INVALID_MM || range_mm < *place)
    {
        *place = range_mm;
    }
}

/// Returns the range of the chord between two ends at a share of the angle between them, metres:
/// for small angles 1 / r is even along a line.
fn chord_m(one: &End, other: &End, share: f32) -> f32 {
    let (near, far) = (one.range_m, other.range_m);
    near * far / (far + share * (near - far))
}

/// Returns true if three neighbouring ends lie on one surface.
#[inline(never)]
fn is_flat(one: &End, middle: &End, other: &End) -> bool {
    let share = (middle.at - one.at) / (other.at - one.at);
    let is_between = share > 0.0 && share < 1.0;
    let all_returned = one.returned() && middle.returned() && other.returned();
    is_between && all_returned && (chord_m(one, other, share) - middle.range_m).abs() < FLAT_M
}

#[cfg(test)]
mod tests;
