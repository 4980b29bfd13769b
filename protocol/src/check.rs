//! The checksum of a frame, and the keys that are mixed into it.
//!
//! ```text
//! check = CRC-24/OPENPGP(sequence ++ body) xor key(kind)
//! ```
//!
//! The key depends on the kind of the frame and, except for the hello, on the schema hash. A frame
//! of another schema, kind or direction therefore fails the check, and no byte of the frame is
//! spent on saying what it is.
//!
//! Why 24 bits: a frame may cost ten bytes. A full observation needs four bytes of stuffing, two of
//! sequence number and one delimiter, so three are left.
//!
//! What it finds: x + 1 divides the polynomial, and the order of x is far above the length of our
//! longest frame. All errors of up to three bits are found, and all bursts of up to 24 bits except
//! the few that turn the key of one kind into the key of another. Damage to the stuffing moves
//! everything behind it; such a frame passes by chance once in 2²⁴. It must then still hold a
//! well-formed message of the right kind with the awaited sequence number.

use crc::{CRC_24_OPENPGP, Crc};

use crate::schema::{SCHEMA, fold};

/// Length of the checksum, bytes.
pub const CHECK_BYTES: usize = 3;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_24_OPENPGP);

/// The kinds of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From the host: [`crate::message::Request::Hello`].
    Greeting,
    /// From the host: any other request.
    Request,
    /// From the device: [`crate::message::Reply::Hello`] or
    /// [`crate::message::Reply::Incompatible`].
    Welcome,
    /// From the device: any other reply.
    Reply,
    /// From the device: bytes of its log.
    Log,
    /// From a robot to its team: [`crate::message::Packet`].
    Packet,
}

impl Kind {
    /// The key that is mixed into the checksum of a frame of this kind. The keys of the two hello
    /// kinds never change.
    #[must_use]
    pub const fn key(self) -> u32 {
        match self {
            Self::Greeting => 0x48_69_3f,
            Self::Welcome => 0x48_69_21,
            Self::Request => SCHEMA_KEY,
            Self::Reply => SCHEMA_KEY ^ 0x5a_96_c3,
            Self::Log => SCHEMA_KEY ^ 0xc3_69_5a,
            Self::Packet => SCHEMA_KEY ^ 0x69_5a_3c,
        }
    }
}

const SCHEMA_KEY: u32 = {
    let hash = fold(0xcbf2_9ce4_8422_2325, SCHEMA as u64);
    ((hash ^ (hash >> 40)) & 0xff_ffff) as u32
};

/// Returns the checksum of `content` (sequence number and body) without a key.
#[must_use]
pub fn sum(content: &[u8]) -> u32 {
    CRC.checksum(content)
}

/// The checksum of the part of a frame that is already written.
pub(crate) struct RunningChecksum(crc::Digest<'static, u32>);

impl RunningChecksum {
    pub(crate) fn new() -> Self {
        Self(CRC.digest())
    }

    pub(crate) fn push(&mut self, byte: u8) {
        self.0.update(&[byte]);
    }

    /// Returns the bytes to send, least significant first.
    pub(crate) fn seal(self, kind: Kind) -> [u8; CHECK_BYTES] {
        let [a, b, c, _] = (self.0.finalize() ^ kind.key()).to_le_bytes();
        [a, b, c]
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{Kind, sum};
    use crate::frame::MAX_REQUEST_FRAME;

    const POLYNOMIAL: u32 = 0x0186_4cfb;

    #[test]
    fn checksum_has_the_catalogue_value() {
        assert_eq!(sum(b"123456789"), 0x21_cf02);
    }

    /// x + 1 divides the polynomial, so every odd number of wrong bits is found. The order of x is
    /// greater than the bits of the longest frame, so every two wrong bits are found.
    #[test]
    fn up_to_three_wrong_bits_are_found() {
        assert_eq!(POLYNOMIAL.count_ones() % 2, 0);
        let mut power = 1u32;
        for exponent in 1..=8 * MAX_REQUEST_FRAME {
            power <<= 1;
            if power > 0x00ff_ffff {
                power ^= POLYNOMIAL;
            }
            assert_ne!(power, 1, "x^{exponent} = 1");
        }
    }

    #[test]
    fn every_kind_has_its_own_key() {
        let kinds = [
            Kind::Greeting,
            Kind::Request,
            Kind::Welcome,
            Kind::Reply,
            Kind::Log,
            Kind::Packet,
        ];
        let keys: BTreeSet<u32> = kinds.iter().map(|kind| kind.key()).collect();
        assert_eq!(keys.len(), kinds.len());
        assert!(keys.iter().all(|key| *key < 1 << 24));
    }

    /// A burst of up to eight wrong bits never turns a reply into a log or a log into a reply,
    /// wherever it lies in the frame. A hello differs from the other kinds by its message number as
    /// well.
    #[test]
    fn one_wrong_byte_never_turns_a_log_into_a_reply() {
        let swap = Kind::Reply.key() ^ Kind::Log.key();
        for burst in 1..=255u32 {
            let mut syndrome = burst;
            for _ in 0..8 * MAX_REQUEST_FRAME {
                assert_ne!(syndrome, swap, "{burst:#x}");
                syndrome <<= 1;
                if syndrome > 0x00ff_ffff {
                    syndrome ^= POLYNOMIAL;
                }
            }
        }
    }
}
