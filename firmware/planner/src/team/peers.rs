//! The other robots of the team, as their last beacons told.
//!
//! - A peer that was silent for [`SILENT_MS`] has no claims: its goal and road are nobody's.
//! - Its last footprint stays an obstacle until [`FORGOTTEN_MS`]. Then it is an ordinary thing,
//!   which scans may enter into the map.
//! - Of two packets of a peer the one with the greater number counts, so a late one changes
//!   nothing. A greater boot is a new life of the same robot.
//!
//! Units: milliseconds of the robot's own clock, metres.

use heapless::Vec;

use crate::clock::since;
use crate::config::Member;
use crate::geometry::{Point, Pose};
use crate::math;
use crate::team::packet::Beacon;

/// Greatest number of peers: a team of eight.
pub const MOST_PEERS: usize = 7;
/// Silence after which a peer has no claims, milliseconds: ten beacons.
pub(crate) const SILENT_MS: u32 = 2_000;
/// Silence after which a peer is forgotten, milliseconds.
pub(crate) const FORGOTTEN_MS: u32 = 20_000;
/// A position is not predicted for longer than this, seconds: the peer may have stopped.
const MOST_PREDICTED_S: f32 = 1.0;

/// A peer as its last beacon told.
#[derive(Clone, Debug)]
pub struct Peer {
    /// Who it is.
    pub member: Member,
    /// Number of its last packet.
    sequence: u16,
    /// Standard deviation of its place in the team's coordinates, centimetres.
    pub(crate) said_sd_cm: u8,
    /// When its last beacon was heard.
    pub heard_ms: u32,
    /// The beacon, in the coordinates of this robot's map.
    pub beacon: Beacon,
}

impl Peer {
    /// Returns the radius of the hull's circle, metres.
    pub(crate) fn radius_m(&self) -> f32 {
        let (length, width) = self.beacon.half_cm;
        let (length_m, width_m) = (f32::from(length) * 0.01, f32::from(width) * 0.01);
        math::sqrt(length_m * length_m + width_m * width_m)
    }

    /// Returns the time since the last beacon, milliseconds.
    #[must_use]
    pub const fn silence_ms(&self, now_ms: u32) -> u32 {
        since(now_ms, self.heard_ms)
    }

    /// Returns true if the peer's claims hold: its goal and its road.
    #[must_use]
    pub const fn has_claims(&self, now_ms: u32) -> bool {
        self.silence_ms(now_ms) <= SILENT_MS
    }

    /// Returns the pose that the peer has now if it drove on as it said.
    #[inline(never)]
    #[must_use]
    pub fn pose(&self, now_ms: u32) -> Pose {
        let age_s = (self.silence_ms(now_ms) as f32 * 1e-3).min(MOST_PREDICTED_S);
        let (velocity, pose) = (self.beacon.velocity, self.beacon.pose());
        let turn_rad = velocity.angular_radps * age_s;
        let half_turned = Pose {
            yaw_rad: pose.yaw_rad + 0.5 * turn_rad,
            ..pose
        };
        let Point { x_m, y_m } = half_turned.to_map(Point {
            x_m: velocity.linear_mps * age_s,
            y_m: 0.0,
        });
        Pose {
            x_m,
            y_m,
            yaw_rad: pose.yaw_rad + turn_rad,
            ..pose
        }
    }
}

/// The peers.
#[derive(Debug)]
pub struct Peers {
    peers: Vec<Peer, MOST_PEERS>,
}

impl Peers {
    /// Returns no peers.
    pub(crate) const fn new() -> Self {
        Self { peers: Vec::new() }
    }

    /// Returns the peers.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Peer> {
        self.peers.iter()
    }

    /// Takes a beacon. In a full store the peer that was silent longest gives way.
    pub(crate) fn hear(&mut self, from: Member, sequence: u16, beacon: &Beacon, now_ms: u32) {
        let peer = Peer {
            member: from,
            sequence,
            said_sd_cm: beacon.sd_cm,
            heard_ms: now_ms,
            beacon: beacon.clone(),
        };
        if let Some(known) = self.peers.iter_mut().find(|peer| peer.member.id == from.id) {
            let is_newer = if known.member.boot == from.boot {
                is_after(sequence, known.sequence)
            } else {
                is_after(from.boot, known.member.boot)
            };
            if is_newer {
                *known = peer;
            }
            return;
        }
        if self.peers.is_full() {
            let silence = |(_, peer): &(usize, &Peer)| peer.silence_ms(now_ms);
            let longest = self.peers.iter().enumerate().max_by_key(silence);
            if let Some((index, _)) = longest {
                self.peers.swap_remove(index);
            }
        }
        // There is room now.
        let _ = self.peers.push(peer);
    }

    /// Notes the standard deviation that a peer said of its place. That of its beacon in this
    /// robot's map is greater.
    pub(crate) fn note_sd(&mut self, from: Member, said_sd_cm: u8) {
        if let Some(peer) = self.peers.iter_mut().find(|peer| peer.member == from) {
            peer.said_sd_cm = said_sd_cm;
        }
    }

    /// Forgets the peers that were silent for too long.
    pub(crate) fn forget_silent(&mut self, now_ms: u32) {
        self.peers
            .retain(|peer| peer.silence_ms(now_ms) <= FORGOTTEN_MS);
    }
}

/// Returns true if one wrapping number comes after another.
const fn is_after(number: u16, other: u16) -> bool {
    number != other && number.wrapping_sub(other) < 0x8000
}

#[cfg(test)]
mod tests {
    use super::{FORGOTTEN_MS, Peers, SILENT_MS};
    use crate::config::Member;
    use crate::geometry::Twist;
    use crate::team::packet::Beacon;

    const PEER: Member = Member { id: 3, boot: 1 };

    fn at(x_cm: i16) -> Beacon {
        Beacon {
            position_cm: (x_cm, 0),
            ..Beacon::default()
        }
    }

    fn place(peers: &Peers) -> i16 {
        peers.iter().next().expect("a peer").beacon.position_cm.0
    }

    #[test]
    fn late_and_doubled_beacons_change_nothing() {
        let mut peers = Peers::new();
        for (sequence, x_cm) in [
            (65_535, 1),
            (0, 2),
            (65_535, 3),
            (0, 4),
            (65_534, 5),
            (1, 6),
        ] {
            peers.hear(PEER, sequence, &at(x_cm), 0);
        }
        assert_eq!((peers.iter().count(), place(&peers)), (1, 6));
    }

    #[test]
    fn a_new_boot_counts_and_an_older_one_does_not() {
        let mut peers = Peers::new();
        peers.hear(PEER, 900, &at(1), 0);
        peers.hear(Member { id: 3, boot: 2 }, 0, &at(2), 0);
        assert_eq!(place(&peers), 2);
        peers.hear(PEER, 901, &at(3), 0);
        assert_eq!((peers.iter().count(), place(&peers)), (1, 2));
    }

    #[test]
    fn claims_end_after_two_seconds_and_the_peer_after_twenty() {
        let mut peers = Peers::new();
        peers.hear(PEER, 0, &at(1), 500);
        let claims = |peers: &Peers, at_ms| peers.iter().any(|peer| peer.has_claims(at_ms));
        assert!(claims(&peers, 500 + SILENT_MS) && !claims(&peers, 501 + SILENT_MS));
        peers.forget_silent(500 + FORGOTTEN_MS);
        assert_eq!(peers.iter().count(), 1);
        peers.forget_silent(501 + FORGOTTEN_MS);
        assert_eq!(peers.iter().count(), 0);
    }

    #[test]
    fn the_eighth_peer_takes_the_place_of_the_one_longest_silent() {
        let mut peers = Peers::new();
        for id in 0..8 {
            let heard_ms = if id == 4 { 10 } else { 100 + u32::from(id) };
            peers.hear(Member { id, boot: 0 }, 0, &at(id.into()), heard_ms);
        }
        assert_eq!(peers.iter().count(), 7);
        assert!(peers.iter().all(|peer| peer.member.id != 4));
    }

    #[test]
    fn a_pose_is_predicted_along_the_arc_for_at_most_a_second() {
        let mut peers = Peers::new();
        let beacon = Beacon {
            velocity: Twist {
                linear_mps: 0.5,
                angular_radps: core::f32::consts::FRAC_PI_2,
            },
            ..at(100)
        };
        peers.hear(PEER, 0, &beacon, 1_000);
        let peer = peers.iter().next().expect("a peer");
        let pose = peer.pose(2_000);
        assert!((pose.yaw_rad - core::f32::consts::FRAC_PI_2).abs() < 1e-5);
        assert!((pose.x_m - 1.353_553).abs() < 1e-4 && (pose.y_m - 0.353_553).abs() < 1e-4);
        assert_eq!(peer.pose(2_000), peer.pose(9_000));
    }
}
