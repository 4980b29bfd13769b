//! Right of way between robots that meet, without a leader.
//!
//! Two robots *meet* if each is in the way of the other. Both know it from their beacons, and both
//! come to the same result:
//!
//! ```text
//! right   a robot that cannot make way, before one that drives, before one that makes way already;
//!         of two equal ones the lesser number
//! ```
//!
//! The robot with the lower right *yields*: it leaves the other's road, and waits beside it until
//! the other has passed. If no place beside the road can be reached it is *cornered*, and then the
//! other yields. The robot with the higher right *holds*: it stands until the way is free. Nobody
//! waits for a peer that does not move for [`PATIENCE_MS`]: for a while it is an obstacle, as a
//! peer that is faulted, finished, gone or silent.
//!
//! The cells of the map may leave a way past a peer that the hull does not fit through. If the
//! drive finds none, the way is *shut* until the peer moves, and the robot takes a stance as if
//! cells barred it. Otherwise two robots that want out by one door from the same side may stand for
//! ever (measured: docs/MEASURED.md, "A way past a peer that is shut").
//!
//! Units: milliseconds, metres.

use heapless::Vec;

use crate::clock::since;
use crate::geometry::Point;
use crate::team::packet::{Activity, ROAD_POINTS};
use crate::team::peers::{MOST_PEERS, Peer, Peers};

/// Peers farther than this do not meet the robot, metres.
const MEETING_M: f32 = 3.5;
/// Time without a motion of the other after which nobody waits for it, milliseconds.
const PATIENCE_MS: u32 = 10_000;
/// Time for which it is an obstacle then, milliseconds.
const OBSTACLE_MS: u32 = 20_000;
/// A robot that moved less than this stands, metres.
const MOVED_M: f32 = 0.2;

/// What the robot does about the peers that it meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Stance {
    /// It drives.
    #[default]
    Free,
    /// It stands until the way is free.
    Holding,
    /// It leaves the road of a peer, or waits beside it.
    Yielding,
    /// It should leave the road of a peer and cannot.
    Cornered,
}

/// The place of a peer and the road ahead of it.
pub(crate) type Road = Vec<Point, { ROAD_POINTS + 1 }>;

/// Returns a peer's place and the road ahead.
pub(crate) fn road_of(peer: &Peer, now_ms: u32) -> Road {
    let here = core::iter::once(peer.pose(now_ms).point());
    here.chain(peer.beacon.road()).collect()
}

/// Returns true if a peer stands and waits for something in front of it, and the robot is there.
pub(crate) fn waits_for(peer: &Peer, now_ms: u32, robot: Point) -> bool {
    peer.beacon.activity == Activity::Holding && peer.pose(now_ms).to_robot(robot).x_m > 0.0
}

/// Returns the squared distance of a point to a line of points; infinite without any.
pub(crate) fn distance2(road: &[Point], point: Point) -> f32 {
    let first = road
        .first()
        .map_or(f32::INFINITY, |first| first.distance2(point));
    road.windows(2).fold(first, |least, ends| match ends {
        [from, to] => least.min(point.to_line2(*from, *to)),
        _ => least,
    })
}

/// A peer that counts as an obstacle for a while.
#[derive(Clone, Copy, Debug)]
struct Ignored {
    id: u8,
    until_ms: u32,
}

/// The robot's stance, and the peers that it does not wait for.
#[derive(Debug)]
pub(crate) struct RightOfWay {
    stance: Stance,
    /// The peer that the stance is about.
    other: u8,
    /// Where that peer was when it last moved, and when.
    other_at: Point,
    other_ms: u32,
    ignored: Vec<Ignored, MOST_PEERS>,
    /// The drive found no way past the peers, and the other one has not moved since.
    is_shut: bool,
    /// Where a yielding robot goes.
    refuge: Option<Point>,
}

impl RightOfWay {
    /// Returns the state of a robot that meets nobody.
    pub(crate) const fn new() -> Self {
        Self {
            stance: Stance::Free,
            other: 0,
            other_at: Point::ORIGIN,
            other_ms: 0,
            ignored: Vec::new(),
            is_shut: false,
            refuge: None,
        }
    }

    /// Returns the robot's stance.
    pub(crate) const fn stance(&self) -> Stance {
        self.stance
    }

    /// Returns where a yielding robot goes.
    pub(crate) const fn refuge(&self) -> Option<Point> {
        self.refuge
    }

    /// Returns what the robot tells of itself while it explores.
    pub(crate) const fn activity(&self) -> Activity {
        match self.stance {
            Stance::Free => Activity::Exploring,
            Stance::Holding => Activity::Holding,
            Stance::Yielding => Activity::Yielding,
            Stance::Cornered => Activity::Cornered,
        }
    }

    /// Ends the stance.
    pub(crate) const fn go_on(&mut self) {
        self.stance = Stance::Free;
        self.is_shut = false;
        self.refuge = None;
    }

    /// Notes that the drive found no way past the peers.
    pub(crate) const fn shut(&mut self) {
        self.is_shut = true;
    }

    /// Returns true if the drive found no way past the peers, and the one that the stance is about
    /// has not moved since.
    pub(crate) const fn is_shut(&self) -> bool {
        self.is_shut
    }

    /// Takes a stance about a peer.
    pub(crate) fn take(&mut self, stance: Stance, peer: &Peer, now_ms: u32) {
        let at = peer.beacon.point();
        let moved = at.distance2(self.other_at) > MOVED_M * MOVED_M;
        let is_new = self.stance == Stance::Free || self.other != peer.member.id;
        self.is_shut &= is_new || !moved;
        if is_new || moved {
            (self.other_at, self.other_ms) = (at, now_ms);
        }
        (self.stance, self.other) = (stance, peer.member.id);
        if stance == Stance::Holding {
            self.refuge = None;
        }
    }

    /// Notes that a yielding robot cannot leave the road.
    pub(crate) const fn corner(&mut self) {
        self.stance = Stance::Cornered;
    }

    /// Sets where a yielding robot goes; `None` once it is there.
    pub(crate) const fn go_to(&mut self, refuge: Option<Point>) {
        self.refuge = refuge;
    }

    /// Gives up waiting if the other did not move for too long. Returns true then.
    pub(crate) fn loses_patience(&mut self, now_ms: u32) -> bool {
        self.ignored
            .retain(|ignored| since(ignored.until_ms, now_ms) > 0);
        let waits = self.stance != Stance::Free;
        if !waits || since(now_ms, self.other_ms) < PATIENCE_MS {
            return false;
        }
        let ignored = Ignored {
            id: self.other,
            until_ms: now_ms.wrapping_add(OBSTACLE_MS),
        };
        // A full list keeps the others.
        let _ = self.ignored.push(ignored);
        self.go_on();
        true
    }

    /// Returns true if a peer moves, or will move by itself: others are obstacles.
    pub(crate) fn may_move(&self, peer: &Peer, now_ms: u32) -> bool {
        peer.has_claims(now_ms)
            && peer.beacon.activity.moves()
            && !self.ignores(peer.member.id, now_ms)
    }

    /// Returns true if nobody waits for a peer any more, although it says that it moves.
    pub(crate) fn ignores(&self, id: u8, now_ms: u32) -> bool {
        let mut ignored = self.ignored.iter();
        ignored.any(|ignored| ignored.id == id && since(ignored.until_ms, now_ms) > 0)
    }

    /// Returns the peer of the present stance, if it may move.
    pub(crate) fn other<'a>(&self, peers: &'a Peers, now_ms: u32) -> Option<&'a Peer> {
        let mut peers = peers.iter();
        let other = peers.find(|peer| peer.member.id == self.other)?;
        (self.stance != Stance::Free && self.may_move(other, now_ms)).then_some(other)
    }

    /// Returns the nearest peer that may move, near enough to meet the robot.
    pub(crate) fn nearest<'a>(
        &self,
        peers: &'a Peers,
        now_ms: u32,
        robot: Point,
        is_met: impl Fn(&Peer) -> bool,
    ) -> Option<&'a Peer> {
        let distance2 = |peer: &Peer| peer.beacon.point().distance2(robot);
        peers
            .iter()
            .filter(|peer| distance2(peer) <= MEETING_M * MEETING_M)
            .filter(|peer| self.may_move(peer, now_ms) && is_met(peer))
            .min_by(|a, b| distance2(a).total_cmp(&distance2(b)))
    }

    /// Returns true if this robot, which yields or is cornered, goes on to yield to a peer.
    ///
    /// A cornered robot is before everyone, so that those that corner it make way. To the peer that
    /// it makes way for it is still one that yields, unless that peer is cornered as well.
    pub(crate) fn still_yields_to(&self, peer: &Peer, me: u8) -> bool {
        match (self.stance, peer.beacon.activity) {
            (Stance::Cornered, Activity::Yielding) => false,
            (Stance::Cornered, Activity::Cornered) | (Stance::Yielding, _) => {
                self.is_before(peer, me)
            }
            (Stance::Cornered, _) => true,
            (Stance::Free | Stance::Holding, _) => false,
        }
    }

    /// Returns true if a peer has the right of way before this robot.
    pub(crate) fn is_before(&self, peer: &Peer, me: u8) -> bool {
        let rank = |activity: Activity, id: u8| {
            let class = match activity {
                Activity::Cornered => 0,
                Activity::Yielding => 2,
                _ => 1,
            };
            (class, id)
        };
        rank(peer.beacon.activity, peer.member.id) < rank(self.activity(), me)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Member;
    use crate::team::packet::Beacon;

    fn peers(id: u8, activity: Activity, x_m: f32) -> Peers {
        let beacon = Beacon {
            activity,
            position_cm: ((x_m * 100.0) as i16, 0),
            ..Beacon::default()
        };
        let mut peers = Peers::new();
        peers.hear(Member { id, boot: 0 }, 0, &beacon, 0);
        peers
    }

    /// Whatever the stances, of two robots that meet exactly one is before the other.
    #[test]
    fn of_two_robots_exactly_one_has_the_right_of_way() {
        let stances = [
            Stance::Free,
            Stance::Holding,
            Stance::Yielding,
            Stance::Cornered,
        ];
        for (one, other) in stances.into_iter().flat_map(|a| stances.map(|b| (a, b))) {
            let [one, other] = [one, other].map(|stance| RightOfWay {
                stance,
                ..RightOfWay::new()
            });
            let sees = |way: &RightOfWay, me, whom: &RightOfWay, id| {
                let peers = peers(id, whom.activity(), 0.0);
                peers.iter().all(|peer| way.is_before(peer, me))
            };
            assert_ne!(sees(&one, 1, &other, 2), sees(&other, 2, &one, 1));
        }
    }

    /// A robot between two others: the one ahead has the right of way, the one behind corners it.
    #[test]
    fn a_cornered_robot_goes_on_to_yield_until_the_other_makes_way() {
        let way = RightOfWay {
            stance: Stance::Cornered,
            ..RightOfWay::new()
        };
        let yields_to = |id, activity| {
            let peers = peers(id, activity, 1.0);
            peers.iter().all(|peer| way.still_yields_to(peer, 2))
        };
        assert!(yields_to(1, Activity::Exploring) && yields_to(1, Activity::Holding));
        assert!(!yields_to(1, Activity::Yielding), "it makes way itself");
        assert!(yields_to(1, Activity::Cornered) && !yields_to(3, Activity::Cornered));
    }

    #[test]
    fn nobody_waits_ten_seconds_for_a_peer_that_does_not_move() {
        let mut way = RightOfWay::new();
        let stays = peers(2, Activity::Exploring, 1.0);
        let peer = stays.iter().next().expect("a peer");
        way.take(Stance::Holding, peer, 1_000);
        assert!(!way.loses_patience(10_900));
        let moves = peers(2, Activity::Exploring, 1.5);
        way.take(
            Stance::Holding,
            moves.iter().next().expect("a peer"),
            10_900,
        );
        assert!(!way.loses_patience(11_100), "it moved");
        assert!(way.loses_patience(20_900));
        assert!(way.ignores(2, 40_000) && !way.ignores(2, 41_000));
        assert_eq!(way.stance(), Stance::Free);
    }

    #[test]
    fn a_way_is_shut_until_the_peer_moves_or_the_robot_goes_on() {
        let mut way = RightOfWay::new();
        let take = |way: &mut RightOfWay, x_m| {
            let peers = peers(2, Activity::Exploring, x_m);
            way.take(Stance::Holding, peers.iter().next().expect("a peer"), 0);
            way.is_shut()
        };
        way.shut();
        assert!(take(&mut way, 1.0), "it is a new stance");
        assert!(take(&mut way, 1.1));
        assert!(!take(&mut way, 1.3));
        way.shut();
        way.go_on();
        assert!(!way.is_shut());
    }

    #[test]
    fn only_a_peer_that_is_heard_and_explores_counts_as_moving() {
        let moves = |activity, now_ms| {
            let peers = peers(2, activity, 1.0);
            let peer = peers.iter().next().expect("a peer");
            RightOfWay::new().may_move(peer, now_ms)
        };
        assert!(moves(Activity::Exploring, 2_000) && !moves(Activity::Exploring, 2_001));
        let stands = [
            Activity::Standing,
            Activity::Finished,
            Activity::Faulted,
            Activity::Gone,
        ];
        assert!(stands.iter().all(|activity| !moves(*activity, 0)));
    }

    #[test]
    fn the_distance_to_a_road_is_that_to_its_nearest_stretch() {
        let at = |x_m, y_m| Point { x_m, y_m };
        let road = [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 2.0)];
        assert!((distance2(&road, at(1.0, 0.5)) - 0.25).abs() < 1e-6);
        assert!((distance2(&road, at(3.0, 1.0)) - 1.0).abs() < 1e-6);
        assert!((distance2(&road, at(-1.0, 0.0)) - 1.0).abs() < 1e-6);
        assert_eq!(distance2(&[], at(0.0, 0.0)), f32::INFINITY);
        assert_eq!(distance2(&road[..1], at(0.0, 3.0)), 9.0);
    }
}
