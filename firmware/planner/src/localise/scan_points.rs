//! The ends of a level scan's beams in the robot's frame.
//!
//! A beam counts if something came back and a neighbour ended near it: a lone return is false.
//!
//! Units: metres, robot frame.

use heapless::Vec;

use crate::config::MapTuning;
use crate::geometry::{Point, Pose};
use crate::input::has_company;
use crate::map::integrate::level_beams;
use crate::robot::{LaserMount, MAX_BEAMS};

/// Greatest number of points.
const MAX_POINTS: usize = MAX_BEAMS as usize;

/// The points of a scan.
pub(crate) type ScanPoints = Vec<Point, MAX_POINTS>;

/// Returns the points of every `stride`-th beam.
pub(super) fn scan_points(
    laser: &LaserMount,
    ranges_mm: &[u16],
    tuning: &MapTuning,
    stride: usize,
) -> ScanPoints {
    let beams = level_beams(&Pose::default(), laser, ranges_mm, tuning);
    let counts = |number: usize| number.checked_rem(stride) == Some(0);
    beams
        .filter(|beam| beam.hit && counts(beam.number) && has_company(ranges_mm, beam.number))
        .map(|beam| beam.end())
        .take(MAX_POINTS)
        .collect()
}
