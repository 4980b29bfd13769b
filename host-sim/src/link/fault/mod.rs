//! A line that breaks on purpose: between a host's end and any other line, a decorator.
//!
//! Faults are drawn frame by frame, in each direction, from a seeded generator, and act on bytes:
//!
//! | fault | what happens to a frame, with its probability |
//! | --- | --- |
//! | `drop=P` | one byte, a run of bytes, or all of it is lost |
//! | `duplicate=P` | one byte, or all of it, comes twice |
//! | `corrupt=P` | one to three bytes change, maybe to or from a delimiter |
//! | `truncate=P` | the rest from some byte on is lost, the delimiter too |
//! | `delay=P` | it comes up to 300 ms later, maybe behind others |
//! | `reset@N` | before the host's N-th frame the device is told to reboot |
//! | `silent@N` | from the host's N-th frame on nothing passes, either way |
//!
//! Time is that of the line underneath: on a loopback nothing waits.

use core::fmt;
use core::str::FromStr;
use core::time::Duration;
use std::collections::VecDeque;

use fieldline_protocol::frame::{MAX_REQUEST_FRAME, Receiver, Side, encode_request};
use fieldline_protocol::message::{Control, Request};

use super::LinkError;
use super::line::Line;

/// Longest delay of a frame.
const MAX_DELAY: Duration = Duration::from_millis(300);

/// Which faults, how often.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Probability that a frame loses bytes.
    pub drop: f64,
    /// Probability that bytes of a frame are doubled.
    pub duplicate: f64,
    /// Probability that bytes of a frame change.
    pub corrupt: f64,
    /// Probability that a frame is cut off.
    pub truncate: f64,
    /// Probability that a frame is late.
    pub delay: f64,
    /// The device reboots before this frame of the host, counted from 1.
    pub reset_at: Option<u64>,
    /// The line is dead from this frame of the host on.
    pub silent_at: Option<u64>,
}

/// Why a fault specification was not understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FaultsError {
    /// No fault at all.
    Nothing,
    /// A word that is no fault.
    Unknown(String),
    /// A fault that was named before.
    Twice(String),
    /// Not a probability.
    BadProbability(String),
    /// Not a frame's number.
    BadCount(String),
}

impl fmt::Display for FaultsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const KNOWN: &str = "use drop=P, duplicate=P, corrupt=P, truncate=P, delay=P, reset@N, silent@N, separated by commas";
        match self {
            Self::Nothing => write!(f, "no fault is named; {KNOWN}"),
            Self::Unknown(word) => write!(f, "unknown fault '{word}'; {KNOWN}"),
            Self::Twice(name) => write!(f, "'{name}' is given twice; keep one"),
            Self::BadProbability(word) => {
                write!(f, "bad probability in '{word}'; it must be 0 to 0.5")
            }
            Self::BadCount(word) => {
                write!(
                    f,
                    "bad frame number in '{word}'; it must be a whole number from 1 on"
                )
            }
        }
    }
}

impl core::error::Error for FaultsError {}

impl FromStr for Faults {
    type Err = FaultsError;

    fn from_str(text: &str) -> Result<Self, FaultsError> {
        let mut faults = Self::default();
        let mut named = Vec::new();
        let words = text.split(',').map(str::trim);
        for word in words.filter(|word| !word.is_empty()) {
            faults.read(word)?;
            let name = word.split(['=', '@']).next().unwrap_or(word).trim();
            if named.contains(&name) {
                return Err(FaultsError::Twice(name.into()));
            }
            named.push(name);
        }
        if named.is_empty() {
            return Err(FaultsError::Nothing);
        }
        Ok(faults)
    }
}

impl Faults {
    fn read(&mut self, word: &str) -> Result<(), FaultsError> {
        if let Some((name, count)) = word.split_once('@') {
            let place = match name.trim() {
                "reset" => &mut self.reset_at,
                "silent" => &mut self.silent_at,
                _ => return Err(FaultsError::Unknown(word.into())),
            };
            let count: Option<u64> = count.trim().parse().ok();
            *place = Some(
                count
                    .filter(|count| *count > 0)
                    .ok_or_else(|| FaultsError::BadCount(word.into()))?,
            );
            return Ok(());
        }
        let (name, value) = word
            .split_once('=')
            .ok_or_else(|| FaultsError::Unknown(word.into()))?;
        let place = match name.trim() {
            "drop" => &mut self.drop,
            "duplicate" => &mut self.duplicate,
            "corrupt" => &mut self.corrupt,
            "truncate" => &mut self.truncate,
            "delay" => &mut self.delay,
            _ => return Err(FaultsError::Unknown(word.into())),
        };
        let value: Option<f64> = value.trim().parse().ok();
        let possible = |value: &f64| (0.0..=0.5).contains(value);
        *place = value
            .filter(possible)
            .ok_or_else(|| FaultsError::BadProbability(word.into()))?;
        Ok(())
    }
}

/// `SplitMix64` [Steele, Lea and Flood, 2014].
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

/// One direction: frames that are late, soonest first among equals.
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

/// How often each fault was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Made {
    /// Frames that lost bytes.
    pub dropped: u64,
    /// Frames with bytes doubled.
    pub duplicated: u64,
    /// Frames with bytes changed.
    pub corrupted: u64,
    /// Frames cut off.
    pub truncated: u64,
    /// Frames late.
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
    /// The frame of the device that is not complete yet.
    partial: Vec<u8>,
    /// Overhears the host, for the number of a reset.
    overheard: u16,
    made: Made,
}

impl<L: Line> Faulty<L> {
    /// `line`, broken by `faults` drawn from `seed`.
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

    /// The line underneath.
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

    /// What becomes of a frame: its bytes, and how late they are.
    fn mangle(&mut self, frame: &[u8]) -> (Vec<u8>, Duration) {
        let Faults {
            drop,
            duplicate,
            corrupt,
            truncate,
            delay,
            ..
        } = self.faults;
        let mut bytes = frame.to_vec();
        if self.dice.chance(truncate) {
            self.made.truncated += 1;
            bytes.truncate(self.dice.below(bytes.len()));
        }
        if self.dice.chance(corrupt) && !bytes.is_empty() {
            self.made.corrupted += 1;
            for _ in 0..=self.dice.below(3) {
                let at = self.dice.below(bytes.len());
                bytes[at] ^= 1 + self.dice.below(255) as u8;
            }
        }
        if self.dice.chance(drop) && !bytes.is_empty() {
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
        if self.dice.chance(duplicate) && !bytes.is_empty() {
            self.made.duplicated += 1;
            if self.dice.below(2) == 0 {
                bytes.extend_from_within(..);
            } else {
                let at = self.dice.below(bytes.len());
                bytes.insert(at, bytes[at]);
            }
        }
        let mut late = Duration::ZERO;
        if self.dice.chance(delay) {
            self.made.delayed += 1;
            late =
                Duration::from_millis(1 + self.dice.below(MAX_DELAY.as_millis() as usize) as u64);
        }
        (bytes, late)
    }

    /// Tells the device to reboot, with a number that it must take for new.
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

    /// Mangles what the device said, frame by frame.
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
}

#[cfg(test)]
mod tests {
    use super::{Faults, FaultsError};

    #[test]
    fn a_specification_is_read() {
        let faults: Faults =
            "drop=0.02, duplicate=0.01,corrupt=0.5,truncate=0,delay=0.05,reset@120,silent@200"
                .parse()
                .unwrap();
        assert_eq!(
            faults,
            Faults {
                drop: 0.02,
                duplicate: 0.01,
                corrupt: 0.5,
                truncate: 0.0,
                delay: 0.05,
                reset_at: Some(120),
                silent_at: Some(200),
            }
        );
    }

    #[test]
    fn what_is_not_understood_is_named() {
        let error = |text: &str| text.parse::<Faults>().unwrap_err();
        assert_eq!(
            error("drop=0.1,loss=0.1"),
            FaultsError::Unknown("loss=0.1".into())
        );
        for text in ["", " , "] {
            assert_eq!(error(text), FaultsError::Nothing);
        }
        for (text, name) in [
            ("drop=0.1,drop=0.2", "drop"),
            ("reset@3, drop=0, reset @4", "reset"),
        ] {
            assert_eq!(error(text), FaultsError::Twice(name.into()));
        }
        assert_eq!(error("drop"), FaultsError::Unknown("drop".into()));
        assert_eq!(error("explode@3"), FaultsError::Unknown("explode@3".into()));
        for text in ["drop=1", "drop=-0.1", "drop=", "drop=NaN", "drop=2%"] {
            assert_eq!(error(text), FaultsError::BadProbability(text.into()));
        }
        for text in ["reset@0", "silent@", "reset@-1", "reset@1.5"] {
            assert_eq!(error(text), FaultsError::BadCount(text.into()));
        }
        assert!(error("loss=1").to_string().contains("use drop=P"));
    }
}
