//! No bytes make a receiver panic or block it: after any garbage, it decodes a good frame behind a
//! delimiter.
//!
//! Each receiver gets ten million strings: arbitrary bytes; frames with changed, lost, doubled or
//! missing bytes; and frames with a correct checksum around arbitrary or changed bodies.

mod common;

use common::{checked_frame, hello, largest_observation, reply_frame, request_frame};
use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side};
use fieldline_protocol::message::{
    CorrectedTile, CorrectedTiles, Identity, Observation, Reply, Request, Scan, Status,
};

/// Sequence number of the frames around arbitrary bodies.
const SEQUENCE: u16 = 0x0201;

/// The random number generator xorshift64*: small and seeded.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 16
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }

    fn bytes(&mut self, length: usize) -> Vec<u8> {
        (0..length).map(|_| self.next() as u8).collect()
    }
}

fn mutate(random: &mut Random, frame: &[u8]) -> Vec<u8> {
    let mut bytes = frame.to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(5) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.next() as u8,
            2 => drop(bytes.remove(at)),
            3 => bytes.insert(at, bytes[at]),
            _ => bytes.truncate(at + 1),
        }
        if bytes.is_empty() {
            bytes.push(0);
        }
    }
    bytes
}

/// Returns the body of a frame.
fn body(frame: &[u8]) -> Vec<u8> {
    let content = cobs::decode_vec(frame).unwrap();
    content[2..content.len() - 3].to_vec()
}

/// Input for one side: its good frames, and the kinds that it accepts.
struct Target<'a> {
    frames: &'a [Vec<u8>],
    kinds: &'a [Kind],
}

fn garbage(random: &mut Random, target: &Target<'_>) -> Vec<u8> {
    let frame = &target.frames[random.below(target.frames.len())];
    let kind = target.kinds[random.below(target.kinds.len())];
    match random.below(8) {
        0 => {
            let length = random.below(40);
            random.bytes(length)
        }
        1 => {
            let bound = if random.below(64) == 0 { 3000 } else { 12 };
            let length = random.below(bound);
            let body = random.bytes(length);
            checked_frame(kind, SEQUENCE, &body)
        }
        2 | 3 => checked_frame(kind, SEQUENCE, &mutate(random, &body(frame))),
        4 => [mutate(random, frame), frame.clone()].concat(),
        _ => mutate(random, frame),
    }
}

/// Number of strings for each side.
const ROUNDS: usize = 10_000_000;

fn hammer<const N: usize>(side: Side, target: &Target<'_>, probe: &[u8], seed: u64) {
    let mut random = Random(seed);
    let mut receiver = Receiver::<N>::new(side);
    let (mut checked, mut decoded) = (0, 0);
    for round in 0..ROUNDS {
        for byte in garbage(&mut random, target) {
            if let Some(frame) = receiver.push(byte) {
                checked += 1;
                decoded += usize::from(frame.request().is_ok() || frame.reply().is_ok());
            }
        }
        if round % 16 == 0 {
            receiver.push(0);
            let (last, head) = probe.split_last().unwrap();
            assert!(head.iter().all(|byte| receiver.push(*byte).is_none()));
            let frame = receiver
                .push(*last)
                .expect("a good frame after a delimiter");
            assert_eq!(frame.sequence, 77, "round {round}");
        }
    }
    let tally = receiver.tally();
    println!("{ROUNDS} strings: {checked} passed the checksum, {decoded} were messages");
    assert!(checked > ROUNDS / 4 && decoded > ROUNDS / 20);
    assert!(tally.crc_errors > 0 && tally.dropped > 0, "{tally:?}");
}

#[test]
fn the_device_survives_any_bytes() {
    let observation = Observation {
        scans: [Scan {
            ranges_mm: (0..40).map(|beam| beam * 300).collect(),
        }]
        .into_iter()
        .collect(),
        ..Observation::default()
    };
    let part = CorrectedTiles {
        epoch: 2,
        tiles: [CorrectedTile::default(); 3].into_iter().collect(),
        cells: [63 << 2; 48].into_iter().collect(),
        ..CorrectedTiles::default()
    };
    let frames = [
        request_frame(1, &hello(5)),
        request_frame(2, &Request::Frontiers),
        request_frame(3, &Request::Tile { x: 3, y: -3 }),
        request_frame(4, &Request::Observation(observation)),
        request_frame(5, &Request::Tiles(part)),
    ];
    let target = Target {
        frames: &frames,
        kinds: &[Kind::Greeting, Kind::Request],
    };
    let probe = request_frame(77, &Request::FieldRow { row: 1 });
    hammer::<MAX_REQUEST_FRAME>(Side::Device, &target, &probe, 1);
}

#[test]
fn the_host_survives_any_bytes() {
    let frames = [
        reply_frame(1, &Reply::Hello(Identity::default())),
        reply_frame(2, &Reply::Control(Status::Exploring)),
        reply_frame(3, &Reply::Command(Default::default())),
        reply_frame(4, &Reply::Tile(None)),
    ];
    let target = Target {
        frames: &frames,
        kinds: &[Kind::Welcome, Kind::Reply, Kind::Log],
    };
    let probe = reply_frame(77, &Reply::FieldRow(None));
    hammer::<MAX_REPLY_FRAME>(Side::Host, &target, &probe, 2);
}

/// A frame longer than the buffer is dropped as a whole. Its end is not decoded as a frame.
#[test]
fn a_long_frame_is_dropped_to_its_delimiter() {
    let good = request_frame(9, &Request::Frontiers);
    let mut bytes = vec![7; MAX_REQUEST_FRAME + 1];
    bytes.extend(&good);
    bytes.extend(&good);
    let mut receiver = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
    let heard = bytes
        .iter()
        .filter(|byte| receiver.push(**byte).is_some())
        .count();
    assert_eq!(heard, 1);
    assert_eq!(
        (receiver.tally().received, receiver.tally().dropped),
        (1, 1)
    );
}

/// The receiver finds every change, loss and doubling of one byte in a full observation's frame.
#[test]
fn every_one_byte_fault_is_found() {
    let frame = request_frame(5, &Request::Observation(largest_observation(16_000)));
    let heard = |bytes: &[u8]| {
        let mut receiver = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
        bytes
            .iter()
            .filter(|byte| receiver.push(**byte).is_some())
            .count()
    };
    assert_eq!(heard(&frame), 1);
    for at in 0..frame.len() - 1 {
        for change in [1u8, 0x80, 0xff] {
            let mut bytes = frame.clone();
            bytes[at] ^= change;
            assert_eq!(heard(&bytes), 0, "byte {at} ^ {change:#x}");
        }
        let mut lost = frame.clone();
        lost.remove(at);
        let mut doubled = frame.clone();
        doubled.insert(at, frame[at]);
        assert_eq!((heard(&lost), heard(&doubled)), (0, 0), "byte {at}");
    }
}
