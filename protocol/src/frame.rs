//! Frames: messages to bytes and back.
//!
//! ```text
//! frame = COBS(sequence: u16 ++ body ++ check: u24) ++ 0   (integers least significant byte first)
//! ```
//!
//! A frame costs at most ten bytes beside its body ([`overhead`]), for every message whose ranges
//! are at most [`crate::message::NO_RETURN_MM`].

mod receiver;

use core::fmt;

use postcard::ser_flavors::Flavor;
use serde::{Deserialize, Serialize};

use crate::check::{CHECK_BYTES, Kind, RunningChecksum};
use crate::cobs::{self, Stuffer};
use crate::message::{
    CORRECTED_BYTES, CORRECTED_TILES, FIELD_SIDE, MAX_BEAMS, MAX_SCANS, PATH_PAGE, RECALLED_POINTS,
    RECALLED_TRACK, Reply, Request, TILE_BYTES, TILE_SKELETON_BYTES, TILE_STAMPS,
};
use crate::packet::MAX_PACKET;
use crate::schema::{SCHEMA, VERSION};

pub use receiver::{Receiver, Side, Tally};

/// Length of the sequence number, bytes.
const SEQUENCE_BYTES: usize = 2;
/// Maximum number of log bytes in one frame.
pub const MAX_LOG_BYTES: usize = 240;

/// Body of the largest request, bytes: an observation of two full scans whose ranges all need three
/// bytes, with pose, velocity and time at the ends of their types.
const MAX_REQUEST_BODY: usize = 1 + 5 + 6 * 5 + 2 * 3 + 1 + MAX_SCANS * (2 + MAX_BEAMS * 3);
/// Body of the largest reply, bytes: a map tile. A field row has 4 bytes per cell and is shorter.
const MAX_REPLY_BODY: usize =
    2 + 2 * 3 + (2 + TILE_BYTES) + (1 + TILE_SKELETON_BYTES) + 2 * 3 + TILE_STAMPS;
const _: () = assert!(MAX_REPLY_BODY > 12 + 4 * FIELD_SIDE && MAX_REPLY_BODY > MAX_LOG_BYTES);
// A packet: as in the air, with a variant's number and a tag, without the check.
const _: () = assert!(MAX_REPLY_BODY > 2 + MAX_PACKET && MAX_REQUEST_BODY > 1 + MAX_PACKET);
// A part of a correction: epoch, first, last, tiles of twelve bytes at most, cells and trails.
const _: () = assert!(MAX_REQUEST_BODY > 1 + 7 + 1 + 12 * CORRECTED_TILES + 2 + CORRECTED_BYTES);
// A recall: epoch, origin, points of seven bytes at most, the track's end, differences.
const RECALL_BODY: usize =
    3 + 2 * 5 + 2 + 7 * RECALLED_POINTS + (1 + 3 * 5) + 1 + 3 * RECALLED_TRACK;
const _: () = assert!(MAX_REQUEST_BODY > 1 + RECALL_BODY);
// A page of the path: tractor point, shield, length, and cells of two varints.
const _: () = assert!(MAX_REPLY_BODY > 1 + 7 + 13 + 2 + 6 * PATH_PAGE);

/// Length of the longest frame that a host sends, bytes, with its delimiter.
pub const MAX_REQUEST_FRAME: usize = MAX_REQUEST_BODY + overhead(MAX_REQUEST_BODY);
/// Length of the longest frame that a device sends, bytes, with its delimiter.
pub const MAX_REPLY_FRAME: usize = MAX_REPLY_BODY + overhead(MAX_REPLY_BODY);

/// Returns the maximum number of bytes that a frame adds to a body of `body` bytes: sequence
/// number, checksum, stuffing and delimiter.
#[must_use]
pub const fn overhead(body: usize) -> usize {
    let content = SEQUENCE_BYTES + body + CHECK_BYTES;
    SEQUENCE_BYTES + CHECK_BYTES + 1 + (content - 1) / 254 + 1
}

/// The frame does not fit into the output buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

impl fmt::Display for TooLong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "the frame does not fit into its buffer; \
             use a buffer of MAX_REQUEST_FRAME or MAX_REPLY_FRAME bytes",
        )
    }
}

impl core::error::Error for TooLong {}

/// Why the body of a frame with a correct checksum is not a message for this end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyError {
    /// The body is not a message of this schema, or bytes are left over behind it.
    Malformed,
    /// The body is a hello of another version or schema.
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
            Self::Malformed => f.write_str("the frame's body is not a message of this schema"),
            Self::Foreign { version, schema } => write!(
                f,
                "the peer uses protocol {version} with schema {schema:#010x}, \
                 not {VERSION} with {SCHEMA:#010x}; build both ends from the same source"
            ),
        }
    }
}

impl core::error::Error for BodyError {}

/// Output of postcard that computes the checksum and stuffs the bytes while they are written.
struct Writer<'a> {
    checksum: RunningChecksum,
    stuffer: Stuffer<'a>,
    kind: Kind,
}

impl<'a> Writer<'a> {
    fn new(kind: Kind, sequence: u16, out: &'a mut [u8]) -> Result<Self, postcard::Error> {
        let mut writer = Self {
            checksum: RunningChecksum::new(),
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
        self.checksum.push(byte);
        self.stuffer
            .push(byte)
            .map_err(|cobs::Full| postcard::Error::SerializeBufferFull)
    }

    fn finalize(mut self) -> Result<usize, postcard::Error> {
        let full = |cobs::Full| postcard::Error::SerializeBufferFull;
        for byte in self.checksum.seal(self.kind) {
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

/// Writes the frame of a request with its delimiter, and returns its length.
///
/// # Errors
/// [`TooLong`] if `out` is too short. [`MAX_REQUEST_FRAME`] bytes are always enough.
pub fn encode_request(sequence: u16, request: &Request, out: &mut [u8]) -> Result<usize, TooLong> {
    let kind = match request {
        Request::Hello { .. } => Kind::Greeting,
        _ => Kind::Request,
    };
    encode(kind, sequence, request, out)
}

/// Writes the frame of a reply with its delimiter, and returns its length.
///
/// # Errors
/// [`TooLong`] if `out` is too short. [`MAX_REPLY_FRAME`] bytes are always enough.
pub fn encode_reply(sequence: u16, reply: &Reply, out: &mut [u8]) -> Result<usize, TooLong> {
    let kind = match reply {
        Reply::Hello(_) | Reply::Incompatible { .. } => Kind::Welcome,
        _ => Kind::Reply,
    };
    encode(kind, sequence, reply, out)
}

/// Writes a frame of log bytes with its delimiter, and returns its length. The log is the body.
///
/// # Errors
/// [`TooLong`] if `out` is too short. [`MAX_REPLY_FRAME`] bytes are enough for [`MAX_LOG_BYTES`] of
/// log.
pub fn encode_log(sequence: u16, log: &[u8], out: &mut [u8]) -> Result<usize, TooLong> {
    encode_body(Kind::Log, sequence, log, out)
}

/// Writes a frame of any kind around a body that is already encoded, and returns the frame's
/// length.
///
/// The body need not be a message: tests use this to send what no encoder writes.
///
/// # Errors
/// [`TooLong`] if `out` is shorter than `body.len()` + [`overhead`].
pub fn encode_body(
    kind: Kind,
    sequence: u16,
    body: &[u8],
    out: &mut [u8],
) -> Result<usize, TooLong> {
    let too_long = |_| TooLong;
    let mut writer = Writer::new(kind, sequence, out).map_err(too_long)?;
    writer.try_extend(body).map_err(too_long)?;
    writer.finalize().map_err(too_long)
}

/// A received frame with a correct checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Kind of the frame.
    pub kind: Kind,
    /// The number that the host gave to a request, repeated in its reply. The device counts its log
    /// frames by itself.
    pub sequence: u16,
    /// The encoded message, or the log.
    pub body: &'a [u8],
}

impl Frame<'_> {
    /// Decodes the request in this frame.
    ///
    /// # Errors
    /// [`BodyError`]. A frame from a device is malformed.
    // Not inlined: the decoder's temporaries must leave the stack before the request is answered.
    #[inline(never)]
    pub fn request(&self) -> Result<Request, BodyError> {
        match self.kind {
            Kind::Greeting => self.check_version()?,
            Kind::Request => {}
            _ => return Err(BodyError::Malformed),
        }
        let request = decode_all::<Request>(self.body)?;
        let is_hello = matches!(request, Request::Hello { .. });
        if is_hello == (self.kind == Kind::Greeting) {
            Ok(request)
        } else {
            Err(BodyError::Malformed)
        }
    }

    /// Decodes the reply in this frame.
    ///
    /// # Errors
    /// [`BodyError`]. A log, or a frame from a host, is malformed.
    pub fn reply(&self) -> Result<Reply, BodyError> {
        match self.kind {
            Kind::Welcome => self.check_version()?,
            Kind::Reply => {}
            _ => return Err(BodyError::Malformed),
        }
        let reply = decode_all::<Reply>(self.body)?;
        let is_welcome = matches!(reply, Reply::Hello(_) | Reply::Incompatible { .. });
        if is_welcome == (self.kind == Kind::Welcome) {
            Ok(reply)
        } else {
            Err(BodyError::Malformed)
        }
    }

    /// Compares version and schema. In every protocol version a hello starts with its message
    /// number, version and schema.
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

/// Decodes a message and refuses bytes behind it.
fn decode_all<'a, T: Deserialize<'a>>(body: &'a [u8]) -> Result<T, BodyError> {
    match postcard::take_from_bytes(body) {
        Ok((message, [])) => Ok(message),
        _ => Err(BodyError::Malformed),
    }
}
