//! What a step is given: time, odometry and two scans, and what a single range says.
//!
//! Units: milliseconds, metres, radians; ranges in millimetres.

use crate::geometry::{Pose, Twist};

/// Range code: nothing came back, so free up to the range limit.
pub const NO_RETURN_MM: u16 = 16_383;
/// Range code: no information.
pub const INVALID_MM: u16 = 0;
/// Difference of range within which two adjacent beams hit the same thing, millimetres.
const COMPANY_MM: u16 = 250;

/// What a step is given.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The host's clock, milliseconds.
    pub time_ms: u32,
    /// Odometry.
    pub pose: Pose,
    /// Measured velocity.
    pub velocity: Twist,
    /// Ranges in millimetres of each laser of [`Config::lasers`]; [`NO_RETURN_MM`] and
    /// [`INVALID_MM`] are codes.
    pub scans: [&'a [u16]; 2],
}

/// The range of beam `i` if it says anything: not if it is invalid, nor if it is a dropout, a lone
/// no-return between two returns.
pub(crate) fn informative_range_mm(ranges_mm: &[u16], i: usize, limit_mm: u16) -> Option<u16> {
    let range = *ranges_mm.get(i)?;
    let returned = |k: Option<usize>| {
        k.and_then(|k| ranges_mm.get(k))
            .is_none_or(|&range| range != INVALID_MM && range < limit_mm)
    };
    let dropout = range >= limit_mm && returned(i.checked_sub(1)) && returned(Some(i + 1));
    (range != INVALID_MM && !dropout).then_some(range)
}

/// Whether a beam beside this one ended about as far. Within reach even a pole of 4 cm is hit by
/// two; a lone point is a false return, and one that fell behind the robot would never be seen
/// through.
pub(crate) fn has_company(ranges_mm: &[u16], number: usize) -> bool {
    let range = |k: Option<usize>| k.and_then(|k| ranges_mm.get(k)).copied();
    let here = range(Some(number)).unwrap_or(0);
    let near =
        |beside: Option<u16>| beside.is_some_and(|beside| beside.abs_diff(here) < COMPANY_MM);
    near(range(number.checked_sub(1))) || near(range(Some(number + 1)))
}
