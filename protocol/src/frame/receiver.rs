//! The receiver: bytes to frames.
//!
//! A receiver is a total function of the bytes. It counts and drops what is too long, not stuffed,
//! fails the check or belongs to the other side. Then it starts again at the next delimiter.

use super::{Frame, SEQUENCE_BYTES};
use crate::check::{self, CHECK_BYTES, Kind};
use crate::cobs;

/// The end of the line at which a receiver sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Accepts greetings and requests.
    Device,
    /// Accepts welcomes, replies and logs.
    Host,
}

impl Side {
    const fn kinds(self) -> &'static [Kind] {
        match self {
            Self::Device => &[Kind::Greeting, Kind::Request],
            Self::Host => &[Kind::Welcome, Kind::Reply, Kind::Log],
        }
    }
}

/// Counters of a receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Frames with a correct checksum.
    pub received: u32,
    /// Frames with a wrong checksum: noise, another schema, another direction.
    pub crc_errors: u32,
    /// Frames that were too long, too short or not stuffed.
    pub dropped: u32,
}

/// Turns bytes into frames. `N` bytes hold the longest frame without its delimiter.
///
/// ```
/// use fieldline_protocol::frame::{MAX_REQUEST_FRAME, Receiver, Side, encode_request};
/// use fieldline_protocol::message::Request;
///
/// let mut out = [0; MAX_REQUEST_FRAME];
/// let length = encode_request(7, &Request::Frontiers, &mut out)?;
/// let mut device = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
/// let mut requests = vec![];
/// for byte in &out[..length] {
///     if let Some(frame) = device.push(*byte) {
///         requests.push((frame.sequence, frame.request()));
///     }
/// }
/// assert_eq!(requests, [(7, Ok(Request::Frontiers))]);
/// # Ok::<(), fieldline_protocol::frame::TooLong>(())
/// ```
///
/// Invariant: `buffer[..length]` holds the bytes since the last delimiter, unless `overrun` is set.
#[derive(Debug)]
pub struct Receiver<const N: usize> {
    side: Side,
    buffer: [u8; N],
    length: usize,
    overrun: bool,
    tally: Tally,
}

impl<const N: usize> Receiver<N> {
    /// Returns an empty receiver at `side`.
    #[must_use]
    pub const fn new(side: Side) -> Self {
        Self {
            side,
            buffer: [0; N],
            length: 0,
            overrun: false,
            tally: Tally {
                received: 0,
                crc_errors: 0,
                dropped: 0,
            },
        }
    }

    /// Returns the counters since the receiver was made.
    #[must_use]
    pub const fn tally(&self) -> Tally {
        self.tally
    }

    /// Takes a byte and returns the frame that it completes.
    pub fn push(&mut self, byte: u8) -> Option<Frame<'_>> {
        if byte != 0 {
            match self.buffer.get_mut(self.length) {
                Some(slot) => {
                    *slot = byte;
                    self.length += 1;
                }
                None => self.overrun = true,
            }
            return None;
        }
        let length = core::mem::take(&mut self.length);
        if core::mem::take(&mut self.overrun) {
            self.tally.dropped = self.tally.dropped.wrapping_add(1);
            return None;
        }
        // Several delimiters in a row are an idle line: a sender may end noise with one.
        if length == 0 { None } else { self.open(length) }
    }

    /// Decodes and checks the `length` bytes in the buffer.
    fn open(&mut self, length: usize) -> Option<Frame<'_>> {
        let Self {
            side,
            buffer,
            tally,
            ..
        } = self;
        let unstuffed = buffer.get_mut(..length).and_then(|stuffed| {
            let length = cobs::unstuff(stuffed)?;
            let (content, check) = stuffed.get(..length)?.split_last_chunk::<CHECK_BYTES>()?;
            let (sequence, body) = content.split_first_chunk::<SEQUENCE_BYTES>()?;
            Some((content, *sequence, body, *check))
        });
        let Some((content, sequence, body, [a, b, c])) = unstuffed else {
            tally.dropped = tally.dropped.wrapping_add(1);
            return None;
        };
        let key = check::sum(content) ^ u32::from_le_bytes([a, b, c, 0]);
        let Some(&kind) = side.kinds().iter().find(|kind| kind.key() == key) else {
            tally.crc_errors = tally.crc_errors.wrapping_add(1);
            return None;
        };
        tally.received = tally.received.wrapping_add(1);
        Some(Frame {
            kind,
            sequence: u16::from_le_bytes(sequence),
            body,
        })
    }
}
