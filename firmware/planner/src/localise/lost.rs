//! Which place a lost robot takes.
//!
//! The search gives the best place and the best one elsewhere. Both are aligned. Where k of n beams
//! on a surface lie within a cell of an obstacle, and k′ at the other:
//!
//! ```text
//! taken:  the scan agrees there,  and  k − k′ ≥ better_share · n  unless both became one place
//! ```
//!
//! So of two places that fit alike none is taken. A hall looks the same from its other end, and a
//! corridor of equal rooms from the next one.
//!
//! Units: metres, radians; cells inside the alignment.

use crate::config::LocaliseTuning;
use crate::geometry::{CELL_M, MapFromOdom, MapPose, Pose};
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
        let aligned = |motion: MapFromOdom| {
            let start = in_cells(&motion.apply(&odom).0);
            let wide = Symmetric::diagonal(WIDE_CELLS, WIDE_CELLS, WIDE_RAD).inverse();
            let wide = wide.unwrap_or_default();
            align(tiles, points, (start, &wide), start, tuning)
        };
        if let Some(found) = clear(found.map(|motion| motion.map(aligned)), tuning) {
            let is_taken = if was_near {
                found.agreement.is_better_than(&here.agreement, tuning)
            } else {
                found.is_agreed(tuning)
            };
            if is_taken {
                return self.accept(&found, predicted);
            }
        }
        if was_near && !here.agreement.is_refuted(tuning) {
            self.trusted_steps = tuning.trusted_steps;
            return self.accept(here, predicted);
        }
        *predicted
    }
}

/// Returns the better one of two places if it fits clearly better, or if both are one.
fn clear(found: [Option<Aligned>; 2], tuning: &LocaliseTuning) -> Option<Aligned> {
    let [Some(a), Some(b)] = found else {
        return found.into_iter().flatten().next();
    };
    let more = a.agreement.excess(&b.agreement);
    let (better, more) = if more < 0.0 { (b, -more) } else { (a, more) };
    let is_one = !are_apart(&place(&a), &place(&b));
    (is_one || more >= tuning.better_share).then_some(better)
}

/// Returns where an alignment has the robot.
fn place(aligned: &Aligned) -> Pose {
    let [x, y, yaw_rad] = aligned.pose;
    Pose {
        x_m: x * CELL_M,
        y_m: y * CELL_M,
        yaw_rad,
        ..Pose::default()
    }
}
