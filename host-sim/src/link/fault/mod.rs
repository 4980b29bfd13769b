//! Fault injection: a decorator that adds faults to any line.
//!
//! A seeded generator draws the faults for each frame, in each direction. They act on bytes:
//!
//! | fault | effect on a frame, with probability P |
//! | --- | --- |
//! | `drop=P` | one byte, a run of bytes, or the whole frame is lost |
//! | `duplicate=P` | one byte, or the whole frame, comes twice |
//! | `corrupt=P` | one to three bytes change, maybe to or from a delimiter |
//! | `truncate=P` | the frame is cut at some byte; the delimiter is lost too |
//! | `delay=P` | the frame comes up to 300 ms later, maybe after others |
//! | `reset@N` | before the host's N-th frame the device receives a reset |
//! | `silent@N` | from the host's N-th frame on nothing passes in either direction |
//!
//! Time is the time of the inner line: on a loopback nothing waits.

mod spec;

use core::time::Duration;
use std::collections::VecDeque;

use fieldline_protocol::frame::{MAX_REQUEST_FRAME, Receiver, Side, encode_request};
use fieldline_protocol::message::{Control, Request};

use super::LinkError;
use super::cycles::StepCost;
use super::inside::Inside;
use super::line::Line;
pub use spec::Faults;

/// Longest delay of a frame.
const MAX_DELAY: Duration = Duration::from_millis(300);

/// The generator `SplitMix64` [Steele14].
///
/// [Steele14]: G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators",
/// OOPSLA 2014.
#[derive(Clone, Copy, Debug)]
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 to `bound` − 1, and 0 for a bound of 0.
    fn below(&mut self, bound: usize) -> usize {
        (self.roll() % bound.max(1) as u64) as usize
    }

    fn chance(&mut self, probability: f64) -> bool {
        ((self.roll() >> 11) as f64) < probability * (1u64 << 53) as f64
    }
}

/// Delayed frames of one direction, in the order of their due times.
#[derive(Debug, Default)]
struct Late(VecDeque<(Duration, Vec<u8>)>);

impl Late {
    fn put(&mut self, due: Duration, bytes: Vec<u8>) {
        let behind = self.0.partition_point(|(other, _)| *other <= due);
        self.0.insert(behind, (due, bytes));
    }

    fn take(&mut self, now: Duration) -> Option<Vec<u8>> {
        let (due, _) = self.0.front()?;
        if *due > now {
            return None;
        }
        self.0.pop_front().map(|(_, bytes)| bytes)
    }

    fn next_due(&self) -> Option<Duration> {
        self.0.front().map(|(due, _)| *due)
    }
}

/// Number of faults made so far, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Made {
    /// Frames that lost bytes.
    pub dropped: u64,
    /// Frames with bytes doubled.
    pub duplicated: u64,
    /// Frames with bytes changed.
    pub corrupted: u64,
    /// Frames that were cut.
    pub truncated: u64,
    /// Delayed frames.
    pub delayed: u64,
}

/// A line with faults.
#[derive(Debug)]
pub struct Faulty<L> {
    line: L,
    faults: Faults,
    dice: Dice,
    sent: u64,
    to_device: Late,
    to_host: Late,
    /// The device's frame that is not complete yet.
    partial: Vec<u8>,
    /// Sequence number of the host's last frame; a reset takes the next one.
    overheard: u16,
    made: Made,
}

impl<L: Line> Faulty<L> {
    /// Adds `faults`, drawn from `seed`, to `line`.
    pub fn new(line: L, faults: Faults, seed: u64) -> Self {
        Self {
            line,
            faults,
            dice: Dice(seed),
            sent: 0,
            to_device: Late::default(),
            to_host: Late::default(),
            partial: Vec::new(),
            overheard: 0,
            made: Made::default(),
        }
    }

    /// The inner line.
    pub const fn line(&self) -> &L {
        &self.line
    }

    /// Faults made so far.
    pub const fn made(&self) -> Made {
        self.made
    }

    fn is_dead(&self) -> bool {
        self.faults.silent_at.is_some_and(|at| self.sent >= at)
    }

    /// Applies the faults to a frame: returns its bytes and their delay.
    fn mangle(&mut self, frame: &[u8]) -> (Vec<u8>, Duration) {
        let faults = self.faults;
        let mut bytes = frame.to_vec();
        if self.dice.chance(faults.truncate) {
            self.made.truncated += 1;
            bytes.truncate(self.dice.below(bytes.len()));
        }
        if self.dice.chance(faults.corrupt) && !bytes.is_empty() {
            self.corrupt(&mut bytes);
        }
        if self.dice.chance(faults.drop) && !bytes.is_empty() {
            self.lose(&mut bytes);
        }
        if self.dice.chance(faults.duplicate) && !bytes.is_empty() {
            self.duplicate(&mut bytes);
        }
        let mut late = Duration::ZERO;
        if self.dice.chance(faults.delay) {
            self.made.delayed += 1;
            late =
                Duration::from_millis(1 + self.dice.below(MAX_DELAY.as_millis() as usize) as u64);
        }
        (bytes, late)
    }

    /// Changes one to three bytes.
    fn corrupt(&mut self, bytes: &mut [u8]) {
        self.made.corrupted += 1;
        for _ in 0..=self.dice.below(3) {
            let at = self.dice.below(bytes.len());
            bytes[at] ^= 1 + self.dice.below(255) as u8;
        }
    }

    /// Removes one byte, a run of bytes, or all bytes.
    fn lose(&mut self, bytes: &mut Vec<u8>) {
        self.made.dropped += 1;
        let at = self.dice.below(bytes.len());
        let run = match self.dice.below(3) {
            0 => 1,
            1 => 1 + self.dice.below(bytes.len() - at),
            _ => bytes.len(),
        };
        let from = if run == bytes.len() { 0 } else { at };
        bytes.drain(from..from + run);
    }

    /// Doubles one byte or all bytes.
    fn duplicate(&mut self, bytes: &mut Vec<u8>) {
        self.made.duplicated += 1;
        if self.dice.below(2) == 0 {
            bytes.extend_from_within(..);
        } else {
            let at = self.dice.below(bytes.len());
            bytes.insert(at, bytes[at]);
        }
    }

    /// Tells the device to reboot, with a sequence number that is new to it.
    fn reset_device(&mut self) -> Result<(), LinkError> {
        let mut frame = [0; MAX_REQUEST_FRAME];
        let sequence = self.overheard.wrapping_add(1);
        let length = encode_request(sequence, &Request::Control(Control::Reset), &mut frame)
            .map_err(|error| LinkError::Io(error.to_string()))?;
        self.line.send(&frame[..length])
    }

    fn pass_late_requests(&mut self) -> Result<(), LinkError> {
        while let Some(bytes) = self.to_device.take(self.line.now()) {
            self.line.send(&bytes)?;
        }
        Ok(())
    }

    /// Applies the faults to the device's bytes, frame by frame.
    fn hear(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.partial.push(*byte);
            if *byte == 0 {
                let frame = core::mem::take(&mut self.partial);
                let (bytes, late) = self.mangle(&frame);
                self.to_host.put(self.line.now() + late, bytes);
            }
        }
    }
}

impl<L: Line> Line for Faulty<L> {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.sent += 1;
        if self.is_dead() {
            return Ok(());
        }
        let mut receiver = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
        for byte in bytes {
            if let Some(frame) = receiver.push(*byte) {
                self.overheard = frame.sequence;
            }
        }
        if self.faults.reset_at == Some(self.sent) {
            self.reset_device()?;
        }
        let (bytes, late) = self.mangle(bytes);
        if late.is_zero() {
            return self.line.send(&bytes);
        }
        self.to_device.put(self.line.now() + late, bytes);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        let deadline = self.line.now() + wait;
        loop {
            self.pass_late_requests()?;
            if let Some(bytes) = self.to_host.take(self.line.now()) {
                into.extend(bytes);
                return Ok(());
            }
            let now = self.line.now();
            if now >= deadline {
                return Ok(());
            }
            let next = [self.to_device.next_due(), self.to_host.next_due()];
            let until = next.into_iter().flatten().fold(deadline, Duration::min);
            let mut bytes = Vec::new();
            self.line.receive(&mut bytes, until.saturating_sub(now))?;
            if !self.is_dead() {
                self.hear(&bytes);
            }
        }
    }

    fn now(&self) -> Duration {
        self.line.now()
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        self.line.inside()
    }

    fn cycles(&self) -> Option<StepCost> {
        self.line.cycles()
    }
}
