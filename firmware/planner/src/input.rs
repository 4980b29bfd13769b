//! The input of a step: time, odometry and two scans. Also the rules for a single range.
//!
//! Units: milliseconds, metres, radians; ranges in millimetres.

use core::fmt;

use crate::geometry::{Pose, Twist};

/// Range code in place of millimetres: nothing came back, so the beam was free up to the range
/// limit.
pub const NO_RETURN_MM: u16 = 16_383;
/// Range code in place of millimetres: the beam carries no information.
pub const INVALID_MM: u16 = 0;
/// Two adjacent beams whose ranges differ by less than this hit the same thing, millimetres.
const SAME_THING_MM: u16 = 250;

/// The input of a step.
///
/// A step checks it. What cannot be used is refused ([`InputError`]), and what is doubtful is
/// counted ([`InputFaults`]).
///
/// ```
/// use fieldline_planner::{INVALID_MM, Input, MAX_BEAMS, NO_RETURN_MM, Pose, Twist};
///
/// // A wall 3 m away; the first beam is broken, and the last one saw nothing.
/// let mut ranges_mm = [3_000; MAX_BEAMS as usize];
/// ranges_mm[0] = INVALID_MM;
/// ranges_mm[180] = NO_RETURN_MM;
/// let input = Input {
///     time_ms: 200,
///     pose: Pose { x_m: 0.1, ..Pose::default() },
///     velocity: Twist { linear_mps: 0.5, angular_radps: 0.0 },
///     scans: [&ranges_mm, &[]],
/// };
/// # assert_eq!(input.scans[0].len(), 181);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The host's clock, milliseconds. It may begin anywhere, and it may wrap.
    pub time_ms: u32,
    /// Odometry, at the instant of the newest beam.
    pub pose: Pose,
    /// Measured velocity.
    pub velocity: Twist,
    /// Ranges of each laser of [`Config::lasers`](crate::Config::lasers), millimetres, one a beam;
    /// none if the laser has no scan now. [`NO_RETURN_MM`] and [`INVALID_MM`] are codes.
    pub scans: [&'a [u16]; 2],
}

/// Why a report of the host was not used.
///
/// ```
/// use fieldline_planner::InputError;
///
/// assert_eq!(InputError::NotFinite.to_string(), "a number is not finite");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputError {
    /// A number of pose or velocity is NaN or infinite.
    NotFinite,
    /// A coordinate is beyond 10,000 m, the yaw beyond 32,768 rad, or the robot leans by more than
    /// 60°.
    OutOfRange,
    /// A scan has not one range per beam of its laser, or there is no such laser.
    Scans,
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a number is not finite",
            Self::OutOfRange => "a pose is out of range",
            Self::Scans => "a scan has not one range per beam",
        })
    }
}

impl core::error::Error for InputError {}

/// Numbers of reports since the start of the session that were not as they should be.
///
/// ```
/// # use fieldline_planner::{Config, F405, LaserMount, Planner, RobotShape};
/// use fieldline_planner::{Input, InputError, InputFaults, Pose, Twist};
///
/// # let config = Config::builder(RobotShape::PIONEER_3AT)
/// #     .laser(LaserMount::level(0.10, 0.40))
/// #     .build()?;
/// let mut planner = Box::new(Planner::<F405>::new(&config));
/// let output = planner.step(&Input {
///     time_ms: 0,
///     pose: Pose { x_m: f32::NAN, ..Pose::default() },
///     velocity: Twist::default(),
///     scans: [&[2_000; 181], &[]],
/// });
/// assert_eq!(output.velocity, Twist::default());
/// assert_eq!(output.refused, Some(InputError::NotFinite));
/// assert_eq!(planner.input_faults(), InputFaults { refused: 1, ..InputFaults::default() });
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputFaults {
    /// Number of reports that were refused ([`InputError`]): no step was made of them.
    pub refused: u32,
    /// Number of poses that no robot reaches in the time: the odometry was taken to have begun anew
    /// where the robot stood.
    pub jumps: u32,
    /// Number of times that were no later than the one before, or later by more than a minute.
    pub clock: u32,
}

/// Returns the range of beam `i`, millimetres; `None` if it is invalid or a dropout. A dropout is a
/// lone no-return between two returns.
pub(crate) fn informative_range_mm(ranges_mm: &[u16], i: usize, limit_mm: u16) -> Option<u16> {
    let range = *ranges_mm.get(i)?;
    let returned = |k: Option<usize>| {
        k.and_then(|k| ranges_mm.get(k))
            .is_none_or(|&range| range != INVALID_MM && range < limit_mm)
    };
    let dropout = range >= limit_mm && returned(i.checked_sub(1)) && returned(Some(i + 1));
    (range != INVALID_MM && !dropout).then_some(range)
}

/// Returns true if a neighbour of this beam ended at about its range.
///
/// Two beams hit even a pole of 4 cm within reach, so a lone return is false. A false point behind
/// the robot would stay for ever, because no beam passes through it.
pub(crate) fn has_company(ranges_mm: &[u16], number: usize) -> bool {
    let Some(&here) = ranges_mm.get(number) else {
        return false;
    };
    let is_near = |beside: usize| {
        let beside = ranges_mm.get(beside);
        beside.is_some_and(|&beside| is_same_thing(beside, here))
    };
    is_near(number.wrapping_sub(1)) || is_near(number + 1)
}

/// Returns true if two adjacent beams of these ranges hit the same thing.
pub(crate) const fn is_same_thing(one_mm: u16, other_mm: u16) -> bool {
    one_mm.abs_diff(other_mm) < SAME_THING_MM
}
