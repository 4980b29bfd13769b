//! The conversation with a host: bytes in, bytes out.
//!
//! Rules, each with a test:
//!
//! - The host must send a hello first.
//! - Every request gets one reply.
//! - A repeated sequence number gets the same reply and makes no step. An older number is refused.
//! - A hello with a new nonce restarts the sequence numbers. A repeated hello does not.
//! - Silence for more than [`crate::STALE_MS`] while driving is a stale stop.
//! - A log frame is sent only if a whole reply fits behind it.
//!
//! [`Session::tick`] sets the time, in milliseconds from any origin, wrapping.

mod identity;
mod outbox;

use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{
    BodyError, MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, encode_log, encode_reply,
};
use fieldline_protocol::message::{
    Command, Control, Counters, Identity, Observation, Refusal, Reply, Request, Status,
};
use fieldline_protocol::{SCHEMA, VERSION};

use crate::STALE_MS;
use crate::log::{info, warning};
use crate::memory::Memory;
use crate::meter::{self, Mark, Meter, Stopwatch};
use crate::pilot::Pilot;
use crate::signal::Signal;

pub use identity::{Boot, identity};
use identity::{NOT_BOOTED, ZERO_COUNTERS};
use outbox::Outbox;

/// The last reply, stored for a host that did not receive it.
#[derive(Debug)]
struct StoredReply {
    sequence: u16,
    frame: [u8; MAX_REPLY_FRAME],
    length: usize,
}

/// A device's side of its conversations since the boot. The crate's documentation has an example.
///
/// Invariant: `stored` belongs to the host that greeted with `nonce`.
#[derive(Debug)]
pub struct Session {
    identity: Identity,
    pilot: Pilot,
    receiver: Receiver<MAX_REQUEST_FRAME>,
    outbox: Outbox,
    nonce: Option<u32>,
    incompatible: bool,
    stored: Option<StoredReply>,
    log_sequence: u16,
    counters: Counters,
    now_ms: u32,
    heard_ms: u32,
    stale: bool,
    reset: bool,
    /// The meter's count when the current request was complete.
    request_count: u32,
    /// Instructions spent on the reply to the last observation.
    reply_cost: u32,
}

impl Default for Session {
    fn default() -> Self {
        Self::new()
    }
}

impl Session {
    /// Returns the session of a device that has not booted. It can initialise a `static`.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            identity: NOT_BOOTED,
            pilot: Pilot::new(),
            receiver: Receiver::new(Side::Device),
            outbox: Outbox::new(),
            nonce: None,
            incompatible: false,
            stored: None,
            log_sequence: 0,
            counters: ZERO_COUNTERS,
            now_ms: 0,
            heard_ms: 0,
            stale: false,
            reset: false,
            request_count: 0,
            reply_cost: 0,
        }
    }

    /// Boots a device with `tile_pool` tiles and `tile_slots` tile slots, and queues its hello.
    #[inline(never)]
    pub fn boot(&mut self, boot: Boot, tile_pool: usize, tile_slots: usize) {
        info!("boot number {=u32}", boot.boots);
        *self = Self::new();
        self.identity = identity(boot, tile_pool, tile_slots);
        self.send_hello(0);
    }

    /// Takes a byte from the line. If the byte completes a request, the request is executed and its
    /// reply queued before this returns. An observation steps the planner.
    pub fn receive<M: Meter, const TILES: usize, const SLOTS: usize>(
        &mut self,
        byte: u8,
        memory: &mut Memory<'_, TILES, SLOTS>,
        meter: &mut M,
    ) {
        let Some(frame) = self.receiver.push(byte) else {
            return;
        };
        self.request_count = meter.mark(Mark::Request);
        let (sequence, is_greeting) = (frame.sequence, frame.kind == Kind::Greeting);
        // By reference: a request is large, and a copy of it would lie under the planner's stack.
        match &frame.request() {
            Ok(request) => self.handle(sequence, request, memory, meter),
            &Err(BodyError::Foreign { version, schema }) if is_greeting => {
                self.reply_incompatible(sequence, version, schema);
            }
            // No answer: a chance collision of the checksum must cost the host a retry, not its
            // run.
            Err(_) => self.counters.dropped = self.counters.dropped.wrapping_add(1),
        }
    }

    /// Returns the next bytes to send. More bytes may follow: call this again after
    /// [`Session::sent`].
    #[must_use]
    pub fn pending(&self) -> &[u8] {
        self.outbox.pending()
    }

    /// Removes the first `count` pending bytes, because they were sent.
    pub fn sent(&mut self, count: usize) {
        self.outbox.sent(count);
    }

    /// Sets the time to `now_ms`, and checks for silence of the host.
    pub fn tick(&mut self, now_ms: u32) {
        self.now_ms = now_ms;
        let silent = now_ms.wrapping_sub(self.heard_ms) > u32::from(STALE_MS);
        if silent && !self.stale && self.pilot.status().drives() {
            warning!("stale stop: no request for {=u16} ms", STALE_MS);
            self.stale = true;
            self.counters.stale_stops = self.counters.stale_stops.wrapping_add(1);
        }
    }

    /// Sets the state of the emergency stop input.
    pub fn set_emergency_stop(&mut self, pressed: bool) {
        self.pilot.set_emergency_stop(pressed);
    }

    /// Returns true if the host was silent for so long that nobody may follow the last command.
    #[must_use]
    pub const fn is_stale(&self) -> bool {
        self.stale
    }

    /// Returns true if the host asked for a reboot. Send the pending bytes first.
    #[must_use]
    pub const fn wants_reset(&self) -> bool {
        self.reset
    }

    /// Returns the signal for the LED.
    #[must_use]
    pub const fn signal(&self) -> Signal {
        let status = self.pilot.status();
        if matches!(status, Status::EmergencyStop) {
            Signal::EmergencyStop
        } else if self.stale || self.incompatible {
            Signal::Trouble
        } else if self.nonce.is_some() {
            Signal::of(status)
        } else if self.identity.crash.is_some() {
            Signal::Crashed
        } else {
            Signal::Waiting
        }
    }

    /// Returns the counters since the boot.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        let tally = self.receiver.tally();
        Counters {
            received: tally.received,
            crc_errors: tally.crc_errors,
            dropped: self.counters.dropped.wrapping_add(tally.dropped),
            ..self.counters
        }
    }

    /// Returns the number of log bytes that can be queued now.
    #[must_use]
    pub fn log_room(&self) -> usize {
        self.outbox.log_room()
    }

    /// Queues at most [`Session::log_room`] of the log bytes, and returns how many.
    #[inline(never)]
    pub fn log(&mut self, bytes: &[u8]) -> usize {
        let count = bytes.len().min(self.log_room());
        let mut frame = [0; MAX_REPLY_FRAME];
        let Some(chunk) = bytes.get(..count).filter(|chunk| !chunk.is_empty()) else {
            return 0;
        };
        if let Ok(length) = encode_log(self.log_sequence, chunk, &mut frame) {
            self.log_sequence = self.log_sequence.wrapping_add(1);
            self.put(&frame, length);
        }
        count
    }

    #[inline(never)]
    fn reply_incompatible(&mut self, sequence: u16, version: u16, schema: u32) {
        warning!(
            "host refused: it uses protocol {=u16}, schema {=u32:#x}",
            version,
            schema
        );
        self.counters.dropped = self.counters.dropped.wrapping_add(1);
        self.incompatible = true;
        self.nonce = None;
        self.reply(
            sequence,
            &Reply::Incompatible {
                version: VERSION,
                schema: SCHEMA,
            },
        );
    }

    /// Executes a request and queues its reply.
    fn handle<M: Meter, const TILES: usize, const SLOTS: usize>(
        &mut self,
        sequence: u16,
        request: &Request,
        memory: &mut Memory<'_, TILES, SLOTS>,
        meter: &mut M,
    ) {
        self.heard_ms = self.now_ms;
        if let Request::Hello { nonce, .. } = request {
            return self.greet(sequence, *nonce);
        }
        if self.nonce.is_none() {
            return self.refuse(sequence, Refusal::NotGreeted);
        }
        match self
            .stored
            .as_ref()
            .map(|last| sequence.wrapping_sub(last.sequence))
        {
            Some(0) => self.repeat(),
            Some(ahead) if ahead >= 0x8000 => {
                self.counters.dropped = self.counters.dropped.wrapping_add(1);
                self.refuse(sequence, Refusal::OutOfOrder);
            }
            _ => {
                if let Request::Observation(observation) = request {
                    meter.start();
                    let command = self.observe(observation, memory, meter);
                    let done = meter.mark(Mark::Reply);
                    self.reply_command(sequence, command);
                    self.reply_cost = meter.mark(Mark::Replied).wrapping_sub(done);
                    meter.stop();
                } else {
                    self.answer(sequence, request, memory);
                }
            }
        }
    }

    #[inline(never)]
    fn refuse(&mut self, sequence: u16, refusal: Refusal) {
        self.reply(sequence, &Reply::Refused(refusal));
    }

    #[inline(never)]
    fn greet(&mut self, sequence: u16, nonce: u32) {
        if self.nonce != Some(nonce) {
            info!("hello from host {=u32:#x}", nonce);
            self.nonce = Some(nonce);
            self.stored = None;
        }
        self.incompatible = false;
        self.send_hello(sequence);
    }

    fn send_hello(&mut self, sequence: u16) {
        self.identity.counters = self.counters();
        self.reply(sequence, &Reply::Hello(self.identity.clone()));
    }

    /// Steps the planner. The stack of this function lies under the planner's stack, so it is kept
    /// small: other functions, which are not inlined, build the replies.
    #[inline(never)]
    fn observe<M: Meter, const TILES: usize, const SLOTS: usize>(
        &mut self,
        observation: &Observation,
        memory: &mut Memory<'_, TILES, SLOTS>,
        meter: &mut M,
    ) -> Result<Command, Refusal> {
        self.stale = false;
        let mut watch = Stopwatch::new(meter, self.request_count, self.reply_cost);
        watch.mark_session();
        let command = self.pilot.observe(memory, observation, &mut watch);
        watch.mark_session();
        let stages = watch.stages();
        command.map(|mut command| {
            command.counters = self.counters();
            command.cost.instructions = meter::sum(&stages);
            command.cost.stages = stages;
            command.cost.stack_bytes = meter.stack_bytes();
            command
        })
    }

    #[inline(never)]
    fn reply_command(&mut self, sequence: u16, command: Result<Command, Refusal>) {
        let reply = command.map_or_else(Reply::Refused, Reply::Command);
        self.reply_and_store(sequence, &reply);
    }

    /// Answers a request that is no hello and no observation.
    #[inline(never)]
    fn answer<const TILES: usize, const SLOTS: usize>(
        &mut self,
        sequence: u16,
        request: &Request,
        memory: &mut Memory<'_, TILES, SLOTS>,
    ) {
        if let Request::Control(control) = request {
            self.reset |= matches!(control, Control::Reset);
            self.stale = false;
        }
        let reply = self.pilot.answer(memory, request);
        let reply = reply.unwrap_or_else(Reply::Refused);
        self.reply_and_store(sequence, &reply);
    }

    /// Queues a reply without storing it.
    #[inline(never)]
    fn reply(&mut self, sequence: u16, reply: &Reply) {
        let mut frame = [0; MAX_REPLY_FRAME];
        if let Ok(length) = encode_reply(sequence, reply, &mut frame) {
            self.put(&frame, length);
        }
    }

    /// Queues a reply and stores it for repetition.
    fn reply_and_store(&mut self, sequence: u16, reply: &Reply) {
        let stored = self.stored.get_or_insert(StoredReply {
            sequence,
            frame: [0; MAX_REPLY_FRAME],
            length: 0,
        });
        stored.sequence = sequence;
        // Every reply fits: a test checks that MAX_REPLY_FRAME holds the largest.
        stored.length = encode_reply(sequence, reply, &mut stored.frame).unwrap_or(0);
        self.send_stored();
    }

    /// Queues the stored reply again.
    fn repeat(&mut self) {
        self.counters.duplicates = self.counters.duplicates.wrapping_add(1);
        self.send_stored();
    }

    fn send_stored(&mut self) {
        let Self {
            stored,
            outbox,
            counters,
            ..
        } = self;
        if let Some(stored) = stored {
            put(outbox, counters, &stored.frame, stored.length);
        }
    }

    fn put(&mut self, frame: &[u8], length: usize) {
        put(&mut self.outbox, &mut self.counters, frame, length);
    }
}

/// Queues the first `length` bytes of `frame`, or counts a dropped frame if the host reads too
/// slowly.
fn put(outbox: &mut Outbox, counters: &mut Counters, frame: &[u8], length: usize) {
    if !outbox.put(frame.get(..length).unwrap_or(frame)) {
        counters.dropped = counters.dropped.wrapping_add(1);
    }
}

#[cfg(test)]
mod tests;
