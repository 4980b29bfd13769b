//! Wiring mistakes: what a robot's first day shows, told in its first metre and quarter turn.
//!
//! Three witnesses tell how the robot moved: the command, the odometry, and two scans. A mistake is
//! a *hypothesis*, a motion other than the odometry's that would explain the scans:
//!
//! ```text
//! key scan ──odometry (shift t, turn θ)──► scan          a leg: 0.25 m, or 17°
//! turned: k θ    k = 1 odometry, −1 mirrored, 0 stands, ½ and 2 scaled
//! driven: z t    z = 1 odometry, ±i and −1 laser turned, 0 stands, ½ and 2 scaled
//! gain(h) += Σ max(0, v(h) − v(1))      loss(h) += Σ max(0, v(1) − v(h))      v: `agreement`
//! ```
//!
//! A hypothesis is told if its gain is 15 beams and 4 times its loss, and
//! refuted if it is the other way round. So surroundings that do not tell two motions apart, as a
//! corridor along itself, decide nothing.
//!
//! | scan | command | mistake |
//! | --- | --- | --- |
//! | turns against the odometry | agrees with the odometry | the scan is mirrored |
//! | turns against the odometry | contradicts it | odometry's yaw has the wrong sign |
//! | agrees with the odometry | contradicts it | the wheels are swapped |
//!
//! The same holds for backwards instead of against. If odometry counts nothing, the command is the
//! motion to compare with: a robot that is held has scans that stand.
//!
//! The check only watches, and ends with the mistake, when all hypotheses are refuted, or after
//! [`MOST_LEGS`] legs. Units: metres, radians, milliseconds, beams.

#[cfg(not(feature = "internals"))]
mod agreement;
#[cfg(feature = "internals")]
pub mod agreement;
mod evidence;
#[cfg(test)]
mod tests;

use heapless::Vec;

use crate::clock::since;
use crate::config::Config;
use crate::geometry::{Point, Pose, Twist};
use crate::input::{INVALID_MM, Input};
use crate::math;
use crate::planner::sense::level_scans;
use crate::robot::{LaserMount, MAX_BEAMS};
use crate::status::Mistake;
use agreement::Shift;
use evidence::{Evidence, Obedience, TURNS, WAYS};

/// Turn and way that end a leg, radians and metres: a mirrored turn of that size is 0.6 rad off.
const LEG: (f32, f32) = (0.3, 0.25);
/// Commanded turn and way that end a leg on which odometry counts nothing.
const TOLD_LEG: (f32, f32) = (0.6, 0.25);
/// Least way of a leg that says anything of the way, metres.
const SHORT_M: f32 = 0.12;
/// Share of the command below which odometry counts nothing.
const NOTHING: f32 = 0.1;
/// Greatest turn of a leg that counts as a way, radians.
const STRAIGHT_RAD: f32 = 0.2;
/// Least radius of a curve that counts as a way, metres.
const LEAST_RADIUS_M: f32 = 0.5;
/// Least turn and way before anything is told, radians and metres: 45° and half a metre.
const LEAST: (f32, f32) = (0.78, 0.5);
/// The same for a scan that stands: odometry that leaps makes it seem so for a moment.
const STANDING_LEGS: u8 = 4;
/// Turn and way with and against the command before that is judged, radians and metres.
const OBEYED: (f32, f32) = (0.5, 0.2);
/// A range within this share of the ground's is one of the ground.
const GROUND: f32 = 0.05;
/// Legs after which the check ends undecided.
const MOST_LEGS: u8 = 60;
/// Consecutive reports after which a clock that stands or runs is told.
const CLOCK_REPORTS: u8 = 20;
/// A clock that goes on so many periods in one runs too fast.
const RACING: u32 = 50;
/// A step of the odometry that is longer than the robot slides, and by so much, is a jump, metres.
const LEAP_M: f32 = 0.3;
/// Jumps of the odometry after which it is told, less half of the steps without: one is a restart.
const JUMPS: u8 = 4;

/// The check of the wiring.
#[derive(Debug)]
pub(super) struct Wiring {
    is_over: bool,
    /// The scan that the next ones are compared with, millimetres; empty before the first.
    key: Vec<u16, { MAX_BEAMS as usize }>,
    /// Odometry's pose there.
    key_pose: Pose,
    /// Odometry's pose at the last step; `None` before the first.
    last: Option<(u32, Pose)>,
    /// The last two commands, the latest last.
    told: [Twist; 2],
    /// Way and turn that were commanded since the key scan.
    told_way: (f32, f32),
    turns: Evidence<{ TURNS.len() }>,
    ways: Evidence<{ WAYS.len() }>,
    turned: Obedience,
    driven: Obedience,
    /// Consecutive legs at whose end the level scan had the ground that a tilted laser sees.
    grounds: u8,
    /// The host's clock at the last step.
    host_ms: u32,
    standing: u8,
    racing: u8,
    /// Jumps of the odometry so far, and twice those that count.
    jumps: (u32, u8),
}

impl Wiring {
    /// Returns the check of a new session.
    pub(super) const fn new() -> Self {
        Self {
            is_over: false,
            key: Vec::new(),
            key_pose: Pose::ORIGIN,
            last: None,
            told: [Twist::STILL; 2],
            told_way: (0.0, 0.0),
            turns: Evidence::new(),
            ways: Evidence::new(),
            turned: Obedience::new(),
            driven: Obedience::new(),
            grounds: 0,
            host_ms: 0,
            standing: 0,
            racing: 0,
            jumps: (0, 0),
        }
    }

    /// Notes what the robot is told to drive.
    pub(super) const fn tell(&mut self, velocity: Twist) {
        let [_, last] = self.told;
        self.told = [last, velocity];
    }

    /// Notes that the robot may have been moved by others: a session that is paused.
    pub(super) fn release(&mut self) {
        self.key.clear();
        self.last = None;
        self.told = [Twist::default(); 2];
    }

    /// Takes an input that the door let in, with the host's own clock and the number of jumps of
    /// its odometry. Returns the mistake, once it is certain. A leg ends only in a step that plans
    /// nothing: both are long.
    #[inline(never)]
    pub(super) fn watch(
        &mut self,
        config: &Config,
        input: &Input<'_>,
        (host_ms, jumps): (u32, u32),
        plans: bool,
    ) -> Option<Mistake> {
        if self.is_over || config.survey {
            return None;
        }
        let mistake = self
            .clock(config, host_ms)
            .or_else(|| self.odometry(config, input, jumps))
            .or_else(|| self.scan(config, input, plans));
        self.is_over |= mistake.is_some();
        mistake
    }

    /// Judges the host's clock. One that stands for a moment is a report that came twice.
    fn clock(&mut self, config: &Config, host_ms: u32) -> Option<Mistake> {
        let begins = self.last.is_none();
        let gap_ms = since(host_ms, core::mem::replace(&mut self.host_ms, host_ms));
        if begins {
            return None;
        }
        let count = |counter: &mut u8, is_so: bool| {
            *counter = if is_so { counter.saturating_add(1) } else { 0 };
            *counter >= CLOCK_REPORTS
        };
        let period_ms = config.period_ms();
        let stands = count(&mut self.standing, gap_ms == 0);
        let races = count(&mut self.racing, gap_ms >= RACING * period_ms);
        if stands {
            return Some(Mistake::ClockStands);
        }
        races.then_some(Mistake::ClockFast)
    }

    /// Judges the odometry by itself and by the command.
    fn odometry(&mut self, config: &Config, input: &Input<'_>, jumps: u32) -> Option<Mistake> {
        let last = self.last.replace((input.time_ms, input.pose));
        let jumped = jumps != core::mem::replace(&mut self.jumps.0, jumps);
        let (last_ms, last) = last?;
        let [before, told] = self.told;
        let elapsed_ms = since(input.time_ms, last_ms).min(2 * config.period_ms());
        let elapsed_s = elapsed_ms as f32 * 1e-3;
        let most_m = config.sliding_speed().linear_mps * elapsed_s + LEAP_M;
        let leapt = last.point().distance2(input.pose.point()) > most_m * most_m;
        if jumped || leapt {
            self.key.clear();
            self.jumps.1 = self.jumps.1.saturating_add(2);
            return (self.jumps.1 >= 2 * JUMPS).then_some(Mistake::WayTooLong);
        }
        self.jumps.1 = self.jumps.1.saturating_sub(1);
        let ahead_m = last.to_robot(input.pose.point()).x_m;
        let turn_rad = math::wrap(input.pose.yaw_rad - last.yaw_rad);
        self.driven
            .add([before.linear_mps, told.linear_mps], ahead_m);
        self.turned
            .add([before.angular_radps, told.angular_radps], turn_rad);
        self.told_way.0 += told.angular_radps * elapsed_s;
        self.told_way.1 += told.linear_mps * elapsed_s;
        None
    }

    /// Compares the scan with the key scan at the end of a leg.
    fn scan(&mut self, config: &Config, input: &Input<'_>, plans: bool) -> Option<Mistake> {
        let (laser, ranges_mm) = level_scans(config, input).next()?;
        if is_too_short(laser, ranges_mm) {
            return Some(Mistake::RangesTooShort);
        }
        if ranges_mm.is_empty() || !agreement::is_rich(laser, ranges_mm) {
            return None;
        }
        if self.key.is_empty() {
            self.renew(input, ranges_mm);
            return None;
        }
        let Point { x_m, y_m } = self.key_pose.to_robot(input.pose.point());
        let turn_rad = math::wrap(input.pose.yaw_rad - self.key_pose.yaw_rad);
        let motion = Shift { x_m, y_m, turn_rad };
        let is_moved = turn_rad.abs() >= LEG.0 || motion.length_m() >= LEG.1;
        if plans || (!is_moved && !self.unseen(&motion).0 && !self.unseen(&motion).1) {
            return None;
        }
        self.compare(laser, ranges_mm, &motion);
        self.renew(input, ranges_mm);
        self.grounds = if sees_ground(config, ranges_mm) {
            self.grounds.saturating_add(1)
        } else {
            0
        };
        if self.grounds >= STANDING_LEGS && self.turns.seen >= LEAST.0 {
            return Some(Mistake::LasersSwapped);
        }
        self.judge()
    }

    /// Returns true for the turn, and for the way, if odometry counted nothing of a command that is
    /// long enough for a leg.
    fn unseen(&self, motion: &Shift) -> (bool, bool) {
        let (told_rad, told_m) = (self.told_way.0.abs(), self.told_way.1.abs());
        (
            told_rad >= TOLD_LEG.0 && motion.turn_rad.abs() < NOTHING * told_rad,
            told_m >= TOLD_LEG.1 && motion.length_m() < NOTHING * told_m,
        )
    }

    /// Adds what a leg says of the turn and of the way.
    fn compare(&mut self, laser: &LaserMount, ranges_mm: &[u16], motion: &Shift) {
        let scans = (laser, self.key.as_slice(), ranges_mm);
        let (turns_unseen, drives_unseen) = self.unseen(motion);
        let (turn_rad, way_m) = (motion.turn_rad.abs(), motion.length_m());
        if turn_rad >= LEG.0 && self.turns.legs < MOST_LEGS {
            self.turns.add_turn(scans, motion);
        } else if turns_unseen {
            self.turns.add_unseen_turn(scans, motion, self.told_way.0);
        }
        // In a curve the way counts only if the turn is right and the curve is wide: wheels that
        // turn a robot on the spot slip, and count a way that it did not go.
        let is_wide = self.turns.refutes(1) && way_m >= LEAST_RADIUS_M * turn_rad;
        let is_drive = turn_rad <= STRAIGHT_RAD || is_wide;
        if way_m >= SHORT_M && is_drive && self.ways.legs < MOST_LEGS {
            self.ways.add_way(scans, motion);
        } else if drives_unseen {
            self.ways.add_unseen_way(scans, motion, self.told_way.1);
        }
    }

    /// Begins a leg.
    fn renew(&mut self, input: &Input<'_>, ranges_mm: &[u16]) {
        self.key.clear();
        // A scan has no more beams than there is room.
        let _ = self.key.extend_from_slice(ranges_mm);
        self.key_pose = input.pose;
        self.told_way = (0.0, 0.0);
    }

    /// Returns the mistake that is certain, and ends the check if none is left.
    fn judge(&mut self) -> Option<Mistake> {
        let (turns, ways) = (self.turns.told(LEAST.0), self.ways.told(LEAST.1));
        let (turned, driven) = (self.turned.verdict(OBEYED.0), self.driven.verdict(OBEYED.1));
        let (is_unmirrored, is_ahead) = (
            self.turns.is_unlikely(1, LEAST.0),
            self.ways.is_unlikely(2, LEAST.1),
        );
        let of_turn = match (turns, turned) {
            (Some(1), Some(true)) => Some(Mistake::ScanMirrored),
            (Some(1), Some(false)) => Some(Mistake::YawReversed),
            (Some(1), None) => None,
            (Some(2), _) if self.turns.legs < STANDING_LEGS => None,
            (Some(2), _) => Some(Mistake::ScanStands),
            (Some(3), _) => Some(Mistake::TurnTooGreat),
            (Some(_), _) => Some(Mistake::TurnTooSmall),
            (None, Some(false)) if is_unmirrored => Some(Mistake::TurnsReversed),
            (None, _) => None,
        };
        let of_way = match (ways, driven) {
            (Some(1), _) => Some(Mistake::LaserTurnedRight),
            (Some(2), Some(true)) => Some(Mistake::LaserTurnedBack),
            (Some(2), Some(false)) => Some(Mistake::WayReversed),
            (Some(2), None) => None,
            (Some(3), _) => Some(Mistake::LaserTurnedLeft),
            (Some(4), _) if self.ways.legs < STANDING_LEGS => None,
            (Some(4), _) => Some(Mistake::ScanStands),
            (Some(5), _) => Some(Mistake::WayTooLong),
            (Some(_), _) => Some(Mistake::WayTooShort),
            (None, Some(false)) if is_ahead => Some(Mistake::DriveReversed),
            (None, _) => None,
        };
        let (turn, way) = (self.turns.agrees(LEAST.0), self.ways.agrees(LEAST.1));
        let turn_ends = (turn && turned == Some(true)) || self.turns.legs >= MOST_LEGS;
        let way_ends = (way && driven == Some(true)) || self.ways.legs >= MOST_LEGS;
        // A clock that is wrong is counted for longer than a short drive takes.
        let clock_ends = self.standing == 0 && self.racing == 0;
        self.is_over = turn_ends && way_ends && clock_ends;
        of_turn.or(of_way)
    }
}

/// Returns true if all that returned is nearer than a thousandth of the range.
fn is_too_short(laser: &LaserMount, ranges_mm: &[u16]) -> bool {
    let limit_mm = laser.range_limit_mm;
    let returned = |&&range_mm: &&u16| range_mm != INVALID_MM && range_mm < limit_mm;
    let mut returns = ranges_mm.iter().filter(returned);
    let count = returns.clone().count();
    2 * count >= ranges_mm.len().max(1) && returns.all(|&range_mm| range_mm <= limit_mm / 1000)
}

/// Returns true if a level laser's scan has the line on the ground that a tilted one would see.
/// It turns with the robot, so no wall is taken for it for long.
fn sees_ground(config: &Config, ranges_mm: &[u16]) -> bool {
    let mut tilted = config.lasers.iter().filter(|laser| !laser.is_level());
    let Some(laser) = tilted.next() else {
        return false;
    };
    let (down, _) = math::sin_cos(laser.pitch_rad);
    let (mut on, mut counted) = (0, 0);
    for (number, &range_mm) in ranges_mm.iter().enumerate() {
        let bearing_rad = laser.first_bearing_rad + number as f32 * laser.bearing_step_rad;
        let (_, ahead) = math::sin_cos(bearing_rad);
        let ground_mm = 1000.0 * laser.z_m / (down * ahead).max(1e-3);
        if ground_mm < 0.5 * f32::from(laser.range_limit_mm) {
            counted += 1;
            on += u32::from((f32::from(range_mm) - ground_mm).abs() < GROUND * ground_mm);
        }
    }
    counted > 0 && 5 * on >= 3 * counted
}
