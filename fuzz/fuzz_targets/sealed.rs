//! A frame with a right checksum around any body, stuffed the simple way.

use fieldline_protocol::check::{Kind, sum};
use fieldline_protocol::cobs::Stuffer;

pub fn frame(kind: Kind, sequence: u16, body: &[u8]) -> Vec<u8> {
    let mut content = [&sequence.to_le_bytes()[..], body].concat();
    let check = sum(&content) ^ kind.key();
    content.extend(&check.to_le_bytes()[..3]);
    let mut out = vec![0; content.len() + content.len() / 254 + 3];
    let mut stuffer = Stuffer::new(&mut out);
    for byte in content {
        stuffer.push(byte).expect("there is room");
    }
    let length = stuffer.finish().expect("there is room");
    out.truncate(length);
    out
}
