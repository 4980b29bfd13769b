//! What robots of a team say to one another.

use fieldline_protocol::message::{
    Activity, Beacon, Body, Digest, Member, Packet, Team, TeamTile, TileVersion, Wanted,
};
use proptest::prelude::*;

use super::{list, long, short, twist};

fn member() -> impl Strategy<Value = Member> {
    any::<(u8, u16)>().prop_map(|(id, boot)| Member { id, boot })
}

pub(super) fn team() -> impl Strategy<Value = Team> {
    let sd = (any::<u16>(), any::<u16>());
    (member(), long(), long(), long(), sd).prop_map(|(member, x, y, yaw, sd)| Team {
        member,
        origin: (x, y),
        yaw,
        sd_mm: sd.0,
        sd_mrad: sd.1,
    })
}

fn beacon() -> impl Strategy<Value = Beacon> {
    let activity = prop::sample::select(vec![
        Activity::Exploring,
        Activity::Yielding,
        Activity::Cornered,
        Activity::Standing,
        Activity::Finished,
        Activity::Faulted,
        Activity::Gone,
        Activity::Holding,
    ]);
    let motion = (short(), twist());
    let place = any::<(u32, i16, i16, u8, u8, u8)>();
    let road = list(any::<(i8, i8)>());
    (place, motion, activity, any::<Option<(i16, i16)>>(), road).prop_map(
        |((map, x_cm, y_cm, sd_cm, length, width), (yaw, velocity), activity, goal, road)| Beacon {
            map,
            x_cm,
            y_cm,
            yaw,
            sd_cm,
            velocity,
            half_length_cm: length,
            half_width_cm: width,
            activity,
            goal,
            road,
        },
    )
}

/// Any packet of a team.
pub(super) fn packet() -> impl Strategy<Value = Packet> {
    let version = any::<(i8, i8, u16, u16)>().prop_map(|(x, y, epoch, hash)| TileVersion {
        x,
        y,
        epoch,
        hash,
    });
    let digest = (any::<u8>(), list(version)).prop_map(|(salt, tiles)| Digest { salt, tiles });
    let wanted = (any::<u8>(), list(any::<(i8, i8)>()));
    let tile = (any::<(i8, i8, u16)>(), list(any::<u8>()));
    let body = prop_oneof![
        beacon().prop_map(Body::Beacon),
        digest.prop_map(Body::Digest),
        wanted.prop_map(|(of, tiles)| Body::Wanted(Wanted { of, tiles })),
        tile.prop_map(|((x, y, epoch), cells)| Body::Tile(TeamTile { x, y, epoch, cells })),
    ];
    (member(), any::<u16>(), body).prop_map(|(from, sequence, body)| Packet {
        from,
        sequence,
        body,
    })
}
