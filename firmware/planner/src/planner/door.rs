//! The door: each report of the host is checked once, before anything else of a step reads it.
//!
//! | report | what the door does |
//! | --- | --- |
//! | a number that is not finite, or that no robot reports | refuses it: the robot stands |
//! | a scan without one range per beam | refuses it |
//! | a pose that no robot reaches in the time | takes the odometry to have begun anew |
//! | a clock that stands, or goes back | takes one period to have passed |
//! | a clock that leaps | takes [`MOST_GAP_MS`] to have passed |
//!
//! ```text
//! now  ← now + elapsed                              the session's clock, which begins at 0
//! pose ← correction ∘ odometry                      the session's odometry, which never jumps
//! ```
//!
//! So behind the door time only goes on, the pose moves no farther than a robot can, and a host
//! whose clock wraps gets the same commands as one whose clock does not.
//!
//! Units: metres, radians, seconds; milliseconds where a name says so.

use crate::clock::since;
use crate::config::Config;
use crate::geometry::{MapFromOdom, MapPose, OdomPose, Pose, Twist};
use crate::input::{Input, InputError, InputFaults};
use crate::math;
use crate::planner::deskew::{Moved, Report};

/// Greatest coordinate of the odometry, metres. Farther off, f32 does not resolve a millimetre, and
/// the wire has no room for the sum of odometry and correction.
const MOST_M: f32 = 10_000.0;
/// Greatest yaw, radians: that of the wire.
const MOST_YAW_RAD: f32 = 32_768.0;
/// Greatest roll and pitch, radians: 60°. A robot that leans more has fallen.
const MOST_LEAN_RAD: f32 = math::PI / 3.0;
/// Most time that one step goes on, milliseconds: beyond it nothing that waits for a time waits
/// any longer.
const MOST_GAP_MS: u32 = 60_000;
/// What odometry may jump in any time, metres and radians: the error of kept or late reports.
const JUMP: (f32, f32) = (1.0, 1.0);

/// What the door remembers of the reports before.
#[derive(Debug)]
pub(super) struct Door {
    /// The host's clock and odometry at the last report; `None` before the first.
    last: Option<(u32, Pose)>,
    /// The session's clock.
    now_ms: u32,
    /// The session's odometry, from the host's; `None` until the host's jumps.
    correction: Option<(MapFromOdom, f32)>,
    faults: InputFaults,
}

impl Door {
    /// Returns the door of a new session.
    pub(super) const fn new() -> Self {
        Self {
            last: None,
            now_ms: 0,
            correction: None,
            faults: InputFaults {
                refused: 0,
                jumps: 0,
                clock: 0,
            },
        }
    }

    /// Returns the numbers of reports that were not as they should be.
    pub(super) const fn faults(&self) -> InputFaults {
        self.faults
    }

    /// Returns the last report, if a lidar of this robot turns while the robot moves.
    fn last_report(&self, config: &Config) -> Option<Report> {
        let (_, pose) = self.last.as_ref()?;
        let turns = config.lasers.iter().any(|laser| laser.turn_time_ms > 0);
        turns.then(|| (self.now_ms, self.corrected(pose)))
    }

    /// Notes that a report was refused.
    pub(super) const fn note_refused(&mut self) {
        self.faults.refused = self.faults.refused.saturating_add(1);
    }

    /// Lets a report in: with the session's clock, and the session's odometry. Also tells how the
    /// robot moved since the last one, if a scan needs it and nothing is wrong with either report.
    /// It is called from two places, so it is not inlined.
    ///
    /// # Errors
    /// [`InputError`]: what cannot be used.
    #[inline(never)]
    pub(super) fn admit<'a>(
        &mut self,
        config: &Config,
        input: &Input<'a>,
    ) -> Result<(Input<'a>, Option<Moved>), InputError> {
        if let Err(error) = check(config, input) {
            self.note_refused();
            return Err(error);
        }
        let (before, faults) = (self.last_report(config), self.faults);
        let elapsed_ms = self.elapse(config, input.time_ms);
        self.follow(config, &input.pose, elapsed_ms);
        self.last = Some((input.time_ms, input.pose));
        let now = (self.now_ms, self.corrected(&input.pose));
        let before = before.filter(|_| self.faults == faults);
        let moved = before.and_then(|before| Moved::between(config, &before, &now));
        let (time_ms, pose) = now;
        let admitted = Input {
            time_ms,
            pose,
            velocity: limited(config, input.velocity),
            scans: input.scans,
        };
        Ok((admitted, moved))
    }

    /// Advances the session's clock. Returns by how much.
    fn elapse(&mut self, config: &Config, host_ms: u32) -> u32 {
        let Some((last_ms, _)) = self.last else {
            return 0;
        };
        let elapsed_ms = match since(host_ms, last_ms) {
            0 => config.period_ms(),
            gap_ms => gap_ms.min(MOST_GAP_MS),
        };
        if host_ms != last_ms.wrapping_add(elapsed_ms) {
            self.faults.clock = self.faults.clock.saturating_add(1);
        }
        self.now_ms = self.now_ms.wrapping_add(elapsed_ms);
        elapsed_ms
    }

    /// Corrects the odometry, if it jumped, so that the robot stands where it stood.
    fn follow(&mut self, config: &Config, pose: &Pose, elapsed_ms: u32) {
        let Some((_, last)) = self.last else {
            return;
        };
        let elapsed_s = elapsed_ms as f32 * 1e-3;
        let most = config.sliding_speed();
        let reach_m = JUMP.0 + most.linear_mps * elapsed_s;
        let turn_rad = JUMP.1 + most.angular_radps * elapsed_s;
        let is_far = pose.point().distance2(last.point()) > reach_m * reach_m
            || (pose.z_m - last.z_m).abs() > reach_m
            || math::wrap(pose.yaw_rad - last.yaw_rad).abs() > turn_rad;
        if is_far {
            self.faults.jumps = self.faults.jumps.saturating_add(1);
            let stood = self.corrected(&last);
            let motion = MapFromOdom::between(&OdomPose(*pose), &MapPose(stood));
            self.correction = Some((motion, stood.z_m - pose.z_m));
        }
    }

    /// Returns a pose of the host's odometry in the session's.
    #[inline(never)]
    fn corrected(&self, pose: &Pose) -> Pose {
        let Some((motion, rise_m)) = &self.correction else {
            return Pose {
                yaw_rad: math::wrap(pose.yaw_rad),
                ..*pose
            };
        };
        let MapPose(moved) = motion.apply(&OdomPose(*pose));
        Pose {
            z_m: moved.z_m + rise_m,
            ..moved
        }
    }
}

/// Checks each number of a report by itself.
fn check(config: &Config, input: &Input<'_>) -> Result<(), InputError> {
    let Pose {
        x_m,
        y_m,
        z_m,
        roll_rad,
        pitch_rad,
        yaw_rad,
    } = input.pose;
    let Twist {
        linear_mps,
        angular_radps,
    } = input.velocity;
    let numbers = [
        (x_m, MOST_M),
        (y_m, MOST_M),
        (z_m, MOST_M),
        (roll_rad, MOST_LEAN_RAD),
        (pitch_rad, MOST_LEAN_RAD),
        (yaw_rad, MOST_YAW_RAD),
        (linear_mps, f32::MAX),
        (angular_radps, f32::MAX),
    ];
    for (number, most) in numbers {
        if !number.is_finite() {
            return Err(InputError::NotFinite);
        }
        if number.abs() > most {
            return Err(InputError::OutOfRange);
        }
    }
    let beams = |number: usize| {
        config
            .lasers
            .get(number)
            .map_or(0, |laser| laser.beams.into())
    };
    let fits = |(number, ranges_mm): (usize, &&[u16])| {
        ranges_mm.is_empty() || ranges_mm.len() == beams(number)
    };
    if input.scans.iter().enumerate().all(fits) {
        Ok(())
    } else {
        Err(InputError::Scans)
    }
}

/// Clamps a measured velocity to what a robot that slides can have.
fn limited(config: &Config, velocity: Twist) -> Twist {
    let most = config.sliding_speed();
    let Twist {
        linear_mps,
        angular_radps,
    } = velocity;
    Twist {
        linear_mps: linear_mps.min(most.linear_mps).max(-most.linear_mps),
        angular_radps: angular_radps
            .min(most.angular_radps)
            .max(-most.angular_radps),
    }
}

#[cfg(test)]
mod tests;
