//! Wheels that slip: the scan decides where a step took the robot.
//!
//! Gauss–Newton reaches a wall within a cell of a beam's end, and a step at full speed is longer.
//! So a robot whose wheels spin on the spot, or that moves while they stand, needs a start that
//! odometry does not give. Two more predictions take the last pose p and the last step δ:
//!
//! ```text
//! odometry p₀ = p ⊕ (odom⁻¹ ⊕ odom′), aligned      it stood p₁ = p      it went on p₂ = p ⊕ δ
//! gain = Σ w(r₀) r₀² − w(rₖ) rₖ²         over the beams that tell the two apart
//! ```
//!
//! w and r are those of the alignment. A prediction is taken if its gain is the greatest and over
//! `slip_price`, which is twice the logarithm of how seldom wheels slip. Without a slip standing
//! gains about −100. If the robot does stand, it gains 6 to 20 in a corridor, more in a room.
//!
//! Odometry is aligned before it is compared. Without that the other two fit better wherever
//! odometry errs across a corridor, and then nothing holds the pose along it (measured:
//! docs/MEASURED.md, "Odometry aligned before a slip is judged").
//!
//! A beam tells two predictions apart if its ends differ across their surface. So a wall along
//! which the robot drives, and that is seen for the first time, speaks for none. Without an
//! obstacle within a cell r is 1, also in unknown space: a beam that seems to end behind a wall
//! contradicts it.
//!
//! A scan comes each period, and no slip is longer than a robot slides in one. A longer step has
//! left scans out. Then the map holds little of what the new scan sees: in a corridor the last scan
//! is all of it, and it fits best where it was taken. So a step that long is never taken for a
//! slip.
//!
//! Units: map cells, radians; metres for poses.

use crate::config::{Config, LocaliseTuning};
use crate::geometry::Pose;
use crate::localise::alignment::{Frame, weight};
use crate::localise::motion::Motion;
use crate::localise::occupancy::occupancy;
use crate::localise::scan_points::ScanPoint;
use crate::map::Tiles;
use crate::map::neighbourhood::Neighbourhood;
use crate::math;

/// Ends that differ less across their surface are the same, cells: the alignment reaches one from
/// the other.
const SAME_CELLS: f32 = 0.5;

/// Returns where a robot is that stood, and one that went on with its last motion; `None` if
/// odometry's step is longer than a slip. If the second is too far from odometry, it is the first.
pub(super) fn predictions(
    config: &Config,
    (before, odometry): (&Pose, &Pose),
    last: &Motion,
) -> Option<[Pose; 2]> {
    let went_on = Some(last.from(before)).filter(|pose| is_slip(config, odometry, pose));
    is_slip(config, odometry, before).then(|| [*before, went_on.unwrap_or(*before)])
}

/// Returns true if a robot that slides gets from one pose to the other in a period. It is asked for
/// twice, so it is not inlined.
#[inline(never)]
fn is_slip(config: &Config, from: &Pose, to: &Pose) -> bool {
    let (speed, period_s) = (config.sliding_speed(), config.period_s);
    let (reach_m, turn_rad) = (speed.linear_mps * period_s, speed.angular_radps * period_s);
    to.point().distance2(from.point()) <= reach_m * reach_m
        && math::wrap(to.yaw_rad - from.yaw_rad).abs() <= turn_rad
}

/// Returns the place of the prediction that the scan makes likelier than all others and than
/// odometry's; `None` if odometry's is the likeliest.
#[inline(never)]
pub(super) fn likelier<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &[ScanPoint],
    odometry: [f32; 3],
    others: [[f32; 3]; 2],
    tuning: &LocaliseTuning,
) -> Option<usize> {
    let here = Frame::of(odometry);
    let frames = others.map(Frame::of);
    let mut near = Neighbourhood::of(tiles);
    let mut cost = |end| {
        let r = occupancy(&mut near, end).map_or(1.0, |found| 1.0 - found.value);
        weight(r, tuning) * r * r
    };
    let mut gains = [0.0; 2];
    for point in points {
        let (_, from) = here.reach(point);
        let normal = point.normal.map(|normal| here.turn(normal));
        let mut cost_here = None;
        for (gain, there) in gains.iter_mut().zip(&frames) {
            let (_, to) = there.reach(point);
            if apart2(normal, from, to) >= SAME_CELLS * SAME_CELLS {
                *gain += *cost_here.get_or_insert_with(|| cost(from)) - cost(to);
            }
        }
    }
    let mut best = (tuning.slip_price, None);
    for (place, gain) in gains.into_iter().enumerate() {
        if gain > best.0 {
            best = (gain, Some(place));
        }
    }
    best.1
}

/// Returns the squared distance of two ends of a beam across its surface.
fn apart2(normal: Option<(f32, f32)>, from: (f32, f32), to: (f32, f32)) -> f32 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    match normal {
        None => dx * dx + dy * dy,
        Some((x, y)) => (x * dx + y * dy) * (x * dx + y * dy),
    }
}
