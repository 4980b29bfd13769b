//! Which place a lost robot takes.
//!
//! The search gives the best place and the best one elsewhere. Both are aligned. Where k of n beams
//! on a surface lie within a cell of an obstacle, and k′ at the other:
//!
//! ```text
//! far off:   the scan agrees there,  and  k − k′ ≥ better_share · n  unless both became one place
//! near by:   the same against where the robot takes itself to be, whatever is elsewhere
//! ```
//!
//! So of two places that fit alike none is taken. A hall looks the same from its other end, and a
//! corridor of equal rooms from the next one.
//!
//! Units: metres, radians; cells inside the alignment.

use crate::config::LocaliseTuning;
use crate::geometry::MapPose;
use crate::localise::alignment::{Aligned, align};
use crate::localise::scan_points::ScanPoints;
use crate::localise::search::are_apart;
use crate::localise::{Footing, Localiser, Symmetric, in_cells};
use crate::map::Tiles;
use crate::math;

/// Variance of a candidate's place, square cells: it is a cell of a coarse search.
const WIDE_CELLS: f32 = 4.0;
/// Variance of a candidate's yaw, square radians: 3° squared.
const WIDE_RAD: f32 = 2.7e-3;

impl Localiser {
    /// Searches on. Returns the predicted pose until the scan agrees with the map at another one.
    ///
    /// If no place near by is much better, and the scan does not refute this one, then what
    /// contradicts the map came or is a fold of the map: the robot goes on.
    pub(super) fn search<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        points: &ScanPoints,
        (here, predicted): (&Aligned, &MapPose),
        tuning: &LocaliseTuning,
    ) -> MapPose {
        let odom = self.odom();
        let yaw_sd_rad = math::sqrt(self.covariance.tt);
        let Footing::Lost(search) = &mut self.footing else {
            return *predicted;
        };
        let was_near = search.is_near();
        let Some(found) = search.advance(tiles, points, (&odom, predicted), yaw_sd_rad) else {
            return *predicted;
        };
        let found =
            found.map(|motion| Some(candidate(tiles, points, &motion?.apply(&odom), tuning)));
        // Near by, the robot's own place is the one that a candidate must excel.
        let best = if was_near {
            found[0].as_ref()
        } else {
            clear(&found, tuning)
        };
        if let Some(found) = best {
            let is_taken = if was_near {
                found.agreement.is_better_than(&here.agreement, tuning)
            } else {
                found.is_agreed(tuning)
            };
            if is_taken {
                return self.accept(found, predicted);
            }
        }
        if was_near && !here.agreement.is_refuted(tuning) {
            self.trusted_steps = tuning.trusted_steps;
            return self.accept(here, predicted);
        }
        *predicted
    }
}

/// Aligns a scan from a candidate's pose, which is that of a coarse search.
#[inline(never)]
fn candidate<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &ScanPoints,
    pose: &MapPose,
    tuning: &LocaliseTuning,
) -> Aligned {
    let start = in_cells(&pose.0);
    let wide = Symmetric::diagonal(WIDE_CELLS, WIDE_CELLS, WIDE_RAD).inverse();
    align(
        tiles,
        points,
        (start, &wide.unwrap_or_default()),
        start,
        tuning,
    )
}

/// Returns the better one of two places if it fits clearly better, or if both are one.
fn clear<'a>(found: &'a [Option<Aligned>; 2], tuning: &LocaliseTuning) -> Option<&'a Aligned> {
    let [Some(a), Some(b)] = found else {
        return found.iter().flatten().next();
    };
    let more = a.agreement.excess(&b.agreement);
    let better = if more < 0.0 { b } else { a };
    (more.abs() >= tuning.better_share || !are_apart(&a.pose, &b.pose)).then_some(better)
}
