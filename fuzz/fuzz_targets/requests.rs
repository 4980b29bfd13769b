//! Any bytes into the device's receiver: it never panics, and it always decodes the next good
//! frame.
#![no_main]

use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{MAX_REQUEST_FRAME, Receiver, Side, encode_request};
use fieldline_protocol::message::Request;
use libfuzzer_sys::fuzz_target;

#[path = "sealed.rs"]
mod sealed;

fuzz_target!(|data: &[u8]| {
    let mut receiver = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
    let mut out = [0; MAX_REQUEST_FRAME];
    let sealed = [Kind::Greeting, Kind::Request].map(|kind| sealed::frame(kind, 9, data));
    for byte in data.iter().chain(&sealed[0]).chain(&sealed[1]) {
        if let Some(Ok(request)) = receiver.push(*byte).map(|frame| frame.request()) {
            // A decoded request can be encoded again.
            assert!(encode_request(1, &request, &mut out).is_ok());
        }
    }
    receiver.push(0);
    let length = encode_request(77, &Request::Frontiers, &mut out).unwrap();
    let heard = out[..length]
        .iter()
        .filter(|byte| receiver.push(**byte).is_some())
        .count();
    assert_eq!(heard, 1, "the receiver missed a good frame");
});
