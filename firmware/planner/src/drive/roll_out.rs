//! Roll-out: the short motions of a robot that follows the field from a place, for its own length.
//!
//! A place from which the field leads on can still be a trap: askew before a gap, the robot would
//! turn in it and touch. So a robot that creeps, and the end of a recovery, are judged by what
//! comes next. The roll-out follows the field as the drive does: it turns on the spot where the
//! field leads aside, and in a curve where it nearly leads ahead. Where that touches, it takes
//! another motion ahead.
//!
//! Invariant: every place of a roll-out keeps the margin.
//! Units: metres, radians; robot frame at the start.

use heapless::Vec;

use crate::drive::hull::Place;
use crate::drive::motion::{BACKWARD, FORWARD, LENGTH_M, MOTIONS, TURN_LEFT};
use crate::drive::search_query::SearchQuery;
use crate::math;

/// Length of a roll-out, metres: nearly that of a hull, so that it leads through a wall's gap.
pub(super) const ROLL_M: f32 = 0.45;
/// Maximum number of its motions: half a turn, and 1.2 m straight on.
const MOST_MOTIONS: usize = 64;
/// Greatest error without a curve, and without a turn on the spot, radians.
const STRAIGHT_RAD: f32 = 0.05;
const CURVE_RAD: f32 = 0.3;
/// The field turns by more than this at its goal only, radians.
const GOAL_RAD: f32 = 2.0;

/// The numbers of a roll-out's motions, the first one first.
pub(super) type RollOut = Vec<u8, MOST_MOTIONS>;

/// Returns the roll-out from a place, with the robot's front ahead or its back, and its end. It is
/// at least [`ROLL_M`] long and goes on until `is_far`. Adds to `points` the obstacle points of
/// each checked place.
///
/// # Errors
///
/// The motions as far as they are clear, if the way on comes nearer to an obstacle than the margin,
/// or to a place that is a dead end.
#[inline(never)]
pub(super) fn roll_out<H: Fn(Place) -> Option<f32>>(
    query: &SearchQuery<'_, H>,
    (from, backwards): (Place, bool),
    margin_m: f32,
    points: &mut u32,
    (is_far, is_dead_end): (&dyn Fn(Place) -> bool, &dyn Fn(Place) -> bool),
) -> Result<(RollOut, Place), RollOut> {
    let straight = if backwards { BACKWARD } else { FORWARD };
    let (mut motions, mut place, mut rolled_m) = (RollOut::new(), from, 0.0);
    while (rolled_m < ROLL_M || !is_far(place)) && !motions.is_full() {
        let Some(error) = query.misalignment(place) else {
            break;
        };
        let error = if backwards {
            math::wrap(error + math::PI)
        } else {
            error
        };
        if error.abs() > GOAL_RAD && rolled_m > 0.0 {
            break;
        }
        let step = next(query, place, error, straight, margin_m, points);
        let Some((number, next)) = step.filter(|&(_, next)| !is_dead_end(next)) else {
            return Err(motions);
        };
        if number >= FORWARD {
            rolled_m += LENGTH_M;
        }
        place = next;
        // There is room: the loop ends when it is full.
        let _ = motions.push(number);
    }
    const { assert!(ROLL_M / LENGTH_M < MOST_MOTIONS as f32) };
    if rolled_m > 0.0 {
        Ok((motions, place))
    } else {
        Err(motions)
    }
}

/// Returns the next motion and its end: the one that the field wants, or else the straight one or
/// a curve, as the drive takes the nearest velocity that it can; `None` if all touch.
fn next<H: Fn(Place) -> Option<f32>>(
    query: &SearchQuery<'_, H>,
    place: Place,
    error: f32,
    straight: u8,
    margin_m: f32,
    points: &mut u32,
) -> Option<(u8, Place)> {
    let to_the_right = u8::from(error < 0.0);
    let wanted = if error.abs() > CURVE_RAD {
        TURN_LEFT + to_the_right
    } else if error.abs() > STRAIGHT_RAD {
        straight + 1 + to_the_right
    } else {
        straight
    };
    let others = [
        straight,
        straight + 1 + to_the_right,
        straight + 2 - to_the_right,
    ];
    let mut tried = core::iter::once(wanted).chain(others.into_iter().filter(|&it| it != wanted));
    tried.find_map(|number| {
        let motion = MOTIONS.get(usize::from(number))?;
        let (length_m, turn_rad) = (motion.length_m, motion.turn_rad);
        let checker = query.checker;
        *points += checker.points() * checker.places_on(length_m, turn_rad, margin_m);
        checker
            .is_arc_clear(place, length_m, turn_rad, margin_m)
            .then(|| (number, place.after(length_m, turn_rad)))
    })
}
