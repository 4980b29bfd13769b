//! A link answers an observation with a command; only it differs between the rungs of a trial.

use fieldline_protocol::message::{
    Command, Control, FieldRow, Frontier, Identity, Observation, Status, Tile,
};

/// What can go wrong with a link; every variant ends a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkError {
    /// Nothing answered in time, after every retry.
    Silent,
    /// The device rebooted in the middle of the run.
    Reset,
    /// The peer speaks another protocol or schema, or is not a Fieldline device.
    Incompatible(String),
    /// The device refused a request.
    Refused(String),
    /// The port or process under the link failed.
    Io(String),
}

/// Counters of the host's end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    /// As [`LinkError`].
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
    fn frontiers(&mut self) -> Result<Vec<Frontier>, LinkError>;
    /// Counters.
    fn stats(&self) -> LinkStats;
}
