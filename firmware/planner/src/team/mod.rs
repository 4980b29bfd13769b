//! The team: what this robot says to the others, and what it knows of them.
//!
//! | file | holds |
//! | --- | --- |
//! | [`packet`] | what the robots say to each other |
//! | [`peers`] | the other robots, as their last beacons told |
//!
//! All members use the same coordinates: [`Team::to_map`] converts a robot's odometry to them at
//! the planner's entry. So the tiles of all members lie in one grid.
//!
//! Units: metres, milliseconds.

pub mod packet;
pub mod peers;

use crate::config::{Member, TeamPlace};
use crate::geometry::{Pose, RobotFrame, Twist};
use crate::math;
use packet::{Beacon, Body, Packet};
use peers::Peers;

/// The state of a team's member; of a robot alone it is empty.
#[derive(Debug)]
pub(crate) struct Team {
    /// This robot; `None` for a robot alone.
    member: Option<Member>,
    /// The pose of the odometry's origin in the team's coordinates.
    map_from_odom: Pose,
    /// Number of the next packet.
    sequence: u16,
    /// A beacon is due: a step was made since the last one.
    owes_beacon: bool,
    now_ms: u32,
    pose: Pose,
    velocity: Twist,
    peers: Peers,
}

impl Team {
    /// Returns the state of a robot alone.
    pub(crate) const fn new() -> Self {
        const ORIGIN: Pose = Pose {
            x_m: 0.0,
            y_m: 0.0,
            z_m: 0.0,
            roll_rad: 0.0,
            pitch_rad: 0.0,
            yaw_rad: 0.0,
        };
        Self {
            member: None,
            map_from_odom: ORIGIN,
            sequence: 0,
            owes_beacon: false,
            now_ms: 0,
            pose: ORIGIN,
            velocity: Twist {
                linear_mps: 0.0,
                angular_radps: 0.0,
            },
            peers: Peers::new(),
        }
    }

    /// Forgets everything and begins a session.
    pub(crate) fn reset(&mut self, place: Option<TeamPlace>) {
        *self = Self::new();
        if let Some(place) = place {
            self.member = Some(place.member);
            self.map_from_odom = place.map_from_odom;
        }
    }

    /// Returns true if the robot is in a team.
    pub(crate) const fn is_member(&self) -> bool {
        self.member.is_some()
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
        let place = RobotFrame::of(&self.map_from_odom).to_map(odom.point());
        Pose {
            x_m: place.x_m,
            y_m: place.y_m,
            yaw_rad: math::wrap(odom.yaw_rad + self.map_from_odom.yaw_rad),
            ..*odom
        }
    }

    /// Notes the time and the robot's motion at the beginning of a step.
    pub(crate) fn note(&mut self, now_ms: u32, pose: &Pose, velocity: Twist) {
        (self.now_ms, self.pose, self.velocity) = (now_ms, *pose, velocity);
        self.owes_beacon = self.is_member();
        self.peers.forget_silent(now_ms);
    }

    /// Takes a packet of another robot.
    pub(crate) fn hear(&mut self, packet: &Packet) {
        let is_peer = |me: Member| me.id != packet.from.id;
        if !self.member.is_some_and(is_peer) {
            return;
        }
        if let Body::Beacon(beacon) = &packet.body {
            self.peers
                .hear(packet.from, packet.sequence, beacon, self.now_ms);
        }
    }

    /// Returns the next packet for the team; `None` until the next step. `beacon` fills in what the
    /// rest of the planner knows.
    pub(crate) fn say(&mut self, beacon: impl FnOnce(Beacon) -> Beacon) -> Option<Packet> {
        let from = self.member?;
        if !core::mem::replace(&mut self.owes_beacon, false) {
            return None;
        }
        let body = beacon(Beacon {
            velocity: self.velocity,
            ..Beacon::default().at(&self.pose)
        });
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        Some(Packet {
            from,
            sequence,
            body: Body::Beacon(body),
        })
    }
}
