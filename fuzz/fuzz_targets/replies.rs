//! Any bytes into the host's receiver: it never panics, and it always decodes the next good frame.
#![no_main]

use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{MAX_REPLY_FRAME, Receiver, Side, encode_reply};
use fieldline_protocol::message::Reply;
use libfuzzer_sys::fuzz_target;

#[path = "sealed.rs"]
mod sealed;

fuzz_target!(|data: &[u8]| {
    let mut receiver = Receiver::<MAX_REPLY_FRAME>::new(Side::Host);
    let mut out = [0; MAX_REPLY_FRAME];
    let sealed = [Kind::Welcome, Kind::Reply].map(|kind| sealed::frame(kind, 9, data));
    for byte in data.iter().chain(&sealed[0]).chain(&sealed[1]) {
        if let Some(Ok(reply)) = receiver.push(*byte).map(|frame| frame.reply()) {
            // A decoded reply can be encoded again.
            assert!(encode_reply(1, &reply, &mut out).is_ok());
        }
    }
    receiver.push(0);
    let length = encode_reply(77, &Reply::Tile(None), &mut out).unwrap();
    let heard = out[..length]
        .iter()
        .filter(|byte| receiver.push(**byte).is_some())
        .count();
    assert_eq!(heard, 1, "the receiver missed a good frame");
});
