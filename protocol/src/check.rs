//! The frame's checksum, and the keys folded into it.
//!
//! ```text
//! check = CRC-24/OPENPGP(sequence ++ body) xor key(kind)
//! ```
//!
//! The key depends on the kind of frame and, but for the hello, on the schema hash: a frame of another schema, kind or
//! direction fails the check, without a byte spent on saying what it is. Why 24 bits: a full observation needs four bytes of
//! stuffing, two of sequence and a delimiter, and ten bytes of overhead are what a frame may cost. The polynomial is divisible
//! by x + 1 and of an order far beyond our longest frame, so up to three wrong bits anywhere are always found, and so is a burst
//! of up to 24, but for those few that turn the key of one kind into that of another. What is left (damage to
//! the stuffing moves everything behind it) passes once in 2²⁴, and must then still be a well-formed message of the right
//! kind with the awaited sequence number.

use crc::{CRC_24_OPENPGP, Crc};

use crate::schema::{SCHEMA, fold};

/// Bytes of the checksum.
pub const CHECK_BYTES: usize = 3;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_24_OPENPGP);

/// What a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From the host: [`crate::message::Request::Hello`].
    Greeting,
    /// From the host: any other request.
    Request,
    /// From the device: [`crate::message::Reply::Hello`] or [`crate::message::Reply::Incompatible`].
    Welcome,
    /// From the device: any other reply.
    Reply,
    /// From the device: bytes of its log.
    Log,
}

impl Kind {
    /// What is folded into the checksum of a frame of this kind. The hello's never change.
    #[must_use]
    pub const fn key(self) -> u32 {
        match self {
            Self::Greeting => 0x48_69_3f,
            Self::Welcome => 0x48_69_21,
            Self::Request => SCHEMA_KEY,
            Self::Reply => SCHEMA_KEY ^ 0x5a_96_c3,
            Self::Log => SCHEMA_KEY ^ 0xc3_69_5a,
        }
    }
}

const SCHEMA_KEY: u32 = {
    let hash = fold(0xcbf2_9ce4_8422_2325, SCHEMA as u64);
    ((hash ^ (hash >> 40)) & 0xff_ffff) as u32
};

/// The checksum of sequence number and body, before a key is folded in.
#[must_use]
pub fn sum(content: &[u8]) -> u32 {
    CRC.checksum(content)
}

/// The running checksum of a frame that is being written.
pub(crate) struct Running(crc::Digest<'static, u32>);

impl Running {
    pub(crate) fn new() -> Self {
        Self(CRC.digest())
    }

    pub(crate) fn push(&mut self, byte: u8) {
        self.0.update(&[byte]);
    }

    /// The bytes to send, least significant first.
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
    fn the_check_value_of_the_catalogue() {
        assert_eq!(sum(b"123456789"), 0x21_cf02);
    }

    /// x + 1 divides the polynomial: every odd number of wrong bits is found. The order of x exceeds the longest frame:
    /// every two are.
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
    fn every_kind_has_a_key_of_its_own() {
        let kinds = [
            Kind::Greeting,
            Kind::Request,
            Kind::Welcome,
            Kind::Reply,
            Kind::Log,
        ];
        let keys: BTreeSet<u32> = kinds.iter().map(|kind| kind.key()).collect();
        assert_eq!(keys.len(), kinds.len());
        assert!(keys.iter().all(|key| *key < 1 << 24));
    }

    /// A reply never turns into a log, or a log into a reply, by a burst of up to eight wrong bits anywhere in a frame. (Between
    /// a hello and the rest, the message's own number stands as well.)
    #[test]
    fn a_wrong_byte_makes_no_reply_of_a_log() {
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
