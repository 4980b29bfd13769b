//! What scans alone say of a motion: the one under which a scan fits an earlier one best.
//!
//! The search goes over all turns of ±[`MOST_RAD`], or all shifts of ±[`MOST_M`], with the
//! agreement of the planner's own check. A motion that another one, far from it, fits nearly as
//! well is *undecided*: a corridor looks the same all along. Units: metres, radians.

use fieldline_planner::LaserMount;
use fieldline_planner::planner::wiring::agreement::{Shift, agreement};

/// Greatest turn between two scans, radians, and its step.
const MOST_RAD: f32 = 0.9;
const STEP_RAD: f32 = 0.02;
/// Greatest shift between two scans, metres, and its step.
const MOST_M: f32 = 0.6;
const STEP_M: f32 = 0.05;
/// Turns that are tried with each shift.
const TURNS_RAD: [f32; 3] = [-0.04, 0.0, 0.04];
/// Share of the best agreement that another motion must not reach.
const CONTESTED: f32 = 0.97;
/// Another motion is at least so far away: the tolerance of a beam at some metres.
const APART_RAD: f32 = 0.16;
const APART_M: f32 = 0.2;
/// Least agreement.
const LEAST: f32 = 0.4;

/// Two scans of a laser, the earlier one first.
pub(super) type Pair<'a> = (&'a LaserMount, &'a [u16], &'a [u16]);

/// Returns the numbers from −`most` to `most`.
fn grid(most: f32, step: f32) -> impl Iterator<Item = f32> + Clone {
    let count = (most / step).round() as i16;
    (-count..=count).map(move |k| f32::from(k) * step)
}

/// Returns the turn between two scans; `None` if they do not tell.
pub(super) fn turn_rad(scans: Pair<'_>) -> Option<f32> {
    let fits: Vec<(f32, f32)> = grid(MOST_RAD, STEP_RAD)
        .map(|turn_rad| {
            let motion = Shift {
                turn_rad,
                ..Shift::default()
            };
            (turn_rad, agreement(scans, &motion))
        })
        .collect();
    let (turn_rad, best) = fits.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let rivals = |(other, fit): &(f32, f32)| {
        (other - turn_rad).abs() >= APART_RAD && *fit >= CONTESTED * best
    };
    (best >= LEAST && !fits.iter().any(rivals)).then_some(turn_rad)
}

/// Returns the shift between two scans of a robot that turned by about `turn_rad`; `None` if they
/// do not tell.
pub(super) fn shift_m(scans: Pair<'_>, turn_rad: f32) -> Option<[f32; 2]> {
    let fits: Vec<([f32; 2], f32)> = grid(MOST_M, STEP_M)
        .flat_map(|x_m| grid(MOST_M, STEP_M).map(move |y_m| [x_m, y_m]))
        .map(|[x_m, y_m]| {
            let tries = TURNS_RAD.map(|error_rad| {
                let turn_rad = turn_rad + error_rad;
                agreement(scans, &Shift { x_m, y_m, turn_rad })
            });
            ([x_m, y_m], tries.into_iter().fold(0.0, f32::max))
        })
        .collect();
    let (shift, best) = fits.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let rivals = |(other, fit): &([f32; 2], f32)| {
        (other[0] - shift[0]).hypot(other[1] - shift[1]) >= APART_M && *fit >= CONTESTED * best
    };
    (best >= LEAST && !fits.iter().any(rivals)).then_some(shift)
}
