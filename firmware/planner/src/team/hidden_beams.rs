//! Beams that end on a peer: they carry no information, so a peer is never entered into the map.
//!
//! The hull in which a beam may end is grown by what is not known of its place:
//!
//! ```text
//! grown by   2 sd + (0.1 + 0.3 · age in s, at most 2 s) m
//! ```
//!
//! With a rough start this is several metres, and a wall there ends as many beams as the peer. So
//! things that are larger than the peer, grown by all but the 2 sd, count as the map's (measured:
//! docs/MEASURED.md, "Walls where a peer may be").
//!
//! The obstacle points of a peer whose place is known stay only as long as they are in view.
//!
//! Units: millimetres of range, metres, seconds, radians.

use heapless::Vec;

use crate::geometry::{Point, Pose, RobotFrame};
use crate::input::INVALID_MM;
use crate::math;
use crate::robot::{LaserMount, MAX_BEAMS};
use crate::team::hull::Hull;
use crate::team::peers::{Peer, Peers};

/// Growth of a hull: the noise of a range and of a pose, and its rate.
const GROWTH_M: f32 = 0.1;
const GROWTH_MPS: f32 = 0.3;
const MOST_GROWING_S: f32 = 2.0;
/// Ends of neighbouring beams that are farther apart lie on two things, metres.
pub(super) const GAP_M: f32 = 0.25;

/// Beams by their numbers, with their ends in the robot's frame.
type Ends = Vec<(usize, Point), { MAX_BEAMS as usize }>;

/// Where a beam may end on a peer.
struct Place {
    hull: Hull,
    /// The greatest size of a thing there that may be the peer, metres.
    size_m: f32,
}

impl Place {
    fn of(peer: &Peer, now_ms: u32) -> Self {
        let age_s = peer.silence_ms(now_ms) as f32 * 1e-3;
        let sd_m = f32::from(peer.beacon.sd_cm) * 0.01;
        let grown_m = GROWTH_M + GROWTH_MPS * age_s.min(MOST_GROWING_S);
        Self {
            hull: Hull::of(peer, now_ms, 2.0 * sd_m + grown_m),
            size_m: 2.0 * Hull::of(peer, now_ms, grown_m).radius_m(),
        }
    }

    /// Returns the beams of a scan that end here.
    fn ends(&self, pose: &Pose, laser: &LaserMount, ranges_mm: &[u16]) -> Ends {
        let frame = RobotFrame::of(pose);
        let from = Point {
            x_m: laser.x_m,
            y_m: laser.y_m,
        };
        let (_, cos_pitch) = math::sin_cos(laser.pitch_rad);
        let centre = frame.to_robot(self.hull.centre);
        let (dx, dy) = (centre.x_m - from.x_m, centre.y_m - from.y_m);
        let distance_m = math::sqrt(dx * dx + dy * dy);
        let radius_m = self.hull.radius_m();
        let bearing_rad = math::wrap(math::atan2(dy, dx) - laser.first_bearing_rad);
        // The arc sine of x is at most π/2 · x.
        let half_rad = if distance_m > radius_m {
            0.5 * math::PI * radius_m / distance_m
        } else {
            math::PI
        };
        let end = |(number, range_mm): (usize, &u16)| {
            let beam_rad = number as f32 * laser.bearing_step_rad;
            let range_m = f32::from(*range_mm) * 1e-3;
            let may_end = *range_mm != INVALID_MM
                && *range_mm < laser.range_limit_mm
                && range_m <= distance_m + radius_m
                && math::wrap(beam_rad - bearing_rad).abs() <= half_rad;
            if !may_end {
                return None;
            }
            let (sin, cos) = math::sin_cos(laser.first_bearing_rad + beam_rad);
            let end = Point {
                x_m: from.x_m + range_m * cos * cos_pitch,
                y_m: from.y_m + range_m * sin,
            };
            self.hull.holds(frame.to_map(end)).then_some((number, end))
        };
        let ends = ranges_mm.iter().enumerate().filter_map(end);
        ends.take(MAX_BEAMS.into()).collect()
    }

    /// Returns true if a thing with these ends may be the peer.
    fn may_hold(&self, thing: &[(usize, Point)]) -> bool {
        extent_m(thing.iter().map(|(_, end)| *end)) <= self.size_m
    }
}

/// Returns the distance from the first to the last of a thing's ends, metres.
pub(super) fn extent_m(mut ends: impl DoubleEndedIterator<Item = Point>) -> f32 {
    let first_and_last = ends.next().zip(ends.next_back());
    first_and_last.map_or(0.0, |(first, last)| first.distance_m(last))
}

impl Peers {
    /// Makes the beams of a scan that end on a peer invalid. Not inlined: the ends lie on the stack
    /// only here.
    #[inline(never)]
    pub(crate) fn hide(&self, now_ms: u32, pose: &Pose, laser: &LaserMount, ranges_mm: &mut [u16]) {
        for place in self.iter().map(|peer| Place::of(peer, now_ms)) {
            let ends = place.ends(pose, laser, ranges_mm);
            let things = ends.chunk_by(|(_, a), (_, b)| a.distance_m(*b) <= GAP_M);
            for (number, _) in things.filter(|thing| place.may_hold(thing)).flatten() {
                if let Some(range_mm) = ranges_mm.get_mut(*number) {
                    *range_mm = INVALID_MM;
                }
            }
        }
    }

    /// Returns the hulls of the peers whose place is known, as a beam sees them.
    pub(crate) fn seen(&self, now_ms: u32) -> impl Iterator<Item = Hull> {
        self.placed().map(move |peer| Place::of(peer, now_ms).hull)
    }

    /// Returns true if a peer may be in the view of a laser.
    pub(crate) fn may_be_seen(&self, now_ms: u32, pose: &Pose, lasers: &[LaserMount]) -> bool {
        let range_mm = lasers.iter().map(|laser| laser.range_limit_mm).max();
        let range_m = f32::from(range_mm.unwrap_or(0)) * 1e-3;
        let mut hulls = self.iter().map(|peer| Place::of(peer, now_ms).hull);
        hulls.any(|hull| hull.centre.distance_m(pose.point()) <= range_m + hull.radius_m())
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::input::NO_RETURN_MM;
    use crate::team::hull::tests::{peers, peers_known_to};

    const LASER: LaserMount = LaserMount::level(0.1, 0.4);
    const NONE: [usize; 0] = [];

    /// Returns the numbers of the beams of a wall at a range that are hidden.
    fn hidden(peers: &Peers, range_mm: u16, now_ms: u32) -> Vec<usize> {
        let mut ranges_mm = [range_mm; 181];
        peers.hide(now_ms, &Pose::default(), &LASER, &mut ranges_mm);
        let gone = ranges_mm
            .iter()
            .enumerate()
            .filter(|(_, mm)| **mm == INVALID_MM);
        gone.map(|(number, _)| number).collect()
    }

    #[test]
    fn only_beams_that_end_in_the_peer_are_hidden() {
        let peers = peers(2.0, 0.0, 0.0);
        // Its front is 1.64 m from the laser; 0.1 m of growth.
        assert_eq!(hidden(&peers, 1_500, 0), NONE);
        let seen = hidden(&peers, 1_700, 0);
        assert_eq!((seen.first(), seen.last()), (Some(&79), Some(&101)));
        assert_eq!(hidden(&peers, 2_400, 0), NONE, "behind the peer");
        assert_eq!(hidden(&peers, NO_RETURN_MM, 0), NONE);
        assert!(
            hidden(&peers, 1_400, 2_000).len() > 20,
            "grown after a silence"
        );
    }

    /// A peer 15 m from its start, which is known to 0.3 m and 5°, may be anywhere in a room.
    #[test]
    fn a_wall_where_a_peer_may_be_is_no_peer() {
        let peers = peers_known_to(130, 2.0, 0.0, 0.0);
        assert_eq!(hidden(&peers, 2_000, 0), NONE);
        // A robot stands before the wall.
        let mut ranges_mm = [2_000; 181];
        ranges_mm[60..80].fill(1_500);
        peers.hide(0, &Pose::default(), &LASER, &mut ranges_mm);
        let is_hidden = |range_mm: &u16| *range_mm == INVALID_MM;
        assert!(ranges_mm[60..80].iter().all(is_hidden));
        assert_eq!(ranges_mm.into_iter().filter(is_hidden).count(), 20);
    }

    /// Obstacle points out of view stay where a peer is not known to be.
    #[test]
    fn only_a_peer_whose_place_is_known_is_seen() {
        let count = |sd_cm| peers_known_to(sd_cm, 2.0, 0.0, 0.0).seen(0).count();
        assert_eq!([0, 15, 16, 130].map(count), [1, 1, 0, 0]);
    }

    #[test]
    fn a_peer_beside_the_view_or_beyond_the_range_is_not_looked_for() {
        let sees = |peers: &Peers| peers.may_be_seen(0, &Pose::default(), &[LASER]);
        assert!(sees(&peers(0.0, 3.0, 0.0)));
        assert!(!sees(&peers(0.0, 30.0, 0.0)));
    }
}
