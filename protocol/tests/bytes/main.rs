//! Exact bytes: every message as a value and as its bytes on the wire, in both directions.
//!
//! Bodies are literals. The tests rebuild the frame around them with a bitwise CRC-24 and another
//! crate's COBS, so no line of the tested codec decides what is correct. The frames of the hello
//! never change, so they are literals as a whole.

#[path = "../common/mod.rs"]
mod common;
mod replies;
mod requests;
mod team;

use common::{reply_frame, request_frame};
use fieldline_protocol::SCHEMA;
use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::encode_log;
use fieldline_protocol::message::{Reply, Request};
use fixed::types::{I4F12, I16F16};

fn long(value: f32) -> I16F16 {
    I16F16::from_num(value)
}

fn short(value: f32) -> I4F12 {
    I4F12::from_num(value)
}

/// CRC-24/OPENPGP, computed bit by bit.
fn crc24(content: &[u8]) -> u32 {
    content.iter().fold(0xb7_04ce, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte) << 16, |crc, _| {
            let shifted = crc << 1;
            if shifted & 1 << 24 == 0 {
                shifted
            } else {
                shifted ^ 0x0186_4cfb
            }
        })
    })
}

fn frame(kind: Kind, sequence: u16, body: &[u8]) -> Vec<u8> {
    let mut content = [&sequence.to_le_bytes()[..], body].concat();
    let check = crc24(&content) ^ kind.key();
    content.extend(&check.to_le_bytes()[..3]);
    [cobs::encode_vec(&content), vec![0]].concat()
}

#[track_caller]
fn request_is(request: Request, body: &[u8]) {
    assert_eq!(postcard::to_allocvec(&request).unwrap(), body);
    let kind = if matches!(request, Request::Hello { .. }) {
        Kind::Greeting
    } else {
        Kind::Request
    };
    let bytes = request_frame(0x1234, &request);
    assert_eq!(bytes, frame(kind, 0x1234, body));
    assert_eq!(common::requests(&bytes).0, [(0x1234, request)]);
    assert_eq!(common::replies(&bytes).0, [], "a host ignores requests");
}

#[track_caller]
fn reply_is(reply: Reply, body: &[u8]) {
    assert_eq!(postcard::to_allocvec(&reply).unwrap(), body);
    let kind = match reply {
        Reply::Hello(_) | Reply::Incompatible { .. } => Kind::Welcome,
        _ => Kind::Reply,
    };
    let bytes = reply_frame(0x00ff, &reply);
    assert_eq!(bytes, frame(kind, 0x00ff, body));
    assert_eq!(common::replies(&bytes).0, [(0x00ff, reply)]);
    assert_eq!(common::requests(&bytes).0, [], "a device ignores replies");
}

/// Returns the schema hash as a varint. Its bytes change with the schema.
fn schema() -> Vec<u8> {
    postcard::to_allocvec(&SCHEMA).unwrap()
}

#[test]
fn a_log_is_its_own_body() {
    let mut out = [0; 32];
    let length = encode_log(7, &[0, 1, 0xff], &mut out).unwrap();
    assert_eq!(out[..length], frame(Kind::Log, 7, &[0, 1, 0xff]));
    assert_eq!(common::requests(&out[..length]).0, []);
}

/// No change of the protocol changes these bytes: a greeting of version 9 with schema 1, and its
/// answer.
#[test]
fn the_hello_frame_never_changes() {
    let greeting = Request::Hello {
        version: 9,
        schema: 1,
        nonce: 2,
    };
    assert_eq!(request_frame(1, &greeting), GREETING_OF_VERSION_9);
    let refusal = Reply::Incompatible {
        version: 9,
        schema: 1,
    };
    assert_eq!(reply_frame(1, &refusal), REFUSAL_OF_VERSION_9);
}

const GREETING_OF_VERSION_9: &[u8] = &[2, 1, 1, 7, 9, 1, 2, 0x72, 0x8c, 0x12, 0];
const REFUSAL_OF_VERSION_9: &[u8] = &[2, 1, 7, 1, 9, 1, 0x85, 5, 0x69, 0];
