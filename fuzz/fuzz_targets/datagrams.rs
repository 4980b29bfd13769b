//! Any bytes as a datagram between processes: nothing panics, and only what was sealed is opened.
#![no_main]

use fieldline_protocol::packet::{MAX_PACKET, decode_packet, encode_packet};
use libfuzzer_sys::fuzz_target;

#[expect(dead_code, reason = "the target does not use all of it")]
#[path = "../../host-sim/src/network/envelope.rs"]
mod envelope;

use envelope::{Heard, Key, Kind, Letter};

fuzz_target!(|data: &[u8]| {
    let key = Key::new(b"0123456789abcdef");
    // No fuzzer guesses a tag.
    assert!(key.open(data).is_err());
    let letter = Letter {
        kind: Kind::Packet,
        from: data.first().map_or(0, |byte| byte % 8),
        session: data.len() as u64,
        counter: 1,
        body: data,
    };
    let bytes = key.seal(&letter);
    assert_eq!(key.open(&bytes), Ok(letter));
    let mut heard = Heard::default();
    assert!(heard.is_new(&letter));
    assert!(!heard.is_new(&letter));
    if let Some(packet) = decode_packet(data) {
        // A decoded packet can be encoded again.
        let mut out = [0; MAX_PACKET];
        assert!(encode_packet(&packet, &mut out).is_ok());
    }
});
