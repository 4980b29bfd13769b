//! Packets of hostile robots of the team, near a place or anywhere.

use fieldline_protocol::message::{
    Activity, Beacon, Body, DIGEST_TILES, Digest, Member, Packet, ROAD_POINTS, TeamTile,
    TileVersion, Twist, WANTED_TILES, Wanted,
};

use super::quantities::{narrow, narrow_within};
use crate::session::choices::Choices;

/// Half a turn in the wire's bits.
const HALF_TURN: i64 = 12_868;
/// Side of a tile, centimetres.
const TILE_CM: i16 = 320;
/// Cells of a tile.
const TILE_CELLS: u64 = 1_024;

const ACTIVITIES: [Activity; 8] = [
    Activity::Exploring,
    Activity::Yielding,
    Activity::Cornered,
    Activity::Standing,
    Activity::Finished,
    Activity::Faulted,
    Activity::Gone,
    Activity::Holding,
];

/// What the packets of a session depend on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Team {
    /// Number of the robot that hears them.
    pub(super) own: u8,
    /// Where it is, centimetres.
    pub(super) near_cm: (i16, i16),
    /// Number of the last packet.
    pub(super) sequence: u16,
}

impl Team {
    /// Draws a packet.
    pub(super) fn packet(&mut self, choices: &mut impl Choices) -> Packet {
        let ahead = if choices.once_in(8) {
            choices.bits(16) as u16
        } else {
            1
        };
        self.sequence = self.sequence.wrapping_add(ahead);
        let body = match choices.below(6) {
            0..=2 => Body::Beacon(self.beacon(choices)),
            3 => Body::Digest(self.digest(choices)),
            4 => Body::Wanted(self.wanted(choices)),
            _ => Body::Tile(self.tile(choices)),
        };
        Packet {
            from: member(choices),
            sequence: self.sequence,
            body,
        }
    }

    fn beacon(&self, choices: &mut impl Choices) -> Beacon {
        let wildly = choices.once_in(6);
        let on_top = choices.once_in(4);
        let around = |choices: &mut _, near: i16, by: i16| match (wildly, on_top) {
            (true, _) => word(choices),
            (false, true) => near,
            (false, false) => near.wrapping_add(within(choices, by)),
        };
        let (x, y) = self.near_cm;
        let (x_cm, y_cm) = (around(choices, x, 400), around(choices, y, 400));
        let goal = (!choices.once_in(3))
            .then(|| (around(choices, x / 10, 60), around(choices, y / 10, 60)));
        let side = |choices: &mut _| {
            if one_in(choices, 3) {
                byte(choices)
            } else {
                26
            }
        };
        Beacon {
            map: choices.bits(32) as u32,
            x_cm,
            y_cm,
            yaw: if choices.once_in(8) {
                narrow(choices)
            } else {
                narrow_within(choices, -HALF_TURN, HALF_TURN)
            },
            sd_cm: if choices.once_in(2) { byte(choices) } else { 0 },
            velocity: Twist {
                linear: narrow(choices),
                angular: narrow(choices),
            },
            half_length_cm: side(choices),
            half_width_cm: side(choices),
            activity: choices.pick(&ACTIVITIES),
            goal,
            road: (0..choices.below(ROAD_POINTS as u64 + 1))
                .map(|_| (byte(choices) as i8, byte(choices) as i8))
                .collect(),
        }
    }

    /// Draws the place of a tile: within three tiles of the robot; rarely, any.
    fn place(&self, choices: &mut impl Choices) -> (i8, i8) {
        if choices.once_in(8) {
            return (byte(choices) as i8, byte(choices) as i8);
        }
        let (x, y) = self.near_cm;
        let mut near = |cm: i16| (cm.div_euclid(TILE_CM) + within(choices, 3)) as i8;
        (near(x), near(y))
    }

    fn digest(&self, choices: &mut impl Choices) -> Digest {
        let tile = |choices: &mut _| {
            let (x, y) = self.place(choices);
            TileVersion {
                x,
                y,
                epoch: word(choices) as u16,
                hash: word(choices) as u16,
            }
        };
        Digest {
            salt: byte(choices),
            tiles: (0..choices.below(DIGEST_TILES as u64 + 1))
                .map(|_| tile(choices))
                .collect(),
        }
    }

    fn wanted(&self, choices: &mut impl Choices) -> Wanted {
        Wanted {
            of: if choices.once_in(3) {
                byte(choices)
            } else {
                self.own
            },
            tiles: (0..choices.below(WANTED_TILES as u64 + 1))
                .map(|_| self.place(choices))
                .collect(),
        }
    }

    fn tile(&self, choices: &mut impl Choices) -> TeamTile {
        let (x, y) = self.place(choices);
        let epoch = match choices.below(4) {
            0 => word(choices) as u16,
            1 => u16::MAX,
            2 => 0x8000,
            _ => 0,
        };
        TeamTile {
            x,
            y,
            epoch,
            cells: cells(choices),
        }
    }
}

/// Draws the cells of a tile: all classes in turn, one class, stripes, a chequered or a random
/// pattern, or bytes that need not be a tile.
pub(super) fn cells(choices: &mut impl Choices) -> heapless::Vec<u8, 256> {
    let shape = choices.below(6);
    let mut bulk = choices.fork();
    let class = bulk.bits(2) as u8;
    match shape {
        0 => TeamTile::pack((0..TILE_CELLS).map(|cell| (cell % 4) as u8)),
        1 => TeamTile::pack((0..TILE_CELLS).map(move |_| class)),
        2 => (0..bulk.below(257)).map(|_| bulk.bits(8) as u8).collect(),
        3 => {
            let pitch = 2 + bulk.below(8);
            TeamTile::pack((0..TILE_CELLS).map(move |cell| {
                let is_wall =
                    (cell / 32).is_multiple_of(pitch) || (cell % 32).is_multiple_of(pitch);
                if is_wall { 2 } else { 1 }
            }))
        }
        4 => {
            let classes: Vec<u8> = (0..TILE_CELLS).map(|_| 1 + bulk.below(2) as u8).collect();
            TeamTile::pack(classes.iter().copied())
        }
        _ => {
            let word = bulk.bits(64);
            TeamTile::pack((0..TILE_CELLS).map(move |cell| {
                let turn = (cell / 32) as u32 * 7 + (cell % 32) as u32 / 5;
                (word.rotate_left(turn) & 3) as u8
            }))
        }
    }
}

fn member(choices: &mut impl Choices) -> Member {
    Member {
        id: if choices.once_in(10) {
            byte(choices)
        } else {
            choices.below(8) as u8
        },
        boot: if choices.once_in(4) {
            word(choices) as u16
        } else {
            5
        },
    }
}

fn byte(choices: &mut impl Choices) -> u8 {
    choices.bits(8) as u8
}

fn word(choices: &mut impl Choices) -> i16 {
    choices.bits(16) as i16
}

fn one_in(choices: &mut impl Choices, times: u64) -> bool {
    choices.once_in(times)
}

fn within(choices: &mut impl Choices, by: i16) -> i16 {
    choices.between(-i64::from(by), i64::from(by)) as i16
}
