//! Helpers that the wire tests share: frames, and receivers that take all bytes at once.
#![allow(dead_code, reason = "each test file uses only a part")]

pub(crate) mod arbitrary;

use fieldline_protocol::check::{Kind, sum};
use fieldline_protocol::frame::{
    MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, Tally, encode_reply, encode_request,
};
use fieldline_protocol::message::{MAX_BEAMS, Observation, Pose, Reply, Request, Scan, Twist};
use fixed::types::{I4F12, I16F16};

/// Returns the frame of a request.
pub(crate) fn request_frame(sequence: u16, request: &Request) -> Vec<u8> {
    let mut out = [0; MAX_REQUEST_FRAME];
    let length = encode_request(sequence, request, &mut out).expect("every request fits");
    out[..length].to_vec()
}

/// Returns the frame of a reply.
pub(crate) fn reply_frame(sequence: u16, reply: &Reply) -> Vec<u8> {
    let mut out = [0; MAX_REPLY_FRAME];
    let length = encode_reply(sequence, reply, &mut out).expect("every reply fits");
    out[..length].to_vec()
}

/// Returns the requests that a device decodes from `bytes`, and its counters.
pub(crate) fn requests(bytes: &[u8]) -> (Vec<(u16, Request)>, Tally) {
    let mut receiver = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
    let mut heard = Vec::new();
    for byte in bytes {
        if let Some(frame) = receiver.push(*byte)
            && let Ok(request) = frame.request()
        {
            heard.push((frame.sequence, request));
        }
    }
    (heard, receiver.tally())
}

/// Returns the replies that a host decodes from `bytes`, and its counters.
pub(crate) fn replies(bytes: &[u8]) -> (Vec<(u16, Reply)>, Tally) {
    let mut receiver = Receiver::<MAX_REPLY_FRAME>::new(Side::Host);
    let mut heard = Vec::new();
    for byte in bytes {
        if let Some(frame) = receiver.push(*byte)
            && let Ok(reply) = frame.reply()
        {
            heard.push((frame.sequence, reply));
        }
    }
    (heard, receiver.tally())
}

/// Returns an observation with two full scans of `range_mm`; every other field has the value with
/// the most bytes.
pub(crate) fn largest_observation(range_mm: u16) -> Observation {
    let far = I16F16::MIN;
    let scan = Scan {
        ranges_mm: [range_mm; MAX_BEAMS].into_iter().collect(),
    };
    Observation {
        time_ms: u32::MAX,
        pose: Pose {
            x: far,
            y: far,
            z: far,
            roll: far,
            pitch: far,
            yaw: far,
        },
        velocity: Twist {
            linear: I4F12::MIN,
            angular: I4F12::MIN,
        },
        scans: [scan.clone(), scan].into_iter().collect(),
    }
}

/// Returns a hello of this version and schema.
pub(crate) fn hello(nonce: u32) -> Request {
    Request::Hello {
        version: fieldline_protocol::VERSION,
        schema: fieldline_protocol::SCHEMA,
        nonce,
    }
}

/// Returns a frame with a correct checksum around any body, stuffed by another crate.
pub(crate) fn checked_frame(kind: Kind, sequence: u16, body: &[u8]) -> Vec<u8> {
    let mut content = [&sequence.to_le_bytes()[..], body].concat();
    let check = sum(&content) ^ kind.key();
    content.extend(&check.to_le_bytes()[..3]);
    [cobs::encode_vec(&content), vec![0]].concat()
}
