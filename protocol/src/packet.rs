//! The bytes of a packet in the air, or in a datagram.
//!
//! ```text
//! bytes = packet in postcard ++ check: u24    (least significant byte first)
//! check = CRC-24/OPENPGP(packet) xor key(packet)
//! ```
//!
//! The key depends on the schema, so a packet of another program is refused. The check protects
//! against damage and strangers by accident. It does not protect against an attacker.

use crate::check::{CHECK_BYTES, Kind, sum};
use crate::frame::TooLong;
use crate::message::{DIGEST_TILES, Packet, ROAD_POINTS, TILE_BYTES, WANTED_TILES};

/// Member, sequence number and number of the body, bytes.
const HEAD: usize = (1 + 3) + 3 + 1;
/// Map, pose and standard deviation; velocity, hull and activity; goal; road.
const BEACON: usize = (5 + 3 * 3 + 1) + (2 * 3 + 2 + 1) + (1 + 2 * 3) + (1 + 2 * ROAD_POINTS);
/// Length of the longest beacon in the air, bytes.
pub const MAX_BEACON: usize = HEAD + BEACON + CHECK_BYTES;
/// Length of the longest packet in the air, bytes: a tile.
pub const MAX_PACKET: usize = HEAD + (2 + 3) + (2 + TILE_BYTES) + CHECK_BYTES;
const _: () = assert!(MAX_BEACON <= 64);
const _: () = assert!(MAX_PACKET > HEAD + 2 + 8 * DIGEST_TILES + CHECK_BYTES);
const _: () = assert!(MAX_PACKET > HEAD + 2 + 2 * WANTED_TILES + CHECK_BYTES);

/// Writes the bytes of a packet, and returns their number.
///
/// # Errors
/// [`TooLong`] if `out` is too short. [`MAX_PACKET`] bytes are always enough.
pub fn encode_packet(packet: &Packet, out: &mut [u8]) -> Result<usize, TooLong> {
    let length = postcard::to_slice(packet, out).map_err(|_| TooLong)?.len();
    let (body, rest) = out.split_at_mut_checked(length).ok_or(TooLong)?;
    let [a, b, c, _] = (sum(body) ^ Kind::Packet.key()).to_le_bytes();
    rest.get_mut(..CHECK_BYTES)
        .ok_or(TooLong)?
        .copy_from_slice(&[a, b, c]);
    Ok(length + CHECK_BYTES)
}

/// Reads a packet. `None` for damaged bytes, for a packet of another schema, and for anything else.
#[must_use]
pub fn decode_packet(bytes: &[u8]) -> Option<Packet> {
    let (body, check) = bytes.split_last_chunk::<CHECK_BYTES>()?;
    let [a, b, c] = *check;
    let sealed = u32::from_le_bytes([a, b, c, 0]) == sum(body) ^ Kind::Packet.key();
    let (packet, rest) = postcard::take_from_bytes(body).ok().filter(|_| sealed)?;
    rest.is_empty().then_some(packet)
}
