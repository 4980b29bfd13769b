//! No bytes make a receiver panic, and none wedge it: after any garbage, a delimiter and a good frame are decoded.
//!
//! Ten million strings into each receiver: arbitrary bytes; frames with bytes changed, lost, doubled or cut; and, past
//! the checksum, well-checked frames around arbitrary bodies and around bodies that were changed so.

mod common;

use common::{hello, largest_observation, reply_frame, request_frame};
use fieldline_protocol::check::{Kind, sum};
use fieldline_protocol::frame::{MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side};
use fieldline_protocol::message::{Identity, Observation, Reply, Request, Scan, Status};

/// xorshift64*: small, seeded, good enough to choose bytes.
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

/// A frame with a right checksum around any body.
fn checked(kind: Kind, body: &[u8]) -> Vec<u8> {
    let mut content = [&[1, 2][..], body].concat();
    let check = sum(&content) ^ kind.key();
    content.extend(&check.to_le_bytes()[..3]);
    [cobs::encode_vec(&content), vec![0]].concat()
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

/// What a frame's check was made for.
fn body(frame: &[u8]) -> Vec<u8> {
    let content = cobs::decode_vec(frame).unwrap();
    content[2..content.len() - 3].to_vec()
}

/// What is thrown at one side: its good frames, and the kinds that get past its checksum.
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
            checked(kind, &body)
        }
        2 | 3 => checked(kind, &mutate(random, &body(frame))),
        4 => [mutate(random, frame), frame.clone()].concat(),
        _ => mutate(random, frame),
    }
}

/// Strings thrown at each side.
const ROUNDS: usize = 10_000_000;

fn hammer<const N: usize>(side: Side, target: &Target<'_>, probe: &[u8], seed: u64) {
    let mut random = Random(seed);
    let mut receiver = Receiver::<N>::new(side);
    let (mut checked, mut understood) = (0, 0);
    for round in 0..ROUNDS {
        for byte in garbage(&mut random, target) {
            if let Some(frame) = receiver.push(byte) {
                checked += 1;
                understood += usize::from(frame.request().is_ok() || frame.reply().is_ok());
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
    println!("{ROUNDS} strings: {checked} went past the checksum, {understood} were messages");
    assert!(checked > ROUNDS / 4 && understood > ROUNDS / 20);
    assert!(tally.crc_errors > 0 && tally.dropped > 0, "{tally:?}");
}

#[test]
fn the_device_survives_anything() {
    let observation = Observation {
        scans: [Scan {
            ranges_mm: (0..40).map(|beam| beam * 300).collect(),
        }]
        .into_iter()
        .collect(),
        ..Observation::default()
    };
    let frames = [
        request_frame(1, &hello(5)),
        request_frame(2, &Request::Frontiers),
        request_frame(3, &Request::Tile { x: 3, y: -3 }),
        request_frame(4, &Request::Observation(observation)),
    ];
    let target = Target {
        frames: &frames,
        kinds: &[Kind::Greeting, Kind::Request],
    };
    let probe = request_frame(77, &Request::FieldRow { row: 1 });
    hammer::<MAX_REQUEST_FRAME>(Side::Device, &target, &probe, 1);
}

#[test]
fn the_host_survives_anything() {
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

/// A frame longer than the buffer is dropped as a whole: its tail is not taken for a frame.
#[test]
fn too_long_is_dropped_to_the_next_delimiter() {
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

/// Every one-byte change, loss and doubling of a full observation's frame is found.
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
