//! The conversation: bytes in, bytes out.
//!
//! Rules, each with a test below: hello first; one reply per request; a repeated sequence number gets the same reply and steps
//! nothing; an older one is refused; a new nonce starts the numbers afresh and a repeated hello does not; silence beyond
//! [`crate::STALE_MS`] while driving is a stale stop; logs go out only where a whole reply still has room.
//!
//! Time is given by [`Session::tick`], in milliseconds of any origin, wrapping.

use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{
    BodyError, MAX_LOG_BYTES, MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, encode_log,
    encode_reply, overhead,
};
use fieldline_protocol::message::{
    Command, Control, Counters, Crash, Identity, Observation, Refusal, Reply, Request, Status,
};
use fieldline_protocol::{SCHEMA, VERSION};
use heapless::Deque;

use crate::STALE_MS;
use crate::log::{info, warning};
use crate::meter::{self, Meter, Stopwatch};
use crate::pilot::{Memory, Pilot};
use crate::signal::Signal;

/// Bytes waiting to be sent: a reply, another one, and some log.
const OUTBOX: usize = 2 * MAX_REPLY_FRAME + 128;

/// What the board knows of its last boot.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Boot {
    /// Boots since power-on.
    pub boots: u32,
    /// The crash that caused it.
    pub crash: Option<Crash>,
}

/// The last reply, kept for a host that did not hear it.
#[derive(Debug)]
struct Answered {
    sequence: u16,
    frame: [u8; MAX_REPLY_FRAME],
    length: usize,
}

/// One conversation after another, since boot.
///
/// Invariant: `answered` belongs to the host that greeted with `nonce`.
#[derive(Debug)]
pub struct Session {
    identity: Identity,
    pilot: Pilot,
    receiver: Receiver<MAX_REQUEST_FRAME>,
    outbox: Deque<u8, OUTBOX>,
    nonce: Option<u32>,
    incompatible: bool,
    answered: Option<Answered>,
    log_sequence: u16,
    counters: Counters,
    now_ms: u32,
    heard_ms: u32,
    stale: bool,
    reset: bool,
    /// The meter's count when the present request was complete.
    began: u32,
    /// What the last command's reply cost.
    reply_cost: u32,
}

impl Default for Session {
    fn default() -> Self {
        Self::new()
    }
}

impl Session {
    /// A device that has not booted: silent, and a stranger to everybody. Made for a `static`.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            identity: NOBODY,
            pilot: Pilot::new(),
            receiver: Receiver::new(Side::Device),
            outbox: Deque::new(),
            nonce: None,
            incompatible: false,
            answered: None,
            log_sequence: 0,
            counters: NOTHING_COUNTED,
            now_ms: 0,
            heard_ms: 0,
            stale: false,
            reset: false,
            began: 0,
            reply_cost: 0,
        }
    }

    /// Boots, with `tile_pool` tiles and `tile_slots` places for them. The hello waits to be sent.
    #[inline(never)]
    pub fn boot(&mut self, boot: Boot, tile_pool: usize, tile_slots: usize) {
        info!("boot {=u32}", boot.boots);
        *self = Self::new();
        self.identity = identity(boot, tile_pool, tile_slots);
        self.say_who(0);
    }

    /// Takes a byte off the line. The byte that ends a request is answered before this returns: an observation steps the planner.
    pub fn receive<M: Meter, const TILES: usize, const SLOTS: usize>(
        &mut self,
        byte: u8,
        memory: &mut Memory<'_, TILES, SLOTS>,
        meter: &mut M,
    ) {
        let Some(frame) = self.receiver.push(byte) else {
            return;
        };
        self.began = meter.count();
        let (sequence, greets) = (frame.sequence, frame.kind == Kind::Greeting);
        match frame.request() {
            Ok(request) => self.take(sequence, &request, memory, meter),
            Err(BodyError::Foreign { version, schema }) if greets => {
                self.turn_away(sequence, version, schema);
            }
            // A chance collision must cost the host a retry, not its run: no answer.
            Err(_) => self.counters.dropped = self.counters.dropped.wrapping_add(1),
        }
    }

    /// Bytes to put on the line, in order. Not all of them at once: ask again after [`Session::sent`].
    #[must_use]
    pub fn pending(&self) -> &[u8] {
        self.outbox.as_slices().0
    }

    /// The first `count` pending bytes are on the line.
    pub fn sent(&mut self, count: usize) {
        for _ in 0..count {
            self.outbox.pop_front();
        }
    }

    /// It is `now_ms`.
    pub fn tick(&mut self, now_ms: u32) {
        self.now_ms = now_ms;
        let silent = now_ms.wrapping_sub(self.heard_ms) > u32::from(STALE_MS);
        if silent && !self.stale && self.pilot.status() == Status::Exploring {
            warning!("stale: no host for {=u16} ms", STALE_MS);
            self.stale = true;
            self.counters.stale_stops = self.counters.stale_stops.wrapping_add(1);
        }
    }

    /// Whether the emergency stop input is pressed.
    pub fn set_emergency_stop(&mut self, pressed: bool) {
        self.pilot.set_emergency_stop(pressed);
    }

    /// Whether the last command must not be followed any longer, for the host's silence.
    #[must_use]
    pub const fn is_stale(&self) -> bool {
        self.stale
    }

    /// Whether the host asked for a reboot. Send what is pending first.
    #[must_use]
    pub const fn wants_reset(&self) -> bool {
        self.reset
    }

    /// What the LED shows.
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

    /// Counters since boot.
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

    /// How many log bytes the line can take now, such that a reply still has room.
    #[must_use]
    pub fn log_room(&self) -> usize {
        let free = OUTBOX - self.outbox.len();
        free.saturating_sub(MAX_REPLY_FRAME + overhead(MAX_LOG_BYTES))
            .min(MAX_LOG_BYTES)
    }

    /// Puts log bytes on the line: as many as [`Session::log_room`] says, and gives how many that were.
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
    fn turn_away(&mut self, sequence: u16, version: u16, schema: u32) {
        warning!(
            "host speaks protocol {=u16}, schema {=u32:#x}: refused",
            version,
            schema
        );
        self.counters.dropped = self.counters.dropped.wrapping_add(1);
        self.incompatible = true;
        self.nonce = None;
        self.say(
            sequence,
            &Reply::Incompatible {
                version: VERSION,
                schema: SCHEMA,
            },
        );
    }

    fn take<M: Meter, const TILES: usize, const SLOTS: usize>(
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
            .answered
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
                    let done = meter.count();
                    self.keep_command(sequence, command);
                    self.reply_cost = meter.count().wrapping_sub(done);
                    meter.stop();
                } else {
                    self.attend(sequence, request, memory);
                }
            }
        }
    }

    #[inline(never)]
    fn refuse(&mut self, sequence: u16, refusal: Refusal) {
        self.say(sequence, &Reply::Refused(refusal));
    }

    #[inline(never)]
    fn greet(&mut self, sequence: u16, nonce: u32) {
        if self.nonce != Some(nonce) {
            info!("host {=u32:#x}", nonce);
            self.nonce = Some(nonce);
            self.answered = None;
        }
        self.incompatible = false;
        self.say_who(sequence);
    }

    fn say_who(&mut self, sequence: u16) {
        self.identity.counters = self.counters();
        self.say(sequence, &Reply::Hello(self.identity.clone()));
    }

    /// The step. What lies on the stack here lies under the planner's own, so there is little: the replies are built by functions
    /// of their own, never inlined.
    #[inline(never)]
    fn observe<M: Meter, const TILES: usize, const SLOTS: usize>(
        &mut self,
        observation: &Observation,
        memory: &mut Memory<'_, TILES, SLOTS>,
        meter: &mut M,
    ) -> Result<Command, Refusal> {
        self.stale = false;
        let mut watch = Stopwatch::new(meter, self.began, self.reply_cost);
        watch.lap_of_session();
        let command = self.pilot.observe(memory, observation, &mut watch);
        watch.lap_of_session();
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
    fn keep_command(&mut self, sequence: u16, command: Result<Command, Refusal>) {
        let reply = command.map_or_else(Reply::Refused, Reply::Command);
        self.keep(sequence, &reply);
    }

    /// Answers everything but hellos and observations.
    #[inline(never)]
    fn attend<const TILES: usize, const SLOTS: usize>(
        &mut self,
        sequence: u16,
        request: &Request,
        memory: &mut Memory<'_, TILES, SLOTS>,
    ) {
        let reply = match request {
            Request::Control(control) => {
                self.reset |= matches!(control, Control::Reset);
                self.stale = false;
                let status = self.pilot.control(memory, control);
                status.map_or_else(Reply::Refused, Reply::Control)
            }
            Request::Tile { x, y } => Reply::Tile(Pilot::tile(memory, *x, *y)),
            Request::FieldRow { row } => Reply::FieldRow(Pilot::field_row(memory, *row)),
            Request::Frontiers => Reply::Frontiers(Pilot::frontiers(memory)),
            Request::Road { from } => Reply::Road(Pilot::road(memory, *from)),
            // Answered before it came here.
            Request::Hello { .. } | Request::Observation(_) => Reply::Refused(Refusal::OutOfOrder),
        };
        self.keep(sequence, &reply);
    }

    /// Says a reply that need not be kept.
    #[inline(never)]
    fn say(&mut self, sequence: u16, reply: &Reply) {
        let mut frame = [0; MAX_REPLY_FRAME];
        if let Ok(length) = encode_reply(sequence, reply, &mut frame) {
            self.put(&frame, length);
        }
    }

    /// Says a reply and keeps it for repetition.
    fn keep(&mut self, sequence: u16, reply: &Reply) {
        let answered = self.answered.get_or_insert(Answered {
            sequence,
            frame: [0; MAX_REPLY_FRAME],
            length: 0,
        });
        answered.sequence = sequence;
        // Every reply fits: MAX_REPLY_FRAME is tested to hold the largest.
        answered.length = encode_reply(sequence, reply, &mut answered.frame).unwrap_or(0);
        self.send_kept();
    }

    fn repeat(&mut self) {
        self.counters.duplicates = self.counters.duplicates.wrapping_add(1);
        self.send_kept();
    }

    fn send_kept(&mut self) {
        let Self {
            answered,
            outbox,
            counters,
            ..
        } = self;
        if let Some(answered) = answered {
            put(outbox, counters, &answered.frame, answered.length);
        }
    }

    fn put(&mut self, frame: &[u8], length: usize) {
        put(&mut self.outbox, &mut self.counters, frame, length);
    }
}

/// Queues a whole frame or, where the host does not read, none of it.
fn put(outbox: &mut Deque<u8, OUTBOX>, counters: &mut Counters, frame: &[u8], length: usize) {
    if OUTBOX - outbox.len() < length {
        counters.dropped = counters.dropped.wrapping_add(1);
        return;
    }
    for byte in frame.iter().take(length) {
        // There is room: checked above.
        let _ = outbox.push_back(*byte);
    }
}

const NOTHING_COUNTED: Counters = Counters {
    received: 0,
    crc_errors: 0,
    dropped: 0,
    duplicates: 0,
    stale_stops: 0,
};

const NOBODY: Identity = Identity {
    version: VERSION,
    schema: SCHEMA,
    build: heapless::String::new(),
    boots: 0,
    tile_slots: 0,
    tile_pool: 0,
    max_frame: 0,
    stale_ms: STALE_MS,
    crash: None,
    counters: NOTHING_COUNTED,
};

/// Who a device is that just booted, with `tile_pool` tiles and `tile_slots` places for them.
#[must_use]
pub fn identity(boot: Boot, tile_pool: usize, tile_slots: usize) -> Identity {
    let short = |count: usize| u16::try_from(count).unwrap_or(u16::MAX);
    Identity {
        build: build(),
        boots: boot.boots,
        tile_slots: short(tile_slots),
        tile_pool: short(tile_pool),
        max_frame: short(MAX_REQUEST_FRAME),
        crash: boot.crash,
        ..NOBODY
    }
}

/// What was built: the name that the builder gave it, or else the version.
fn build() -> heapless::String<{ fieldline_protocol::message::BUILD_BYTES }> {
    let name = option_env!("FIELDLINE_BUILD").unwrap_or(env!("CARGO_PKG_VERSION"));
    let mut build = heapless::String::new();
    for letter in name.chars() {
        if build.push(letter).is_err() {
            break;
        }
    }
    build
}

#[cfg(test)]
mod tests;
