//! The file of a state: bytes that are checked before anything is believed.
//!
//! ```text
//! magic 8 | version u16 | length of the body u32 | body (postcard) | CRC-32 of all before u32
//! ```
//!
//! Numbers are little-endian. A file that is cut, damaged, newer or none of ours is refused for
//! what it is.
//!
//! Units: metres, radians, milliseconds.

use core::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use crc::{CRC_32_ISO_HDLC, Crc};
use fieldline_protocol::message::{Start, Status};
use serde::{Deserialize, Serialize};

use super::journal::Answer;
use crate::link::correction::Classes;
use crate::report::MadeBy;

/// Name of the file in a run's folder.
pub const NAME: &str = "session.state";
/// Version of the format.
pub const VERSION: u16 = 2;

const MAGIC: [u8; 8] = *b"FLDSTATE";
/// Bytes before the body, and after it.
const HEAD: usize = MAGIC.len() + 2 + 4;
const TAIL: usize = 4;
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What a run knows after a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// What made the run.
    pub made_by: MadeBy,
    /// The session that the device was told.
    pub start: Start,
    /// Simulated time.
    pub time_ms: u32,
    /// Number of steps.
    pub steps: u32,
    /// Share of the explorable world that is known.
    pub coverage: f64,
    /// Status of the device.
    pub status: Status,
    /// The true pose: x, y, yaw.
    pub truth: [f64; 3],
    /// The last pose by odometry, in its own frame.
    pub odometry: [f32; 3],
    /// The same pose in the map.
    pub pose: [f32; 3],
    /// Where the session began, in the map.
    pub home: Option<[f32; 3]>,
    /// Number of the last correction of the map.
    pub epoch: u16,
    /// The tiles of the map in which something was measured: column, row, cells.
    pub tiles: Vec<((i16, i16), Classes)>,
    /// The planner's answers so far.
    pub answers: Vec<Answer>,
}

/// The reason why a state cannot be read.
#[derive(Debug)]
pub struct StateError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What is wrong with a file.
#[derive(Debug)]
pub enum Fault {
    /// It cannot be read.
    Io(std::io::Error),
    /// It does not begin as a state does.
    Foreign,
    /// Its format is of this version, and not of [`VERSION`].
    Other(u16),
    /// It has this many bytes, and says that it has another number.
    Cut(usize, usize),
    /// Its checksum is wrong.
    Damaged,
    /// Its body is no state, though its checksum is right.
    Malformed,
}

impl fmt::Display for StateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        const AGAIN: &str = "leave --resume out to make the run again";
        match &self.fault {
            Fault::Io(error) => write!(
                f,
                "cannot read {path}: {error}; --resume takes the folder --out of a run that was \
                 killed or interrupted, and one that has ended keeps no state"
            ),
            Fault::Foreign => write!(f, "{path} is no state of a run; {AGAIN}"),
            Fault::Other(version) => write!(
                f,
                "{path} has format {version}, and this program knows {VERSION}; resume it with the \
                 program that kept it"
            ),
            Fault::Cut(have, want) => {
                write!(f, "{path} has {have} bytes of {want}; it was cut; {AGAIN}")
            }
            Fault::Damaged => write!(f, "{path} is damaged: its checksum is wrong; {AGAIN}"),
            Fault::Malformed => write!(
                f,
                "{path} was kept by another build of this program; resume it with that one, or \
                 {AGAIN}"
            ),
        }
    }
}

// No source: the message includes it.
impl core::error::Error for StateError {}

impl State {
    /// Returns the bytes of the file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        // A state has only what postcard can write.
        let body = postcard::to_allocvec(self).unwrap_or_default();
        let mut bytes = Vec::with_capacity(HEAD + body.len() + TAIL);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((body.len() as u32).to_le_bytes());
        bytes.extend(body);
        bytes.extend(CRC.checksum(&bytes).to_le_bytes());
        bytes
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// What is wrong with them: every cut and every damaged byte is found.
    pub fn of_bytes(bytes: &[u8]) -> Result<Self, Fault> {
        let cut = |want| Fault::Cut(bytes.len(), want);
        let known = MAGIC.len().min(bytes.len());
        if bytes.is_empty() || bytes[..known] != MAGIC[..known] {
            return Err(Fault::Foreign);
        }
        let Some((head, rest)) = bytes.split_at_checked(HEAD) else {
            return Err(cut(HEAD + TAIL));
        };
        let version = u16::from_le_bytes([head[8], head[9]]);
        if version != VERSION {
            return Err(Fault::Other(version));
        }
        let length = u32::from_le_bytes([head[10], head[11], head[12], head[13]]) as usize;
        let want = HEAD.saturating_add(length).saturating_add(TAIL);
        if bytes.len() < want {
            return Err(cut(want));
        }
        let Some((body, tail)) = rest.split_at_checked(length) else {
            return Err(cut(want));
        };
        let sum = CRC.checksum(&bytes[..HEAD + length]).to_le_bytes();
        if tail != sum {
            return Err(Fault::Damaged);
        }
        match postcard::take_from_bytes(body) {
            Ok((state, [])) => Ok(state),
            _ => Err(Fault::Malformed),
        }
    }

    /// Reads the state of a folder, or the file itself.
    ///
    /// # Errors
    /// As [`StateError`].
    pub fn read(path: &Path) -> Result<Self, StateError> {
        let path = if path.is_dir() {
            path.join(NAME)
        } else {
            path.to_owned()
        };
        let bytes = fs::read(&path).map_err(Fault::Io);
        let state = bytes.and_then(|bytes| Self::of_bytes(&bytes));
        state.map_err(|fault| StateError { path, fault })
    }
}

#[cfg(test)]
mod tests {
    use super::{Fault, State};
    use crate::report::MadeBy;
    use crate::state::Answer;
    use fieldline_protocol::message::{Command, Start, Status};
    use proptest::prelude::{any, proptest};

    fn sample() -> State {
        State {
            made_by: MadeBy::default(),
            start: Start::default(),
            time_ms: 12_000,
            steps: 60,
            coverage: 0.25,
            status: Status::Exploring,
            truth: [1.0, 2.0, 0.5],
            odometry: [1.0, 2.0, 0.5],
            pose: [1.1, 2.1, 0.6],
            home: Some([0.0; 3]),
            epoch: 1,
            tiles: vec![((0, -1), [[5; 32], [1 << 31; 32]])],
            answers: vec![
                Answer::Status(Status::Exploring),
                Answer::Command(Command::default()),
                Answer::Refused("no".into()),
                Answer::Reset,
                Answer::Done,
            ],
        }
    }

    #[test]
    fn a_state_reads_as_it_was_written_and_every_cut_is_refused() {
        let (state, bytes) = (sample(), sample().to_bytes());
        assert_eq!(State::of_bytes(&bytes).expect("a state"), state);
        for length in 0..bytes.len() {
            let fault = State::of_bytes(&bytes[..length]).expect_err("it is cut");
            let is_told = matches!(fault, Fault::Cut(have, _) if have == length);
            assert!(is_told || length == 0, "{length}: {fault:?}");
        }
        let longer = [&bytes[..], &[0]].concat();
        assert!(matches!(State::of_bytes(&longer), Err(Fault::Damaged)));
    }

    #[test]
    fn every_wrong_byte_is_refused() {
        let bytes = sample().to_bytes();
        for (place, flip) in
            (0..bytes.len()).flat_map(|place| [1, 0x80, 0xff].map(|it| (place, it)))
        {
            let mut wrong = bytes.clone();
            wrong[place] ^= flip;
            let fault = State::of_bytes(&wrong).expect_err("a byte is wrong");
            let wanted = match place {
                0..8 => matches!(fault, Fault::Foreign),
                8..10 => matches!(fault, Fault::Other(_)),
                10..14 => matches!(fault, Fault::Cut(..) | Fault::Damaged),
                _ => matches!(fault, Fault::Damaged),
            };
            assert!(wanted, "{place}: {fault:?}");
        }
    }

    #[test]
    fn a_file_of_another_version_and_a_foreign_one_are_named() {
        for version in [1, 3] {
            let mut other = sample().to_bytes();
            other[8] = version;
            let fault = State::of_bytes(&other).expect_err("it has another version");
            assert!(matches!(fault, Fault::Other(it) if it == u16::from(version)));
        }
        assert!(matches!(
            State::of_bytes(b"{\"a\": 1}"),
            Err(Fault::Foreign)
        ));
    }

    proptest! {
        #[test]
        fn flipped_bytes_and_any_bytes_are_refused(
            flips in proptest::collection::vec((any::<usize>(), 1..=255_u8), 1..20),
            noise in proptest::collection::vec(any::<u8>(), 0..300),
        ) {
            let bytes = sample().to_bytes();
            let mut wrong = bytes.clone();
            for (place, flip) in flips {
                let place = place % wrong.len();
                wrong[place] ^= flip;
            }
            if wrong != bytes {
                assert!(State::of_bytes(&wrong).is_err());
            }
            assert!(State::of_bytes(&noise).is_err());
            // A body of noise with a right checksum is no panic either.
            let body = noise;
            let mut file = [&bytes[..10], &(body.len() as u32).to_le_bytes(), &body].concat();
            file.extend(super::CRC.checksum(&file).to_le_bytes());
            let _ = State::of_bytes(&file);
        }
    }
}
