//! Frames: messages to bytes and back.
//!
//! ```text
//! frame = COBS(sequence: u16 ++ body ++ check: u24) ++ 0         (integers least significant byte first)
//! ```
//!
//! Ten bytes are the most that a frame costs beside its body ([`overhead`]), for every message whose ranges are at most
//! [`crate::message::NO_RETURN_MM`]. A [`Receiver`] is a total function of the bytes: what is too long, not stuffed, wrongly checked
//! or of a kind for the other side is counted and dropped, and the next delimiter starts afresh.

use core::fmt;

use postcard::ser_flavors::Flavor;
use serde::{Deserialize, Serialize};

use crate::check::{self, CHECK_BYTES, Kind, Running};
use crate::cobs::{self, Stuffer};
use crate::message::{
    FIELD_SIDE, MAX_BEAMS, MAX_SCANS, ROAD_PAGE, Reply, Request, TILE_BYTES, TILE_DATES,
    TILE_SKELETON_BYTES,
};
use crate::schema::{SCHEMA, VERSION};

/// Bytes of the sequence number.
const SEQUENCE_BYTES: usize = 2;
/// Bytes of log that one frame carries at the most.
pub const MAX_LOG_BYTES: usize = 240;

/// Body of the largest request: an observation of two full scans whose ranges all need three bytes, and a pose, velocity
/// and time at the ends of their types.
const MAX_REQUEST_BODY: usize = 1 + 5 + 6 * 5 + 2 * 3 + 1 + MAX_SCANS * (2 + MAX_BEAMS * 3);
/// Body of the largest reply: a map tile. A field row takes 4 bytes a cell, less in sum.
const MAX_REPLY_BODY: usize =
    2 + 2 * 3 + (2 + TILE_BYTES) + (1 + TILE_SKELETON_BYTES) + 3 + TILE_DATES;
const _: () = assert!(MAX_REPLY_BODY > 12 + 4 * FIELD_SIDE && MAX_REPLY_BODY > MAX_LOG_BYTES);
// A page of the road: tractor point, shield, length, and cells of two varints.
const _: () = assert!(MAX_REPLY_BODY > 1 + 7 + 13 + 2 + 6 * ROAD_PAGE);

/// Bytes of the longest frame that a host sends, delimiter included.
pub const MAX_REQUEST_FRAME: usize = MAX_REQUEST_BODY + overhead(MAX_REQUEST_BODY);
/// Bytes of the longest frame that a device sends, delimiter included.
pub const MAX_REPLY_FRAME: usize = MAX_REPLY_BODY + overhead(MAX_REPLY_BODY);

/// The most bytes that a frame adds to a body of `body` bytes: sequence, checksum, stuffing and delimiter.
#[must_use]
pub const fn overhead(body: usize) -> usize {
    let content = SEQUENCE_BYTES + body + CHECK_BYTES;
    SEQUENCE_BYTES + CHECK_BYTES + 1 + (content - 1) / 254 + 1
}

/// The frame does not fit the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

impl fmt::Display for TooLong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "the frame does not fit its buffer; give it MAX_REQUEST_FRAME or MAX_REPLY_FRAME bytes",
        )
    }
}

impl core::error::Error for TooLong {}

/// Why a checked body is no message for us.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyError {
    /// Not a message of this schema, or bytes left over.
    Malformed,
    /// A hello of another protocol.
    Foreign {
        /// The peer's protocol version.
        version: u16,
        /// Hash of the peer's message schema.
        schema: u32,
    },
}

impl fmt::Display for BodyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed => {
                f.write_str("a checked frame does not hold a message of this schema")
            }
            Self::Foreign { version, schema } => write!(
                f,
                "the peer speaks protocol {version} with schema {schema:#010x}, not {VERSION} with {SCHEMA:#010x}; build both ends from the same source"
            ),
        }
    }
}

impl core::error::Error for BodyError {}

/// Checksums and stuffs a body while postcard writes it.
struct Writer<'a> {
    check: Running,
    stuffer: Stuffer<'a>,
    kind: Kind,
}

impl<'a> Writer<'a> {
    fn new(kind: Kind, sequence: u16, out: &'a mut [u8]) -> Result<Self, postcard::Error> {
        let mut writer = Self {
            check: Running::new(),
            stuffer: Stuffer::new(out),
            kind,
        };
        writer.try_extend(&sequence.to_le_bytes())?;
        Ok(writer)
    }
}

impl Flavor for Writer<'_> {
    type Output = usize;

    fn try_push(&mut self, byte: u8) -> Result<(), postcard::Error> {
        self.check.push(byte);
        self.stuffer
            .push(byte)
            .map_err(|cobs::Full| postcard::Error::SerializeBufferFull)
    }

    fn finalize(mut self) -> Result<usize, postcard::Error> {
        let full = |cobs::Full| postcard::Error::SerializeBufferFull;
        for byte in self.check.seal(self.kind) {
            self.stuffer.push(byte).map_err(full)?;
        }
        self.stuffer.finish().map_err(full)
    }
}

fn encode<T: Serialize>(
    kind: Kind,
    sequence: u16,
    body: &T,
    out: &mut [u8],
) -> Result<usize, TooLong> {
    let too_long = |_| TooLong;
    let writer = Writer::new(kind, sequence, out).map_err(too_long)?;
    postcard::serialize_with_flavor(body, writer).map_err(too_long)
}

/// Writes the frame of a request, delimiter included, and gives its length.
///
/// # Errors
/// [`TooLong`] if `out` is too short; [`MAX_REQUEST_FRAME`] bytes always do.
pub fn encode_request(sequence: u16, request: &Request, out: &mut [u8]) -> Result<usize, TooLong> {
    let kind = match request {
        Request::Hello { .. } => Kind::Greeting,
        _ => Kind::Request,
    };
    encode(kind, sequence, request, out)
}

/// Writes the frame of a reply, delimiter included, and gives its length.
///
/// # Errors
/// [`TooLong`] if `out` is too short; [`MAX_REPLY_FRAME`] bytes always do.
pub fn encode_reply(sequence: u16, reply: &Reply, out: &mut [u8]) -> Result<usize, TooLong> {
    let kind = match reply {
        Reply::Hello(_) | Reply::Incompatible { .. } => Kind::Welcome,
        _ => Kind::Reply,
    };
    encode(kind, sequence, reply, out)
}

/// Writes a frame of log bytes (as they are, not as a message), delimiter included, and gives its length.
///
/// # Errors
/// [`TooLong`] if `out` is too short; [`MAX_REPLY_FRAME`] bytes do for [`MAX_LOG_BYTES`] of log.
pub fn encode_log(sequence: u16, log: &[u8], out: &mut [u8]) -> Result<usize, TooLong> {
    let too_long = |_| TooLong;
    let mut writer = Writer::new(Kind::Log, sequence, out).map_err(too_long)?;
    writer.try_extend(log).map_err(too_long)?;
    writer.finalize().map_err(too_long)
}

/// A frame whose checksum was right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// What it is.
    pub kind: Kind,
    /// The host's number of a request and of its reply; the device's own count for a log.
    pub sequence: u16,
    /// The message or the log.
    pub body: &'a [u8],
}

impl Frame<'_> {
    /// The request in this frame.
    ///
    /// # Errors
    /// [`BodyError`]; a frame from a device is malformed.
    // On a small stack the decoder's temporaries must be gone before the request is answered.
    #[inline(never)]
    pub fn request(&self) -> Result<Request, BodyError> {
        match self.kind {
            Kind::Greeting => self.check_version()?,
            Kind::Request => {}
            _ => return Err(BodyError::Malformed),
        }
        let request = whole::<Request>(self.body)?;
        let greets = matches!(request, Request::Hello { .. });
        if greets == (self.kind == Kind::Greeting) {
            Ok(request)
        } else {
            Err(BodyError::Malformed)
        }
    }

    /// The reply in this frame.
    ///
    /// # Errors
    /// [`BodyError`]; a log, or a frame from a host, is malformed.
    pub fn reply(&self) -> Result<Reply, BodyError> {
        match self.kind {
            Kind::Welcome => self.check_version()?,
            Kind::Reply => {}
            _ => return Err(BodyError::Malformed),
        }
        let reply = whole::<Reply>(self.body)?;
        let welcomes = matches!(reply, Reply::Hello(_) | Reply::Incompatible { .. });
        if welcomes == (self.kind == Kind::Welcome) {
            Ok(reply)
        } else {
            Err(BodyError::Malformed)
        }
    }

    /// Number, version and schema of a hello are where they are in every version.
    fn check_version(&self) -> Result<(), BodyError> {
        let ((_, version, schema), _) = postcard::take_from_bytes::<(u8, u16, u32)>(self.body)
            .map_err(|_| BodyError::Malformed)?;
        if (version, schema) == (VERSION, SCHEMA) {
            Ok(())
        } else {
            Err(BodyError::Foreign { version, schema })
        }
    }
}

fn whole<'a, T: Deserialize<'a>>(body: &'a [u8]) -> Result<T, BodyError> {
    match postcard::take_from_bytes(body) {
        Ok((message, [])) => Ok(message),
        _ => Err(BodyError::Malformed),
    }
}

/// Which end a receiver sits at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Hears greetings and requests.
    Device,
    /// Hears welcomes, replies and logs.
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

/// What a receiver made of the bytes so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Frames whose checksum was right.
    pub received: u32,
    /// Frames whose checksum was wrong: noise, another schema, another direction.
    pub crc_errors: u32,
    /// Frames too long, too short or not stuffed.
    pub dropped: u32,
}

/// Bytes in, frames out. `N` bytes hold the longest frame without its delimiter.
///
/// Invariant: `buffer[..length]` is what came since the last delimiter, unless `overrun`.
#[derive(Debug)]
pub struct Receiver<const N: usize> {
    side: Side,
    buffer: [u8; N],
    length: usize,
    overrun: bool,
    tally: Tally,
}

impl<const N: usize> Receiver<N> {
    /// An empty receiver at `side`.
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

    /// Counters since it was made.
    #[must_use]
    pub const fn tally(&self) -> Tally {
        self.tally
    }

    /// Takes a byte and gives the frame that it completes.
    pub fn push(&mut self, byte: u8) -> Option<Frame<'_>> {
        if byte != 0 {
            match self.buffer.get_mut(self.length) {
                Some(place) => {
                    *place = byte;
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
        // Delimiters in a row are idle line: a sender may flush noise with one.
        if length == 0 { None } else { self.open(length) }
    }

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
