//! The team: what this robot says to the others, and what it knows of them.
//!
//! | file | holds |
//! | --- | --- |
//! | [`packet`] | what the robots say to each other |
//! | [`peers`] | the other robots, as their last beacons told |
//! | [`hull`] | the places that the peers take, and the beams that they stop |
//! | [`right_of_way`] | who makes way for whom |
//! | `exchange` | the exchange of map tiles |
//! | [`frame`] | how the map of a robot with an uncertain start lies in the team's coordinates |
//! | `sighting` | what a member in sight says about that |
//!
//! [`Team::to_map`] converts a robot's odometry to the team's coordinates at the planner's entry.
//! All tiles in the air lie in them, in one grid. A robot whose start is uncertain keeps its own
//! map, and takes none of these tiles, until it knows how the two lie.
//!
//! Units: metres, milliseconds.

mod exchange;
pub(crate) mod frame;
mod hidden_beams;
pub(crate) mod hull;
pub mod packet;
pub mod peers;
pub(crate) mod right_of_way;
mod sighting;

use crate::config::{LocaliseTuning, Member, TeamPlace};
use crate::geometry::{MapFromOdom, MapPose, OdomPose, Point, Pose, Twist};
use crate::map::Map;
use crate::map::exchange::Stand;
use exchange::{Exchange, differs};
use frame::{Motion, OwnFrame};
use packet::{Beacon, Body, Packet};
use peers::{Peer, Peers};
use right_of_way::{RightOfWay, distance2};

/// The state of a team's member; of a robot alone it is empty.
#[derive(Debug)]
pub(crate) struct Team {
    /// This robot; `None` for a robot alone.
    member: Option<Member>,
    /// From the odometry's coordinates to the team's.
    map_from_odom: MapFromOdom,
    /// From the map's coordinates to the team's.
    frame: OwnFrame,
    /// Number of the next packet.
    sequence: u16,
    /// A beacon is due: a step was made since the last one.
    owes_beacon: bool,
    now_ms: u32,
    pose: Pose,
    velocity: Twist,
    peers: Peers,
    exchange: Exchange,
    /// The right of way.
    pub(crate) way: RightOfWay,
}

impl Team {
    /// Returns the state of a robot alone.
    pub(crate) const fn new() -> Self {
        Self {
            member: None,
            map_from_odom: MapFromOdom::IDENTITY,
            frame: OwnFrame::new(),
            sequence: 0,
            owes_beacon: false,
            now_ms: 0,
            pose: Pose::ORIGIN,
            velocity: Twist::STILL,
            peers: Peers::new(),
            exchange: Exchange::new(),
            way: RightOfWay::new(),
        }
    }

    /// Forgets everything and begins a session. On uneven ground every start counts as known.
    /// It is not inlined: its copy must not be on the stack while the strategy begins.
    #[inline(never)]
    pub(crate) fn reset(&mut self, place: Option<TeamPlace>, is_uneven: bool) {
        *self = Self::new();
        if let Some(place) = place {
            self.member = Some(place.member);
            self.map_from_odom = MapFromOdom::of(&place.map_from_odom);
            if !is_uneven {
                self.frame = OwnFrame::at(&place);
            }
        }
    }

    /// Returns true if the robot's map does not lie in the team's coordinates.
    pub(crate) const fn has_own_frame(&self) -> bool {
        self.frame.is_own()
    }

    /// Returns the motion by which the robot's map comes to lie in the team's coordinates, once it
    /// is certain. Everything that the team knows of places is moved or forgotten.
    pub(crate) fn take_motion<const TILES: usize, const SLOTS: usize>(
        &mut self,
        map: &mut Map<TILES, SLOTS>,
    ) -> Option<Motion> {
        let (motion, page) = self.frame.take_certain()?;
        if let Some(page) = page {
            map.return_sample(page);
        }
        let MapPose(pose) = motion.team_from_own.apply(&OdomPose(self.pose));
        self.pose = pose;
        self.peers = Peers::new();
        self.way = RightOfWay::new();
        Some(motion)
    }

    /// Returns true if the robot is in a team.
    pub(crate) const fn is_member(&self) -> bool {
        self.member.is_some()
    }

    /// Returns the time of the last step, milliseconds of the session's clock.
    #[cfg(feature = "internals")]
    pub(crate) const fn now_ms(&self) -> u32 {
        self.now_ms
    }

    /// Returns the peers.
    pub(crate) const fn peers(&self) -> &Peers {
        &self.peers
    }

    /// Converts a pose of the odometry to the team's coordinates. A robot alone has its own.
    pub(crate) fn to_map(&self, odom: &Pose) -> Pose {
        if !self.is_member() {
            return *odom;
        }
        self.map_from_odom.apply(&OdomPose(*odom)).0
    }

    /// Notes the time and the robot's motion at the beginning of a step. It is called from two
    /// places, so it is not inlined.
    #[inline(never)]
    pub(crate) fn begin_step<const TILES: usize, const SLOTS: usize>(
        &mut self,
        now_ms: u32,
        (pose, velocity): (&Pose, Twist),
        map: &mut Map<TILES, SLOTS>,
    ) {
        self.frame.follow(&self.pose, pose);
        (self.now_ms, self.pose, self.velocity) = (now_ms, *pose, velocity);
        if self.is_member() {
            self.owes_beacon = true;
            self.peers.forget_silent(now_ms);
            self.exchange.begin_step(now_ms, map);
        }
    }

    /// Returns the nearest peer that may move, near enough to meet the robot.
    pub(crate) fn meets(
        &self,
        now_ms: u32,
        robot: Point,
        is_met: impl Fn(&Peer) -> bool,
    ) -> Option<&Peer> {
        self.way.nearest(&self.peers, now_ms, robot, is_met)
    }

    /// Returns the peers that may move: they explore as this robot does.
    pub(crate) fn rivals(&self, now_ms: u32) -> impl Iterator<Item = &Peer> {
        let peers = self.peers.iter();
        peers.filter(move |peer| self.way.may_move(peer, now_ms))
    }

    /// Returns true if a peer that stands for good is in the way of a robot that drives through
    /// `places`: the circles around the two hulls would meet. This robot's circle is taken to be as
    /// large as the peer's. A robot that is nearer already may leave.
    pub(crate) fn bars(
        &self,
        robot: Point,
        mut places: impl Iterator<Item = Point> + Clone,
    ) -> bool {
        let first = places.next().unwrap_or(robot);
        let stand = |peer: &&Peer| !peer.beacon.activity.moves();
        self.peers.iter().filter(stand).any(|peer| {
            let (at, apart_m) = (peer.beacon.point(), 2.0 * peer.radius_m());
            let limit2 = (apart_m * apart_m).min(at.distance2(robot));
            distance2(&[robot, first], at) < limit2
                || places.clone().any(|place| place.distance2(at) < limit2)
        })
    }

    /// Returns true if this robot makes way for a peer and goes on to do so.
    pub(crate) fn still_yields_to(&self, peer: &Peer) -> bool {
        self.member
            .is_some_and(|me| self.way.still_yields_to(peer, me.id))
    }

    /// Returns true if a peer has the right of way before this robot.
    pub(crate) fn is_before_me(&self, peer: &Peer) -> bool {
        self.member
            .is_some_and(|me| self.way.is_before(peer, me.id))
    }

    /// Takes a packet of another robot. The robot stands within `stand_m` of its centre.
    /// `has_evidence` is true on flat ground.
    pub(crate) fn hear<const TILES: usize, const SLOTS: usize>(
        &mut self,
        packet: &Packet,
        map: &mut Map<TILES, SLOTS>,
        (stand_m, has_evidence, tuning): (f32, bool, &LocaliseTuning),
    ) {
        let Some(me) = self.member.filter(|me| me.id != packet.from.id) else {
            return;
        };
        if !self.frame.is_placed() {
            return;
        }
        match &packet.body {
            Body::Beacon(said) => {
                let beacon = self.frame.heard(said, self.pose.point());
                let (from, sequence) = (packet.from, packet.sequence);
                self.peers.hear(from, sequence, &beacon, self.now_ms);
                self.peers.note_sd(from, said.sd_cm);
            }
            Body::Digest(digest) => {
                let (frame, robot) = (&self.frame, self.pose.point());
                self.exchange
                    .hear_digest(packet.from.id, digest, |version| {
                        if frame.is_own() {
                            // A tile that overlaps the map is matched again and again.
                            let middle = frame.middle(version.tile, robot);
                            let tile = middle.map(|at| (at.cell().x >> 5, at.cell().y >> 5));
                            tile.is_some_and(|tile| map.view(tile).is_some())
                        } else {
                            differs(map, version, digest.salt)
                        }
                    });
            }
            Body::Tile(said) if self.frame.is_own() => {
                self.frame.hear_tile(said, &self.pose, map, tuning);
            }
            Body::Wanted(wanted) if wanted.of == me.id => self.exchange.hear_wanted(&wanted.tiles),
            Body::Wanted(_) => {}
            Body::Tile(said) => {
                let tile = (said.tile.0.into(), said.tile.1.into());
                let stand = Stand {
                    centre: self.pose.point(),
                    radius_m: stand_m,
                };
                // A tile without room is offered again.
                let _ = map.join(tile, (said.epoch, &said.planes), stand, has_evidence);
            }
        }
    }

    /// Returns the next packet for the team; `None` until the next step. `beacon` fills in what the
    /// rest of the planner knows.
    pub(crate) fn say<const TILES: usize, const SLOTS: usize>(
        &mut self,
        map: &mut Map<TILES, SLOTS>,
        beacon: impl FnOnce(Beacon) -> Beacon,
    ) -> Option<Packet> {
        let from = self.member?;
        let body = if core::mem::replace(&mut self.owes_beacon, false) {
            let said = beacon(Beacon {
                map: self.exchange.mark(map),
                velocity: self.velocity,
                ..Beacon::default().at(&self.pose)
            });
            Body::Beacon(self.frame.said(said, self.pose.point()))
        } else if self.frame.is_own() {
            Body::Wanted(self.exchange.say_wanted()?)
        } else {
            let mark = self.exchange.mark(map);
            let mut in_reach = self
                .peers
                .iter()
                .filter(|peer| peer.has_claims(self.now_ms));
            let has_other_map = |peer: &Peer| peer.beacon.map != mark;
            // Without a peer in reach nobody would hear.
            let differs = in_reach
                .next()
                .map(|peer| has_other_map(peer) || in_reach.any(has_other_map))?;
            self.exchange.say(map, differs)?
        };
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        Some(Packet {
            from,
            sequence,
            body,
        })
    }
}

#[cfg(test)]
mod scenes;
