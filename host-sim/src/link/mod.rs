//! A link answers an observation with a command; only it differs between the rungs of a trial.
//!
//! | rung | file | what is between |
//! | --- | --- | --- |
//! | direct | [`direct`] | nothing: the pilot is called |
//! | loopback | [`loopback`] | frames, to a device in this process, in virtual time |
//! | qemu | [`qemu`] | frames, over a socket, to the image in an emulated STM32F405 |
//! | serial | [`serial`] | frames, over a serial port or a pty, to whatever is there |
//!
//! All but the first are an [`endpoint::Endpoint`] over a [`line::Line`]; [`fault`] breaks lines on purpose, and [`spec`] opens
//! what a user named.

use core::fmt;

use fieldline_protocol::message::{
    Command, Control, FieldRow, Identity, Observation, Path, ResidualFrontier, Status, Tile,
};
use serde::{Deserialize, Serialize};

pub mod digest;
pub mod direct;
pub mod endpoint;
pub mod fault;
pub mod image;
pub mod line;
#[cfg(feature = "logs")]
pub mod logs;
pub mod loopback;
pub mod qemu;
pub mod serial;
pub mod spec;
pub mod stream;

/// What can go wrong with a link; every variant ends a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkError {
    /// Nothing answered in time, after every retry. The robot must stand by now.
    Silent,
    /// The device rebooted in the middle of the run.
    Reset,
    /// The device's program crashed, and where.
    Crashed(String),
    /// The peer speaks another protocol or schema, or is not a Fieldline device.
    Incompatible(String),
    /// The device refused a request.
    Refused(String),
    /// The port or process under the link failed.
    Io(String),
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silent => f.write_str(
                "the device does not answer; check its power, the wiring and the baud rate",
            ),
            Self::Reset => f.write_str(
                "the device rebooted in the middle of the run; check its supply and start again",
            ),
            Self::Crashed(place) => write!(f, "the device's program crashed: {place}"),
            Self::Incompatible(why) => f.write_str(why),
            Self::Refused(why) => write!(f, "the device refused a request: {why}"),
            Self::Io(what) => f.write_str(what),
        }
    }
}

impl core::error::Error for LinkError {}

/// Counters of a link since its hello, as they stand in a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkStats {
    /// Frames sent.
    pub sent: u64,
    /// Frames received and accepted.
    pub received: u64,
    /// Requests sent again.
    pub retries: u64,
    /// Frames dropped (framing, length, format, order), both ends.
    pub dropped: u64,
    /// Frames dropped for a bad checksum, both ends.
    pub crc_errors: u64,
}

/// One rung: direct call, loopback bytes, QEMU, serial port.
pub trait Link {
    /// Who answers.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn hello(&mut self) -> Result<Identity, LinkError>;
    /// Change the session's state.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn control(&mut self, control: &Control) -> Result<Status, LinkError>;
    /// One step.
    ///
    /// # Errors
    /// As [`LinkError`]. On [`LinkError::Silent`] as much of the robot's time as the device's stale limit may have passed.
    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError>;
    /// One map tile.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError>;
    /// One row of the last field.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError>;
    /// Residual frontiers.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError>;
    /// Where the planner is going, without the first `from` cells of the road; nothing where it does not say.
    ///
    /// # Errors
    /// As [`LinkError`].
    fn road(&mut self, _from: u8) -> Result<Path, LinkError> {
        Ok(Path::default())
    }
    /// Counters.
    fn stats(&self) -> LinkStats;
    /// Log bytes (defmt) of the device since the last call; empty where there is no log.
    fn take_log(&mut self) -> Vec<u8> {
        Vec::new()
    }
}
