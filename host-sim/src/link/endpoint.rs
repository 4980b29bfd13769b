//! The host's end of a link over any line.
//!
//! One request is in flight. If no answer comes in time, the endpoint sends the same bytes again
//! with the same sequence number, so the device answers without a second step. After the last
//! attempt the link is [`LinkError::Silent`]. The endpoint sorts out late answers, logs and noise.
//! It detects a reboot of the device by its hello, or because the device does not know this host.

use core::time::Duration;
use std::collections::VecDeque;

use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{
    BodyError, MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, encode_request,
};
use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, CorrectionProgress, Counters, FieldRow, Identity,
    Observation, Packet, Path, Recall, Refusal, Reply, Request, ResidualFrontier, Status, Tile,
};
use fieldline_protocol::{SCHEMA, VERSION};

use super::inside::Inside;
use super::line::Line;
use super::{Link, LinkError, LinkStats};

/// How long to wait for an answer, and how often to ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RetryPolicy {
    /// Time to wait for an answer before the request is sent again.
    pub attempt: Duration,
    /// Number of times that a request is sent.
    pub attempts: u32,
    /// Total time for the first hello: long enough for a device that is still booting, and short
    /// enough for a peer that never answers.
    pub greeting: Duration,
}

impl RetryPolicy {
    /// In virtual time: twelve attempts within the device's stale limit of 500 ms.
    pub const VIRTUAL: Self = Self {
        attempt: Duration::from_millis(40),
        attempts: 12,
        greeting: Duration::from_millis(480),
    };
    /// In lockstep, where the simulated robot stands still during the wait: a loaded machine that
    /// emulates a chip may take seconds.
    pub const LOCKSTEP: Self = Self {
        attempt: Duration::from_secs(3),
        attempts: 10,
        greeting: Duration::from_secs(30),
    };
    /// In lockstep with a board, which boots within a second after its port is opened.
    pub const SERIAL: Self = Self {
        greeting: Duration::from_secs(4),
        ..Self::LOCKSTEP
    };

    /// The policy of a hello: the greeting's time in attempts of at most 0.2 s. A device that is
    /// still booting hears nothing, and a repeated hello costs it nothing.
    #[must_use]
    pub fn for_hello(self) -> Self {
        let attempt = self.attempt.min(Duration::from_millis(200));
        Self {
            attempt,
            attempts: (self.greeting.as_millis() / attempt.as_millis().max(1)) as u32,
            ..self
        }
    }

    /// With a robot that moves during the wait: five attempts within the device's stale limit of
    /// 500 ms.
    pub const REAL_TIME: Self = Self {
        attempt: Duration::from_millis(95),
        attempts: 5,
        greeting: Self::SERIAL.greeting,
    };
}

/// The host's end of a link.
///
/// Invariant: `sequence` is the number of the last request and never 0; 0 marks a device's message
/// that answers no request.
#[derive(Debug)]
pub struct Endpoint<L> {
    line: L,
    policy: RetryPolicy,
    receiver: Receiver<MAX_REPLY_FRAME>,
    inbox: VecDeque<u8>,
    bytes: u64,
    sequence: u16,
    nonce: u32,
    boots: Option<u32>,
    started: bool,
    stats: LinkStats,
    before: Counters,
    device: Counters,
    log: Vec<u8>,
}

impl<L: Line> Endpoint<L> {
    /// An endpoint that has not said hello. `nonce` distinguishes this host from the last one.
    pub fn new(line: L, policy: RetryPolicy, nonce: u32) -> Self {
        Self {
            line,
            policy,
            receiver: Receiver::new(Side::Host),
            inbox: VecDeque::new(),
            bytes: 0,
            sequence: 0,
            nonce,
            boots: None,
            started: false,
            stats: LinkStats::default(),
            before: Counters::default(),
            device: Counters::default(),
            log: Vec::new(),
        }
    }

    /// The line.
    pub const fn line(&self) -> &L {
        &self.line
    }

    /// Time on the line's clock.
    pub fn now(&self) -> Duration {
        self.line.now()
    }

    fn call(&mut self, request: &Request) -> Result<Reply, LinkError> {
        if self.boots.is_none() {
            self.hello()?;
        }
        let reply = self.ask(request, self.policy);
        if reply == Err(LinkError::Reset) {
            // Whoever goes on greets the device again.
            (self.boots, self.started) = (None, false);
        }
        reply
    }

    /// Sends a request until it is answered.
    fn ask(&mut self, request: &Request, policy: RetryPolicy) -> Result<Reply, LinkError> {
        self.sequence = self.sequence.wrapping_add(1).max(1);
        let mut frame = [0; 1 + MAX_REQUEST_FRAME];
        // A zero before a repeated frame ends any noise on the line.
        let length = encode_request(self.sequence, request, &mut frame[1..])
            .map_err(|error| LinkError::Io(error.to_string()))?;
        for attempt in 0..policy.attempts {
            self.stats.sent += 1;
            self.stats.retries += u64::from(attempt > 0);
            self.line.send(&frame[usize::from(attempt == 0)..=length])?;
            if let Some(reply) = self.await_reply(policy.attempt)? {
                return Ok(reply);
            }
        }
        Err(LinkError::Silent)
    }

    fn await_reply(&mut self, limit: Duration) -> Result<Option<Reply>, LinkError> {
        let deadline = self.line.now() + limit;
        loop {
            while let Some(byte) = self.inbox.pop_front() {
                if let Some(reply) = self.take(byte)? {
                    return Ok(Some(reply));
                }
            }
            let wait = deadline.saturating_sub(self.line.now());
            if wait.is_zero() {
                return Ok(None);
            }
            let mut bytes = Vec::new();
            self.line.receive(&mut bytes, wait)?;
            self.bytes += bytes.len() as u64;
            self.inbox.extend(bytes);
        }
    }

    /// Takes a byte; returns the awaited reply when it is complete.
    fn take(&mut self, byte: u8) -> Result<Option<Reply>, LinkError> {
        let Some(frame) = self.receiver.push(byte) else {
            return Ok(None);
        };
        if frame.kind == Kind::Log {
            self.log.extend_from_slice(frame.body);
            return Ok(None);
        }
        let (sequence, awaited) = (frame.sequence, frame.sequence == self.sequence);
        match frame.reply() {
            Ok(Reply::Crash(crash)) => Err(LinkError::Crashed(crash.to_string())),
            Ok(Reply::Hello(identity)) => self.hear_hello(sequence, identity),
            Ok(Reply::Refused(refusal)) if awaited => Err(self.refused(refusal)),
            Ok(reply) if awaited => Ok(Some(reply)),
            Err(error @ BodyError::Foreign { .. }) => {
                Err(LinkError::Incompatible(error.to_string()))
            }
            // A late answer, or a chance collision.
            Ok(_) | Err(BodyError::Malformed) => {
                self.stats.dropped += 1;
                Ok(None)
            }
        }
    }

    fn hear_hello(
        &mut self,
        sequence: u16,
        identity: Identity,
    ) -> Result<Option<Reply>, LinkError> {
        match self.boots {
            Some(boots) if boots != identity.boots => Err(match identity.crash {
                Some(crash) => LinkError::Crashed(crash.to_string()),
                None => LinkError::Reset,
            }),
            _ if sequence == self.sequence => Ok(Some(Reply::Hello(identity))),
            // The device just booted, or it answered an earlier hello twice.
            _ => Ok(None),
        }
    }

    /// The error for a refusal; a device that forgot this host has rebooted.
    fn refused(&self, refusal: Refusal) -> LinkError {
        match refusal {
            Refusal::NotGreeted if self.boots.is_some() => LinkError::Reset,
            Refusal::NotStarted if self.started => LinkError::Reset,
            _ => LinkError::Refused(refusal.to_string()),
        }
    }
}

fn unexpected(what: &str) -> LinkError {
    LinkError::Incompatible(format!(
        "the device answered {what} with another kind of reply; \
         build both ends from the same source"
    ))
}

impl<L: Line> Link for Endpoint<L> {
    fn hello(&mut self) -> Result<Identity, LinkError> {
        let request = Request::Hello {
            version: VERSION,
            schema: SCHEMA,
            nonce: self.nonce,
        };
        let identity = match self.ask(&request, self.policy.for_hello()) {
            Ok(Reply::Hello(identity)) => identity,
            Ok(_) => return Err(unexpected("a hello")),
            Err(LinkError::Silent) if self.bytes > 0 && self.receiver.tally().received == 0 => {
                return Err(LinkError::Incompatible(format!(
                    "{} bytes came but no Fieldline frame; \
                     check the device, the baud rate and the image's schema",
                    self.bytes
                )));
            }
            Err(error) => return Err(error),
        };
        if self.boots.is_none() {
            self.boots = Some(identity.boots);
            (self.before, self.device) = (identity.counters, identity.counters);
        }
        Ok(identity)
    }

    fn control(&mut self, control: &Control) -> Result<Status, LinkError> {
        match self.call(&Request::Control(control.clone()))? {
            Reply::Control(status) => {
                self.started |= matches!(control, Control::Start(_));
                if matches!(control, Control::Reset) {
                    // This reboot was requested, and afterwards the device does not know this host.
                    (self.boots, self.started) = (None, false);
                }
                Ok(status)
            }
            _ => Err(unexpected("a control request")),
        }
    }

    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        match self.call(&Request::Observation(observation.clone()))? {
            Reply::Command(command) => {
                self.device = command.counters;
                Ok(command)
            }
            _ => Err(unexpected("an observation")),
        }
    }

    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError> {
        match self.call(&Request::Tile { x, y })? {
            Reply::Tile(tile) => Ok(tile),
            _ => Err(unexpected("a request for a tile")),
        }
    }

    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError> {
        match self.call(&Request::FieldRow { row })? {
            Reply::FieldRow(row) => Ok(row),
            _ => Err(unexpected("a request for a field row")),
        }
    }

    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
        match self.call(&Request::Frontiers)? {
            Reply::Frontiers(frontiers) => Ok(frontiers.iter().copied().collect()),
            _ => Err(unexpected("a request for frontiers")),
        }
    }

    fn path(&mut self, from: u8) -> Result<Path, LinkError> {
        match self.call(&Request::Path { from })? {
            Reply::Path(path) => Ok(path),
            _ => Err(unexpected("a request for the road")),
        }
    }

    fn hear(&mut self, packet: &Packet) -> Result<(), LinkError> {
        match self.call(&Request::Hear(packet.clone()))? {
            Reply::Heard => Ok(()),
            _ => Err(unexpected("a packet")),
        }
    }

    fn say(&mut self) -> Result<Option<Packet>, LinkError> {
        match self.call(&Request::Say)? {
            Reply::Say(packet) => Ok(packet),
            _ => Err(unexpected("a request for a packet")),
        }
    }

    fn open_correction(&mut self, correct: &Correct) -> Result<CorrectionProgress, LinkError> {
        match self.call(&Request::Correct(*correct))? {
            Reply::Corrected(progress) => Ok(progress),
            _ => Err(unexpected("a correction")),
        }
    }

    fn send_tiles(&mut self, part: &CorrectedTiles) -> Result<CorrectionProgress, LinkError> {
        match self.call(&Request::Tiles(part.clone()))? {
            Reply::Corrected(progress) => Ok(progress),
            _ => Err(unexpected("a part of a correction")),
        }
    }

    fn recall(&mut self, recall: &Recall) -> Result<(), LinkError> {
        match self.call(&Request::Recall(recall.clone()))? {
            Reply::Corrected(_) => Ok(()),
            _ => Err(unexpected("a recall")),
        }
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        self.line.inside()
    }

    fn stats(&self) -> LinkStats {
        let tally = self.receiver.tally();
        let there = |now: u32, before: u32| u64::from(now.wrapping_sub(before));
        LinkStats {
            received: u64::from(tally.received),
            dropped: self.stats.dropped
                + u64::from(tally.dropped)
                + there(self.device.dropped, self.before.dropped),
            crc_errors: u64::from(tally.crc_errors)
                + there(self.device.crc_errors, self.before.crc_errors),
            ..self.stats
        }
    }

    fn take_log(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.log)
    }
}
