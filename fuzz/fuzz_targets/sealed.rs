//! A frame with a correct checksum around any body.

use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{encode_body, overhead};

/// Returns the frame of `body`, which need not be a message.
pub fn frame(kind: Kind, sequence: u16, body: &[u8]) -> Vec<u8> {
    let mut out = vec![0; body.len() + overhead(body.len())];
    let length = encode_body(kind, sequence, body, &mut out).expect("the frame fits");
    out.truncate(length);
    out
}
