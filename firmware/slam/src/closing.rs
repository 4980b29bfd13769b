//! Closing loops: which old keyframe may see what the newest one sees, whether it does, and whether
//! a second closure agrees.
//!
//! 1. **Candidate.** The nearest keyframe that is [`OLD_M`] of way old, within what the way since
//!    the last closure could have cost.
//! 2. **Measurement.** A grid of the keyframes around it, a correlative search, and an alignment.
//!    It counts if most ends are near a wall, and if the alignment stayed where the search ended.
//!    It claims only the directions in which walls hold the scan. So in a bare corridor, where many
//!    places fit, the one nearest to the prediction is taken, and nothing is claimed along it. If
//!    many places fit and each holds the scan in every direction, the rooms are equal, and nothing
//!    is measured.
//! 3. **Agreement.** A closure waits until another one, some way on, moves the newest keyframe by
//!    the same motion. Two such closures enter the graph together; one alone never moves the map. A
//!    closure that the next one contradicts is refused.
//!
//! Units: metres, radians.

use crate::alignment::{BEAM, Prior, align};
use crate::correlation::Reach;
use crate::graph::{Closure, Graph};
use crate::matrix::{Matrix, diagonal, least_eigenvalue, sum, turned};
use crate::pose::Pose;
use crate::scan::{LASERS, Laser, Scan};
use crate::workspace::Workspace;

/// Way after which a keyframe is old, metres.
const OLD_M: f32 = 15.0;
/// Way behind the newest keyframe whose keyframes are no part of a candidate's grid, metres.
const RECENT_M: f32 = 10.0;
/// Way after a closure before the next one is tried, metres.
const REST_M: f32 = 2.0;
/// A candidate's grid holds the keyframes of so much way on each side, metres, and at least so
/// many.
const AROUND: (f32, usize) = (4.0, 8);
/// Least share of ends near a wall.
const LEAST_SHARE: f32 = 0.6;
/// Least information of the position in every direction, beams.
const LEAST_BEAMS: f32 = 3.0;
/// Greatest distance from the search's result to the alignment's, metres.
const SETTLED_M: f32 = 0.3;
/// Information of a search's result, which is no measurement.
const WEAK: Matrix = diagonal([1e-3, 1e-3, 1e-1]);
/// Variances of the keyframes of a grid among themselves: 3 cm, 0.3°.
const AMONG: [f32; 3] = [9e-4, 9e-4, 2.7e-5];
/// Least way between two closures that agree, metres.
const APART_M: f32 = 0.9;
/// Most way between them, metres.
const MOST_APART_M: f32 = 10.0;
/// Greatest difference of the motions of two closures that agree, metres and radians.
const AGREE: (f32, f32) = (0.25, 0.05);

/// A closure that waits for another one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waiting {
    closure: Closure,
    /// The motion that it would give to the newest keyframe, in the map.
    correction: Pose,
    way_m: f32,
}

/// What became of a keyframe's try to close a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tried {
    /// No keyframe is near, or the last closure is too fresh.
    Nothing,
    /// No closure, or one that contradicts the last.
    Refused,
    /// A closure that waits for another.
    Waits,
    /// Two closures that agree: they are in the graph.
    Closed,
}

/// How far a keyframe may be off, and its candidate.
struct Candidate {
    key: usize,
    reach: Reach,
}

/// Tries to close a loop at the newest keyframe, whose scan is given. Without `agreement` one
/// closure is enough.
pub(crate) fn try_to_close<
    const KEYS: usize,
    const LOOPS: usize,
    const BEAMS: usize,
    const SIDE: usize,
>(
    graph: &mut Graph<KEYS, LOOPS, BEAMS>,
    waiting: &mut Option<Waiting>,
    (lasers, scan): (&[Laser; LASERS], &Scan<BEAMS>),
    workspace: &mut Workspace<KEYS, SIDE>,
    agreement: bool,
) -> Tried {
    let Some(newest) = graph.keys.len().checked_sub(1) else {
        return Tried::Nothing;
    };
    let Some(candidate) = candidate(graph, newest) else {
        return Tried::Nothing;
    };
    let Some(found) = measure(graph, newest, &candidate, (lasers, scan), workspace) else {
        return Tried::Refused;
    };
    if !agreement {
        let is_entered = graph.closures.push(found.closure).is_ok();
        return if is_entered {
            Tried::Closed
        } else {
            Tried::Refused
        };
    }
    let agrees = waiting
        .as_ref()
        .map(|last| last.agrees(&found, graph, newest));
    match (waiting.take(), agrees) {
        (Some(last), Some(Agreement::Same)) => {
            let room = graph.closures.capacity() - graph.closures.len();
            if room < 2 {
                return Tried::Refused;
            }
            // There is room for both.
            let _ = graph.closures.push(last.closure);
            let _ = graph.closures.push(found.closure);
            Tried::Closed
        }
        (Some(last), Some(Agreement::TooNear)) => {
            *waiting = Some(last);
            Tried::Waits
        }
        (_, Some(Agreement::Other)) => {
            *waiting = Some(found);
            Tried::Refused
        }
        _ => {
            *waiting = Some(found);
            Tried::Waits
        }
    }
}

/// How two closures compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Agreement {
    Same,
    /// They see the same, so that one is no witness of the other.
    TooNear,
    Other,
}

impl Waiting {
    fn agrees<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
        &self,
        other: &Self,
        graph: &Graph<KEYS, LOOPS, BEAMS>,
        newest: usize,
    ) -> Agreement {
        let Some(here) = graph.pose(newest) else {
            return Agreement::Other;
        };
        let apart_m = other.way_m - self.way_m;
        let difference = (self.correction.compose(&here)).between(&other.correction.compose(&here));
        let is_same = difference.length_m() < AGREE.0 && difference.yaw_rad.abs() < AGREE.1;
        if apart_m > MOST_APART_M || !is_same {
            Agreement::Other
        } else if apart_m < APART_M {
            Agreement::TooNear
        } else {
            Agreement::Same
        }
    }
}

/// Returns the nearest old keyframe within what the way could have cost.
fn candidate<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
    graph: &Graph<KEYS, LOOPS, BEAMS>,
    newest: usize,
) -> Option<Candidate> {
    let here = graph.keys.get(newest)?;
    let last = graph.closures.last();
    let last_m = last.and_then(|last| graph.keys.get(usize::from(last.to)));
    let since_m = here.way_m - last_m.map_or(0.0, |key| key.way_m);
    if last_m.is_some() && since_m < REST_M {
        return None;
    }
    let olds = graph
        .keys
        .iter()
        .take_while(|key| here.way_m - key.way_m >= OLD_M);
    let near = olds.enumerate().filter_map(|(number, key)| {
        let reach_m = (1.0 + 0.04 * since_m.min(here.way_m - key.way_m)).min(6.0);
        let far_m = key.pose.between(&here.pose).length_m();
        (far_m < reach_m).then_some((far_m, number))
    });
    let (_, key) = near.min_by(|(one, _), (other, _)| one.total_cmp(other))?;
    let old_m = since_m.min(here.way_m - graph.keys.get(key)?.way_m);
    Some(Candidate {
        key,
        reach: Reach {
            way_m: (0.5 + 0.03 * old_m).min(4.0),
            turn_rad: (0.06 + 0.004 * old_m).min(0.5),
        },
    })
}

/// Measures the newest keyframe against a candidate. Returns the closure; `None` if the scan does
/// not show it.
fn measure<const KEYS: usize, const LOOPS: usize, const BEAMS: usize, const SIDE: usize>(
    graph: &Graph<KEYS, LOOPS, BEAMS>,
    newest: usize,
    candidate: &Candidate,
    (lasers, scan): (&[Laser; LASERS], &Scan<BEAMS>),
    workspace: &mut Workspace<KEYS, SIDE>,
) -> Option<Waiting> {
    let here = graph.keys.get(newest)?;
    let key = graph.keys.get(candidate.key)?;
    let old = key.pose;
    workspace.grid.clear(&old);
    let before = |way_m: f32| graph.keys.partition_point(|other| other.way_m < way_m);
    let (way_m, number) = (key.way_m, candidate.key);
    let first = before(way_m - AROUND.0).min(number.saturating_sub(AROUND.1));
    let end = before(way_m + AROUND.0).max(number + AROUND.1);
    let end = end.min(before(here.way_m - RECENT_M));
    for key in graph.keys.iter().take(end).skip(first) {
        let scan: Scan<BEAMS> = Scan::of(lasers, &key.ranges_mm);
        workspace.grid.enter(&key.pose, &scan);
    }
    let grid = &workspace.grid;
    let planes = &mut workspace.planes;
    let start = planes.search(grid, scan, &here.pose, candidate.reach)?;
    let start = planes.nearest_alike(scan, &here.pose, candidate.reach, &start);
    let prior = Prior {
        pose: start.pose,
        information: WEAK,
    };
    let found = align(grid, scan, &start.pose, &prior);
    let is_held = least_eigenvalue(&found.held) >= LEAST_BEAMS * BEAM;
    let holds = found.share >= LEAST_SHARE
        && (start.is_only || !is_held)
        && start.pose.between(&found.pose).length_m() < SETTLED_M;
    let information = sum(&found.held, &WEAK);
    holds.then(|| Waiting {
        closure: Closure {
            from: candidate.key as u16,
            to: newest as u16,
            measured: old.between(&found.pose),
            information: softened(&turned(&information, old.yaw_rad)),
        },
        correction: found.pose.compose(&here.pose.inverse()),
        way_m: here.way_m,
    })
}

/// Returns the information with a variance of each axis added.
fn softened(information: &Matrix) -> Matrix {
    let mut scales = [1.0; 3];
    for (k, (scale, variance)) in scales.iter_mut().zip(AMONG).enumerate() {
        let own = information.get(k).and_then(|row| row.get(k));
        *scale = 1.0 / crate::pose::sqrt(1.0 + own.copied().unwrap_or(0.0) * variance);
    }
    let mut out = *information;
    for (row, a) in out.iter_mut().zip(scales) {
        for (cell, b) in row.iter_mut().zip(scales) {
            *cell *= a * b;
        }
    }
    out
}
