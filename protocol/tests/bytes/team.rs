//! Bytes of the team's packets, on the line and in the air.

use fieldline_protocol::check::Kind;
use fieldline_protocol::message::{
    Activity, Beacon, Body, Digest, Member, Packet, Reply, Request, TeamTile, TileVersion, Twist,
    Wanted,
};
use fieldline_protocol::packet::{MAX_BEACON, MAX_PACKET, decode_packet, encode_packet};
use fixed::types::I4F12;

use super::{crc24, reply_is, request_is, short};

fn said(body: Body) -> Packet {
    Packet {
        from: Member { id: 3, boot: 300 },
        sequence: 5,
        body,
    }
}

/// Checks the bytes of a packet in a request, in a reply, and in the air.
#[track_caller]
fn packet_is(packet: &Packet, body: &[u8]) {
    request_is(Request::Hear(packet.clone()), &[&[7], body].concat());
    reply_is(Reply::Say(Some(packet.clone())), &[&[11, 1], body].concat());
    let mut air = [0; MAX_PACKET];
    let length = encode_packet(packet, &mut air).unwrap();
    let check = crc24(body) ^ Kind::Packet.key();
    assert_eq!(
        air[..length],
        [body, &check.to_le_bytes()[..3]].concat()[..]
    );
    assert_eq!(decode_packet(&air[..length]).as_ref(), Some(packet));
    assert_eq!(decode_packet(&air[..length - 1]), None, "cut off");
    for at in 0..length {
        air[at] ^= 0x10;
        assert_eq!(decode_packet(&air[..length]), None, "byte {at} is damaged");
        air[at] ^= 0x10;
    }
}

#[test]
fn a_beacon() {
    let beacon = Beacon {
        map: 0x1234,
        x_cm: 64,
        y_cm: -1,
        yaw: short(-0.5),
        sd_cm: 7,
        velocity: Twist {
            linear: short(0.5),
            angular: short(0.0),
        },
        half_length_cm: 26,
        half_width_cm: 25,
        activity: Activity::Exploring,
        goal: Some((-2, 64)),
        road: [(2, -1), (127, -128)].into_iter().collect(),
    };
    packet_is(
        &said(Body::Beacon(beacon)),
        &[
            3, 0xac, 2, 5, 0, // robot 3, boot 300, packet 5, a beacon
            0xb4, 0x24, // map
            0x80, 0x01, 1, // 0.64 m, −0.01 m
            0xff, 0x1f, // −0.5 rad = −2048/4096
            7,    // 7 cm
            0x80, 0x20, 0, // 0.5 m/s, straight
            26, 25, 0, // half sides, exploring
            1, 3, 0x80, 0x01, // goal
            2, 2, 0xff, 127, 0x80, // two places: a byte for each offset
        ],
    );
}

#[test]
fn a_digest() {
    let version = |x, y, epoch, hash| TileVersion { x, y, epoch, hash };
    let tiles = [version(-1, 2, 0, 127), version(3, -128, 128, 65_535)];
    let digest = Digest {
        salt: 200,
        tiles: tiles.into_iter().collect(),
    };
    packet_is(
        &said(Body::Digest(digest)),
        &[
            3, 0xac, 2, 5, 1, 200, // a digest with its salt
            2, 0xff, 2, 0, 127, // the first tile
            3, 0x80, 0x80, 0x01, 0xff, 0xff, 0x03, // the second one
        ],
    );
}

#[test]
fn a_request_for_tiles() {
    let wanted = Wanted {
        of: 4,
        tiles: [(0, -1), (1, 1)].into_iter().collect(),
    };
    packet_is(
        &said(Body::Wanted(wanted)),
        &[3, 0xac, 2, 5, 2, 4, 2, 0, 0xff, 1, 1],
    );
}

#[test]
fn a_tile() {
    // A wall of one row, and free ground beyond it.
    let class = |k| match k / 32 {
        0 => 2,
        1..4 => 1,
        _ => 0,
    };
    let tile = TeamTile {
        x: -1,
        y: 1,
        epoch: 2,
        cells: TeamTile::pack((0..1024).map(class)),
    };
    let runs = [&[31 << 2 | 2, 63 << 2 | 1, 31 << 2 | 1][..], &[63 << 2; 14]];
    packet_is(
        &said(Body::Tile(tile)),
        &[&[3, 0xac, 2, 5, 3, 0xff, 1, 2, 17][..], &runs.concat()].concat(),
    );
}

#[test]
fn saying_and_hearing() {
    request_is(Request::Say, &[8]);
    reply_is(Reply::Heard, &[10]);
    reply_is(Reply::Say(None), &[11, 0]);
}

#[test]
fn activities_have_fixed_numbers() {
    let activities = [
        Activity::Exploring,
        Activity::Yielding,
        Activity::Cornered,
        Activity::Standing,
        Activity::Finished,
        Activity::Faulted,
        Activity::Gone,
        Activity::Holding,
    ];
    for (number, activity) in (0..).zip(activities) {
        assert_eq!(postcard::to_allocvec(&activity).unwrap(), [number]);
    }
}

/// Every varint at its greatest length.
#[test]
fn the_longest_beacon_has_at_most_64_bytes() {
    let packet = Packet {
        from: Member {
            id: 255,
            boot: u16::MAX,
        },
        sequence: u16::MAX,
        body: Body::Beacon(Beacon {
            map: u32::MAX,
            x_cm: i16::MIN,
            y_cm: i16::MIN,
            yaw: I4F12::MIN,
            sd_cm: 255,
            velocity: Twist {
                linear: I4F12::MIN,
                angular: I4F12::MIN,
            },
            half_length_cm: 255,
            half_width_cm: 255,
            activity: Activity::Gone,
            goal: Some((i16::MIN, i16::MIN)),
            road: [(i8::MIN, i8::MIN); 4].into_iter().collect(),
        }),
    };
    let mut air = [0; MAX_PACKET];
    assert_eq!(encode_packet(&packet, &mut air), Ok(MAX_BEACON));
    const { assert!(MAX_BEACON <= 64) };
}

#[test]
fn the_longest_tile_fills_the_longest_packet() {
    let packet = Packet {
        from: Member {
            id: 255,
            boot: u16::MAX,
        },
        sequence: u16::MAX,
        body: Body::Tile(TeamTile {
            x: 0,
            y: 0,
            epoch: u16::MAX,
            cells: [0; 256].into_iter().collect(),
        }),
    };
    let mut air = [0; MAX_PACKET];
    assert_eq!(encode_packet(&packet, &mut air), Ok(MAX_PACKET));
    assert!(encode_packet(&packet, &mut air[..MAX_PACKET - 1]).is_err());
}
