//! The bytes of a datagram around a packet, and who may have sent it.
//!
//! ```text
//! datagram = "FL" version kind from session counter body tag
//! bytes       2     1      1    1     8       8      n   16
//! tag      = first 16 bytes of HMAC-SHA-256(key, all before it)    [RFC 2104]
//! ```
//!
//! Numbers have their least significant byte first. All members of a team have one key. Without a
//! key the tag is made with the empty key: then it only finds damage, and teams with and without a
//! key refuse each other.
//!
//! A *session* is a number that grows from one start of a process to the next, and *counter* grows
//! from 1 in each. [`Heard`] accepts each pair once: so a datagram that was recorded is refused by
//! everyone who heard a later session of its sender, or the datagram itself. A process that has
//! just begun has heard nothing yet: it takes a recorded session for the present one until it hears
//! a later one.
//!
//! Nothing here panics for any input.

use hmac::{Hmac, KeyInit as _, Mac as _};
use sha2::Sha256;

/// Greatest number of robots in a team.
pub const ROBOTS: usize = 8;
/// Bytes of the tag.
const TAG: usize = 16;
/// Bytes before the body.
const HEAD: usize = 21;
/// First bytes of a datagram, and its version.
const MAGIC: [u8; 3] = [b'F', b'L', 1];
/// Bytes of a datagram around its body.
pub const OVERHEAD: usize = HEAD + TAG;

/// What a datagram carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A packet of the team.
    Packet,
    /// The port at which the sender hears packets, to be found by others.
    Hello,
}

/// Why a datagram is dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// It is no datagram of this program.
    Malformed,
    /// Its tag is wrong: another key, or damage.
    Unauthentic,
}

/// A datagram's content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Letter<'a> {
    /// What it carries.
    pub kind: Kind,
    /// The sender's number.
    pub from: u8,
    /// The sender's session.
    pub session: u64,
    /// Number of the datagram in the session, from 1.
    pub counter: u64,
    /// The content.
    pub body: &'a [u8],
}

/// The key of a team.
#[derive(Clone, Default)]
pub struct Key(Vec<u8>);

impl core::fmt::Debug for Key {
    /// Hides the key.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(if self.0.is_empty() { "no key" } else { "a key" })
    }
}

impl Key {
    /// The key of these bytes; no bytes are no key.
    #[must_use]
    pub fn new(bytes: &[u8]) -> Self {
        Self(bytes.to_vec())
    }

    /// Returns true if there is a key.
    #[must_use]
    pub fn is_secret(&self) -> bool {
        !self.0.is_empty()
    }

    /// Returns the bytes of a datagram.
    #[must_use]
    pub fn seal(&self, letter: &Letter<'_>) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(OVERHEAD + letter.body.len());
        bytes.extend(MAGIC);
        bytes.push(letter.kind as u8);
        bytes.push(letter.from);
        bytes.extend(letter.session.to_le_bytes());
        bytes.extend(letter.counter.to_le_bytes());
        bytes.extend(letter.body);
        let tag = self
            .mac(&bytes)
            .map(|mac| mac.finalize().into_bytes())
            .unwrap_or_default();
        bytes.extend(tag.iter().take(TAG));
        bytes
    }

    /// Reads a datagram.
    ///
    /// # Errors
    /// [`Refused`].
    pub fn open<'a>(&self, bytes: &'a [u8]) -> Result<Letter<'a>, Refused> {
        let (sealed, tag) = bytes.split_last_chunk::<TAG>().ok_or(Refused::Malformed)?;
        let (head, body) = sealed
            .split_first_chunk::<HEAD>()
            .ok_or(Refused::Malformed)?;
        let [a, b, c, kind, from, numbers @ ..] = *head;
        let kind = match kind {
            0 => Kind::Packet,
            1 => Kind::Hello,
            _ => return Err(Refused::Malformed),
        };
        if [a, b, c] != MAGIC || usize::from(from) >= ROBOTS {
            return Err(Refused::Malformed);
        }
        // Compares in a time that does not depend on the bytes.
        let mac = self.mac(sealed).ok_or(Refused::Malformed)?;
        mac.verify_truncated_left(tag)
            .map_err(|_| Refused::Unauthentic)?;
        let [
            s0,
            s1,
            s2,
            s3,
            s4,
            s5,
            s6,
            s7,
            c0,
            c1,
            c2,
            c3,
            c4,
            c5,
            c6,
            c7,
        ] = numbers;
        Ok(Letter {
            kind,
            from,
            session: u64::from_le_bytes([s0, s1, s2, s3, s4, s5, s6, s7]),
            counter: u64::from_le_bytes([c0, c1, c2, c3, c4, c5, c6, c7]),
            body,
        })
    }

    /// Returns the code of these bytes. HMAC takes keys of any length.
    fn mac(&self, bytes: &[u8]) -> Option<Hmac<Sha256>> {
        let mut mac = Hmac::<Sha256>::new_from_slice(&self.0).ok()?;
        mac.update(bytes);
        Some(mac)
    }
}

/// The datagrams that were heard of one sender.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    session: u64,
    newest: u64,
    /// Bit k: datagram `newest − k` was heard.
    heard: u64,
}

/// The datagrams that were heard, by sender.
#[derive(Clone, Debug, Default)]
pub struct Heard([Window; ROBOTS]);

impl Heard {
    /// Notes a datagram; returns false if it was heard before, or is of an earlier session, or is
    /// more than 63 older than the newest of its session.
    pub fn is_new(&mut self, letter: &Letter<'_>) -> bool {
        let Some(window) = self.0.get_mut(usize::from(letter.from)) else {
            return false;
        };
        if letter.session > window.session {
            *window = Window {
                session: letter.session,
                newest: letter.counter,
                heard: 1,
            };
            return true;
        }
        if letter.session < window.session {
            return false;
        }
        if letter.counter > window.newest {
            let ahead = letter.counter - window.newest;
            let ahead = u32::try_from(ahead).unwrap_or(u32::MAX);
            window.heard = window.heard.checked_shl(ahead).unwrap_or(0) | 1;
            window.newest = letter.counter;
            return true;
        }
        let behind = u32::try_from(window.newest - letter.counter).unwrap_or(u32::MAX);
        let bit = 1_u64.checked_shl(behind).unwrap_or(0);
        let is_new = bit != 0 && window.heard & bit == 0;
        window.heard |= bit;
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: &[u8] = b"a packet";

    fn letter(session: u64, counter: u64) -> Letter<'static> {
        Letter {
            kind: Kind::Packet,
            from: 2,
            session,
            counter,
            body: BODY,
        }
    }

    #[test]
    fn the_bytes_are_exact() {
        let bytes = Key::new(b"secret").seal(&letter(0x0102, 3));
        let head = [
            b'F', b'L', 1, 0, 2, 2, 1, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0,
        ];
        assert_eq!(bytes[..HEAD], head);
        assert_eq!(&bytes[HEAD..HEAD + 8], BODY);
        assert_eq!(bytes.len(), OVERHEAD + 8);
    }

    #[test]
    fn the_tag_is_that_of_rfc_4231() {
        // Test case 2: key "Jefe", data "what do ya want for nothing?".
        let mac = Key::new(b"Jefe")
            .mac(b"what do ya want for nothing?")
            .unwrap();
        let tag = mac.finalize().into_bytes();
        assert_eq!(tag[..4], [0x5b, 0xdc, 0xc1, 0x46]);
    }

    #[test]
    fn only_the_same_key_opens_and_no_bit_may_change() {
        let (key, other) = (Key::new(b"secret"), Key::new(b"Secret"));
        let bytes = key.seal(&letter(7, 9));
        assert_eq!(key.open(&bytes), Ok(letter(7, 9)));
        assert_eq!(other.open(&bytes), Err(Refused::Unauthentic));
        assert_eq!(Key::default().open(&bytes), Err(Refused::Unauthentic));
        for bit in 0..8 * bytes.len() {
            let mut bytes = bytes.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(key.open(&bytes).is_err(), "bit {bit}");
        }
        for length in 0..bytes.len() {
            assert!(key.open(&bytes[..length]).is_err(), "{length} bytes");
        }
        assert_eq!(format!("{key:?}{:?}", Key::default()), "a keyno key");
    }

    #[test]
    fn a_datagram_is_new_once() {
        let mut heard = Heard::default();
        let mut is_new = |session, counter| heard.is_new(&letter(session, counter));
        assert!(is_new(5, 1) && !is_new(5, 1));
        // Out of order, within the window.
        assert!(is_new(5, 4) && is_new(5, 2) && is_new(5, 3) && !is_new(5, 2));
        assert!(is_new(5, 67) && !is_new(5, 3) && !is_new(5, 4) && is_new(5, 5));
        // A new session begins anew, and the earlier one is over.
        assert!(is_new(6, 1) && !is_new(5, 68) && !is_new(6, 1) && is_new(6, 2));
        assert!(is_new(6, u64::MAX) && !is_new(6, u64::MAX) && !is_new(6, 3));
    }
}
