//! A link: it sends an observation to the planner and returns the command.
//!
//! A trial is the same over every link; only the link differs:
//!
//! | link | file | connection |
//! | --- | --- | --- |
//! | direct | [`direct`] | a function call of the pilot |
//! | loopback | [`loopback`] | frames to a device in this process, in virtual time |
//! | qemu | [`qemu`] | frames over a socket to the image in an emulated STM32F405 |
//! | serial | [`serial`] | frames over a serial port or a pty to any device |
//!
//! The last three are an [`endpoint::Endpoint`] over a [`line::Line`]. [`fault`] injects faults
//! into a line, and [`spec`] opens a link by name. [`cycles`] has what a model of the chip counts.

use thiserror::Error;

use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, CorrectionProgress, FieldRow, Identity, Observation,
    Packet, Path, Recall, Reply, Request, ResidualFrontier, Status, Tile,
};
use fieldline_protocol::{SCHEMA, VERSION};
use serde::{Deserialize, Serialize};

use correction::MapCorrection;
use cycles::StepCost;
use inside::Inside;

mod cargo;
pub mod correction;
pub mod cycles;
pub mod digest;
pub mod direct;
pub mod endpoint;
pub mod fault;
pub mod image;
pub mod inside;
pub mod line;
#[cfg(feature = "logs")]
pub mod logs;
pub mod loopback;
pub mod profile;
pub mod qemu;
pub(crate) mod said;
pub mod serial;
pub mod spec;
pub mod stream;

/// Errors of a link; every one ends the run.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum LinkError {
    /// No answer came in time after all retries; by then the robot has stopped.
    #[error("the device does not answer; check its power, the wiring and the baud rate")]
    Silent,
    /// The device rebooted during the run.
    #[error("the device rebooted during the run; {LOSS}; check its power supply and start again")]
    Reset,
    /// The device's program crashed, at this place.
    #[error("the device's program crashed: {0}; {LOSS}")]
    Crashed(String),
    /// The peer has another protocol or schema, or is not a Fieldline device.
    #[error("{0}")]
    Incompatible(String),
    /// The device refused a request.
    #[error("the device refused a request: {0}")]
    Refused(String),
    /// The port or process under the link failed.
    #[error("{0}")]
    Io(String),
}

/// What a reboot costs, in words.
const LOSS: &str = "its map, its pose and the state of its strategy are lost, so an exploration \
                    begins anew";

impl LinkError {
    /// Returns the names of what the device lost with this error: its memory, if it rebooted.
    #[must_use]
    pub const fn lost(&self) -> &'static [&'static str] {
        match self {
            Self::Reset | Self::Crashed(_) => &["map", "pose", "strategy"],
            Self::Silent | Self::Incompatible(_) | Self::Refused(_) | Self::Io(_) => &[],
        }
    }
}

/// Counters of a link since its hello, as in a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkStats {
    /// Frames sent.
    pub sent: u64,
    /// Frames received and accepted.
    pub received: u64,
    /// Requests that were sent again.
    pub retries: u64,
    /// Frames that either end dropped for framing, length, format or order.
    pub dropped: u64,
    /// Frames that either end dropped for a bad checksum.
    pub crc_errors: u64,
}

/// A link: direct call, loopback bytes, QEMU, serial port.
///
/// A link answers requests. A link around another one changes how it asks, and names the other's
/// end.
pub trait Link {
    /// Sends a request and returns its reply. A refusal is an error.
    ///
    /// # Errors
    /// As [`LinkError`]. On [`LinkError::Silent`], robot time of up to the device's stale limit may
    /// have passed.
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError>;
    /// Returns the end that answers.
    fn end(&self) -> &dyn End;

    /// Asks for the device's identity.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn hello(&mut self) -> Result<Identity, LinkError> {
        let request = Request::Hello {
            version: VERSION,
            schema: SCHEMA,
            nonce: 0,
        };
        match self.ask(&request)? {
            Reply::Hello(identity) => Ok(identity),
            _ => Err(unexpected("a hello")),
        }
    }

    /// Changes the session's state.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn control(&mut self, control: &Control) -> Result<Status, LinkError> {
        match self.ask(&Request::Control(control.clone()))? {
            Reply::Control(status) => Ok(status),
            _ => Err(unexpected("a control request")),
        }
    }

    /// Makes one step: sends an observation and returns the command.
    ///
    /// # Errors
    /// As [`Link::ask`].
    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        match self.ask(&Request::Observation(observation.clone()))? {
            Reply::Command(command) => Ok(command),
            _ => Err(unexpected("an observation")),
        }
    }

    /// Reads one map tile; `None` if the map does not have it.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError> {
        match self.ask(&Request::Tile { x, y })? {
            Reply::Tile(tile) => Ok(tile),
            _ => Err(unexpected("a request for a tile")),
        }
    }

    /// Reads one row of the last field; `None` if there is no field.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError> {
        match self.ask(&Request::FieldRow { row })? {
            Reply::FieldRow(row) => Ok(row),
            _ => Err(unexpected("a request for a field row")),
        }
    }

    /// Reads the residual frontiers.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
        match self.ask(&Request::Frontiers)? {
            Reply::Frontiers(frontiers) => Ok(frontiers.iter().copied().collect()),
            _ => Err(unexpected("a request for frontiers")),
        }
    }

    /// Reads the path to the planner's goal, without its first `from` cells; empty if the planner
    /// has none.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn path(&mut self, from: u8) -> Result<Path, LinkError> {
        match self.ask(&Request::Path { from })? {
            Reply::Path(path) => Ok(path),
            _ => Err(unexpected("a request for the road")),
        }
    }

    /// Passes on a packet that another robot of the team said.
    ///
    /// # Errors
    /// As [`LinkError`]; [`LinkError::Refused`] in a session without a team.
    fn hear(&mut self, packet: &Packet) -> Result<(), LinkError> {
        match self.ask(&Request::Hear(packet.clone()))? {
            Reply::Heard => Ok(()),
            _ => Err(unexpected("a packet")),
        }
    }

    /// Asks for the next packet for the team. Call this after each observation until it returns
    /// `None`: a planner says a beacon and at most three other packets in a step.
    ///
    /// # Errors
    /// As [`Link::hear`].
    fn say(&mut self) -> Result<Option<Packet>, LinkError> {
        match self.ask(&Request::Say)? {
            Reply::Say(packet) => Ok(packet),
            _ => Err(unexpected("a request for a packet")),
        }
    }

    /// Opens a correction of the map.
    ///
    /// # Errors
    /// As [`LinkError`]; [`LinkError::Refused`] by a baseline.
    fn open_correction(&mut self, correct: &Correct) -> Result<CorrectionProgress, LinkError> {
        match self.ask(&Request::Correct(*correct))? {
            Reply::Corrected(progress) => Ok(progress),
            _ => Err(unexpected("a correction")),
        }
    }

    /// Sends a part of the open correction.
    ///
    /// # Errors
    /// As [`Link::open_correction`].
    fn send_tiles(&mut self, part: &CorrectedTiles) -> Result<CorrectionProgress, LinkError> {
        match self.ask(&Request::Tiles(part.clone()))? {
            Reply::Corrected(progress) => Ok(progress),
            _ => Err(unexpected("a part of a correction")),
        }
    }

    /// Tells a device that was reset what lies around its robot, after its map and before its first
    /// step.
    ///
    /// # Errors
    /// As [`Link::open_correction`].
    fn recall(&mut self, recall: &Recall) -> Result<(), LinkError> {
        match self.ask(&Request::Recall(recall.clone()))? {
            Reply::Corrected(_) => Ok(()),
            _ => Err(unexpected("a recall")),
        }
    }

    /// Corrects the map. The robot stands until this returns.
    ///
    /// # Errors
    /// As [`Link::open_correction`].
    fn correct(&mut self, correction: &MapCorrection) -> Result<(), LinkError> {
        let mut progress = self.open_correction(&correction.opening())?;
        while !progress.closed {
            let first = progress.next;
            let part = correction.part(first);
            progress = self.send_tiles(&part)?;
            if !progress.closed && progress.next <= first {
                return Err(LinkError::Refused(format!(
                    "tile {first} of correction {} was not taken; send it anew with a later epoch",
                    correction.epoch
                )));
            }
        }
        Ok(())
    }
}

/// The end of a link that answers: what can be read of it without a request.
pub trait End {
    /// Returns the counters since the hello.
    fn stats(&self) -> LinkStats;
    /// Looks into the device, if it lives in this process.
    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        None
    }
    /// Returns what the last observation took on the chip by the model of its cycles; `None` where
    /// nothing models them, and until the next observation.
    fn cycles(&self) -> Option<StepCost> {
        None
    }
}

fn unexpected(what: &str) -> LinkError {
    LinkError::Incompatible(format!(
        "the device answered {what} with another kind of reply; \
         build both ends from the same source"
    ))
}
