//! Conversions of the team's packets between the wire and the planner.
//!
//! Lengths in centimetres and cells are equal on both sides; a velocity and a yaw are fixed-point
//! on the wire.

use fieldline_planner::{
    Activity, Beacon, Body, Digest, Member, Packet, Pose, TeamPlace, TeamTile, TileVersion, Wanted,
};
use fieldline_protocol::message as wire;

use super::tiles::planes;
use super::{float, quantity, twist, wire_twist};

/// Converts the robot's place in its team.
pub(super) fn place(team: &wire::Team) -> TeamPlace {
    TeamPlace {
        member: member(team.member),
        map_from_odom: Pose {
            x_m: float(team.origin.0),
            y_m: float(team.origin.1),
            yaw_rad: float(team.yaw),
            ..Pose::default()
        },
        sd_m: f32::from(team.sd_mm) * 1e-3,
        sd_rad: f32::from(team.sd_mrad) * 1e-3,
    }
}

const fn member(member: wire::Member) -> Member {
    Member {
        id: member.id,
        boot: member.boot,
    }
}

/// Converts a packet from the wire. `None` if its tile does not have the cells of a tile.
#[must_use]
pub fn packet(packet: &wire::Packet) -> Option<Packet> {
    Some(Packet {
        from: member(packet.from),
        sequence: packet.sequence,
        body: match &packet.body {
            wire::Body::Beacon(said) => Body::Beacon(beacon(said)),
            wire::Body::Digest(said) => Body::Digest(digest(said)),
            wire::Body::Wanted(said) => Body::Wanted(Wanted {
                of: said.of,
                tiles: said.tiles.clone(),
            }),
            wire::Body::Tile(said) => Body::Tile(tile(said)?),
        },
    })
}

fn beacon(said: &wire::Beacon) -> Beacon {
    Beacon {
        map: said.map,
        position_cm: (said.x_cm, said.y_cm),
        yaw_rad: float(said.yaw),
        sd_cm: said.sd_cm,
        velocity: twist(&said.velocity),
        half_cm: (said.half_length_cm, said.half_width_cm),
        activity: match said.activity {
            wire::Activity::Exploring => Activity::Exploring,
            wire::Activity::Yielding => Activity::Yielding,
            wire::Activity::Cornered => Activity::Cornered,
            wire::Activity::Standing => Activity::Standing,
            wire::Activity::Finished => Activity::Finished,
            wire::Activity::Faulted => Activity::Faulted,
            wire::Activity::Gone => Activity::Gone,
            wire::Activity::Holding => Activity::Holding,
        },
        goal: said.goal,
        road: said.road.clone(),
    }
}

fn digest(said: &wire::Digest) -> Digest {
    let version = |tile: &wire::TileVersion| TileVersion {
        tile: (tile.x, tile.y),
        epoch: tile.epoch,
        hash: tile.hash,
    };
    Digest {
        salt: said.salt,
        tiles: said.tiles.iter().map(version).collect(),
    }
}

fn tile(said: &wire::TeamTile) -> Option<TeamTile> {
    Some(TeamTile {
        tile: (said.x, said.y),
        epoch: said.epoch,
        planes: planes(&said.cells)?,
    })
}

/// Converts a packet for the wire.
#[must_use]
pub fn wire_packet(packet: &Packet) -> wire::Packet {
    wire::Packet {
        from: wire::Member {
            id: packet.from.id,
            boot: packet.from.boot,
        },
        sequence: packet.sequence,
        body: match &packet.body {
            Body::Beacon(said) => wire::Body::Beacon(wire_beacon(said)),
            Body::Digest(said) => wire::Body::Digest(wire_digest(said)),
            Body::Wanted(said) => wire::Body::Wanted(wire::Wanted {
                of: said.of,
                tiles: said.tiles.clone(),
            }),
            Body::Tile(said) => wire::Body::Tile(wire_tile(said)),
        },
    }
}

fn wire_beacon(said: &Beacon) -> wire::Beacon {
    wire::Beacon {
        map: said.map,
        x_cm: said.position_cm.0,
        y_cm: said.position_cm.1,
        yaw: quantity(said.yaw_rad),
        sd_cm: said.sd_cm,
        velocity: wire_twist(&said.velocity),
        half_length_cm: said.half_cm.0,
        half_width_cm: said.half_cm.1,
        activity: match said.activity {
            Activity::Exploring => wire::Activity::Exploring,
            Activity::Yielding => wire::Activity::Yielding,
            Activity::Cornered => wire::Activity::Cornered,
            Activity::Standing => wire::Activity::Standing,
            Activity::Finished => wire::Activity::Finished,
            Activity::Faulted => wire::Activity::Faulted,
            Activity::Gone => wire::Activity::Gone,
            Activity::Holding => wire::Activity::Holding,
        },
        goal: said.goal,
        road: said.road.clone(),
    }
}

fn wire_digest(said: &Digest) -> wire::Digest {
    let version = |of: &TileVersion| wire::TileVersion {
        x: of.tile.0,
        y: of.tile.1,
        epoch: of.epoch,
        hash: of.hash,
    };
    wire::Digest {
        salt: said.salt,
        tiles: said.tiles.iter().map(version).collect(),
    }
}

fn wire_tile(said: &TeamTile) -> wire::TeamTile {
    let [low, high] = &said.planes;
    let row = |(low, high): (&u32, &u32)| {
        let (low, high) = (*low, *high);
        (0..32).map(move |k| (low >> k & 1 | (high >> k & 1) << 1) as u8)
    };
    wire::TeamTile {
        x: said.tile.0,
        y: said.tile.1,
        epoch: said.epoch,
        cells: wire::TeamTile::pack(low.iter().zip(high).flat_map(row)),
    }
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::{self as wire, Body, Packet};

    use super::{packet, wire_packet};

    #[track_caller]
    fn is_kept(body: Body) {
        let said = Packet {
            from: wire::Member { id: 7, boot: 9 },
            sequence: 65_535,
            body,
        };
        assert_eq!(wire_packet(&packet(&said).expect("whole")), said);
    }

    #[test]
    fn a_packet_is_the_same_after_both_conversions() {
        for activity in [
            wire::Activity::Exploring,
            wire::Activity::Yielding,
            wire::Activity::Cornered,
            wire::Activity::Standing,
            wire::Activity::Finished,
            wire::Activity::Faulted,
            wire::Activity::Gone,
            wire::Activity::Holding,
        ] {
            is_kept(Body::Beacon(wire::Beacon {
                map: 0xdead_beef,
                x_cm: -5,
                y_cm: 32_767,
                yaw: super::quantity(-3.0),
                sd_cm: 4,
                velocity: wire::Twist {
                    linear: super::quantity(0.7),
                    angular: super::quantity(-1.0),
                },
                half_length_cm: 26,
                half_width_cm: 25,
                activity,
                goal: Some((-1, 2)),
                road: [(1, -2), (-3, 4)].into_iter().collect(),
            }));
        }
        is_kept(Body::Digest(wire::Digest {
            salt: 3,
            tiles: core::iter::once(wire::TileVersion {
                x: -1,
                y: 2,
                epoch: 3,
                hash: 4,
            })
            .collect(),
        }));
        is_kept(Body::Wanted(wire::Wanted {
            of: 2,
            tiles: [(1, -1), (0, 0)].into_iter().collect(),
        }));
        for change in [1, 3, 70] {
            let cells = (0..1024_u32).map(|k| (k / change * 7 % 4) as u8);
            is_kept(Body::Tile(wire::TeamTile {
                x: 1,
                y: -1,
                epoch: 12,
                cells: wire::TeamTile::pack(cells),
            }));
        }
    }

    #[test]
    fn half_a_tile_is_no_packet() {
        let said = Packet {
            from: wire::Member::default(),
            sequence: 0,
            body: Body::Tile(wire::TeamTile {
                cells: [0xfc; 8].into_iter().collect(),
                ..wire::TeamTile::default()
            }),
        };
        assert_eq!(packet(&said), None);
    }
}
